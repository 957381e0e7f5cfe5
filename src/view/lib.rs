//! The camera, its frustum or ground wedge, flights, moving by hand, and the size of things on the picture.

pub mod axes;
pub mod camera;
pub mod flight;
pub mod frustum;
pub mod navigation;
pub mod panorama;
pub mod planes;
pub mod wedge;
