//! The mask of a TIFF: an image of 1 or 8 bits whose zeros say "no data here", within the file or in one of its own
//! beside it (`.tif.msk`).

use std::io::{Cursor, Read, Seek};

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use crate::dem::error::{DemErrorKind, MOST_SAMPLES};
use crate::dem::raster::Samples;
use crate::dem::tiff::neutral::neutralised;
use crate::dem::tiff::storage::{FORMAT, Storage, TiffBlock, fault};

/// Images after this many are not looked at.
pub(crate) const MOST_IMAGES: usize = 64;

/// NewSubfileType's bit for "mask of another image".
pub(crate) const IS_MASK: u32 = 4;

/// Whether there is a mask, within or beside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MaskLocation {
    /// There is one, and it was applied.
    Mask,
    /// There is none.
    Nothing,
}

/// Makes NaN of what the mask hides that lies in a file of its own; its bytes are `mask`.
pub(crate) fn apply_beside(
    mask: &[u8],
    limits: impl Fn(usize) -> Limits,
    size: (u32, u32),
    samples: &mut Samples,
) -> Result<(), DemErrorKind> {
    let bytes = neutralised(mask);
    let mut decoder = Decoder::new(Cursor::new(&bytes[..])).map_err(fault)?.with_limits(limits(bytes.len()));
    let found = decoder.dimensions().map_err(fault)?;
    if found != size {
        let reason =
            format!("the mask beside it has {} x {} samples, not {} x {}", found.0, found.1, size.0, size.1);
        return Err(DemErrorKind::broken(FORMAT, reason));
    }
    hide(&mut decoder, bytes.len(), samples)
}

/// Looks for a mask of the same size among the images after the first and makes NaN of what it hides.
pub(crate) fn apply<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    size: (u32, u32),
    file_bytes: usize,
    samples: &mut Samples,
) -> Result<MaskLocation, DemErrorKind> {
    for _ in 0..MOST_IMAGES {
        // A broken overview or page is no reason to refuse the image before it.
        if !decoder.more_images() || decoder.next_image().is_err() {
            return Ok(MaskLocation::Nothing);
        }
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType).ok().flatten().unwrap_or(0);
        if kind & IS_MASK != 0 && decoder.dimensions().is_ok_and(|found| found == size) {
            return hide(decoder, file_bytes, samples).map(|()| MaskLocation::Mask);
        }
    }
    Ok(MaskLocation::Nothing)
}

fn hide<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    file_bytes: usize,
    samples: &mut Samples,
) -> Result<(), DemErrorKind> {
    let storage = Storage::of(decoder, file_bytes, MOST_SAMPLES)?;
    check(&storage)?;
    for at in storage.blocks() {
        let block = block(decoder, &storage, at)?;
        for (x, y) in block.hidden() {
            samples.clear((at.row as usize + y) * storage.width as usize + at.column as usize + x);
        }
    }
    Ok(())
}

/// Whether a mask is stored in a way that is read.
pub(crate) fn check(storage: &Storage) -> Result<(), DemErrorKind> {
    match storage.bits {
        1 | 8 => Ok(()),
        bits => Err(DemErrorKind::broken(FORMAT, format!("its mask has {bits} bits"))),
    }
}

/// One block of a mask.
pub(crate) struct MaskBlock {
    bytes: Vec<u8>,
    size: (usize, usize),
    bits: usize,
}

/// Decodes a block of a mask.
pub(crate) fn block<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    TiffBlock { index, width, height, .. }: TiffBlock,
) -> Result<MaskBlock, DemErrorKind> {
    // What was never written hides what lies under it.
    let bytes = match storage.is_written(index).then(|| decoder.read_chunk(index)) {
        Some(Ok(DecodingResult::U8(bytes))) => bytes,
        Some(Ok(_)) => return Err(DemErrorKind::broken(FORMAT, "its mask does not hold bytes")),
        Some(Err(error)) => return Err(fault(error)),
        None => Vec::new(),
    };
    Ok(MaskBlock { bytes, size: (width as usize, height as usize), bits: storage.bits.into() })
}

impl MaskBlock {
    /// The columns and rows within the block that it hides.
    pub fn hidden(&self) -> impl Iterator<Item = (usize, usize)> {
        let (width, height) = self.size;
        let places = (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
        places.filter(|&(x, y)| !self.shows(x, y))
    }

    fn shows(&self, x: usize, y: usize) -> bool {
        let row_bytes = (self.size.0 * self.bits).div_ceil(8);
        let byte = self.bytes.get(y * row_bytes + x * self.bits / 8).copied().unwrap_or(0);
        if self.bits == 8 { byte != 0 } else { byte & (0x80 >> (x % 8)) != 0 }
    }
}
