//! Windows of a GeoTIFF that stays on disk: blocks are decoded when a window meets them, and cached.
//!
//! ```text
//! ┌────┬────┬────┐   blocks (tiles, or strips as wide as the image); a window is copied
//! │    │ ┌──┼──┐ │   from those it meets, each with scale, offset and mask applied, in the
//! ├────┼─┼──┼──┤ │   same order and precision as in the whole reader
//! │    │ └──┼──┘ │
//! └────┴────┴────┘
//! ```
//!
//! Blocks that a window needs and that are not kept are decoded on all threads. Those of a window larger than all that is kept
//! are not kept, nor those of whole rows that are stored unpacked (`large_window`).
//!
//! Memory: the window, the blocks that are kept (a bound in bytes), the blocks while they are decoded, some for each
//! thread, and the file's tables of blocks. A file whose single blocks are too large for that (a picture stored as one strip) is refused.
//!
//! Overviews — reduced images in the same file — are listed, and open as rasters of their own.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine2, DVec2};
use rayon::prelude::*;

use crate::dem_file::DemFile;
use crate::hints::DemHints;
use crate::tiff::blocks::{self, BlockDecoder};
use crate::tiff::fault;
use crate::tiff::header::{self, GeoTiffHeader};
use crate::tiff::images::{LaterImages, Overview, SharedFile};
use crate::tiff::mask;
use crate::tiff::storage::{Packing, Storage, TiffBlock};
use crate::tiff::unpack::{BlockBytes, packed_range};
use sandtable_raster::cache::LruCache;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::{DemError, DemErrorKind};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows, WithOverviews};

/// Whether a file is a TIFF or BigTIFF by its first bytes.
pub fn is_tiff(head: &[u8]) -> bool {
    header::recognizes(head)
}

/// A GeoTIFF, read in windows.
pub struct GeoTiffWindows<R> {
    name: String,
    file: SharedFile<R>,
    header: GeoTiffHeader,
    images: LaterImages,
    heights: Storage,
    mask: Option<Storage>,
    blocks: LruCache<u32, Arc<Samples>>,
    cache_bytes: usize,
}

/// Blocks for each thread that are decoded before the next are: enough to keep all threads at work.
const BLOCKS_PER_THREAD: usize = 4;

/// Bytes of blocks for each thread that are decoded before the next are, where blocks are small.
const BYTES_PER_THREAD: usize = 1 << 20;

impl<R: FileContent> GeoTiffWindows<R> {
    /// Opens the first image of `file`, keeping up to `cache_bytes` of decoded blocks. `name` and `hints` are those of
    /// [`crate::read::read`], but for a stated no-data value and vertical datum, which
    /// [`open_windows`](crate::read::open_windows) applies.
    ///
    /// # Errors
    /// Those of the whole reader, except for images that are merely too large for the memory; and single blocks that
    /// are too large for the memory.
    pub fn open(name: &str, file: R, hints: &DemHints, cache_bytes: usize) -> Result<Self, DemError> {
        Self::open_first(name, file, hints, cache_bytes)
            .map_err(|kind| DemError { name: name.to_owned(), kind })
    }

    pub(crate) fn open_first(
        name: &str,
        file: R,
        hints: &DemHints,
        cache_bytes: usize,
    ) -> Result<Self, DemErrorKind> {
        let mut file = SharedFile::new(file).map_err(fault::unread)?;
        let start = file.bytes(0..4).map_err(fault::unread)?;
        if !header::recognizes(&start) {
            return Err(fault::broken("it does not start with the signature of a TIFF file"));
        }
        let source = DemFile { name, bytes: &[], hints };
        let heights = file.storage(0)?;
        heights.elevation_type()?;
        let header = GeoTiffHeader::read(&mut file.decoder(&mut file.lock())?, &heights, &source)?;
        if header.raster.nodata.is_some() && heights.is_all_absent() {
            return Err(header::all_absent());
        }
        if mask::file_beside(&source).is_some() {
            return Err(fault::unsupported(
                "a mask in a file beside it (.msk), and is to be read in parts",
                "take the mask into it: gdal_translate --config GDAL_TIFF_INTERNAL_MASK YES FILE out.tif",
            ));
        }
        let images = file.later_images();
        Self::new(name, file, header, heights, images, cache_bytes)
    }

    /// Looks for a mask of the image's size.
    fn new(
        name: &str,
        file: SharedFile<R>,
        header: GeoTiffHeader,
        heights: Storage,
        images: LaterImages,
        cache_bytes: usize,
    ) -> Result<Self, DemErrorKind> {
        let is_of_size = |mask: &&Overview| (mask.width, mask.height) == (heights.width, heights.height);
        let mask = images.masks.iter().find(is_of_size).map(|mask| file.storage(mask.image)).transpose()?;
        mask.iter().try_for_each(mask::check)?;
        let (name, blocks) = (name.to_owned(), LruCache::new(cache_bytes));
        let is_scaled = header.scale != 1.0 || header.offset != 0.0;
        let is_wide = is_scaled || heights.elevation_type()?.is_wide();
        let raster = Raster { samples: Samples::absent(0, is_wide), ..header.raster };
        let header = GeoTiffHeader { raster, ..header };
        Ok(Self { name, file, header, images, heights, mask, blocks, cache_bytes })
    }

