//! Samples stored as plain binary numbers: what `.bil`, `.flt`, ENVI and RAW files hold beside their headers.
//!
//! ```text
//! start ─►│ s s s … s │ other bands, padding │ s s s … s │ …
//!         └ sample_step                      └ row_step
//! ```

use crate::dem::error::{DemErrorKind, bytes_at, check_size};
use crate::dem::raster::Samples;

/// The kinds of number that samples are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Number {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    F32,
    F64,
}

impl Number {
    /// Bytes of one.
    pub fn bytes(self) -> u64 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
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
            Self::F32 => "Float32",
            Self::F64 => "Float64",
        }
    }
}

/// Which byte of a number comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    /// The least significant: Intel's.
    Little,
    /// The most significant: Motorola's, and the network's.
    Big,
}

/// Where the samples of one band stand in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleLayout {
    /// Samples per row.
    pub width: u64,
    /// Rows.
    pub height: u64,
    /// What a sample is.
    pub number: Number,
    /// Its byte order.
    pub order: ByteOrder,
    /// The byte at which the first sample starts.
    pub start: u64,
    /// Bytes from a sample to the next of its row.
    pub sample_step: u64,
    /// Bytes from a row to the next.
    pub row_step: u64,
}

impl SampleLayout {
    /// One band without gaps, from the byte `start` on.
    pub fn dense((width, height): (u64, u64), number: Number, order: ByteOrder, start: u64) -> Self {
        let sample_step = number.bytes();
        Self { width, height, number, order, start, sample_step, row_step: width.saturating_mul(sample_step) }
    }

    /// The samples, `nodata` and what is not finite as NaN, and the size in 32 bits.
    ///
    /// # Errors
    /// The file is too short for them, or they overlap; nothing is allocated then.
    pub fn read(
        &self,
        format: &'static str,
        bytes: &[u8],
        nodata: Option<f64>,
    ) -> Result<(u32, u32, Samples), DemErrorKind> {
        self.check(format, bytes.len())?;
        let nodata = match (nodata, self.number) {
            (Some(value), Number::F32) => f64::from(value as f32),
            (Some(value), _) => value,
            (None, _) => f64::NAN,
        };
        let samples = match self.number {
            Number::U8 => Samples::F32(self.narrow(bytes, nodata, |[byte]| f32::from(byte))),
            Number::I8 => Samples::F32(self.narrow(bytes, nodata, |[byte]| f32::from(byte as i8))),
            Number::U16 => Samples::F32(self.narrow(bytes, nodata, |b| f32::from(u16::from_le_bytes(b)))),
            Number::I16 => Samples::F32(self.narrow(bytes, nodata, |b| f32::from(i16::from_le_bytes(b)))),
            Number::F32 => Samples::F32(self.narrow(bytes, nodata, f32::from_le_bytes)),
            Number::U32 => Samples::F64(self.wide(bytes, nodata, |b| f64::from(u32::from_le_bytes(b)))),
            Number::I32 => Samples::F64(self.wide(bytes, nodata, |b| f64::from(i32::from_le_bytes(b)))),
            Number::F64 => Samples::F64(self.wide(bytes, nodata, f64::from_le_bytes)),
        };
        Ok((self.width as u32, self.height as u32, samples))
    }

    /// Rows may not overlap, so that no more samples are allocated than the file holds.
    fn check(&self, format: &'static str, file_bytes: usize) -> Result<(), DemErrorKind> {
        check_size((self.width, self.height), self.number.bytes(), (file_bytes, 1))?;
        let of_row = |samples: u64| samples.checked_mul(self.sample_step)?.checked_add(self.number.bytes());
        let row = of_row(self.width - 1);
        let end = row.and_then(|row| {
            (self.height - 1).checked_mul(self.row_step)?.checked_add(row)?.checked_add(self.start)
        });
        if self.sample_step < self.number.bytes() || row.is_none_or(|row| row > self.row_step) {
            let reason = format!(
                "rows of {} samples do not fit the {} bytes that the header gives each",
                self.width, self.row_step
            );
            return Err(DemErrorKind::broken(format, reason));
        }
        match end {
            Some(end) if end <= file_bytes as u64 => Ok(()),
            _ => {
                let reason = format!(
                    "{} x {} samples from byte {} on reach beyond its {file_bytes} bytes",
                    self.width, self.height, self.start
                );
                Err(DemErrorKind::broken(format, reason))
            }
        }
    }

