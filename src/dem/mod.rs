//! Elevation rasters: their georeference, one file per format, warping to a metric system.

pub mod raster;
