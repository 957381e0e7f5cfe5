//! GeoTIFF: the storage and the georeference of images, reading in whole or in windows, and writing.

mod blocks;
pub(crate) mod decoder;
pub(crate) mod fault;
mod gdal_metadata;
mod geokey_codes;
pub mod geokeys;
pub(crate) mod geotiff;
pub(crate) mod header;
pub mod images;
pub(crate) mod jpeg_block;
mod large_window;
mod lerc_block;
mod mask;
mod place;
mod rows;
pub(crate) mod storage;
pub(crate) mod unpack;
pub mod windows;
pub mod write;
mod write_computed;
mod write_geokeys;
mod xz;
