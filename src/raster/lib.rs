//! Elevation values: rasters in memory and in windows, mosaics, statistics, voids, other systems and cells. No file format is
//! known here.

pub mod answer;
pub mod cache;
pub mod cell_grid;
pub mod class_grid;
pub mod class_outlines;
pub mod class_sieve;
pub mod content;
pub mod crop;
pub mod error;
pub mod file_bands;
pub mod georef;
pub mod height_datum;
mod joined_samples;
pub mod largest_rectangle;
pub mod limits;
pub mod mosaic;
mod mosaic_in_cells;
pub mod mosaic_windows;
mod nested_tile;
pub mod nodata_span;
mod north_up;
pub mod odd_values;
pub mod outliers;
pub mod raised;
pub mod raster;
pub mod read_ahead;
pub mod reduced;
pub mod reduced_windows;
pub mod sample;
pub mod sample_type;
pub mod stats;
pub mod stored;
pub mod undeclared;
pub mod unstated_unit;
pub mod vertical;
pub mod void_counts;
pub mod voids;
pub mod warp;
pub mod windows;

/// The program of the README runs as a test.
#[cfg(doctest)]
#[doc = include_str!("README.md")]
pub struct RasterReadme;
