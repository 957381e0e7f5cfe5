//! Statistics of a raster's valid samples.

use rayon::prelude::*;

use crate::error::DemErrorKind;
use crate::odd_values::OddValues;
use crate::raster::{Raster, SampleFloat, Samples};
use crate::read_ahead::read_ahead;
use crate::undeclared::{UndeclaredNodata, of_counts};
use crate::void_counts::{VoidCounts, VoidSearch};
use crate::windows::{RasterWindow, Windows};

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

/// What is found of the samples of a raster.
#[derive(Clone, Debug)]
pub struct RasterSurvey {
    /// The statistics.
    pub stats: Stats,
    /// Voids that other samples enclose.
    pub voids: VoidCounts,
    /// Values that may mean no data by themselves; margins are not looked at.
    pub undeclared: Vec<UndeclaredNodata>,
}

impl Stats {
    /// The statistics of `raster`, in 64 bits: the same bits on every machine, and for every number of threads.
    ///
    /// Each row has a mean and squared deviations from it, and rows are joined in order (Chan, Golub and LeVeque 1979): sums
    /// of squares would lose the deviation of high plateaus, and two passes would read a file twice.
    pub fn new(raster: &Raster) -> Self {
        let mut sums = StatsSums::default();
        sums.add_rows(&raster.samples, raster.width);
        sums.finish()
    }

    /// The statistics of a raster that is read in windows, the same bits, and what else is found of it. It is read once, some
    /// rows at a time.
    ///
    /// # Errors
    /// Samples cannot be read.
    pub fn of_windows(windows: &mut (impl Windows + Send + ?Sized)) -> Result<RasterSurvey, DemErrorKind> {
        let size = windows.size();
        let (mut sums, mut voids) = (StatsSums::default(), VoidSearch::new(size));
        let mut odd = OddValues::new(windows.metadata());
        let bands = RasterWindow::all(size).bands(ROWS_SAMPLES);
        read_ahead(windows, bands, Windows::samples, |_, samples| {
            sums.add_rows(&samples, size.0);
            voids.add_rows(&samples);
            odd.add(&samples);
        })?;
        let (stats, voids) = (sums.finish(), voids.finish());
        Ok(RasterSurvey { stats, voids, undeclared: of_counts(&odd) })
    }

    /// The lowest and the highest valid sample of a raster that is read in windows, once, some rows at a time; NaN where none
    /// is valid.
    ///
    /// # Errors
    /// Samples cannot be read.
    pub fn range_of_windows(
        windows: &mut (impl Windows + Send + ?Sized),
    ) -> Result<(f64, f64), DemErrorKind> {
        let (size, mut sums) = (windows.size(), StatsSums::default());
        let bands = RasterWindow::all(size).bands(ROWS_SAMPLES);
        read_ahead(windows, bands, Windows::samples, |_, samples| sums.add_rows(&samples, size.0))?;
        let Self { min, max, .. } = sums.finish();
        Ok((min, max))
    }
}

/// Samples of the rows that are read at a time.
const ROWS_SAMPLES: u32 = 1 << 22;

/// Sums side by side in a row: a processor adds several while one addition waits for the one before.
const LANES: usize = 8;

/// Sums over the valid samples of rows.
#[derive(Clone, Copy)]
struct StatsSums {
    count: usize,
    sum: f64,
    min: f64,
    max: f64,
    /// The sum of squared deviations from the mean.
    squares: f64,
}

impl Default for StatsSums {
    fn default() -> Self {
        Self { count: 0, sum: 0.0, min: f64::INFINITY, max: f64::NEG_INFINITY, squares: 0.0 }
    }
}

impl StatsSums {
    /// Adds rows of `width` samples, in order.
    fn add_rows(&mut self, samples: &Samples, width: u32) {
        match samples {
            Samples::F32(values) => self.add_rows_of(values, width),
            Samples::F64(values) => self.add_rows_of(values, width),
        }
    }

    fn add_rows_of<T: SampleFloat>(&mut self, values: &[T], width: u32) {
        let rows: Vec<Self> = values.par_chunks(width as usize).map(Self::of_row).collect();
        rows.iter().for_each(|row| self.join(row));
    }

