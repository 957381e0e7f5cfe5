//! A window of a GeoTIFF whose blocks are decoded straight into its rows and not kept: they are too many to be, or as fast to
//! read again as they are stored in the file, row by row.
//!
//! ```text
//! ┌────┬────┬────┐
//! │  ┌─┼────┼──┐ │  bands end where rows of blocks do; each thread fills one
//! ├──┼─┼────┼──┼─┤
//! │  └─┼────┼──┘ │
//! └────┴────┴────┘
//! ```
//!
//! Memory: the window, and for each thread a block, and the packed bytes of a band of small blocks.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::{io, mem};

use rayon::prelude::*;

use crate::tiff::fault;
use crate::tiff::unpack::BlockBytes;
use crate::tiff::windows::GeoTiffWindows;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{SampleFloat, Samples};
use sandtable_raster::windows::RasterWindow;

/// Samples that a thread decodes together, if rows of blocks hold no more: strips are often single rows.
const BAND_SAMPLES: u32 = 1 << 17;

/// Bands for each thread that are decoded before the next are: enough to keep all threads at work.
const BANDS_PER_THREAD: usize = 4;

/// The most bytes of blocks that are read together.
const MOST_IN_RUN: usize = 4 << 20;

/// Some rows of a window, and their samples.
struct Band<'a, E> {
    window: RasterWindow,
    samples: &'a mut [E],
}

impl<R: FileContent> GeoTiffWindows<R> {
    /// Bands of a window whose samples are together no more than what may be kept: so many are announced and decoded at once.
    /// Where they are fewer than threads, these share the blocks of a band instead.
    pub(super) fn bands_at_once(&self, window: RasterWindow) -> usize {
        let band = RasterWindow { height: band_rows(window, self.block_height()), ..window };
        self.cache_bytes() / (band.samples() * self.sample_bytes()).max(1)
    }

    /// The samples of a window; nothing is kept of it.
    pub(super) fn large_window(&self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        if self.is_wide() { self.decoded::<f64>(window) } else { self.decoded::<f32>(window) }
    }

    /// The error is that of the first broken block.
    fn decoded<E: SampleFloat>(&self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        // Zeros come from the system as they are needed, in the task that overwrites them.
        let mut samples = vec![E::default(); window.samples()];
        let mut bands = bands(window, self.block_height(), &mut samples);
        let most = rayon::current_num_threads() * BANDS_PER_THREAD;
        // Memory for packed bytes, used again.
        let spare = Mutex::new(Vec::new());
        let taken = || spare.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        let fill = |band: &mut Band<'_, E>| {
            let mut bytes = taken();
            let outcome = self.fill(band, &mut bytes);
            spare.lock().unwrap_or_else(PoisonError::into_inner).push(bytes);
            outcome
        };
        for some in bands.chunks_mut(self.bands_at_once(window).clamp(1, most)) {
            self.announce_windows(some.iter().map(|band| band.window));
            let outcomes: Vec<_> = some.par_iter_mut().with_max_len(1).map(fill).collect();
            outcomes.into_iter().collect::<Result<(), _>>()?;
        }
        Ok(E::into_samples(samples))
    }

    /// The file, of which the bytes of a band's blocks are held where they lie one behind the other: strips of single rows
    /// are not read one by one.
    fn run_of<'b>(
        &self,
        band: RasterWindow,
        held: &'b mut Vec<u8>,
    ) -> io::Result<RunBytes<'b, impl BlockBytes + use<R>>> {
        let mut run: Option<Range<usize>> = None;
        let mut file = self.file();
        for at in self.blocks_meeting(band) {
            let Some(range) = self.packed_range(at) else {
                return Ok(RunBytes { file, start: 0, held: &[] });
            };
            run = match run {
                None => Some(range),
                Some(run) if run.end == range.start && range.end - run.start <= MOST_IN_RUN => {
                    Some(run.start..range.end)
                }
                Some(_) => return Ok(RunBytes { file, start: 0, held: &[] }),
            };
        }
        let run = run.unwrap_or_default();
        let start = run.start;
        file.read_into(run, held)?;
        Ok(RunBytes { file, start, held })
    }

    fn fill<E: SampleFloat>(&self, band: &mut Band<'_, E>, bytes: &mut Vec<u8>) -> Result<(), DemErrorKind> {
        let mut file = self.run_of(band.window, bytes).map_err(fault::unread)?;
        let mut decoder = self.plain_decoder()?;
        let RasterWindow { column, row, width, .. } = band.window;
        for at in self.blocks_meeting(band.window) {
            if let Some(decoder) =
                decoder.as_mut().filter(|_| band.window.intersection(at.window) == Some(at.window))
            {
                let start =
                    (at.window.row - row) as usize * width as usize + (at.window.column - column) as usize;
                decoder.decode(&mut file, at, &mut band.samples[start..], width as usize)?;
                continue;
            }
            let block = self.decode(&mut file, at)?;
            let block = E::values(&block).expect("blocks have the precision of the raster");
            for (from, to) in at.window.shared_rows(band.window) {
                band.samples[to].copy_from_slice(&block[from]);
            }
        }
        Ok(())
    }
}

