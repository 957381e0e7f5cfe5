//! Blocks of a TIFF that are LERC, as libtiff writes them: all bands of a pixel are one depth of it, but for an alpha band,
//! which is the mask; a float that the mask hides is NaN.
//!
//! libtiff packs what it would write to the file: samples of a big-endian file have their bytes turned first, and are packed
//! as the numbers that these are on a little-endian machine.

use crate::lerc::{self, LercShape};
use crate::tiff::fault::{self, TO_DEFLATE};
use crate::tiff::storage::{Storage, TiffBlock};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::sample_type::SampleType;

/// Decodes a block of the image that is stored so to the bytes of its rows that lie in the image.
///
/// # Errors
/// The stream is broken, of another size or type than the block, or has other values than the image has bands.
pub(crate) fn decode(
    packed: &[u8],
    storage: &Storage,
    block: TiffBlock,
    rows: &mut [u8],
) -> Result<(), DemErrorKind> {
    let (columns, bands) = (storage.block_width as usize, usize::from(storage.bands_per_block));
    let sample = storage.elevation_type()?;
    let shape = LercShape { columns, rows: storage.stored_rows(block) as usize, sample, depth: bands };
    let decoded = lerc::decode(packed, shape).map_err(|error| match error.is_unsupported() {
        true => fault::unsupported(error, TO_DEFLATE),
        false => fault::broken(format!("block {} is no sound LERC: {error}", block.index)),
    })?;
    let has_alpha = decoded.depth + 1 == bands && matches!(sample, SampleType::U8 | SampleType::U16);
    if decoded.depth != bands && !has_alpha {
        let found = decoded.depth;
        return Err(fault::broken(format!("block {} holds {found} values for {bands} bands", block.index)));
    }
    if !decoded.is_whole() && !has_alpha && !sample.is_float() {
        return Err(fault::unsupported("LERC blocks with a mask of integers", TO_DEFLATE));
    }
    let (_, opaque) = sample.range();
    let mut values = Vec::with_capacity(columns * bands);
    let mut bytes = Vec::with_capacity(columns * bands * sample.bytes());
    let pixel_values = decoded.values.chunks_exact(columns * decoded.depth);
    for (row, (out, pixels)) in
        rows.chunks_exact_mut(storage.row_bytes().max(1)).zip(pixel_values).enumerate()
    {
        values.clear();
        for (column, pixel) in pixels.chunks_exact(decoded.depth).enumerate() {
            let is_valid = decoded.is_valid(row * columns + column);
            match (is_valid, has_alpha) {
                (false, false) => values.extend(pixel.iter().map(|_| f64::NAN)),
                _ => values.extend(pixel),
            }
            values.extend(has_alpha.then_some(if is_valid { opaque } else { 0.0 }));
        }
        bytes.clear();
        sample.write(&values, &mut bytes);
        out.copy_from_slice(&bytes);
    }
    Ok(())
}
