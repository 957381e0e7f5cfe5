//! GeoTIFF: the storage and the georeference of images, reading in whole or in windows, and writing.

mod blocks;
mod gdal_metadata;
mod geokey_codes;
pub mod geokeys;
pub(crate) mod geotiff;
pub mod images;
pub(crate) mod jpeg_block;
mod large_window;
mod mask;
mod place;
mod rows;
pub(crate) mod storage;
pub(crate) mod unpack;
pub mod windows;
pub mod write;
mod write_geokeys;

use std::io::{Read, Seek};

use tiff::decoder::Decoder;
use tiff::tags::Tag;

/// The bits of NewSubfileType of the decoder's current image; 0 where it has none.
pub(crate) fn image_kind<R: Read + Seek>(decoder: &mut Decoder<R>) -> u32 {
    decoder.find_tag_unsigned(Tag::NewSubfileType).ok().flatten().unwrap_or(0)
}