    /// The reduced images of this one, as the file lists them: mostly from the finest to the coarsest.
    pub fn overviews(&self) -> &[Overview] {
        &self.images.overviews
    }

    /// Opens a reduced image from [`GeoTiffWindows::overviews`]: the same ground, samples further apart.
    ///
    /// # Errors
    /// The image is broken, or stored in a way that is not read.
    pub fn at_overview(&self, overview: &Overview) -> Result<Self, DemError> {
        self.open_overview(overview).map_err(|kind| DemError { name: self.name.clone(), kind })
    }

    fn open_overview(&self, overview: &Overview) -> Result<Self, DemErrorKind> {
        let heights = self.file.storage(overview.image)?;
        heights.elevation_type()?;
        let Overview { width, height, .. } = *overview;
        let times = self.header.raster.grid_size() / DVec2::new(width.into(), height.into());
        let map_from_grid = self.header.raster.map_from_grid * DAffine2::from_scale(times);
        let raster = Raster { width, height, map_from_grid, ..self.header.raster.without_samples() };
        let header = GeoTiffHeader { raster, ..self.header };
        let coarser = self.images.overviews.iter().filter(|other| other.width < width).copied().collect();
        let images = LaterImages { masks: self.images.masks.clone(), overviews: coarser };
        Self::new(&self.name, self.file.clone(), header, heights, images, self.cache_bytes)
    }

    /// Bytes of decoded blocks that are kept now.
    pub fn cached_bytes(&self) -> usize {
        self.blocks.weight()
    }

    /// Whether samples take 64 bits.
    pub(super) fn is_wide(&self) -> bool {
        self.header.raster.samples.is_wide()
    }

    /// Bytes of decoded blocks that may be kept.
    pub(super) fn cache_bytes(&self) -> usize {
        self.cache_bytes
    }

    /// Bytes of a decoded sample.
    pub(super) fn sample_bytes(&self) -> usize {
        if self.is_wide() { size_of::<f64>() } else { size_of::<f32>() }
    }

    /// The samples of a block as the whole reader has them.
    pub(super) fn decode(&self, file: &mut impl BlockBytes, at: TiffBlock) -> Result<Samples, DemErrorKind> {
        let GeoTiffHeader { raster, scale, offset } = &self.header;
        let mut samples = blocks::block(file, &self.heights, raster.nodata, at)?;
        if let Some(mask) = &self.mask {
            mask::each_hidden(file, mask, at.window, |index| samples.set(index, f64::NAN))?;
        }
        Ok(samples.scaled(*scale, *offset))
    }

