//! Elevation files: reading, writing, gridding, joining and paging.

#[path = "../common/mod.rs"]
mod common;

mod dem_oracle;
mod demo_data;
mod extents;
mod gridding;
mod mosaics;
mod paging;
mod raster_writers;
mod stored;
mod straight_edges;
mod virtual_rasters;
