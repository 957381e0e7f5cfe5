//! The sample type that stores a raster's heights without loss, and its no-data value.
//!
//! A type keeps heights where every bit comes back: integers where all heights are integers in their range (and none is
//! minus zero), floats otherwise. Bytes are kept as bytes; other small heights take 16 bits, as of most elevation. Readers return integers of 16 bits and 32-bit floats in 32 bits and the others in 64,
//! so the choice depends on the raster's own precision: what is read back has the same.

use rayon::prelude::*;

use crate::nodata_span::NoDataSpan;
use crate::raster::{Raster, SampleFloat, Samples};
use crate::sample_type::SampleType;

/// Samples that a thread looks at together: some tens of microseconds.
const SURVEYED_TOGETHER: usize = 1 << 16;

/// A type, and its value for no data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredSamples {
    /// The type.
    pub sample: SampleType,
    /// The value for no data; `None` where the raster has no holes and names no value.
    pub nodata: Option<f64>,
}

impl StoredSamples {
    /// The sample type and nodata value that store `raster` without loss.
    pub fn new(raster: &Raster) -> Self {
        let mut survey = SampleSurvey::new(raster);
        survey.add(&raster.samples);
        survey.stored()
    }
}

/// The values that may mean no data in a type, the preferred first.
fn candidates(sample: SampleType) -> &'static [f64] {
    match sample {
        SampleType::U8 => &[255.0, 0.0],
        SampleType::I16 => &[-32768.0, 32767.0, -9999.0],
        SampleType::U16 => &[65535.0, 0.0],
        SampleType::I32 => &[-2_147_483_648.0, 2_147_483_647.0],
        SampleType::U32 => &[4_294_967_295.0, 0.0],
        _ => &[-9999.0, f64::NAN],
    }
}

/// The facts that decide how samples are stored, of a raster that need never be in memory as a whole.
pub struct SampleSurvey {
    /// The types of integers that may keep the samples, the preferred first.
    integers: &'static [SampleType],
    float: SampleType,
    /// The value that the raster names for no data.
    own: Option<f64>,
    /// Values that may mean no data.
    possible: Vec<f64>,
    found: SurveyedSamples,
}

/// What some samples rule out.
#[derive(Clone)]
struct SurveyedSamples {
    /// Whether one has no data.
    has_holes: bool,
    /// Whether each type of integers keeps all heights.
    kept: Vec<bool>,
    /// Whether each value that may mean no data is a height.
    taken: Vec<bool>,
}

impl SurveyedSamples {
    fn and(mut self, other: Self) -> Self {
        self.has_holes |= other.has_holes;
        self.kept.iter_mut().zip(other.kept).for_each(|(kept, other)| *kept &= other);
        self.taken.iter_mut().zip(other.taken).for_each(|(taken, other)| *taken |= other);
        self
    }
}

impl SampleSurvey {
    /// A survey of the samples of `raster`, of which none is seen yet.
    pub fn new(raster: &Raster) -> Self {
        let (integers, float): (&[SampleType], _) = match raster.samples {
            Samples::F32(_) if raster.data_type == SampleType::U8.gdal_name() => {
                (&[SampleType::U8, SampleType::I16, SampleType::U16], SampleType::F32)
            }
            Samples::F32(_) => (&[SampleType::I16, SampleType::U16], SampleType::F32),
            Samples::F64(_) => (&[SampleType::I32, SampleType::U32], SampleType::F64),
        };
        let types = integers.iter().copied().chain([float]);
        let possible = types.flat_map(candidates).copied().chain(raster.nodata);
        let possible: Vec<f64> = possible.filter(|value| !value.is_nan()).collect();
        let found = SurveyedSamples {
            has_holes: false,
            kept: vec![true; integers.len()],
            taken: vec![false; possible.len()],
        };
        Self { integers, float, own: raster.nodata, possible, found }
    }

    /// Looks at the next samples.
    pub fn add(&mut self, samples: &Samples) {
        match samples {
            Samples::F32(values) => self.add_values(values),
            Samples::F64(values) => self.add_values(values),
        }
    }