/// Rows of a band: whole blocks.
fn band_rows(window: RasterWindow, block_height: u32) -> u32 {
    let blocks = (BAND_SAMPLES / window.width.max(1) / block_height.max(1)).max(1);
    block_height.max(1).saturating_mul(blocks)
}

/// A file of which some bytes are held.
struct RunBytes<'b, F> {
    file: F,
    start: usize,
    held: &'b [u8],
}

impl<F: BlockBytes> BlockBytes for RunBytes<'_, F> {
    fn length(&self) -> usize {
        self.file.length()
    }

    fn bytes(&mut self, range: Range<usize>) -> io::Result<Cow<'_, [u8]>> {
        let start = range.start.checked_sub(self.start);
        match start.and_then(|start| self.held.get(start..start + range.len())) {
            Some(held) => Ok(Cow::Borrowed(held)),
            None => self.file.bytes(range),
        }
    }

    fn held(&self, range: Range<usize>) -> Option<&[u8]> {
        self.held.get(range.start.checked_sub(self.start)?..range.end.checked_sub(self.start)?)
    }

    fn read_into(&mut self, range: Range<usize>, out: &mut Vec<u8>) -> io::Result<()> {
        if self.held.is_empty() {
            return self.file.read_into(range, out);
        }
        out.clear();
        out.extend_from_slice(&self.bytes(range)?);
        Ok(())
    }
}

/// A window in bands.
fn bands<E>(window: RasterWindow, block_height: u32, mut samples: &mut [E]) -> Vec<Band<'_, E>> {
    let rows = band_rows(window, block_height);
    let (mut row, end) = (window.row, window.row + window.height);
    let mut bands = Vec::new();
    while row < end {
        let height = (rows - row % rows).min(end - row);
        let window = RasterWindow { row, height, ..window };
        let (band, rest) = mem::take(&mut samples).split_at_mut(window.samples());
        bands.push(Band { window, samples: band });
        (samples, row) = (rest, row + height);
    }
    bands
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_end_with_rows_of_blocks_and_hold_all_of_the_window() {
        for (row, height, block_height, heights) in
            [(3, 20, 8, vec![5, 8, 7]), (8, 8, 8, vec![8]), (0, 3, 1, vec![1, 1, 1]), (5, 1, 16, vec![1])]
        {
            let window = RasterWindow { column: 2, row, width: BAND_SAMPLES, height };
            let mut samples = vec![0.0_f32; window.samples()];
            let bands = bands(window, block_height, &mut samples);
            assert_eq!(bands.iter().map(|band| band.window.height).collect::<Vec<_>>(), heights);
            assert!(bands.iter().all(|band| band.samples.len() == band.window.samples()));
            assert!(
                bands.windows(2).all(|pair| pair[0].window.row + pair[0].window.height == pair[1].window.row)
            );
        }
        let window = RasterWindow { column: 0, row: 1, width: BAND_SAMPLES / 4, height: 8 };
        let mut samples = vec![0.0_f32; window.samples()];
        let heights = bands(window, 1, &mut samples);
        assert_eq!(heights.iter().map(|band| band.window.height).collect::<Vec<_>>(), [3, 4, 1]);
    }
}
