//! Statistics of a raster's valid samples.

use crate::dem::error::DemErrorKind;
use crate::dem::raster::{Raster, Samples};
use crate::dem::void_counts::{VoidCounts, VoidSearch};
use crate::dem::windows::{RasterWindow, Windows};

/// Statistics of the valid samples of a raster, in its vertical unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stats {
    /// The number of samples with a value; the others are no data.
    pub valid: usize,
    /// The lowest; NaN where none is valid.
    pub min: f64,
    /// The highest; NaN where none is valid.
    pub max: f64,
    /// The mean; NaN where none is valid.
    pub mean: f64,
    /// The standard deviation of all of them (divided by their number); NaN where none is valid.
    pub std: f64,
}

impl Stats {
    /// The statistics of `raster`, summed in 64 bits in the order of the samples: the same bits on every machine.
    ///
    /// Two passes, since the one-pass formula loses the deviation of high plateaus.
    pub fn new(raster: &Raster) -> Self {
        let mut sums = StatsSums::default();
        sums.add(&raster.samples);
        let mean = sums.mean();
        sums.finish(squares(0.0, &raster.samples, mean))
    }

    /// The statistics of a raster that is read in windows, and its [voids](VoidCounts): the same bits. It is read twice, some
    /// rows at a time.
    ///
    /// # Errors
    /// Samples cannot be read.
    pub fn of_windows(windows: &mut (impl Windows + ?Sized)) -> Result<(Self, VoidCounts), DemErrorKind> {
        let size = windows.size();
        let (mut sums, mut voids) = (StatsSums::default(), VoidSearch::new(size));
        for rows in RasterWindow::all(size).bands(ROWS_SAMPLES) {
            let samples = windows.samples(rows)?;
            sums.add(&samples);
            voids.add_rows(&samples);
        }
        let (mean, mut sum) = (sums.mean(), 0.0);
        for rows in RasterWindow::all(size).bands(ROWS_SAMPLES) {
            sum = squares(sum, &windows.samples(rows)?, mean);
        }
        Ok((sums.finish(sum), voids.finish()))
    }

    /// The lowest and the highest valid sample of a raster that is read in windows, once, some rows at a time; NaN where none
    /// is valid.
    ///
    /// # Errors
    /// Samples cannot be read.
    pub fn range_of_windows(windows: &mut (impl Windows + ?Sized)) -> Result<(f64, f64), DemErrorKind> {
        let mut sums = StatsSums::default();
        for rows in RasterWindow::all(windows.size()).bands(ROWS_SAMPLES) {
            sums.add(&windows.samples(rows)?);
        }
        let Self { min, max, .. } = sums.finish(0.0);
        Ok((min, max))
    }
}

/// Samples of the rows that are read at a time.
const ROWS_SAMPLES: u32 = 1 << 22;

/// Adds the squared deviations of samples from a mean to a sum, in order.
fn squares(sum: f64, samples: &Samples, mean: f64) -> f64 {
    samples.valid().fold(sum, |sum, value| sum + (value - mean) * (value - mean))
}

/// Sums over samples in their order.
struct StatsSums {
    count: usize,
    sum: f64,
    min: f64,
    max: f64,
}

impl Default for StatsSums {
    fn default() -> Self {
        Self { count: 0, sum: 0.0, min: f64::NAN, max: f64::NAN }
    }
}

impl StatsSums {
    fn add(&mut self, samples: &Samples) {
        for value in samples.valid() {
            self.count += 1;
            self.sum += value;
            self.min = f64::min(self.min, value);
            self.max = f64::max(self.max, value);
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    fn finish(self, squares: f64) -> Stats {
        let (count, mean) = (self.count, self.mean());
        Stats { valid: count, min: self.min, max: self.max, mean, std: (squares / count as f64).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::raster::tests::small;

    #[test]
    fn holes_do_not_count() {
        let stats = Stats::new(&small(2, 2, vec![1.0, f32::NAN, 3.0, f32::NAN]));
        assert_eq!(stats, Stats { valid: 2, min: 1.0, max: 3.0, mean: 2.0, std: 1.0 });
    }

    #[test]
    fn statistics_of_windows_are_those_of_the_raster() {
        let value = |at: u32| if at % 7 == 3 { f32::NAN } else { (at * 7919 % 1013) as f32 / 3.0 };
        let mut raster = small(23, 19, (0..23 * 19).map(value).collect());
        let (stats, voids) = Stats::of_windows(&mut raster.clone()).expect("in memory");
        assert_eq!(stats, Stats::new(&raster));
        assert_eq!(voids, VoidCounts::of(&raster));
        raster.samples.clear(raster.samples.get(0));
        assert_ne!(Stats::new(&raster), stats);
    }

    #[test]
    fn a_raster_of_holes_has_no_range() {
        let stats = Stats::new(&small(1, 1, vec![f32::NAN]));
        assert_eq!(stats.valid, 0);
        assert!(stats.min.is_nan() && stats.max.is_nan() && stats.mean.is_nan() && stats.std.is_nan());
    }
}
