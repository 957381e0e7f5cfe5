//! Looking: the camera, its frustum, and how large things appear.

pub mod camera;
pub mod flight;
pub mod frustum;
