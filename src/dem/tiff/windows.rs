//! Windows of a GeoTIFF that stays where it is: blocks are decoded when a window meets them and a few are kept.
//!
//! ```text
//! ┌────┬────┬────┐   blocks (tiles, or strips as wide as the image); a window is copied
//! │    │ ┌──┼──┐ │   from those it meets, each with scale, offset, unit and mask applied,
//! ├────┼─┼──┼──┤ │   in the same order and precision as in the whole reader
//! │    │ └──┼──┘ │
//! └────┴────┴────┘
//! ```
//!
//! Memory: the window, the blocks that are kept (a bound in bytes), one block while it is decoded, and the file's
//! tables of blocks. A file whose single blocks are too large for that (a picture stored as one strip) is refused.
//!
//! Overviews — reduced images in the same file — are listed, and open as rasters of their own.

use std::io::{BufReader, Read, Seek};
use std::sync::Arc;

use glam::{DAffine2, DVec2};
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use crate::dem::error::{DemError, DemErrorKind};
use crate::dem::raster::{Raster, scaled};
use crate::dem::read::{DemFile, DemHints};
use crate::dem::recent::Recent;
use crate::dem::tiff::blocks;
use crate::dem::tiff::file::TiffFile;
use crate::dem::tiff::geotiff;
use crate::dem::tiff::geotiff::GeoTiffHeader;
use crate::dem::tiff::mask;
use crate::dem::tiff::mask::{IS_MASK, MOST_IMAGES};
use crate::dem::tiff::storage::{FORMAT, Storage, TiffBlock, fault};
use crate::dem::windows::{RasterWindow, Windows};

/// The most samples of an image that is read in windows: 262,144 a side. Nothing is allocated for them; it keeps the
/// numbers of 16 × 16 tiles within 32 bits.
pub const MOST_WINDOWED: u64 = 1 << 36;

/// The most samples of one block: a tile of 2048². Tiles in use have 128 to 1024 samples a side.
const MOST_BLOCK_SAMPLES: u64 = 1 << 22;

/// The most bytes that one block decodes to: the largest with 64-bit samples.
const LARGEST_BLOCK: usize = 32 << 20;

/// Bytes of decoded blocks that suit terrain patches: two rows of 256² tiles over 16,384 samples.
pub const DEFAULT_CACHE: usize = 32 << 20;

/// NewSubfileType's bit for "reduced version of another image".
const IS_REDUCED: u32 = 1;

/// A reduced image of the same ground in the same file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overview {
    /// Samples per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    image: usize,
}

/// A GeoTIFF, read in windows.
pub struct GeoTiffWindows<R: Read + Seek> {
    name: String,
    file: TiffFile<R>,
    described: GeoTiffHeader,
    overviews: Vec<Overview>,
    masks: Vec<Overview>,
    heights: TiffImage<R>,
    mask: Option<TiffImage<R>>,
    blocks: Recent<u32, Arc<[f32]>>,
    cache_bytes: usize,
}

impl<R: Read + Seek> GeoTiffWindows<R> {
    /// Opens the first image of `file`, keeping up to `cache_bytes` of decoded blocks. `name` and `hints` are those
    /// of [`crate::dem::read::read`].
    ///
    /// # Errors
    /// What the whole reader refuses is refused alike, except images that are merely too large for the memory; so
    /// are files whose single blocks are.
    pub fn open(name: &str, file: R, hints: &DemHints, cache_bytes: usize) -> Result<Self, DemError> {
        Self::open_first(name, file, hints, cache_bytes)
            .map_err(|fault| DemError { name: name.to_owned(), fault })
    }

    fn open_first(name: &str, file: R, hints: &DemHints, cache_bytes: usize) -> Result<Self, DemErrorKind> {
        let unread = |error: std::io::Error| DemErrorKind::broken(FORMAT, error.to_string());
        let file = TiffFile::new(file).map_err(unread)?;
        let mut start = Vec::new();
        file.clone().take(4).read_to_end(&mut start).map_err(unread)?;
        if !geotiff::recognizes(&start) {
            return Err(DemErrorKind::broken(FORMAT, "it does not start as a TIFF file does"));
        }
        let mut heights = TiffImage::open(&file, 0)?;
        heights.storage.check_samples()?;
        let source = DemFile { name, bytes: &[], hints };
        let described = geotiff::describe(&mut heights.decoder, &heights.storage, &source)?;
        if geotiff::mask_beside(&source).is_some() {
            return Err(DemErrorKind::Unsupported {
                format: FORMAT,
                what: "a mask in a file beside it (.msk), and is to be read in parts".into(),
                remedy: "take the mask into it: gdal_translate --config GDAL_TIFF_INTERNAL_MASK YES FILE out.tif",
            });
        }
        let (overviews, masks) = images(&file, (described.bare.width, described.bare.height));
        Self::assemble(name, file, described, (overviews, masks), heights, cache_bytes)
    }

