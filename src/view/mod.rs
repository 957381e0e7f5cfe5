//! Looking: the camera, its frustum, and how large things appear.

pub mod camera;
pub mod frustum;
