//! Rectangles of a raster, read without the rest.
//!
//! A raster larger than the memory is read window by window. A raster in memory is read alike, so that code that works
//! on windows can be tested against it.
//!
//! ```text
//! whole raster        a position keeps its coordinates in the whole raster's grid, and so every bit of its height:
//! ┌──────────────┐    a part is no smaller raster with another corner, but the same raster of which
//! │   ┌─────┐    │    only some samples are held
//! │   │ held│    │
//! │   └─────┘    │
//! └──────────────┘
//! ```

use std::ops::Range;

use glam::DVec2;

use crate::error::{DemError, DemErrorKind};
use crate::raster::{Raster, Samples, scaled};
use crate::sample::SampleGrid;

/// Rasters of at most so many samples are read whole even where a part would do: that takes milliseconds.
pub const MOST_KEPT_SAMPLES: u64 = 1 << 20;

/// Bytes of decoded samples that are kept of a file that is read in windows: two rows of tiles of a raster of the largest
/// size.
pub const WINDOW_CACHE_BYTES: usize = 64 << 20;

/// A rectangle of a raster's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RasterWindow {
    /// Its first column, counted from the raster's first.
    pub column: u32,
    /// Its first row, counted from the raster's first: in a raster with north up, its northernmost.
    pub row: u32,
    /// Samples per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl RasterWindow {
    /// The number of its samples.
    #[inline]
    pub fn samples(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The samples that this window shares with another; `None` where there are none.
    #[inline]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let shared = |first: u32, count: u32, other: u32, others: u32| {
            let start = first.max(other);
            let end = (first + count).min(other + others);
            (start < end).then(|| (start, end - start))
        };
        let (column, width) = shared(self.column, self.width, other.column, other.width)?;
        let (row, height) = shared(self.row, self.height, other.row, other.height)?;
        Some(Self { column, row, width, height })
    }

    /// For each row that this window shares with another, its samples as ranges of indices in either.
    #[inline]
    pub fn shared_rows(self, other: Self) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let first = self.column.max(other.column);
        let last = (self.column + self.width).min(other.column + other.width).max(first);
        let rows = self.row.max(other.row)..(self.row + self.height).min(other.row + other.height);
        let range = move |window: Self, row: u32| {
            let start =
                (row - window.row) as usize * window.width as usize + (first - window.column) as usize;
            start..start + (last - first) as usize
        };
        rows.map(move |row| (range(self, row), range(other, row)))
    }

    /// All of a raster of this size.
    #[inline]
    pub fn all((width, height): (u32, u32)) -> Self {
        Self { column: 0, row: 0, width, height }
    }

    /// The samples around the grid positions from `low` to `high`, and `halo` more on each side as far as there are any;
    /// in a raster of this size. Positions beyond it count as on its border.
    pub fn around((width, height): (u32, u32), low: DVec2, high: DVec2, halo: u32) -> Self {
        let halo = f64::from(halo);
        let last = DVec2::new(f64::from(width - 1), f64::from(height - 1));
        let first = (low.floor() - halo).clamp(DVec2::ZERO, last).as_uvec2();
        let end = (high.floor() + halo).clamp(DVec2::ZERO, last).as_uvec2();
        Self {
            column: first.x,
            row: first.y,
            width: end.x.max(first.x) - first.x + 1,
            height: end.y.max(first.y) - first.y + 1,
        }
    }

    /// The window in bands of whole rows, of about `samples` each and at least a row.
    #[inline]
    pub fn bands(self, samples: u32) -> impl Iterator<Item = Self> {
        let rows = (samples / self.width).max(1);
        (0..self.height).step_by(rows as usize).map(move |first| {
            let height = rows.min(self.height - first);
            Self { row: self.row + first, height, ..self }
        })
    }

    /// The window in squares of `side` samples, row by row; those at its end are smaller.
    pub(crate) fn tiles(self, side: u32) -> impl Iterator<Item = Self> {
        let starts = move |count: u32| (0..count).step_by(side as usize);
        starts(self.height).flat_map(move |row| {
            starts(self.width).map(move |column| Self {
                column: self.column + column,
                row: self.row + row,
                width: side.min(self.width - column),
                height: side.min(self.height - row),
            })
        })
    }

    /// # Panics
    /// Where the window reaches beyond a raster of this size.
    pub fn assert_within(&self, (width, height): (u32, u32)) {
        let end = |start: u32, count: u32| u64::from(start) + u64::from(count);
        assert!(
            end(self.column, self.width) <= width.into() && end(self.row, self.height) <= height.into(),
            "{self:?} reaches beyond {width} x {height} samples"
        );
    }
}

/// A raster of bytes.
pub trait ByteRows: Sync {
    /// Fills `out` with the samples of `row` from `column` on; the metadata's `nodata`, a byte that no sample has, without
    /// data.
    ///
    /// # Panics
    /// Where they reach beyond the raster.
    fn fill(&self, column: u32, row: u32, out: &mut [u8]);
}

/// A raster that is read in rectangles.
pub trait Windows {
    /// The raster's size, place and coordinate system. Its `samples` have the precision of those in windows, and mean
    /// nothing else; they may be empty.
    fn metadata(&self) -> &Raster;

