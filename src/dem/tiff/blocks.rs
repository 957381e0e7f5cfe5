//! Decodes strips and tiles of a TIFF's first band to rows of elevations. Where another band is alpha, what it makes fully
//! transparent has no data.
//!
//! Blocks are independent, so rows of blocks are unpacked in parallel, each straight into its own rows of the raster:
//!
//! ```text
//! ┌────┬────┬────┐
//! │ 0  │ 1  │ 2  │  one task
//! ├────┼────┼────┤
//! │ 3  │ 4  │ 5  │  another
//! └────┴────┴────┘
//! ```
//!
//! A task takes memory for one block. The raster is the same for every number of threads, and so is the error of a
//! broken file: that of its first broken block.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::tiff::rows::{RowDecoder, RowWords};
use crate::tiff::storage::{Storage, TiffBlock};
use crate::tiff::unpack::{BlockBytes, Unpacker};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{SampleFloat, Samples};

/// Tasks for each thread: several, since blocks over flat ground are done sooner; few, since each sets up decompressors.
const TASKS_PER_THREAD: usize = 6;

/// The elevations of an image in memory, NaN where they are `nodata` or transparent.
pub(crate) fn decode(bytes: &[u8], storage: &Storage, nodata: Option<f64>) -> Result<Samples, DemErrorKind> {
    if storage.elevation_type()?.is_wide() {
        elevations::<f64>(bytes, storage, nodata)
    } else {
        elevations::<f32>(bytes, storage, nodata)
    }
}

fn elevations<E: SampleFloat>(
    bytes: &[u8],
    storage: &Storage,
    nodata: Option<f64>,
) -> Result<Samples, DemErrorKind> {
    let (width, height) = (storage.width as usize, storage.height as usize);
    // Zeros come from the system as they are needed, in the task that overwrites them.
    let mut values = vec![E::default(); width * height];
    let (_, down) = storage.blocks_across_and_down();
    let tasks = rayon::current_num_threads() * TASKS_PER_THREAD;
    let per_task = down.div_ceil(tasks as u32).max(1);
    let rows_per_task = per_task as usize * storage.block_height as usize;
    let first_failed = AtomicUsize::new(usize::MAX);
    let outcomes: Vec<Result<(), DemErrorKind>> = values
        .par_chunks_mut(width * rows_per_task)
        .enumerate()
        .map(|(task, rows)| {
            if first_failed.load(Ordering::Relaxed) < task {
                return Ok(());
            }
            let first = task as u32 * per_task;
            let outcome = fill(bytes, storage, nodata, first..down.min(first + per_task), rows);
            if outcome.is_err() {
                first_failed.fetch_min(task, Ordering::Relaxed);
            }
            outcome
        })
        .collect();
    outcomes.into_iter().collect::<Result<(), DemErrorKind>>().map(|()| E::into_samples(values))
}

/// Fills the rows of the raster that rows `down` of blocks hold.
fn fill<E: SampleFloat>(
    mut bytes: &[u8],
    storage: &Storage,
    nodata: Option<f64>,
    down: Range<u32>,
    rows: &mut [E],
) -> Result<(), DemErrorKind> {
    let width = storage.width as usize;
    let (across, _) = storage.blocks_across_and_down();
    let first_row = down.start as usize * storage.block_height as usize;
    let mut decoder = BlockDecoder::new(storage, nodata)?;
    for block in down.flat_map(|y| (0..across).map(move |x| storage.block(x, y))) {
        let start = (block.window.row as usize - first_row) * width + block.window.column as usize;
        decoder.decode(&mut bytes, block, &mut rows[start..], width)?;
    }
    Ok(())
}

/// The elevations of one block alone, row by row, NaN where they are `nodata` or transparent.
pub(crate) fn block(
    file: &mut impl BlockBytes,
    storage: &Storage,
    nodata: Option<f64>,
    block: TiffBlock,
) -> Result<Samples, DemErrorKind> {
    let mut decoder = BlockDecoder::new(storage, nodata)?;
    let (count, width) = (block.window.samples(), block.window.width as usize);
    if storage.elevation_type()?.is_wide() {
        let mut values = vec![0.0; count];
        decoder.decode(file, block, &mut values, width).map(|()| Samples::F64(values))
    } else {
        let mut values = vec![0.0; count];
        decoder.decode(file, block, &mut values, width).map(|()| Samples::F32(values))
    }
}