    fn of_row<T: SampleFloat>(row: &[T]) -> Self {
        let mut lanes = [Self::default(); LANES];
        for values in row.chunks(LANES) {
            for (lane, &value) in lanes.iter_mut().zip(values) {
                let value: f64 = value.into();
                let is_valid = !value.is_nan();
                lane.count += usize::from(is_valid);
                lane.sum += if is_valid { value } else { 0.0 };
                lane.min = if value < lane.min { value } else { lane.min };
                lane.max = if value > lane.max { value } else { lane.max };
            }
        }
        let mut all = Self::default();
        for lane in lanes {
            all.count += lane.count;
            all.sum += lane.sum;
            all.min = all.min.min(lane.min);
            all.max = all.max.max(lane.max);
        }
        let (mean, mut squares) = (all.mean(), [0.0; LANES]);
        for values in row.chunks(LANES) {
            for (sum, &value) in squares.iter_mut().zip(values) {
                let deviation = value.into() - mean;
                *sum += if deviation.is_nan() { 0.0 } else { deviation * deviation };
            }
        }
        Self { squares: squares.iter().sum(), ..all }
    }

    fn join(&mut self, later: &Self) {
        if later.count == 0 {
            return;
        }
        if self.count > 0 {
            let apart = later.mean() - self.mean();
            let (own, others) = (self.count as f64, later.count as f64);
            self.squares += apart * apart * (own * others / (own + others));
        }
        self.squares += later.squares;
        self.count += later.count;
        self.sum += later.sum;
        self.min = self.min.min(later.min);
        self.max = self.max.max(later.max);
    }

    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    fn finish(self) -> Stats {
        let (count, mean) = (self.count, self.mean());
        let [min, max] = [self.min, self.max].map(|bound| if count == 0 { f64::NAN } else { bound });
        Stats { valid: count, min, max, mean, std: (self.squares / count as f64).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    #[test]
    fn holes_do_not_count() {
        let stats = Stats::new(&small(2, 2, vec![1.0, f32::NAN, 3.0, f32::NAN]));
        assert_eq!(stats, Stats { valid: 2, min: 1.0, max: 3.0, mean: 2.0, std: 1.0 });
    }

    #[test]
    fn statistics_of_windows_are_those_of_the_raster() {
        let value = |at: u32| if at % 7 == 3 { f32::NAN } else { (at * 7919 % 1013) as f32 / 3.0 };
        let mut raster = small(23, 19, (0..23 * 19).map(value).collect());
        let surveyed = Stats::of_windows(&mut raster.clone()).expect("in memory");
        let RasterSurvey { stats, voids, undeclared } = surveyed;
        assert_eq!(stats, Stats::new(&raster));
        assert_eq!(voids, VoidCounts::of(&raster));
        assert!(undeclared.is_empty());
        raster.samples.clear(raster.samples.get(0));
        assert_ne!(Stats::new(&raster), stats);
    }

    #[test]
    fn values_of_windows_that_may_mean_no_data_are_found() {
        let value = |at: u32| if at < 50 { 65535.0 } else { (at % 100) as f32 };
        let mut raster = small(20, 20, (0..400).map(value).collect());
        let found = Stats::of_windows(&mut raster).expect("in memory").undeclared;
        assert_eq!(found.iter().map(|found| found.value).collect::<Vec<_>>(), [65535.0]);
    }

    #[test]
    fn a_raster_of_holes_has_no_range() {
        let stats = Stats::new(&small(1, 1, vec![f32::NAN]));
        assert_eq!(stats.valid, 0);
        assert!(stats.min.is_nan() && stats.max.is_nan() && stats.mean.is_nan() && stats.std.is_nan());
    }

    #[test]
    fn a_high_plateau_keeps_its_deviation_over_many_rows() {
        // Heights of 1e6 m and a quarter of a millimeter around it: sums of squares have no digit of that left.
        let samples = (0..100_100u32).map(|at| 1e6 + 0.000_25 * f64::from(at % 5)).collect();
        let stats = Stats::new(&Raster::new(1001, Samples::F64(samples)));
        assert!((stats.std - 0.000_25 * 2f64.sqrt()).abs() < 1e-9, "{stats:?}");
        assert!((stats.mean - 1e6 - 0.000_5).abs() < 1e-8, "{stats:?}");
    }
}
