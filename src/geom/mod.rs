//! Mathematics on `glam` and `geo`: no terrain, no files.

pub mod crs;
pub mod polygon;
pub mod polyline;
pub mod projection;
pub mod rect;
pub mod region;
pub mod wkt;
