//! What to draw, never how: the contract between scenes and renderers.

pub mod color;
pub mod ground;
pub mod lighting;
pub mod list;
pub mod material;
pub mod pixels;
