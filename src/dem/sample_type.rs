//! Types of stored samples.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleType {
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
pub(crate) enum NumberKind {
    Unsigned,
    Signed,
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

    pub fn bytes(self) -> usize {
        TYPES[self as usize].2
    }

    pub fn kind(self) -> NumberKind {
        TYPES[self as usize].1
    }

    pub fn is_float(self) -> bool {
        self.kind() == NumberKind::Float
    }

    /// Whether its values need 64-bit floats to stay exact.
    pub fn is_wide(self) -> bool {
        self.bytes() == 8 || (self.bytes() == 4 && !self.is_float())
    }

    pub fn gdal_name(self) -> &'static str {
        TYPES[self as usize].3
    }

    /// A no-data value as a sample can equal it; NaN, which equals nothing, where there is none.
    pub fn comparable(self, nodata: Option<f64>) -> f64 {
        match nodata {
            Some(value) if matches!(self, Self::F16 | Self::F32) => f64::from(value as f32),
            Some(value) => value,
            None => f64::NAN,
        }
    }

    pub fn range(self) -> (f64, f64) {
        let bits = self.bytes() as i32 * 8;
        match self.kind() {
            NumberKind::Unsigned => (0.0, 2f64.powi(bits) - 1.0),
            NumberKind::Signed => (-2f64.powi(bits - 1), 2f64.powi(bits - 1) - 1.0),
            NumberKind::Float if bits == 64 => (f64::MIN, f64::MAX),
            NumberKind::Float => (f32::MIN.into(), f32::MAX.into()),
        }
    }

    /// Whether `value` comes back from this type to the last bit.
    pub fn keeps(self, value: f64) -> bool {
        let (least, greatest) = self.range();
        let is_minus_zero = value == 0.0 && value.is_sign_negative();
        match self {
            Self::F64 => true,
            Self::F32 => f64::from(value as f32) == value,
            _ => (least..=greatest).contains(&value) && value.fract() == 0.0 && !is_minus_zero,
        }
    }

    /// Appends `value`, the least significant byte first.
    pub fn write(self, value: f64, out: &mut Vec<u8>) {
        match self {
            Self::U8 => out.push(value as u8),
            Self::I8 => out.extend((value as i8).to_le_bytes()),
            Self::U16 => out.extend((value as u16).to_le_bytes()),
            Self::I16 => out.extend((value as i16).to_le_bytes()),
            Self::U32 => out.extend((value as u32).to_le_bytes()),
            Self::I32 => out.extend((value as i32).to_le_bytes()),
            Self::U64 => out.extend((value as u64).to_le_bytes()),
            Self::I64 => out.extend((value as i64).to_le_bytes()),
            Self::F16 => out.extend(half::f16::from_f64(value).to_le_bytes()),
            Self::F32 => out.extend((value as f32).to_le_bytes()),
            Self::F64 => out.extend(value.to_le_bytes()),
        }
    }
}