    /// The samples of `window` in the raster's vertical unit, row by row from its first; NaN without data. They have the
    /// precision and the bits that they have in the raster read whole.
    ///
    /// # Errors
    /// The samples cannot be read; another window still may.
    ///
    /// # Panics
    /// Where the window reaches beyond the raster.
    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind>;

    /// Fills `out` with the heights of `window` in meters, row by row from its first; NaN without data. Reading the
    /// whole raster and converting it to meters gives the same bits.
    ///
    /// # Errors
    /// As [`Windows::samples`].
    ///
    /// # Panics
    /// Where the window reaches beyond the raster.
    fn read(&mut self, window: RasterWindow, out: &mut Vec<f32>) -> Result<(), DemErrorKind> {
        let meters_per_z = self.metadata().meters_per_z;
        match self.samples(window)? {
            Samples::F32(samples) if meters_per_z == 1.0 => *out = samples,
            samples => {
                out.clear();
                out.extend(samples.iter().map(|value| scaled(value, meters_per_z, 0.0) as f32));
            }
        }
        Ok(())
    }

    /// The coarsest overview in the file of the same ground of which one sample covers no more than `step` by `step` of
    /// these, and how many samples a side it covers, a power of two.
    fn overview(&self, _step: u32) -> Option<(u32, Box<dyn Windows + Send + '_>)> {
        None
    }

    /// The samples as bytes, if the raster holds bytes: a file then stores them as they are, without a first pass that
    /// chooses the type.
    fn bytes(&self) -> Option<&dyn ByteRows> {
        None
    }

    /// How many rows are best taken together, if the samples are computed as they are read: a file then stores them in one pass,
    /// band by band, as bytes or f32 by the metadata's `data_type`. `None` for others.
    fn computed_rows(&self) -> Option<u32> {
        None
    }

    /// Announces windows that are read next, so that they can be read together: on all threads, what they share once.
    /// Has no effect on what they hold; errors wait for the reading.
    fn announce(&mut self, _windows: &[RasterWindow]) {}

    /// Samples per row, and rows.
    fn size(&self) -> (u32, u32) {
        (self.metadata().width, self.metadata().height)
    }
}

/// A raster in windows whose file holds overviews: the same ground with samples further apart.
pub trait WithOverviews: Windows + Sized {
    /// Samples per row and rows of each overview, in the order of the file.
    fn overview_sizes(&self) -> Vec<(u32, u32)>;

    /// Opens an overview by its index in [`WithOverviews::overview_sizes`].
    ///
    /// # Errors
    /// The overview is broken, or stored in a way that is not read.
    ///
    /// # Panics
    /// There is no such overview.
    fn at_overview_size(&self, index: usize) -> Result<Self, DemError>;
}

impl Windows for Raster {
    fn metadata(&self) -> &Raster {
        self
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        Ok(window_samples(self, RasterWindow::all(self.size()), window))
    }
}

impl<W: Windows + ?Sized> Windows for Box<W> {
    fn metadata(&self) -> &Raster {
        (**self).metadata()
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        (**self).samples(window)
    }

    fn read(&mut self, window: RasterWindow, out: &mut Vec<f32>) -> Result<(), DemErrorKind> {
        (**self).read(window, out)
    }

    fn overview(&self, step: u32) -> Option<(u32, Box<dyn Windows + Send + '_>)> {
        (**self).overview(step)
    }

    fn announce(&mut self, windows: &[RasterWindow]) {
        (**self).announce(windows);
    }
}

/// The samples of `window`, of a raster that holds those of a window around it.
///
/// # Panics
/// Where `window` reaches beyond `held`.
pub fn window_samples(raster: &Raster, held: RasterWindow, window: RasterWindow) -> Samples {
    let mut samples = Samples::absent(window.samples(), raster.samples.is_wide());
    for (from, to) in held.shared_rows(window) {
        samples.copy_from(to, &raster.samples, from);
    }
    samples
}

/// A raster of which the samples of one window are held.
pub struct RasterPart<'a> {
    /// The whole raster; its `samples` are not used.
    pub whole: &'a Raster,
    /// What is held of it.
    pub window: RasterWindow,
    /// The samples of the window.
    pub samples: Samples,
}

impl SampleGrid for RasterPart<'_> {
    fn whole(&self) -> &Raster {
        self.whole
    }

    #[inline]
    fn value(&self, column: u32, row: u32) -> f64 {
        let RasterWindow { column: first, row: top, width, height } = self.window;
        let (across, down) = (column.wrapping_sub(first), row.wrapping_sub(top));
        assert!(across < width && down < height, "sample ({column}, {row}) is outside {:?}", self.window);
        self.samples.get(down as usize * width as usize + across as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    #[test]
    fn a_window_of_a_raster_in_memory_holds_its_heights_in_meters() {
        let mut raster = small(3, 3, (0..9u8).map(f32::from).collect());
        raster.meters_per_z = 0.5;
        let mut out = vec![7.0; 5];
        raster.read(RasterWindow { column: 1, row: 1, width: 2, height: 2 }, &mut out).expect("inside");
        assert_eq!(out, [2.0, 2.5, 3.5, 4.0]);
    }

    #[test]
    #[should_panic(expected = "reaches beyond")]
    fn a_window_beyond_the_raster_panics() {
        let window = RasterWindow { column: 2, row: 0, width: 2, height: 1 };
        let _ = small(3, 3, vec![0.0; 9]).read(window, &mut Vec::new());
    }
}
