//! Changes to the ground: the alignment of roads and rivers, and the earthworks that follow from it.

pub mod alignment;
pub mod brush;
pub mod channel;
pub mod coast;
pub mod coast_polygons;
pub mod earthwork;
pub mod falling_levels;
pub mod grading;
pub mod held_posts;
pub mod level_ground;
pub mod leveling;
pub mod pad;
pub mod shore;
