//! Heights that are raised or lowered as a whole: tiles that are counted from another zero, or lie off their neighbors.

use crate::error::DemErrorKind;
use crate::raster::{Raster, Samples};
use crate::windows::{RasterWindow, Windows};

impl Raster {
    /// The raster with `meters` added to all heights.
    pub fn raised(self, meters: f64) -> Self {
        let by = meters / self.meters_per_z;
        Self { samples: self.samples.scaled(1.0, by), ..self }
    }
}

/// A raster in windows with meters added to all heights.
pub struct RaisedWindows<W> {
    windows: W,
    header: Raster,
    meters: f64,
}

impl<W: Windows> RaisedWindows<W> {
    /// The heights of `windows` and `meters`.
    pub fn new(windows: W, meters: f64) -> Self {
        let header = windows.metadata().without_samples().raised(meters);
        Self { windows, header, meters }
    }
}

impl<W: Windows + Send> Windows for RaisedWindows<W> {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        let samples = self.windows.samples(window)?;
        Ok(samples.scaled(1.0, self.meters / self.header.meters_per_z))
    }

    fn overview(&self, step: u32) -> Option<(u32, Box<dyn Windows + Send + '_>)> {
        let (held, windows) = self.windows.overview(step)?;
        Some((held, Box::new(RaisedWindows::new(windows, self.meters))))
    }

    fn announce(&mut self, windows: &[RasterWindow]) {
        self.windows.announce(windows);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    #[test]
    fn raised_windows_are_those_of_the_raised_raster_in_its_unit() {
        let mut raster = small(3, 2, vec![1.0, f32::NAN, 3.0, 4.0, 5.0, 6.0]);
        raster.meters_per_z = 0.5;
        let raised = raster.clone().raised(-1.5);
        assert_eq!((raised.at(0, 0), raised.at(2, 1), raised.at(1, 0).is_nan()), (-2.0, 3.0, true));
        let mut windows = RaisedWindows::new(raster.clone(), -1.5);
        assert!(windows.metadata().samples.is_wide() && raised.samples.is_wide());
        let window = RasterWindow { column: 1, row: 0, width: 2, height: 2 };
        let found = windows.samples(window).expect("in memory");
        assert_eq!(found.valid().collect::<Vec<_>>(), [0.0, 2.0, 3.0]);
        assert_eq!(raster.clone().raised(0.0).samples.is_wide(), raster.samples.is_wide());
    }
}
