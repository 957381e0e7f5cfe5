//! Which type keeps a raster's heights, and what stands for no data in it.
//!
//! A type keeps them where every bit comes back: integers are chosen where all heights are integers of their range (and
//! none is minus zero, which they do not have), floats otherwise. The reader gives integers of 16 bits and 32-bit floats
//! in 32 bits and the others in 64, so the choice depends on what the raster has: the raster that is read again is
//! the same kind.

use crate::dem::raster::{Raster, Samples};

/// What a file holds for each sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ValueType {
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl ValueType {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::I16 => "int16",
            Self::U16 => "uint16",
            Self::I32 => "int32",
            Self::U32 => "uint32",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }

    /// Bytes of one value.
    pub fn bytes(self) -> usize {
        match self {
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Whether it holds fractions.
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The least and the most of an integer type.
    fn range(self) -> (f64, f64) {
        match self {
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U16 => (0.0, u16::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U32 => (0.0, u32::MAX.into()),
            Self::F32 => (f32::MIN.into(), f32::MAX.into()),
            Self::F64 => (f64::MIN, f64::MAX),
        }
    }

    /// Whether `value` comes back from it.
    fn keeps(self, value: f64) -> bool {
        match self {
            Self::F64 => true,
            Self::F32 => f64::from(value as f32) == value,
            _ => {
                let (least, most) = self.range();
                (least..=most).contains(&value) && value.fract() == 0.0 && !is_minus_zero(value)
            }
        }
    }

    /// What may stand for no data, in the order of preference; the raster's own comes before.
    fn holes(self) -> &'static [f64] {
        match self {
            Self::I16 => &[-32768.0, 32767.0, -9999.0],
            Self::U16 => &[65535.0, 0.0],
            Self::I32 => &[-2_147_483_648.0, 2_147_483_647.0],
            Self::U32 => &[4_294_967_295.0, 0.0],
            Self::F32 | Self::F64 => &[-9999.0, f64::NAN],
        }
    }
}

fn is_minus_zero(value: f64) -> bool {
    value == 0.0 && value.is_sign_negative()
}

/// A type, and the value for no data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stored {
    /// The type.
    pub value_type: ValueType,
    /// What stands for no data; `None` where there are no holes and the raster names no value.
    pub nodata: Option<f64>,
}

/// How the samples of `raster` are stored without a loss.
pub(crate) fn stored(raster: &Raster) -> Stored {
    let candidates: &[ValueType] = match raster.samples {
        Samples::F32(_) => &[ValueType::I16, ValueType::U16, ValueType::F32],
        Samples::F64(_) => &[ValueType::I32, ValueType::U32, ValueType::F64],
    };
    let kept = |value_type: &ValueType| {
        value_type.is_float() || raster.samples.iter().all(|value| value.is_nan() || value_type.keeps(value))
    };
    let found = candidates.iter().copied().filter(kept).find_map(|value_type| {
        let nodata = nodata(raster, value_type)?;
        Some(Stored { value_type, nodata })
    });
    // Floats have NaN for their holes, which no height is.
    let float = if matches!(raster.samples, Samples::F32(_)) { ValueType::F32 } else { ValueType::F64 };
    found.unwrap_or(Stored { value_type: float, nodata: Some(f64::NAN) })
}

/// What stands for no data; the outer `None` where every value of the type that could is a height.
fn nodata(raster: &Raster, value_type: ValueType) -> Option<Option<f64>> {
    let has_holes = raster.samples.iter().any(f64::is_nan);
    if !has_holes && raster.nodata.is_none() {
        return Some(None);
    }
    let own =
        raster.nodata.filter(|value| value.is_nan() && value_type.is_float() || value_type.keeps(*value));
    let mut candidates = own.into_iter().chain(value_type.holes().iter().copied());
    let is_free = |hole: &f64| hole.is_nan() || raster.samples.iter().all(|value| value != *hole);
    match candidates.find(is_free) {
        Some(hole) => Some(Some(hole)),
        None if !has_holes => Some(None),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::raster::tests::small;

    fn of(samples: Samples) -> (ValueType, Option<f64>) {
        let raster = Raster { samples, ..small(2, 1, vec![0.0; 2]) };
        let Stored { value_type, nodata } = stored(&raster);
        (value_type, nodata)
    }

    #[test]
    fn integers_are_kept_as_integers_and_all_else_as_floats() {
        assert_eq!(of(Samples::F32(vec![-5.0, 32767.0])), (ValueType::I16, None));
        assert_eq!(of(Samples::F32(vec![5.0, 60000.0])), (ValueType::U16, None));
        assert_eq!(of(Samples::F32(vec![-5.0, 60000.0])), (ValueType::F32, None));
        assert_eq!(of(Samples::F32(vec![0.5, 1.0])), (ValueType::F32, None));
        assert_eq!(of(Samples::F32(vec![-0.0, 1.0])), (ValueType::F32, None));
        assert_eq!(of(Samples::F64(vec![-5.0, 1e9])), (ValueType::I32, None));
        assert_eq!(of(Samples::F64(vec![0.1, 1e9])), (ValueType::F64, None));
    }

    #[test]
    fn what_stands_for_no_data_is_never_a_height() {
        assert_eq!(of(Samples::F32(vec![f32::NAN, 7.0])), (ValueType::I16, Some(-32768.0)));
        assert_eq!(of(Samples::F32(vec![f32::NAN, -32768.0])), (ValueType::I16, Some(32767.0)));
        let (value_type, nodata) = of(Samples::F32(vec![f32::NAN, -9999.5]));
        assert_eq!((value_type, nodata), (ValueType::F32, Some(-9999.0)));
        let raster = Raster { nodata: Some(7.0), ..small(2, 1, vec![7.0, 8.0]) };
        assert_eq!(stored(&raster).nodata, Some(-32768.0));
        let raster = Raster { nodata: Some(0.0), ..small(2, 1, vec![7.0, f32::NAN]) };
        assert_eq!(stored(&raster), Stored { value_type: ValueType::I16, nodata: Some(0.0) });
    }
}