    fn narrow<const N: usize>(&self, bytes: &[u8], nodata: f64, value: impl Fn([u8; N]) -> f32) -> Vec<f32> {
        let is_hole = |value: f32| !value.is_finite() || f64::from(value) == nodata;
        let keep = |value: f32| if is_hole(value) { f32::NAN } else { value };
        self.numbers(bytes).map(|raw| raw.map_or(f32::NAN, |raw| keep(value(raw)))).collect()
    }

    fn wide<const N: usize>(&self, bytes: &[u8], nodata: f64, value: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        let keep = |value: f64| if !value.is_finite() || value == nodata { f64::NAN } else { value };
        self.numbers(bytes).map(|raw| raw.map_or(f64::NAN, |raw| keep(value(raw)))).collect()
    }

    /// The bytes of every sample in order, the least significant first.
    fn numbers<const N: usize>(&self, bytes: &[u8]) -> impl Iterator<Item = Option<[u8; N]>> {
        let (start, row_step, sample_step) =
            (self.start as usize, self.row_step as usize, self.sample_step as usize);
        let (width, height, order) = (self.width as usize, self.height as usize, self.order);
        (0..height).flat_map(move |row| {
            (0..width).map(move |column| {
                let mut raw: [u8; N] = bytes_at(bytes, start + row * row_step + column * sample_step)?;
                if order == ByteOrder::Big {
                    raw.reverse();
                }
                Some(raw)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_read_across_gaps_in_either_byte_order() {
        let bytes = [9, 0, 1, 0xee, 0x80, 0, 0xee, 0xee, 0, 2, 0xee, 0, 3];
        let layout = SampleLayout {
            width: 2,
            height: 2,
            number: Number::I16,
            order: ByteOrder::Big,
            start: 1,
            sample_step: 3,
            row_step: 7,
        };
        let (.., samples) = layout.read("test", &bytes, Some(-32768.0)).expect("it fits");
        let Samples::F32(values) = samples else { panic!("16 bits are narrow") };
        assert!(values[0] == 1.0 && values[1].is_nan() && values[2..] == [2.0, 3.0]);
        assert!(layout.read("test", &bytes[..12], None).is_err());
    }

    #[test]
    fn no_data_of_32_bit_floats_is_met_in_32_bits() {
        let bytes: Vec<u8> = [-3.4e38f32, 0.1, f32::INFINITY].iter().flat_map(|v| v.to_le_bytes()).collect();
        let layout = SampleLayout::dense((3, 1), Number::F32, ByteOrder::Little, 0);
        let (.., samples) = layout.read("test", &bytes, Some(-3.4e38)).expect("it fits");
        assert!(samples.get(0).is_nan() && samples.get(1) == f64::from(0.1f32) && samples.get(2).is_nan());
    }

    #[test]
    fn rows_that_overlap_or_overflow_are_refused() {
        let dense = SampleLayout::dense((4, 4), Number::U8, ByteOrder::Little, 0);
        assert!(dense.read("test", &[0; 16], None).is_ok());
        for wrong in [
            SampleLayout { row_step: 3, ..dense },
            SampleLayout { sample_step: 0, ..dense },
            SampleLayout { start: u64::MAX, ..dense },
            SampleLayout { row_step: u64::MAX, ..dense },
            SampleLayout { sample_step: u64::MAX, row_step: u64::MAX, ..dense },
        ] {
            assert!(wrong.read("test", &[0; 16], None).is_err(), "{wrong:?}");
        }
    }
}