    fn assemble(
        name: &str,
        file: TiffFile<R>,
        described: GeoTiffHeader,
        (overviews, masks): (Vec<Overview>, Vec<Overview>),
        heights: TiffImage<R>,
        cache_bytes: usize,
    ) -> Result<Self, DemErrorKind> {
        let size = (described.bare.width, described.bare.height);
        let mask = masks.iter().find(|mask| (mask.width, mask.height) == size);
        let mask = mask.map(|mask| TiffImage::open(&file, mask.image)).transpose()?;
        if let Some(mask) = &mask {
            mask::check(&mask.storage)?;
        }
        let (name, blocks) = (name.to_owned(), Recent::new(cache_bytes));
        Ok(Self { name, file, described, overviews, masks, heights, mask, blocks, cache_bytes })
    }

    /// The reduced images of this one, as the file lists them: mostly from the finest to the coarsest.
    pub fn overviews(&self) -> &[Overview] {
        &self.overviews
    }

    /// Opens a reduced image from [`GeoTiffWindows::overviews`]; it lies where this one lies, its samples further
    /// apart.
    ///
    /// # Errors
    /// The image is broken, or stored in a way that is not read.
    pub fn at_overview(&self, overview: &Overview) -> Result<Self, DemError> {
        self.open_overview(overview).map_err(|fault| DemError { name: self.name.clone(), fault })
    }

    fn open_overview(&self, overview: &Overview) -> Result<Self, DemErrorKind> {
        let heights = TiffImage::open(&self.file, overview.image)?;
        heights.storage.check_samples()?;
        let bare = &self.described.bare;
        let times = DVec2::new(
            f64::from(bare.width) / f64::from(overview.width),
            f64::from(bare.height) / f64::from(overview.height),
        );
        let bare = Raster {
            width: overview.width,
            height: overview.height,
            map_from_grid: bare.map_from_grid * DAffine2::from_scale(times),
            ..bare.clone()
        };
        let described = GeoTiffHeader { bare, ..self.described };
        let images = (Vec::new(), self.masks.clone());
        Self::assemble(&self.name, self.file.clone(), described, images, heights, self.cache_bytes)
    }

    /// Bytes of decoded blocks that are kept now.
    pub fn cached_bytes(&self) -> usize {
        self.blocks.held()
    }

    /// The heights of a block, in meters.
    fn block(&mut self, at: TiffBlock) -> Result<Arc<[f32]>, DemErrorKind> {
        let TiffBlock { index, column, row, width, height } = at;
        if let Some(block) = self.blocks.get(index) {
            return Ok(Arc::clone(block));
        }
        self.blocks.make_room(width as usize * height as usize * 4);
        let TiffImage { decoder, storage } = &mut self.heights;
        let GeoTiffHeader { bare, scale, offset } = &self.described;
        let stored = blocks::block(decoder, storage, bare.nodata, at, self.file.length())?;
        let meters = |stored: f64| scaled(scaled(stored, *scale, *offset), bare.meters_per_z, 0.0) as f32;
        let mut heights: Vec<f32> = stored.iter().map(meters).collect();
        if let Some(mask) = &mut self.mask {
            mask.hide(RasterWindow { column, row, width, height }, &mut heights)?;
        }
        let block: Arc<[f32]> = heights.into();
        self.blocks.put(index, Arc::clone(&block), block.len() * 4);
        Ok(block)
    }
}

impl<R: Read + Seek> Windows for GeoTiffWindows<R> {
    fn bare(&self) -> &Raster {
        &self.described.bare
    }

    fn read(&mut self, window: RasterWindow, out: &mut Vec<f32>) -> Result<(), DemErrorKind> {
        window.assert_within(self.size());
        out.clear();
        out.resize(window.samples(), f32::NAN);
        for at in self.heights.blocks_meeting(window) {
            let block = self.block(at)?;
            let stored = RasterWindow { column: at.column, row: at.row, width: at.width, height: at.height };
            for (from, to) in overlap(stored, window) {
                out[to].copy_from_slice(&block[from]);
            }
        }
        Ok(())
    }
}

