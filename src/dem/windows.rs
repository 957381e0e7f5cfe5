//! Rectangles of a raster, read without the rest.
//!
//! A raster larger than the memory is read window by window. A raster in memory is read alike, so that code that works
//! on windows can be tested against it.

use std::ops::Range;

use crate::dem::error::DemErrorKind;
use crate::dem::raster::{Raster, scaled};

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
    pub fn samples(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// For each row that this window shares with another, its samples as ranges of indices in either.
    pub(crate) fn shared_rows(self, other: Self) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
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

    /// # Panics
    /// Where the window reaches beyond a raster of this size.
    pub(crate) fn assert_within(&self, (width, height): (u32, u32)) {
        let end = |start: u32, count: u32| u64::from(start) + u64::from(count);
        assert!(
            end(self.column, self.width) <= width.into() && end(self.row, self.height) <= height.into(),
            "{self:?} reaches beyond {width} x {height} samples"
        );
    }
}

/// A raster that is read in rectangles.
pub trait Windows {
    /// The raster's size, place and coordinate system. Its `samples` mean nothing and may be empty.
    fn metadata(&self) -> &Raster;

    /// Fills `out` with the heights of `window` in meters, row by row from its first; NaN without data. Reading the
    /// whole raster and converting it to meters gives the same bits.
    ///
    /// # Errors
    /// The samples cannot be read; another window still may.
    ///
    /// # Panics
    /// Where the window reaches beyond the raster.
    fn read(&mut self, window: RasterWindow, out: &mut Vec<f32>) -> Result<(), DemErrorKind>;

    /// Samples per row, and rows.
    fn size(&self) -> (u32, u32) {
        (self.metadata().width, self.metadata().height)
    }
}

impl Windows for Raster {
    fn metadata(&self) -> &Raster {
        self
    }

    fn read(&mut self, window: RasterWindow, out: &mut Vec<f32>) -> Result<(), DemErrorKind> {
        window.assert_within(self.size());
        out.clear();
        for row in window.row..window.row + window.height {
            let columns = window.column..window.column + window.width;
            out.extend(columns.map(|column| scaled(self.at(column, row), self.meters_per_z, 0.0) as f32));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::raster::tests::small;

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