/// Decodes blocks of an image, reusing its buffers.
pub(crate) struct BlockDecoder<'a> {
    storage: &'a Storage,
    nodata: Option<f64>,
    unpacker: Unpacker<'a>,
    rows: RowDecoder,
    alpha: Option<AlphaDecoder>,
    unpacked: Vec<u8>,
    words: RowWords,
}

/// Decodes the band that states how opaque pixels are.
struct AlphaDecoder {
    band: u16,
    rows: RowDecoder,
    row: Vec<f32>,
}

impl<'a> BlockDecoder<'a> {
    pub fn new(storage: &'a Storage, nodata: Option<f64>) -> Result<Self, DemErrorKind> {
        let rows = RowDecoder::new(storage, nodata)?;
        let of_band = |band: u16| AlphaDecoder { band, rows: rows.of_band(band), row: Vec::new() };
        Ok(Self {
            storage,
            nodata,
            unpacker: Unpacker::new(storage),
            rows,
            alpha: storage.alpha.map(of_band),
            unpacked: Vec::new(),
            words: RowWords::default(),
        })
    }

    /// Decodes a block to `out`, which is zeros; its rows lie `stride` apart and start where the block's do.
    pub fn decode<E: SampleFloat>(
        &mut self,
        file: &mut impl BlockBytes,
        block: TiffBlock,
        out: &mut [E],
        stride: usize,
    ) -> Result<(), DemErrorKind> {
        if self.storage.is_written(block.index) {
            // Alpha reads the rows once more.
            let stored = self.unpacker.stored(file, block).filter(|_| self.alpha.is_none());
            let rows = match stored {
                Some(rows) => rows,
                None => {
                    self.unpacker.unpack(file, block, &mut self.unpacked)?;
                    &self.unpacked
                }
            };
            let packed = rows.chunks_exact(self.storage.row_bytes().max(1));
            for (packed, row) in packed.zip(rows_of(block, out, stride)) {
                self.rows.decode(packed, &mut self.words, row);
            }
        } else if self.nodata.is_some() {
            // As in GDAL, what was never written is no data where the file states a value for that, else 0.
            rows_of(block, out, stride).for_each(|row| row.fill(E::NODATA));
        }
        self.hide(file, block, out, stride)
    }

    /// Makes samples without data of those that alpha makes transparent; what decodes them has just decoded the block.
    fn hide<E: SampleFloat>(
        &mut self,
        file: &mut impl BlockBytes,
        block: TiffBlock,
        out: &mut [E],
        stride: usize,
    ) -> Result<(), DemErrorKind> {
        let Some(AlphaDecoder { band, rows: decoder, row: alpha }) = &mut self.alpha else { return Ok(()) };
        let of_alpha = self
            .storage
            .block_of_band(block, *band)
            .filter(|of_alpha| self.storage.is_written(of_alpha.index));
        let Some(of_alpha) = of_alpha else {
            // What was never written is 0.
            rows_of(block, out, stride).for_each(|row| row.fill(E::NODATA));
            return Ok(());
        };
        if of_alpha != block {
            self.unpacker.unpack(file, of_alpha, &mut self.unpacked)?;
        }
        alpha.resize(block.window.width as usize, 0.0);
        let packed = self.unpacked.chunks_exact(self.storage.row_bytes().max(1));
        for (packed, row) in packed.zip(rows_of(block, out, stride)) {
            decoder.decode(packed, &mut self.words, alpha);
            let hidden = row.iter_mut().zip(&*alpha).filter(|(_, alpha)| **alpha == 0.0 || alpha.is_nan());
            hidden.for_each(|(value, _)| *value = E::NODATA);
        }
        Ok(())
    }
}

/// The rows of a block, `stride` apart.
fn rows_of<E>(block: TiffBlock, out: &mut [E], stride: usize) -> impl Iterator<Item = &mut [E]> {
    let rows = out.chunks_mut(stride).take(block.window.height as usize);
    rows.map(move |row| &mut row[..block.window.width as usize])
}
