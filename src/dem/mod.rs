//! Elevation rasters: their georeference, one file per format, warping to a metric system.

pub mod archive;
pub mod ascii;
pub mod bt;
pub mod fault;
pub mod gdal_metadata;
pub mod geokeys;
pub mod georef;
pub mod geotiff;
pub mod gridding;
pub mod hgt;
pub mod png;
pub mod points;
pub mod raster;
pub mod read;
pub mod recent;
pub mod sample;
pub mod stats;
pub mod tiff_blocks;
pub mod tiff_file;
pub mod tiff_mask;
pub mod tiff_neutral;
pub mod tiff_windows;
pub mod valid;
pub mod warp;
pub mod warp_line;
pub mod windows;
