//! Mathematics on `glam` and `geo`: no terrain, no files.

pub mod aabb;
pub mod convex;
pub mod crs;
pub mod crs_fault;
pub mod datum_shift;
pub mod distance_field;
pub mod geodesic;
pub mod leg_tree;
pub mod mgrs;
pub mod morton;
pub mod offset;
pub mod polygon;
pub mod polyline;
pub mod profile;
pub(crate) mod proj_string;
pub mod projection;
pub mod rect;
pub mod rect_tree;
pub mod region;
pub mod segment;
pub mod simplify;
pub mod spline;
pub mod sun_position;
pub mod triangle;
pub mod wkt;
pub mod wkt_writer;
