//! The mask of a TIFF: an image of 1 or 8 bits whose zeros mean "no data here", within the file or in a file beside it
//! (`.tif.msk`).

use std::io::{Cursor, Read, Seek};

use tiff::decoder::Decoder;

use crate::dem_file::DemFile;
use crate::tiff::decoder::limits;
use crate::tiff::decoder::{IS_MASK, image_kind};
use crate::tiff::fault::{self, decode_error};
use crate::tiff::storage::{Predictor, Storage};
use crate::tiff::unpack::{BlockBytes, Unpacker};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::TIFF_IMAGES;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Samples;
use sandtable_raster::windows::RasterWindow;

/// The bytes of the `.msk` file in which GDAL keeps a mask.
pub(crate) fn file_beside(file: &DemFile) -> Option<Vec<u8>> {
    (file.hints.companions)(&format!("{}.msk", file.name))
}

/// Sets the samples to NaN that the mask in a file beside the image hides.
pub(crate) fn apply_beside(
    bytes: &[u8],
    (width, height): (u32, u32),
    samples: &mut Samples,
) -> Result<(), DemErrorKind> {
    let decoder = Decoder::new(Cursor::new(bytes)).map_err(decode_error)?;
    let mut decoder = decoder.with_limits(limits(bytes.len()));
    let found = decoder.dimensions().map_err(decode_error)?;
    if found == (width, height) {
        return hide(&mut decoder, bytes, samples);
    }
    Err(fault::broken(format!(
        "the mask beside it has {} x {} samples, not {width} x {height}",
        found.0, found.1
    )))
}

/// Sets the samples to NaN that a mask of the same size among the later images hides; returns whether there is one.
pub(crate) fn apply_within(
    decoder: &mut Decoder<Cursor<&[u8]>>,
    bytes: &[u8],
    size: (u32, u32),
    samples: &mut Samples,
) -> Result<bool, DemErrorKind> {
    for _ in 0..TIFF_IMAGES.count() {
        // A broken overview or page is no reason to refuse the image before it.
        if !decoder.more_images() || decoder.next_image().is_err() {
            return Ok(false);
        }
        if image_kind(decoder) & IS_MASK != 0 && decoder.dimensions().is_ok_and(|found| found == size) {
            return hide(decoder, bytes, samples).map(|()| true);
        }
    }
    Ok(false)
}

fn hide<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    mut bytes: &[u8],
    samples: &mut Samples,
) -> Result<(), DemErrorKind> {
    let storage = Storage::read(decoder, bytes.len(), &RASTER_SAMPLES)?;
    check(&storage)?;
    let (width, height) = (storage.width, storage.height);
    let window = RasterWindow { column: 0, row: 0, width, height };
    each_hidden(&mut bytes, &storage, window, |index| samples.set(index, f64::NAN))
}

/// Checks that a mask is stored in a way that is read.
pub(crate) fn check(storage: &Storage) -> Result<(), DemErrorKind> {
    if !matches!(storage.bits, 1 | 8) {
        return Err(fault::broken(format!("its mask has {} bits", storage.bits)));
    }
    if storage.predictor != Predictor::Plain || storage.bands_per_block != 1 {
        let remedy = "convert it, for example with: gdal_translate FILE out.tif";
        return Err(fault::unsupported("a mask of several bands or with a predictor", remedy));
    }
    Ok(())
}

/// Calls `hide` with the index in `window` of each of its samples that a mask hides.
pub(crate) fn each_hidden(
    file: &mut impl BlockBytes,
    mask: &Storage,
    window: RasterWindow,
    mut hide: impl FnMut(usize),
) -> Result<(), DemErrorKind> {
    let (mut unpacker, mut packed) = (Unpacker::new(mask), Vec::new());
    for block in mask.blocks_meeting(window) {
        packed.clear();
        // A block that was never written hides all samples.
        if mask.is_written(block.index) {
            unpacker.unpack(file, block, &mut packed)?;
        }
        let shows = |column: usize, row: usize| {
            let byte = packed
                .get(row * mask.row_bytes() + column * usize::from(mask.bits) / 8)
                .copied()
                .unwrap_or(0);
            if mask.bits == 8 { byte != 0 } else { byte & (0x80 >> (column % 8)) != 0 }
        };
        let width = block.window.width as usize;
        for (in_block, in_window) in block.window.shared_rows(window) {
            in_block
                .zip(in_window)
                .filter(|(at, _)| !shows(at % width, at / width))
                .for_each(|(_, at)| hide(at));
        }
    }
    Ok(())
}
