//! The window that walks through a scene.
