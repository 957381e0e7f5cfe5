//! GeoTIFF: how an image is stored, where it lies, and how windows of it are read.

pub mod blocks;
pub mod file;
pub mod gdal_metadata;
pub mod geokeys;
pub mod geotiff;
pub mod lzw;
pub mod mask;
pub mod neutral;
pub mod rows;
pub mod storage;
pub mod unpack;
pub mod windows;
