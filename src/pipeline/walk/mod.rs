//! A walk through a scene: the ground refined from frame to frame, and what lies on it cut again where it changed.