    fn add_values<T: SampleFloat>(&mut self, values: &[T]) {
        let found = values.par_chunks(SURVEYED_TOGETHER).map(|values| self.surveyed(values));
        if let Some(found) = found.reduce_with(SurveyedSamples::and) {
            self.found = self.found.clone().and(found);
        }
    }

    /// What a few samples rule out that is not ruled out yet.
    fn surveyed<T: SampleFloat>(&self, values: &[T]) -> SurveyedSamples {
        // A loop that may end early is not vectorized.
        let has_holes = values.iter().fold(false, |any, &value| any | value.into().is_nan());
        let mut kept = vec![false; self.integers.len()];
        let mut bytes = false;
        for (index, sample) in self.integers.iter().enumerate() {
            // What bytes keep, the wider types keep.
            kept[index] = bytes || self.found.kept[index] && sample.keeps_all(values);
            bytes |= kept[index] && *sample == SampleType::U8;
        }
        let taken = self.possible.iter().zip(&self.found.taken).map(|(&candidate, &is_taken)| {
            // Readers take all of the span for no data.
            let (low, high) = NoDataSpan::around(candidate).ends::<T>();
            // Counted rather than searched: a loop that may end early is not vectorized.
            let equal = || values.iter().filter(|&&value| (value >= low) & (value <= high)).count();
            !is_taken && (!bytes || SampleType::U8.keeps(candidate)) && equal() > 0
        });
        SurveyedSamples { has_holes, taken: taken.collect(), kept }
    }

    /// The sample type and nodata value that store the samples without loss.
    pub fn stored(&self) -> StoredSamples {
        let integers = self.integers.iter().zip(&self.found.kept).filter(|(_, kept)| **kept);
        let types = integers.map(|(sample, _)| *sample).chain([self.float]);
        let mut stored =
            types.filter_map(|sample| Some(StoredSamples { sample, nodata: self.nodata(sample)? }));
        // NaN is no height.
        stored.next().unwrap_or(StoredSamples { sample: self.float, nodata: Some(f64::NAN) })
    }

    /// The value for no data; the outer `None` where every candidate of the type is a height.
    fn nodata(&self, sample: SampleType) -> Option<Option<f64>> {
        let has_holes = self.found.has_holes;
        if !has_holes && self.own.is_none() {
            return Some(None);
        }
        let own = self.own.filter(|value| value.is_nan() && sample.is_float() || sample.keeps(*value));
        let taken = self.possible.iter().zip(&self.found.taken);
        let is_taken = |value: f64| taken.clone().any(|(&candidate, &taken)| taken && candidate == value);
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
    use crate::raster::tests::small;

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
    fn bytes_are_kept_as_bytes_where_one_is_left_for_no_data() {
        let stored = |values: Vec<f32>, nodata| {
            let raster = Raster { data_type: "Byte", nodata, ..Raster::new(1, Samples::F32(values)) };
            let StoredSamples { sample, nodata } = StoredSamples::new(&raster);
            (sample, nodata)
        };
        let all = || (0..=255_u8).map(f32::from);
        let holed = |values: Vec<f32>| [values, vec![f32::NAN]].concat();
        assert_eq!(stored(all().collect(), None), (SampleType::U8, None));
        assert_eq!(stored(holed(all().skip(1).collect()), None), (SampleType::U8, Some(0.0)));
        assert_eq!(stored(holed(vec![0.0, 1.0]), Some(255.0)), (SampleType::U8, Some(255.0)));
        assert_eq!(stored(holed(all().collect()), Some(255.0)), (SampleType::I16, Some(-32768.0)));
        for beyond in [256.0, -1.0] {
            assert_eq!(stored(vec![0.0, beyond], None), (SampleType::I16, None));
        }
        for no_integer in [-0.0, 0.5, f32::INFINITY] {
            assert_eq!(stored(vec![1.0, no_integer], None), (SampleType::F32, None));
        }
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
