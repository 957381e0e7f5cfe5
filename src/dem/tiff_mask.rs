//! The internal mask of a TIFF: a second image of 1 or 8 bits whose zeros say "no data here".

use std::io::{Read, Seek};

use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

use crate::dem::fault::Fault;
use crate::dem::raster::Samples;
use crate::dem::tiff_blocks::{FORMAT, Storage, fault};

/// Images after this many are not looked at.
const MOST_IMAGES: usize = 64;

/// NewSubfileType's bit for "mask of another image".
const IS_MASK: u32 = 4;

/// Looks for a mask of the same size among the images after the first and makes NaN of what it hides.
pub(crate) fn apply<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    size: (u32, u32),
    file_bytes: usize,
    samples: &mut Samples,
) -> Result<(), Fault> {
    for _ in 0..MOST_IMAGES {
        // A broken overview or page is no reason to refuse the image before it.
        if !decoder.more_images() || decoder.next_image().is_err() {
            return Ok(());
        }
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType).ok().flatten().unwrap_or(0);
        if kind & IS_MASK != 0 && decoder.dimensions().is_ok_and(|found| found == size) {
            return hide(decoder, file_bytes, samples);
        }
    }
    Ok(())
}

fn hide<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    file_bytes: usize,
    samples: &mut Samples,
) -> Result<(), Fault> {
    let storage = Storage::of(decoder, file_bytes)?;
    let bits = usize::from(storage.bits);
    if ![1, 8].contains(&bits) {
        return Err(Fault::broken(FORMAT, format!("its mask has {bits} bits")));
    }
    for (index, column, row) in storage.blocks(decoder) {
        let (width, height) = decoder.chunk_data_dimensions(index);
        // What was never written hides what lies under it.
        let block = match storage.is_written(index).then(|| decoder.read_chunk(index)) {
            Some(Ok(DecodingResult::U8(bytes))) => bytes,
            Some(Ok(_)) => return Err(Fault::broken(FORMAT, "its mask does not hold bytes")),
            Some(Err(error)) => return Err(fault(error)),
            None => Vec::new(),
        };
        let row_bytes = (width as usize * bits).div_ceil(8);
        for y in 0..height as usize {
            for x in 0..width as usize {
                let byte = block.get(y * row_bytes + x * bits / 8).copied().unwrap_or(0);
                let shown = if bits == 8 { byte != 0 } else { byte & (0x80 >> (x % 8)) != 0 };
                let at = (row as usize + y) * storage.width as usize + column as usize + x;
                if !shown {
                    samples.clear(at);
                }
            }
        }
    }
    Ok(())
}
