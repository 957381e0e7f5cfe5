//! Types of stored samples.

use crate::nodata_span::NoDataSpan;

/// The type of a stored sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are those of the types of numbers")]
pub enum SampleType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
}

/// The representation of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberKind {
    /// An integer from 0.
    Unsigned,
    /// An integer in two's complement.
    Signed,
    /// A floating-point number of IEEE 754.
    Float,
}

/// Every type in the order of the enum: its kind, its bytes, and its name in GDAL.
const TYPES: [(SampleType, NumberKind, usize, &str); 11] = [
    (SampleType::U8, NumberKind::Unsigned, 1, "Byte"),
    (SampleType::I8, NumberKind::Signed, 1, "Int8"),
    (SampleType::U16, NumberKind::Unsigned, 2, "UInt16"),
    (SampleType::I16, NumberKind::Signed, 2, "Int16"),
    (SampleType::U32, NumberKind::Unsigned, 4, "UInt32"),
    (SampleType::I32, NumberKind::Signed, 4, "Int32"),
    (SampleType::U64, NumberKind::Unsigned, 8, "UInt64"),
    (SampleType::I64, NumberKind::Signed, 8, "Int64"),
    (SampleType::F16, NumberKind::Float, 2, "Float32"),
    (SampleType::F32, NumberKind::Float, 4, "Float32"),
    (SampleType::F64, NumberKind::Float, 8, "Float64"),
];

impl SampleType {
    /// The type of a kind with a number of bits; `None` where there is none.
    pub fn new(kind: NumberKind, bits: u64) -> Option<Self> {
        let mut known = TYPES.iter().filter(|known| known.1 == kind);
        known.find(|known| known.2 as u64 * 8 == bits).map(|known| known.0)
    }

    /// The bytes of a sample.
    #[inline]
    pub fn bytes(self) -> usize {
        TYPES[self as usize].2
    }

    /// The representation of a sample.
    #[inline]
    pub fn kind(self) -> NumberKind {
        TYPES[self as usize].1
    }

    /// Whether samples are floats.
    #[inline]
    pub fn is_float(self) -> bool {
        self.kind() == NumberKind::Float
    }

    /// Whether its values need 64-bit floats to stay exact.
    #[inline]
    pub fn is_wide(self) -> bool {
        self.bytes() == 8 || (self.bytes() == 4 && !self.is_float())
    }

    /// The name in GDAL: `Byte`, `Int16`, `Float32` and the like.
    pub fn gdal_name(self) -> &'static str {
        TYPES[self as usize].3
    }

    /// The samples that a stated no-data value means; none where none is stated.
    pub fn nodata_span(self, stated: Option<f64>) -> NoDataSpan {
        let Some(stated) = stated else { return NoDataSpan::NONE };
        let span = NoDataSpan::around(stated);
        match self {
            // Of 16 bits the nearest number may be some meters off.
            Self::F16 => {
                let nearest = half::f16::from_f64(stated);
                if nearest.is_finite() { span.with(nearest.to_f64()) } else { span }
            }
            _ => span,
        }
    }

    /// The least and the greatest value; of 64 bits, as the nearest float.
    #[inline]
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::U8 => (0.0, u8::MAX.into()),
            Self::I8 => (i8::MIN.into(), i8::MAX.into()),
            Self::U16 => (0.0, u16::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U32 => (0.0, u32::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U64 => (0.0, u64::MAX as f64),
            Self::I64 => (i64::MIN as f64, i64::MAX as f64),
            Self::F16 | Self::F32 => (f32::MIN.into(), f32::MAX.into()),
            Self::F64 => (f64::MIN, f64::MAX),
        }
    }

    /// Whether `value` comes back from this type to the last bit.
    #[inline]
    pub fn keeps(self, value: f64) -> bool {
        let (least, greatest) = self.range();
        // Of equal bits, so that minus zero is not kept.
        let comes_back = |stored: f64| stored.to_bits() == value.to_bits();
        match self {
            Self::F64 => true,
            Self::F32 => f64::from(value as f32) == value,
            Self::U64 => (least..=greatest).contains(&value) && comes_back(value as u64 as f64),
            _ => (least..=greatest).contains(&value) && comes_back(value as i64 as f64),
        }
    }

    /// Whether every value comes back, or is NaN.
    pub fn keeps_all<T: Copy + Into<f64>>(self, values: &[T]) -> bool {
        /// Sums with it lose the bits behind the point of numbers below 2⁵¹.
        const WHOLE: f64 = 6_755_399_441_055_744.0;
        /// Values that are looked at together: a loop that may end early is not vectorized.
        const TOGETHER: usize = 1024;
        if self.is_float() || self.bytes() == 8 {
            return values.iter().all(|&value| value.into().is_nan() || self.keeps(value.into()));
        }
        let (least, greatest) = self.range();
        let keeps = |value: f64| {
            // Of equal bits, so that minus zero is not kept.
            let is_whole = ((value + WHOLE) - WHOLE).to_bits() == value.to_bits();
            (value >= least) & (value <= greatest) & is_whole | value.is_nan()
        };
        let all = |values: &[T]| values.iter().fold(true, |all, &value| all & keeps(value.into()));
        values.chunks(TOGETHER).all(all)
    }

    /// Appends values, the least significant byte of each first.
    pub fn write(self, values: &[f64], out: &mut Vec<u8>) {
        match self {
            Self::U8 => append(values, out, |value| (value as u8).to_le_bytes()),
            Self::I8 => append(values, out, |value| (value as i8).to_le_bytes()),
            Self::U16 => append(values, out, |value| (value as u16).to_le_bytes()),
            Self::I16 => append(values, out, |value| (value as i16).to_le_bytes()),
            Self::U32 => append(values, out, |value| (value as u32).to_le_bytes()),
            Self::I32 => append(values, out, |value| (value as i32).to_le_bytes()),
            Self::U64 => append(values, out, |value| (value as u64).to_le_bytes()),
            Self::I64 => append(values, out, |value| (value as i64).to_le_bytes()),
            Self::F16 => append(values, out, |value| half::f16::from_f64(value).to_le_bytes()),
            Self::F32 => append(values, out, |value| (value as f32).to_le_bytes()),
            Self::F64 => append(values, out, f64::to_le_bytes),
        }
    }
}

/// Appends the bytes of each value.
fn append<const N: usize>(values: &[f64], out: &mut Vec<u8>, bytes: impl Fn(f64) -> [u8; N]) {
    let start = out.len();
    out.resize(start + values.len() * N, 0);
    for (place, &value) in out[start..].chunks_exact_mut(N).zip(values) {
        place.copy_from_slice(&bytes(value));
    }
}
