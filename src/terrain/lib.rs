//! The ground: one lattice of heights, the light that reaches it, the height query service, and lines of sight over it.

pub mod cell_triangle;
pub mod densify;
pub mod full_resolution;
mod height_scan;
pub mod hillshade;
pub mod lattice;
mod lattice_cut;
mod level_regions;
pub mod light;
mod low_regions;
pub mod neighbors;
pub mod post_rect;
pub mod profile;
pub mod prominence;
pub mod pyramid;
pub mod query;
mod returned_memory;
mod row_order;
pub mod sight;
mod slopes;
pub mod stop_flag;
pub mod support_surface;
pub mod terraces;
pub mod triangle_surface;
pub mod volumes;
pub mod water_cover;
pub mod water_shore;
