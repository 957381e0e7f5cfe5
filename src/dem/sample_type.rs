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

/// What the bits of a number mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberKind {
    Unsigned,
    Signed,
    Float,
}

impl SampleType {
    /// The type of a kind with so many bits; `None` where there is none.
    pub fn new(kind: NumberKind, bits: u64) -> Option<Self> {
        Some(match (kind, bits) {
            (NumberKind::Unsigned, 8) => Self::U8,
            (NumberKind::Signed, 8) => Self::I8,
            (NumberKind::Unsigned, 16) => Self::U16,
            (NumberKind::Signed, 16) => Self::I16,
            (NumberKind::Float, 16) => Self::F16,
            (NumberKind::Unsigned, 32) => Self::U32,
            (NumberKind::Signed, 32) => Self::I32,
            (NumberKind::Float, 32) => Self::F32,
            (NumberKind::Unsigned, 64) => Self::U64,
            (NumberKind::Signed, 64) => Self::I64,
            (NumberKind::Float, 64) => Self::F64,
            _ => return None,
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    pub fn kind(self) -> NumberKind {
        match self {
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => NumberKind::Unsigned,
            Self::I8 | Self::I16 | Self::I32 | Self::I64 => NumberKind::Signed,
            Self::F16 | Self::F32 | Self::F64 => NumberKind::Float,
        }
    }

    pub fn is_float(self) -> bool {
        self.kind() == NumberKind::Float
    }

    /// Whether its values need 64-bit floats to stay exact.
    pub fn is_wide(self) -> bool {
        self.bytes() == 8 || (self.bytes() == 4 && !self.is_float())
    }

    /// Its name, as GDAL names its types.
    pub fn gdal_name(self) -> &'static str {
        match self {
            Self::U8 => "Byte",
            Self::I8 => "Int8",
            Self::U16 => "UInt16",
            Self::I16 => "Int16",
            Self::U32 => "UInt32",
            Self::I32 => "Int32",
            Self::U64 => "UInt64",
            Self::I64 => "Int64",
            Self::F16 | Self::F32 => "Float32",
            Self::F64 => "Float64",
        }
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
