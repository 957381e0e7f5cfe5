//! The images of a GeoTIFF that stays on disk, and its file, which they and the threads that decode blocks share.

use std::borrow::Cow;
use std::io::{self, BufReader, SeekFrom};
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::UVec2;
use tiff::decoder::Decoder;

use crate::tiff::decoder::{IS_MASK, IS_REDUCED, image_kind, limits};
use crate::tiff::fault::{self, decode_error};
use crate::tiff::storage::Storage;
use crate::tiff::unpack::BlockBytes;
use sandtable_base::limits::BLOCK_SAMPLES;
use sandtable_base::limits::TIFF_IMAGES;
use sandtable_base::limits::WINDOWED_SAMPLES;
use sandtable_raster::content::{FileContent, ReadByPlace};
use sandtable_raster::error::DemErrorKind;

/// The most bytes that one block decodes to: the largest with 64-bit samples.
const LARGEST_BLOCK: usize = 32 << 20;

/// A reduced image of the same ground in the same file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overview {
    /// Samples per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    pub(super) image: usize,
}

/// The overviews and the masks among the images after the first.
#[derive(Clone, Debug, Default)]
pub(super) struct LaterImages {
    pub overviews: Vec<Overview>,
    pub masks: Vec<Overview>,
}

/// A file that a raster shares with its overviews.
pub(super) struct SharedFile<R> {
    file: Arc<Mutex<R>>,
    /// Where threads need not wait for each other.
    by_place: Option<Arc<dyn ReadByPlace>>,
    pub length: usize,
}

impl<R> Clone for SharedFile<R> {
    fn clone(&self) -> Self {
        Self { file: Arc::clone(&self.file), by_place: self.by_place.clone(), length: self.length }
    }
}

impl<R: FileContent> SharedFile<R> {
    pub fn new(mut file: R) -> io::Result<Self> {
        let length = usize::try_from(file.seek(SeekFrom::End(0))?).map_err(io::Error::other)?;
        let by_place = file.by_place();
        Ok(Self { file: Arc::new(Mutex::new(file)), by_place, length })
    }

    pub fn lock(&self) -> MutexGuard<'_, R> {
        // A reader that panicked elsewhere left no state here: every read seeks first.
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn decoder<'a>(&self, file: &'a mut R) -> Result<Decoder<BufReader<&'a mut R>>, DemErrorKind> {
        file.rewind().map_err(fault::unread)?;
        let decoder = Decoder::new(BufReader::new(file)).map_err(decode_error)?;
        Ok(decoder.with_limits(limits(self.length)))
    }

    /// The storage of one image of the file.
    pub fn storage(&self, image: usize) -> Result<Storage, DemErrorKind> {
        let mut file = self.lock();
        let mut decoder = self.decoder(&mut file)?;
        for _ in 0..image {
            decoder.next_image().map_err(decode_error)?;
        }
        let storage = Storage::read(&mut decoder, self.length, &WINDOWED_SAMPLES)?;
        let across = storage.block_width.clamp(1, storage.width);
        let down = storage.block_height.clamp(1, storage.height);
        let samples = u64::from(across) * u64::from(down);
        if samples > BLOCK_SAMPLES.get() {
            return Err(DemErrorKind::LargeBlocks(UVec2::new(across, down)));
        }
        if storage.decoded_bytes(samples) > LARGEST_BLOCK as u64 {
            return Err(fault::unsupported(
                format!("blocks of {across} x {down} samples"),
                "rewrite it in tiles, for example with: gdal_translate -co TILED=YES FILE out.tif",
            ));
        }
        let blocks = u64::from(storage.width.div_ceil(across)) * u64::from(storage.height.div_ceil(down));
        if blocks > u64::from(u32::MAX) {
            return Err(fault::broken(format!("it claims {blocks} blocks")));
        }
        Ok(storage)
    }

    pub fn later_images(&self) -> LaterImages {
        let mut images = LaterImages::default();
        let mut file = self.lock();
        let Ok(mut decoder) = self.decoder(&mut file) else { return images };
        let size = decoder.dimensions().unwrap_or_default();
        for image in 1..=TIFF_IMAGES.count() {
            // A broken overview or page is no reason to refuse the images before it.
            if !decoder.more_images() || decoder.next_image().is_err() {
                break;
            }
            let kind = image_kind(&mut decoder);
            let Ok((width, height)) = decoder.dimensions() else { continue };
            let found = Overview { width, height, image };
            if kind & IS_MASK != 0 {
                images.masks.push(found);
            } else if kind & IS_REDUCED != 0 && width.min(height) > 0 && width < size.0 && height <= size.1 {
                images.overviews.push(found);
            }
        }
        images
    }
}

impl<R: FileContent> BlockBytes for SharedFile<R> {
    fn length(&self) -> usize {
        self.length
    }

    fn bytes(&mut self, range: Range<usize>) -> io::Result<Cow<'_, [u8]>> {
        let mut bytes = Vec::new();
        self.read_into(range, &mut bytes)?;
        Ok(Cow::Owned(bytes))
    }

    fn read_into(&mut self, range: Range<usize>, out: &mut Vec<u8>) -> io::Result<()> {
        out.resize(range.len(), 0);
        let start = range.start as u64;
        let filled = match &self.by_place {
            Some(file) => filled(out, |rest, at| file.read_by_place(rest, start + at as u64))?,
            None => {
                let mut file = self.lock();
                file.seek(SeekFrom::Start(start))?;
                filled(out, |rest, _| file.read(rest))?
            }
        };
        out.truncate(filled);
        Ok(())
    }
}

/// Fills `out` as far as there are bytes, asking for all that is missing at once: a file on a server is not asked for many
/// small parts. `read` gets what is not filled yet and how much is.
fn filled(out: &mut [u8], mut read: impl FnMut(&mut [u8], usize) -> io::Result<usize>) -> io::Result<usize> {
    let mut filled = 0;
    while filled < out.len() {
        match read(&mut out[filled..], filled) {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}
