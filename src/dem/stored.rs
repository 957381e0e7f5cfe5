//! The sample type that stores a raster's heights without loss, and its no-data value.
//!
//! A type keeps heights where every bit comes back: integers where all heights are integers in their range (and none is
//! minus zero), floats otherwise. Readers return integers of 16 bits and 32-bit floats in 32 bits and the others in 64,
//! so the choice depends on the raster's own precision: what is read back has the same.

use rayon::prelude::*;

use crate::dem::raster::{Raster, SampleFloat, Samples};
use crate::dem::sample_type::SampleType;

/// Samples that a thread looks at together: some tens of microseconds.
const SURVEYED_TOGETHER: usize = 1 << 16;

/// A type, and its value for no data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StoredSamples {
    pub sample: SampleType,
    /// The value for no data; `None` where the raster has no holes and names no value.
    pub nodata: Option<f64>,
}

impl StoredSamples {
    /// How the samples of `raster` are stored without a loss.
    pub fn new(raster: &Raster) -> Self {
        let mut survey = SampleSurvey::new(raster);
        survey.add(&raster.samples);
        survey.stored()
    }
}

/// The values that may mean no data in a type, the preferred first.
fn candidates(sample: SampleType) -> &'static [f64] {
    match sample {
        SampleType::I16 => &[-32768.0, 32767.0, -9999.0],
        SampleType::U16 => &[65535.0, 0.0],
        SampleType::I32 => &[-2_147_483_648.0, 2_147_483_647.0],
        SampleType::U32 => &[4_294_967_295.0, 0.0],
        _ => &[-9999.0, f64::NAN],
    }
}

/// What decides how samples are stored, of a raster of which never all need be in memory.
pub(crate) struct SampleSurvey {
    integers: [SampleType; 2],
    float: SampleType,
    /// Whether each type of integers keeps all heights.
    kept: [bool; 2],
    /// The value that the raster names for no data.
    own: Option<f64>,
    /// Values that may mean no data, and whether each is a height.
    taken: Vec<(f64, bool)>,
    /// Samples with data.
    pub valid: u64,
    samples: u64,
}

impl SampleSurvey {
    /// A survey of the samples of `raster`, of which none is seen yet.
    pub fn new(raster: &Raster) -> Self {
        let (integers, float) = match raster.samples {
            Samples::F32(_) => ([SampleType::I16, SampleType::U16], SampleType::F32),
            Samples::F64(_) => ([SampleType::I32, SampleType::U32], SampleType::F64),
        };
        let types = integers.into_iter().chain([float]);
        let possible = types.flat_map(candidates).copied().chain(raster.nodata);
        let taken = possible.filter(|value| !value.is_nan()).map(|value| (value, false)).collect();
        Self { integers, float, kept: [true; 2], own: raster.nodata, taken, valid: 0, samples: 0 }
    }

    /// Looks at the next samples.
    pub fn add(&mut self, samples: &Samples) {
        match samples {
            Samples::F32(values) => self.add_values(values),
            Samples::F64(values) => self.add_values(values),
        }
    }

    fn add_values<T: SampleFloat>(&mut self, values: &[T]) {
        self.samples += values.len() as u64;
        let chunks = || values.par_chunks(SURVEYED_TOGETHER);
        let valid = |values: &[T]| values.iter().filter(|&&value| !value.into().is_nan()).count() as u64;
        self.valid += chunks().map(valid).sum::<u64>();
        for (sample, kept) in self.integers.iter().zip(&mut self.kept).filter(|(_, kept)| **kept) {
            let keeps = |value: f64| value.is_nan() || sample.keeps(value);
            *kept = chunks().all(|values| values.iter().all(|&value| keeps(value.into())));
        }
        for (candidate, taken) in self.taken.iter_mut().filter(|(_, taken)| !*taken) {
            // Counted rather than searched: a loop that may end early is not vectorized.
            let equal = |values: &[T]| values.iter().filter(|&&value| value.into() == *candidate).count();
            *taken = chunks().any(|values| equal(values) > 0);
        }
    }

    /// How the samples are stored without a loss.
    pub fn stored(&self) -> StoredSamples {
        let integers = self.integers.into_iter().zip(self.kept).filter(|(_, kept)| *kept);
        let types = integers.map(|(sample, _)| sample).chain([self.float]);
        let mut stored =
            types.filter_map(|sample| Some(StoredSamples { sample, nodata: self.nodata(sample)? }));
        // NaN is no height.
        stored.next().unwrap_or(StoredSamples { sample: self.float, nodata: Some(f64::NAN) })
    }

    /// The value for no data; the outer `None` where every candidate of the type is a height.
    fn nodata(&self, sample: SampleType) -> Option<Option<f64>> {
        let has_holes = self.valid < self.samples;
        if !has_holes && self.own.is_none() {
            return Some(None);
        }
        let own = self.own.filter(|value| value.is_nan() && sample.is_float() || sample.keeps(*value));
        let is_taken = |value: f64| self.taken.iter().any(|&(candidate, taken)| taken && candidate == value);
        let is_free = |value: &f64| value.is_nan() || !is_taken(*value);
        match own.into_iter().chain(candidates(sample).iter().copied()).find(is_free) {
            Some(nodata) => Some(Some(nodata)),
            None if !has_holes => Some(None),
            None => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::raster::tests::small;

    fn stored(samples: Samples) -> (SampleType, Option<f64>) {
        let StoredSamples { sample, nodata } = StoredSamples::new(&Raster::new(2, samples));
        (sample, nodata)
    }

    #[test]
    fn integers_are_kept_as_integers_and_all_else_as_floats() {
        assert_eq!(stored(Samples::F32(vec![-5.0, 32767.0])), (SampleType::I16, None));
        assert_eq!(stored(Samples::F32(vec![5.0, 60000.0])), (SampleType::U16, None));
        assert_eq!(stored(Samples::F32(vec![-5.0, 60000.0])), (SampleType::F32, None));
        assert_eq!(stored(Samples::F32(vec![0.5, 1.0])), (SampleType::F32, None));
        assert_eq!(stored(Samples::F32(vec![-0.0, 1.0])), (SampleType::F32, None));
        assert_eq!(stored(Samples::F64(vec![-5.0, 1e9])), (SampleType::I32, None));
        assert_eq!(stored(Samples::F64(vec![0.1, 1e9])), (SampleType::F64, None));
    }

    #[test]
    fn the_value_for_no_data_is_never_a_height() {
        assert_eq!(stored(Samples::F32(vec![f32::NAN, 7.0])), (SampleType::I16, Some(-32768.0)));
        assert_eq!(stored(Samples::F32(vec![f32::NAN, -32768.0])), (SampleType::I16, Some(32767.0)));
        assert_eq!(stored(Samples::F32(vec![f32::NAN, -9999.5])), (SampleType::F32, Some(-9999.0)));
        let raster = Raster { nodata: Some(7.0), ..small(2, 1, vec![7.0, 8.0]) };
        assert_eq!(StoredSamples::new(&raster).nodata, Some(-32768.0));
        let raster = Raster { nodata: Some(0.0), ..small(2, 1, vec![7.0, f32::NAN]) };
        let stored = StoredSamples { sample: SampleType::I16, nodata: Some(0.0) };
        assert_eq!(StoredSamples::new(&raster), stored);
    }
}
