//! Looking: the camera, its frustum or wedge, and how large things appear.

pub mod camera;
pub mod flight;
pub mod frustum;
pub mod planes;
pub mod wedge;
