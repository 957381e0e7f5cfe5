//! Elevation rasters: their formats and georeference, mosaics, voids, other systems and cells; scattered points, and
//! grids of them.

pub mod answer;
pub mod cache;
pub mod cell_grid;
pub mod crop;
pub mod error;
pub mod formats;
pub mod georef;
pub mod gridding;
pub mod height_datum;
pub mod imagery;
pub mod largest_rectangle;
pub mod limits;
pub mod mosaic;
pub mod mosaic_windows;
mod north_up;
pub mod outliers;
mod point_text;
pub mod points;
pub mod raster;
pub mod read;
pub(crate) mod read_ahead;
pub mod reduced;
pub mod reduced_windows;
pub mod sample;
mod sample_type;
pub mod stats;
mod stored;
pub mod tiff;
pub mod undeclared;
pub mod units;
pub mod vertical;
pub mod void_counts;
pub mod voids;
pub mod vrt;
mod vrt_frame;
pub mod vrt_source;
pub mod warp;
pub mod windows;
pub mod write;

/// The program of the README runs as a test.
#[cfg(doctest)]
#[doc = include_str!("README.md")]
pub struct DemReadme;
