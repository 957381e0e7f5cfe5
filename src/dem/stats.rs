//! Statistics of a raster's valid samples.

use crate::dem::raster::Raster;

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
        let (mut count, mut sum) = (0usize, 0.0);
        let (mut min, mut max) = (f64::NAN, f64::NAN);
        for value in raster.samples.valid() {
            count += 1;
            sum += value;
            min = f64::min(min, value);
            max = f64::max(max, value);
        }
        let mean = sum / count as f64;
        let squares: f64 =
            raster.samples.valid().fold(0.0, |sum, value| sum + (value - mean) * (value - mean));
        Self { valid: count, min, max, mean, std: (squares / count as f64).sqrt() }
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
    fn a_raster_of_holes_has_no_range() {
        let stats = Stats::new(&small(1, 1, vec![f32::NAN]));
        assert_eq!(stats.valid, 0);
        assert!(stats.min.is_nan() && stats.max.is_nan() && stats.mean.is_nan() && stats.std.is_nan());
    }
}
