//! The sample type that stores a raster's heights without loss, and its no-data value.
//!
//! A type keeps heights where every bit comes back: integers where all heights are integers in their range (and none is
//! minus zero), floats otherwise. Readers return integers of 16 bits and 32-bit floats in 32 bits and the others in 64,
//! so the choice depends on the raster's own precision: what is read back has the same.

use crate::dem::raster::{Raster, Samples};
use crate::dem::sample_type::SampleType;

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
        let (integers, float) = match raster.samples {
            Samples::F32(_) => ([SampleType::I16, SampleType::U16], SampleType::F32),
            Samples::F64(_) => ([SampleType::I32, SampleType::U32], SampleType::F64),
        };
        let keeps = |sample: &SampleType| raster.samples.valid().all(|value| sample.keeps(value));
        let candidates = integers.into_iter().filter(keeps).chain([float]);
        let mut stored =
            candidates.filter_map(|sample| Some(Self { sample, nodata: nodata(raster, sample)? }));
        // NaN is no height.
        stored.next().unwrap_or(Self { sample: float, nodata: Some(f64::NAN) })
    }
}

/// The value for no data; the outer `None` where every candidate of the type is a height.
fn nodata(raster: &Raster, sample: SampleType) -> Option<Option<f64>> {
    let has_holes = raster.samples.iter().any(f64::is_nan);
    if !has_holes && raster.nodata.is_none() {
        return Some(None);
    }
    let own = raster.nodata.filter(|value| value.is_nan() && sample.is_float() || sample.keeps(*value));
    let preferred: &[f64] = match sample {
        SampleType::I16 => &[-32768.0, 32767.0, -9999.0],
        SampleType::U16 => &[65535.0, 0.0],
        SampleType::I32 => &[-2_147_483_648.0, 2_147_483_647.0],
        SampleType::U32 => &[4_294_967_295.0, 0.0],
        _ => &[-9999.0, f64::NAN],
    };
    let is_free = |nodata: &f64| nodata.is_nan() || raster.samples.iter().all(|value| value != *nodata);
    match own.into_iter().chain(preferred.iter().copied()).find(is_free) {
        Some(nodata) => Some(Some(nodata)),
        None if !has_holes => Some(None),
        None => None,
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
