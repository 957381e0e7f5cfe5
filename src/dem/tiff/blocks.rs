//! Strips and tiles of a TIFF's first band to rows of elevations.
//!
//! Blocks stand alone, so rows of blocks are unpacked side by side, each straight into its own rows of the raster:
//!
//! ```text
//! ┌────┬────┬────┐
//! │ 0  │ 1  │ 2  │  one task
//! ├────┼────┼────┤
//! │ 3  │ 4  │ 5  │  another
//! └────┴────┴────┘
//! ```
//!
//! A task takes room for one block. The raster is the same for every number of threads, and so is the fault of a
//! broken file: that of its first broken block.

use std::io::{Cursor, Read, Seek, SeekFrom};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use tiff::decoder::{Decoder, DecodingResult, Limits};

use crate::dem::error::DemErrorKind;
use crate::dem::raster::Samples;
use crate::dem::tiff::rows::Elevation;
use crate::dem::tiff::storage::{FORMAT, Storage, TiffBlock, fault};
use crate::dem::tiff::unpack::Unpacker;

/// Tasks for each thread: several, since blocks over flat ground are done sooner; few, since each may have to read
/// the file's tables of blocks.
const TASKS_PER_THREAD: usize = 6;

/// The elevations of the first image's first band, `nodata` as NaN. `limits` are what a decoder may allocate.
pub(crate) fn decode(
    bytes: &[u8],
    storage: &Storage,
    nodata: Option<f64>,
    limits: &Limits,
) -> Result<Samples, DemErrorKind> {
    storage.check_samples()?;
    let image = Image { bytes, storage, nodata, limits };
    if storage.is_wide() {
        image.elevations().map(Samples::F64)
    } else {
        image.elevations().map(Samples::F32)
    }
}

/// An image in memory.
struct Image<'a> {
    bytes: &'a [u8],
    storage: &'a Storage,
    nodata: Option<f64>,
    limits: &'a Limits,
}

impl Image<'_> {
    fn elevations<E: Elevation>(&self) -> Result<Vec<E>, DemErrorKind> {
        let (width, height) = (self.storage.width as usize, self.storage.height as usize);
        // Zeros come from the system as they are needed, in the task that overwrites them.
        let mut values = vec![E::default(); width * height];
        let (_, down) = self.storage.blocks_across_and_down();
        let tasks = rayon::current_num_threads() * TASKS_PER_THREAD;
        let per_task = down.div_ceil(tasks as u32).max(1);
        let rows_per_task = per_task as usize * self.storage.block_size.1 as usize;
        let first_failed = AtomicUsize::new(usize::MAX);
        let outcomes: Vec<Result<(), DemErrorKind>> = values
            .par_chunks_mut(width * rows_per_task)
            .enumerate()
            .map(|(task, rows)| {
                if first_failed.load(Ordering::Relaxed) < task {
                    return Ok(());
                }
                let first = task as u32 * per_task;
                let outcome = self.fill(first..down.min(first + per_task), rows);
                if outcome.is_err() {
                    first_failed.fetch_min(task, Ordering::Relaxed);
                }
                outcome
            })
            .collect();
        outcomes.into_iter().collect::<Result<(), DemErrorKind>>().map(|()| values)
    }

    /// Fills the rows of the raster that rows `down` of blocks hold.
    fn fill<E: Elevation>(&self, down: Range<u32>, rows: &mut [E]) -> Result<(), DemErrorKind> {
        let width = self.storage.width as usize;
        let (across, _) = self.storage.blocks_across_and_down();
        let first_row = down.start as usize * self.storage.block_size.1 as usize;
        let mut reader = self.reader()?;
        for block in down.flat_map(|y| (0..across).map(move |x| self.storage.block(x, y))) {
            let start = (block.row as usize - first_row) * width + block.column as usize;
            let out = &mut rows[start..];
            match &mut reader {
                _ if !self.storage.is_written(block.index) => blank(self.nodata, block, out, width),
                BlockReader::Straight(unpacker) => {
                    let range = unpacker.range(block, self.bytes.len())?;
                    unpacker.fill(&self.bytes[range], block, out, width)?;
                }
                BlockReader::Decoder(decoder) => {
                    decoded(decoder, self.storage, self.nodata, block, out, width)?;
                }
            }
        }
        Ok(())
    }

    fn reader(&self) -> Result<BlockReader<'_>, DemErrorKind> {
        if let Some(unpacker) = Unpacker::of(self.storage, self.nodata) {
            return Ok(BlockReader::Straight(Box::new(unpacker)));
        }
        let decoder = Decoder::new(Cursor::new(self.bytes)).map_err(fault)?;
        Ok(BlockReader::Decoder(Box::new(decoder.with_limits(self.limits.clone()))))
    }
}

