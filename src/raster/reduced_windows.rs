//! A raster of means over squares of another's samples, read in windows of its own.

use crate::error::DemErrorKind;
use crate::raster::{Raster, Samples};
use crate::reduced::{reduced_header, reduced_part};
use crate::windows::{RasterWindow, Windows};

/// The raster that [`reduced_by_overview`](crate::reduced::reduced_by_overview) makes, read and averaged in windows only.
pub struct ReducedWindows {
    source: Box<dyn Windows + Send>,
    step: u32,
    header: Raster,
}

impl ReducedWindows {
    /// The means of `step` × `step` samples of `source`; `step` is a power of two.
    pub fn new(source: Box<dyn Windows + Send>, step: u32) -> Self {
        let header = reduced_header(source.metadata(), step);
        Self { source, step, header }
    }
}

impl Windows for ReducedWindows {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let columns = window.column..window.column + window.width;
        let south = self.header.height - window.row - window.height;
        let rows = south..south + window.height;
        let means = reduced_part(&mut self.source, self.step, columns, rows)?;
        Ok(Samples::F32(means.chunks(window.width as usize).rev().collect::<Vec<_>>().concat()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reduced::reduced;

    #[test]
    fn a_window_holds_the_samples_of_the_whole_smaller_raster() {
        let heights = (0..37 * 29u32).map(|at| (at.wrapping_mul(7919) % 1013) as f32).collect();
        let mut raster = Raster::new(37, Samples::F32(heights));
        let whole = reduced(&mut raster, 4).expect("in memory");
        let mut windows = ReducedWindows::new(Box::new(raster), 4);
        assert_eq!(windows.metadata().map_from_grid, whole.map_from_grid);
        let window = RasterWindow { column: 2, row: 1, width: 5, height: 4 };
        let samples = windows.samples(window).expect("in memory");
        for row in 0..4 {
            for column in 0..5 {
                let own = samples.get((row * 5 + column) as usize);
                assert_eq!(own, whole.at(2 + column, 1 + row), "{column} {row}");
            }
        }
    }
}
