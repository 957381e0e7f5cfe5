//! Blocks of a TIFF that are JPEG streams (Adobe, TIFF Technical Note 2, 1995): abbreviated streams, whose tables lie in
//! the tag `JPEGTables`, once for all.
//!
//! ```text
//! JPEGTables  SOI │ DQT, DHT … │ EOI
//! block       SOI │ SOF, SOS … │ EOI     ─►   SOI │ DQT, DHT … │ SOF, SOS … │ EOI
//! ```
//!
//! The photometric interpretation says whether the three components are red, green and blue, or luminance and chroma;
//! nothing within the stream need say so.

use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use crate::tiff::fault::{self, TO_DEFLATE};
use crate::tiff::storage::{Storage, TiffBlock};
use sandtable_raster::error::DemErrorKind;

/// Bytes of a marker: the start of the image, and its end.
const MARKER: usize = 2;

/// The photometric interpretation "luminance and chroma".
pub(crate) const YCBCR: u16 = 6;

/// The bands of a block side by side, red, green and blue in place of luminance and chroma: the rows within the image,
/// each as long as the stream's.
pub(crate) struct JpegBlock {
    pub samples: Vec<u8>,
    pub row_bytes: usize,
}

/// Decodes a block of the image that is stored so.
///
/// # Errors
/// The stream is broken, of another size than the block, or has other components than the image has bands.
pub(crate) fn decode(
    packed: &[u8],
    storage: &Storage,
    block: TiffBlock,
    photometric: u16,
) -> Result<JpegBlock, DemErrorKind> {
    let tables = &storage.jpeg_tables;
    let tables = tables.get(..tables.len().saturating_sub(MARKER)).filter(|tables| tables.len() > MARKER);
    let stream = match tables {
        Some(tables) => [tables, packed.get(MARKER..).unwrap_or_default()].concat(),
        None => packed.to_vec(),
    };
    let options = DecoderOptions::default()
        .set_max_width(storage.block_width as usize)
        .set_max_height(storage.block_height as usize);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&stream), options);
    let broken = |error| fault::broken(format!("block {} is no sound JPEG ({error})", block.index));
    decoder.decode_headers().map_err(broken)?;
    let bands = usize::from(storage.bands_per_block);
    let input = decoder.input_colorspace().unwrap_or(ColorSpace::Unknown);
    let output = match (input, bands) {
        (ColorSpace::Luma, 1) => ColorSpace::Luma,
        (ColorSpace::YCbCr, 3) if photometric == YCBCR => ColorSpace::RGB,
        // Three components without a word on their meaning are taken for luminance and chroma: left as they are.
        (ColorSpace::YCbCr | ColorSpace::RGB, 3) => input,
        _ => {
            let found = format!("JPEG blocks of {} components for {bands} bands", input.num_components());
            return Err(fault::unsupported(found, TO_DEFLATE));
        }
    };
    decoder.set_options(options.jpeg_set_out_colorspace(output));
    let samples = decoder.decode().map_err(broken)?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    let is_whole = width >= block.window.width as usize && height >= block.window.height as usize;
    if !is_whole || samples.len() < width * height * bands {
        let index = block.index;
        return Err(fault::broken(format!(
            "block {index} is a JPEG of {width} x {height} pixels, too small"
        )));
    }
    Ok(JpegBlock { samples, row_bytes: width * bands })
}