/// What turns blocks into elevations.
enum BlockReader<'a> {
    Straight(Box<Unpacker<'a>>),
    Decoder(Box<Decoder<Cursor<&'a [u8]>>>),
}

/// The elevations of one block alone, row by row, `nodata` as NaN; blank where it was never written.
pub(crate) fn block<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    nodata: Option<f64>,
    block: TiffBlock,
    file_bytes: usize,
) -> Result<Samples, DemErrorKind> {
    let mut file = BlockFile { decoder, storage, nodata, file_bytes };
    if storage.is_wide() {
        file.elevations(block).map(Samples::F64)
    } else {
        file.elevations(block).map(Samples::F32)
    }
}

/// An image that is not in memory.
struct BlockFile<'a, R: Read + Seek> {
    decoder: &'a mut Decoder<R>,
    storage: &'a Storage,
    nodata: Option<f64>,
    file_bytes: usize,
}

impl<R: Read + Seek> BlockFile<'_, R> {
    fn elevations<E: Elevation>(&mut self, block: TiffBlock) -> Result<Vec<E>, DemErrorKind> {
        let width = block.width as usize;
        let mut values = vec![E::default(); width * block.height as usize];
        if !self.storage.is_written(block.index) {
            blank(self.nodata, block, &mut values, width);
        } else if let Some(mut unpacker) = Unpacker::of(self.storage, self.nodata) {
            let packed = self.bytes(unpacker.range(block, self.file_bytes)?)?;
            unpacker.fill(&packed, block, &mut values, width)?;
        } else {
            decoded(self.decoder, self.storage, self.nodata, block, &mut values, width)?;
        }
        Ok(values)
    }

    fn bytes(&mut self, range: Range<usize>) -> Result<Vec<u8>, DemErrorKind> {
        let file = self.decoder.inner();
        let mut bytes = Vec::new();
        let read = file
            .seek(SeekFrom::Start(range.start as u64))
            .and_then(|_| file.take(range.len() as u64).read_to_end(&mut bytes));
        read.map_err(|error| DemErrorKind::broken(FORMAT, error.to_string()))?;
        Ok(bytes)
    }
}

/// What stands where nothing was written: no data where the file knows such a value, else the 0 that is there
/// already, as GDAL has it.
fn blank<E: Elevation>(nodata: Option<f64>, block: TiffBlock, out: &mut [E], stride: usize) {
    if nodata.is_some() {
        for row in out.chunks_mut(stride).take(block.height as usize) {
            row[..block.width as usize].fill(E::NONE);
        }
    }
}

/// A block by way of the decoder, to `out`, whose rows lie `stride` apart and start where the block's do.
fn decoded<R: Read + Seek, E: Elevation>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    nodata: Option<f64>,
    block: TiffBlock,
    out: &mut [E],
    stride: usize,
) -> Result<(), DemErrorKind> {
    let hole = storage.comparable(nodata);
    let elevation =
        move |value: f64| if value == hole || !value.is_finite() { E::NONE } else { E::of(value) };
    let mut place = BlockTarget { bands: storage.bands_per_block.into(), block, out, stride };
    let placed = match &decoder.read_chunk(block.index).map_err(fault)? {
        DecodingResult::U8(v) => place.copy(v, |x| elevation(x.into())),
        DecodingResult::I8(v) => place.copy(v, |x| elevation(x.into())),
        DecodingResult::U16(v) => place.copy(v, |x| elevation(x.into())),
        DecodingResult::I16(v) => place.copy(v, |x| elevation(x.into())),
        DecodingResult::U32(v) => place.copy(v, |x| elevation(x.into())),
        DecodingResult::I32(v) => place.copy(v, |x| elevation(x.into())),
        DecodingResult::U64(v) => place.copy(v, |x| elevation(x as f64)),
        DecodingResult::I64(v) => place.copy(v, |x| elevation(x as f64)),
        DecodingResult::F16(v) => place.copy(v, |x| elevation(x.to_f64())),
        DecodingResult::F32(v) => place.copy(v, |x| elevation(x.into())),
        DecodingResult::F64(v) => place.copy(v, elevation),
    };
    placed
        .ok_or_else(|| DemErrorKind::broken(FORMAT, format!("block {} does not fit its image", block.index)))
}

/// Where a block's elevations go, and how many bands it holds.
struct BlockTarget<'a, E> {
    bands: usize,
    block: TiffBlock,
    out: &'a mut [E],
    stride: usize,
}

impl<E> BlockTarget<'_, E> {
    /// Copies the first band of a block; `None` where the two do not fit.
    fn copy<S: Copy>(&mut self, samples: &[S], to: impl Fn(S) -> E) -> Option<()> {
        let (bands, width) = (self.bands, self.block.width as usize);
        for row in 0..self.block.height as usize {
            let source = samples.get(row * width * bands..(row + 1) * width * bands)?;
            let target = self.out.get_mut(row * self.stride..row * self.stride + width)?;
            for (target, source) in target.iter_mut().zip(source.chunks_exact(bands)) {
                *target = to(source[0]);
            }
        }
        Some(())
    }
}