    /// What decodes blocks straight to samples, where these are as they are stored: neither scaled nor masked.
    pub(super) fn plain_decoder(&self) -> Result<Option<BlockDecoder<'_>>, DemErrorKind> {
        let is_plain = self.mask.is_none() && self.header.scale == 1.0 && self.header.offset == 0.0;
        is_plain.then(|| BlockDecoder::new(&self.heights, self.header.raster.nodata)).transpose()
    }

    /// The file.
    pub(super) fn file(&self) -> impl BlockBytes + use<R> {
        self.file.clone()
    }

    /// Where the packed bytes of a block lie; `None` where the table does not list it.
    pub(super) fn packed_range(&self, at: TiffBlock) -> Option<Range<usize>> {
        packed_range(&self.heights, at, self.file.length).ok()
    }

    /// The blocks that a window meets.
    pub(super) fn blocks_meeting(&self, window: RasterWindow) -> impl Iterator<Item = TiffBlock> + '_ {
        self.heights.blocks_meeting(window)
    }

    /// Rows of a block.
    pub(super) fn block_height(&self) -> u32 {
        self.heights.block_height
    }

    /// Whether a window of whole rows is stored one block behind the other as the samples are, so that blocks are read from the
    /// file as fast as they would be copied from the cache.
    fn is_stored_as(&self, window: RasterWindow) -> bool {
        let Storage { packing, block_width, width, .. } = self.heights;
        packing == Packing::Plain && block_width >= width && window.width == width && self.mask.is_none()
    }

    /// Says which bytes of the file are read next, as far as their samples fit the cache.
    pub(super) fn announce_windows(&self, windows: impl Iterator<Item = RasterWindow>) {
        self.announce_blocks(&self.fitting(windows.flat_map(|window| self.blocks_meeting(window))));
    }

    /// The first of some blocks, as many as fit the cache.
    fn fitting(&self, blocks: impl Iterator<Item = TiffBlock>) -> Vec<TiffBlock> {
        let bytes = self.sample_bytes();
        let fitting = blocks.scan(0, |total, block| {
            *total += block.window.samples() * bytes;
            (*total <= self.cache_bytes).then_some(block)
        });
        fitting.collect()
    }

    /// Says which bytes of the file are read next. Blocks that the table does not list are an error of their reading.
    fn announce_blocks(&self, blocks: &[TiffBlock]) {
        let length = self.file.length;
        let range = |image: &Storage, at: TiffBlock| {
            packed_range(image, at, length).map(|range| range.start as u64..range.end as u64).ok()
        };
        let mut ranges: BTreeMap<u64, Range<u64>> = BTreeMap::new();
        for at in blocks {
            let of_mask = self.mask.iter().flat_map(|mask| {
                mask.blocks_meeting(at.window).filter_map(|at| range(mask, at)).collect::<Vec<_>>()
            });
            let of_alpha = self.heights.alpha.and_then(|band| self.heights.block_of_band(*at, band));
            let of_image = [Some(*at), of_alpha].into_iter().flatten();
            let of_image = of_image.filter_map(|at| range(&self.heights, at));
            for range in of_image.chain(of_mask) {
                ranges.insert(range.start, range);
            }
        }
        self.file.lock().announce(&ranges.into_values().collect::<Vec<_>>());
    }

    /// Decodes those of `blocks` that are not kept, some at a time on all threads, and calls `each` with every block; those
    /// that are kept come first. The error is that of the first broken block.
    fn each_block(
        &mut self,
        blocks: impl Iterator<Item = TiffBlock>,
        mut each: impl FnMut(TiffBlock, &Samples),
    ) -> Result<(), DemErrorKind> {
        let mut missing = Vec::new();
        for at in blocks {
            match self.blocks.get(at.index) {
                Some(block) => each(at, block),
                None => missing.push(at),
            }
        }
        // No more than are kept, so that a file of large blocks takes no more memory for many threads.
        let largest = missing.iter().map(|at| at.window.samples() * self.sample_bytes()).max().unwrap_or(1);
        let most = rayon::current_num_threads() * BLOCKS_PER_THREAD.max(BYTES_PER_THREAD / largest.max(1));
        let at_once = (self.cache_bytes / largest.max(1)).clamp(1, most);
        for some in missing.chunks(at_once) {
            self.announce_blocks(some);
            let decoded: Vec<Result<Arc<Samples>, DemErrorKind>> = match some {
                [one] => vec![self.decode(&mut self.file(), *one).map(Arc::new)],
                some => some.par_iter().map(|&at| self.decode(&mut self.file(), at).map(Arc::new)).collect(),
            };
            for (&at, block) in some.iter().zip(decoded) {
                let block = block?;
                each(at, &block);
                let weight = block.bytes();
                self.blocks.make_room(weight);
                self.blocks.put(at.index, block, weight);
            }
        }
        Ok(())
    }
}

impl<R: FileContent> WithOverviews for GeoTiffWindows<R> {
    fn overview_sizes(&self) -> Vec<(u32, u32)> {
        self.overviews().iter().map(|overview| (overview.width, overview.height)).collect()
    }

    fn at_overview_size(&self, index: usize) -> Result<Self, DemError> {
        self.at_overview(&self.overviews()[index])
    }
}

impl<R: FileContent> Windows for GeoTiffWindows<R> {
    fn metadata(&self) -> &Raster {
        &self.header.raster
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let is_large = window.samples() * self.sample_bytes() > self.cache_bytes;
        if (is_large || self.is_stored_as(window))
            && self.bands_at_once(window) >= rayon::current_num_threads()
        {
            return self.large_window(window);
        }
        // Zeros come from the system as they are needed; blocks cover all of them.
        let count = window.samples();
        let mut out = match self.is_wide() {
            true => Samples::F64(vec![0.0; count]),
            false => Samples::F32(vec![0.0; count]),
        };
        let blocks: Vec<TiffBlock> = self.heights.blocks_meeting(window).collect();
        self.each_block(blocks.into_iter(), |at, block| {
            for (from, to) in at.window.shared_rows(window) {
                out.copy_from(to, block, from);
            }
        })?;
        Ok(out)
    }

    fn overview(&self, step: u32) -> Option<(u32, Box<dyn Windows + Send + '_>)> {
        let (width, height) = self.size();
        let times = |image: &Overview| {
            let times =
                width.div_ceil(image.width).checked_next_power_of_two().filter(|times| *times <= step)?;
            (width.div_ceil(times) == image.width && height.div_ceil(times) == image.height).then_some(times)
        };
        let found = self.images.overviews.iter().filter_map(|image| Some((times(image)?, image)));
        let (times, image) = found.max_by_key(|(times, _)| *times)?;
        Some((times, Box::new(self.open_overview(image).ok()?)))
    }

    /// Decodes the blocks under the windows as far as they fit the cache.
    fn announce(&mut self, windows: &[RasterWindow]) {
        let blocks: BTreeMap<u32, TiffBlock> = windows
            .iter()
            .flat_map(|&window| self.heights.blocks_meeting(window))
            .map(|block| (block.index, block))
            .collect();
        let fitting = self.fitting(blocks.into_values());
        // What cannot be read is an error of the window that needs it.
        let _ = self.each_block(fitting.into_iter(), |_, _| ());
    }
}
