//! Elevation rasters: their georeference, one file per format, warping to a metric system; scattered points, and grids
//! of them.

pub mod answer;
pub mod archive;
pub mod error;
pub mod formats;
pub mod georef;
pub mod gridding;
pub mod mosaic;
pub mod points;
pub mod raster;
pub mod read;
pub mod recent;
pub mod sample;
pub mod stats;
pub mod tiff;
pub mod valid;
pub mod vertical;
pub mod voids;
pub mod warp;
pub mod windows;
pub mod write;