/// The index ranges, in two windows' samples, of the rows they share.
fn overlap(
    from: RasterWindow,
    to: RasterWindow,
) -> impl Iterator<Item = (std::ops::Range<usize>, std::ops::Range<usize>)> {
    let first = from.column.max(to.column);
    let last = (from.column + from.width).min(to.column + to.width).max(first);
    let rows = from.row.max(to.row)..(from.row + from.height).min(to.row + to.height);
    let range = move |of: RasterWindow, row: u32| {
        let start = (row - of.row) as usize * of.width as usize + (first - of.column) as usize;
        start..start + (last - first) as usize
    };
    rows.map(move |row| (range(from, row), range(to, row)))
}

/// One image of the file.
struct TiffImage<R: Read + Seek> {
    decoder: Decoder<BufReader<TiffFile<R>>>,
    storage: Storage,
}

impl<R: Read + Seek> TiffImage<R> {
    fn open(file: &TiffFile<R>, image: usize) -> Result<Self, DemErrorKind> {
        let mut decoder = decoder(file)?;
        for _ in 0..image {
            decoder.next_image().map_err(fault)?;
        }
        let storage = Storage::of(&mut decoder, file.length(), MOST_WINDOWED)?;
        let (across, down) = storage.block_size;
        let (across, down) = (across.clamp(1, storage.width), down.clamp(1, storage.height));
        let samples = u64::from(across) * u64::from(down);
        if samples > MOST_BLOCK_SAMPLES || storage.decoded_bytes(samples) > LARGEST_BLOCK as u64 {
            return Err(DemErrorKind::Unsupported {
                format: FORMAT,
                what: format!("blocks of {across} x {down} samples"),
                remedy: "rewrite it in tiles, for example with: gdal_translate -co TILED=YES FILE out.tif",
            });
        }
        let blocks = u64::from(storage.width.div_ceil(across)) * u64::from(storage.height.div_ceil(down));
        if blocks > u64::from(u32::MAX) {
            return Err(DemErrorKind::broken(FORMAT, format!("it claims {blocks} blocks")));
        }
        Ok(Self { decoder, storage })
    }

    /// The blocks that a window meets.
    fn blocks_meeting(&self, window: RasterWindow) -> Vec<TiffBlock> {
        let (width, height) = self.storage.block_size;
        let span = |first: u32, count: u32, block: u32| first / block..(first + count).div_ceil(block);
        let columns = span(window.column, window.width, width);
        span(window.row, window.height, height)
            .flat_map(|down| columns.clone().map(move |across| self.storage.block(across, down)))
            .collect()
    }

    /// Makes NaN of the heights of `window` that this mask hides.
    fn hide(&mut self, window: RasterWindow, heights: &mut [f32]) -> Result<(), DemErrorKind> {
        for at in self.blocks_meeting(window) {
            let block = mask::block(&mut self.decoder, &self.storage, at)?;
            for (x, y) in block.hidden() {
                let x = (at.column as usize + x).checked_sub(window.column as usize);
                let y = (at.row as usize + y).checked_sub(window.row as usize);
                if let (Some(x), Some(y)) = (x, y)
                    && x < window.width as usize
                    && y < window.height as usize
                {
                    heights[y * window.width as usize + x] = f32::NAN;
                }
            }
        }
        Ok(())
    }
}

fn decoder<R: Read + Seek>(file: &TiffFile<R>) -> Result<Decoder<BufReader<TiffFile<R>>>, DemErrorKind> {
    let limits = geotiff::limits(file.length(), LARGEST_BLOCK);
    Ok(Decoder::new(BufReader::new(file.clone())).map_err(fault)?.with_limits(limits))
}

/// The overviews and the masks among the images after the first, whose size is `size`.
fn images<R: Read + Seek>(file: &TiffFile<R>, size: (u32, u32)) -> (Vec<Overview>, Vec<Overview>) {
    let (mut overviews, mut masks) = (Vec::new(), Vec::new());
    let Ok(mut decoder) = decoder(file) else { return (overviews, masks) };
    for image in 1..=MOST_IMAGES {
        // A broken overview or page is no reason to refuse the images before it.
        if !decoder.more_images() || decoder.next_image().is_err() {
            break;
        }
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType).ok().flatten().unwrap_or(0);
        let Ok((width, height)) = decoder.dimensions() else { continue };
        let found = Overview { width, height, image };
        if kind & IS_MASK != 0 {
            masks.push(found);
        } else if kind & IS_REDUCED != 0 && width.min(height) > 0 && width < size.0 && height <= size.1 {
            overviews.push(found);
        }
    }
    (overviews, masks)
}
