//! Rectangles of a raster, read without reading it whole.
//!
//! What is larger than the memory is asked for piece by piece. A raster in memory answers the same questions, so
//! whatever works on windows can be tested against one that works on the whole.

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
    /// How many samples it has.
    pub fn samples(&self) -> usize {
        self.width as usize * self.height as usize
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
    /// The raster without its samples: size, place, coordinate system. What its `samples` hold, if anything, is not
    /// to be looked at.
    fn bare(&self) -> &Raster;

    /// Fills `out` with the heights of `window` in meters, row by row from its first; NaN without data. They are
    /// those that reading the whole raster and bringing it to meters would give, to the last bit.
    ///
    /// # Errors
    /// The samples cannot be had; another window may still be read.
    ///
    /// # Panics
    /// Where the window reaches beyond the raster.
    fn read(&mut self, window: RasterWindow, out: &mut Vec<f32>) -> Result<(), DemErrorKind>;

    /// Samples per row, and rows.
    fn size(&self) -> (u32, u32) {
        (self.bare().width, self.bare().height)
    }
}

/// A raster in memory.
impl Windows for Raster {
    fn bare(&self) -> &Raster {
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
    fn a_window_beyond_the_raster_is_our_own_mistake() {
        let window = RasterWindow { column: 2, row: 0, width: 2, height: 1 };
        let _ = small(3, 3, vec![0.0; 9]).read(window, &mut Vec::new());
    }
}
