//! Samples stored as plain binary numbers, in any byte order, by rows or by columns.
//!
//! ```text
//! start ─►│ s s s … s │ other bands, padding │ s s s … s │ …
//!         └ column_step                      └ row_step
//! ```

use std::ops::Range;

use sandtable_base::bytes::ByteOrder;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::work_limit::WorkLimit;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::nodata_span::NoDataSpan;
use sandtable_raster::raster::{Raster, SampleFloat, Samples};
use sandtable_raster::sample_type::SampleType;
use sandtable_raster::windows::RasterWindow;

/// Places of the samples of one band in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleLayout {
    pub width: u64,
    pub height: u64,
    pub sample: SampleType,
    pub order: ByteOrder,
    /// The first byte of the first sample.
    pub start: u64,
    /// Bytes from a sample to the next of its row.
    pub column_step: u64,
    /// Bytes from a row to the next.
    pub row_step: u64,
    pub first_row: FirstRow,
}

/// The size of a file, and of the rasters that are taken from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FileSize {
    pub bytes: usize,
    pub most_samples: &'static WorkLimit,
}

impl FileSize {
    /// The size of a file that is read completely.
    pub fn in_memory(bytes: &[u8]) -> Self {
        Self { bytes: bytes.len(), most_samples: &RASTER_SAMPLES }
    }

    /// The size without a header of this many bytes.
    pub fn after(self, header: usize) -> Self {
        Self { bytes: self.bytes.saturating_sub(header), ..self }
    }
}

/// The row that comes first in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FirstRow {
    North,
    South,
}

/// Which stored values are no data. Values that are not finite always are.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NoData {
    /// All that this value means ([`NoDataSpan`]).
    Value(Option<f64>),
    /// All values from this one on.
    From(f64),
}

impl SampleLayout {
    /// One band in rows without gaps, from the byte `start` on.
    pub fn dense((width, height): (u64, u64), sample: SampleType, order: ByteOrder, start: u64) -> Self {
        let column_step = sample.bytes() as u64;
        let row_step = width.saturating_mul(column_step);
        Self { width, height, sample, order, start, column_step, row_step, first_row: FirstRow::North }
    }

    /// This layout with the southernmost row first.
    pub fn south_up(self) -> Self {
        Self { first_row: FirstRow::South, ..self }
    }

    /// This layout in columns without gaps, each northward, instead of rows.
    pub fn by_columns(self) -> Self {
        let row_step = self.sample.bytes() as u64;
        let column_step = self.height.saturating_mul(row_step);
        Self { column_step, row_step, first_row: FirstRow::South, ..self }
    }

    /// This dense layout with a sample of each of `bands` bands in a pixel.
    pub fn by_pixel(self, bands: u64) -> Self {
        let (column_step, row_step) =
            (self.column_step.saturating_mul(bands), self.row_step.saturating_mul(bands));
        Self { column_step, row_step, ..self }
    }

    /// The raster of these samples, without a georeference.
    ///
    /// # Errors
    /// The file is too short for them, or they overlap; nothing is allocated then.
    pub fn read(&self, format: &'static str, bytes: &[u8], nodata: NoData) -> Result<Raster, DemErrorKind> {
        let raster = self.header(format, FileSize::in_memory(bytes))?;
        Ok(Raster { samples: self.samples(bytes, nodata), ..raster })
    }

    /// The raster without its samples, and without a georeference.
    ///
    /// # Errors
    /// A file of this size is too short for the samples, or they overlap or are too many.
    pub fn header(&self, format: &'static str, file: FileSize) -> Result<Raster, DemErrorKind> {
        self.check(format, file)?;
        let raster = Raster::without_place(self.width as u32, self.height as u32);
        Ok(Raster { data_type: self.sample.gdal_name(), ..raster })
    }

    /// The samples in bytes that hold all of them.
    pub fn samples(&self, bytes: &[u8], nodata: NoData) -> Samples {
        match self.sample {
            SampleType::U8 => self.values(bytes, nodata, |[byte]| f32::from(byte)),
            SampleType::I8 => self.values(bytes, nodata, |[byte]| f32::from(byte as i8)),
            SampleType::U16 => self.values(bytes, nodata, |raw| f32::from(u16::from_le_bytes(raw))),
            SampleType::I16 => self.values(bytes, nodata, |raw| f32::from(i16::from_le_bytes(raw))),
            SampleType::F16 => self.values(bytes, nodata, |raw| half::f16::from_le_bytes(raw).to_f32()),
            SampleType::F32 => self.values(bytes, nodata, f32::from_le_bytes),
            SampleType::U32 => self.values(bytes, nodata, |raw| f64::from(u32::from_le_bytes(raw))),
            SampleType::I32 => self.values(bytes, nodata, |raw| f64::from(i32::from_le_bytes(raw))),
            SampleType::U64 => self.values(bytes, nodata, |raw| u64::from_le_bytes(raw) as f64),
            SampleType::I64 => self.values(bytes, nodata, |raw| i64::from_le_bytes(raw) as f64),
            SampleType::F64 => self.values(bytes, nodata, f64::from_le_bytes),
        }
    }

    /// The lines of the file, rows or columns, whichever lie in one piece, that hold the samples of a window; and the layout
    /// of these samples where the lines follow each other without gaps.
    pub fn lines(&self, window: RasterWindow) -> (Vec<Range<u64>>, Self) {
        let RasterWindow { column, row, width, height } = window;
        let [column, row, width, height] = [column, row, width, height].map(u64::from);
        let row = if self.first_row == FirstRow::North { row } else { self.height - row - height };
        let first = self.start + row * self.row_step + column * self.column_step;
        let sample = self.sample.bytes() as u64;
        let line = |count: u64, step: u64| (count - 1) * step + sample;
        let part = Self { width, height, start: 0, ..*self };
        if self.row_step >= self.column_step {
            let length = line(width, self.column_step);
            let starts = (0..height).map(|row| first + row * self.row_step);
            return (starts.map(|at| at..at + length).collect(), Self { row_step: length, ..part });
        }
        let length = line(height, self.row_step);
        let starts = (0..width).map(|column| first + column * self.column_step);
        (starts.map(|at| at..at + length).collect(), Self { column_step: length, ..part })
    }

    /// Samples may not overlap, so that no more are allocated than the file holds.
    fn check(&self, format: &'static str, file: FileSize) -> Result<(), DemErrorKind> {
        let Self { width, height, column_step, row_step, start, .. } = *self;
        let (sample, file_bytes) = (self.sample.bytes() as u64, file.bytes);
        let claim = SizeClaim::new(width, height, sample);
        SizeClaim { most_samples: file.most_samples, ..claim }.check(file_bytes)?;
        let length = |count: u64, step: u64, last: u64| (count - 1).checked_mul(step)?.checked_add(last);
        let row = length(width, column_step, sample);
        let column = length(height, row_step, sample);
        let rows_are_apart = column_step >= sample && row.is_some_and(|row| row <= row_step);
        let columns_are_apart = row_step >= sample && column.is_some_and(|column| column <= column_step);
        let broken = |reason: String| Err(DemErrorKind::Broken { format, reason });
        if !rows_are_apart && !columns_are_apart {
            return broken(format!(
                "rows of {width} samples do not fit the {row_step} bytes that the header gives each"
            ));
        }
        let end = row.and_then(|row| length(height, row_step, row)?.checked_add(start));
        if end.is_some_and(|end| end <= file_bytes as u64) {
            return Ok(());
        }
        broken(format!("{width} x {height} samples from byte {start} on reach beyond its {file_bytes} bytes"))
    }

    /// The samples, row by row from the north. `value` takes the bytes of one, the least significant first.
    fn values<const N: usize, T: SampleFloat>(
        &self,
        bytes: &[u8],
        nodata: NoData,
        value: impl Fn([u8; N]) -> T,
    ) -> Samples {
        let (nodata, nodata_from) = match nodata {
            NoData::Value(nodata) => (self.sample.nodata_span(nodata), f64::INFINITY),
            NoData::From(nodata) => (NoDataSpan::NONE, nodata),
        };
        let (width, height) = (self.width as usize, self.height as usize);
        let mut values = Vec::with_capacity(width * height);
        for row in 0..height {
            let row = if self.first_row == FirstRow::North { row } else { height - 1 - row };
            let start = self.start as usize + row * self.row_step as usize;
            values.extend(bytes[start..].chunks(self.column_step as usize).take(width).map(|sample| {
                let mut raw = sample.first_chunk::<N>().map_or([0; N], |raw| *raw);
                if self.order == ByteOrder::Big {
                    raw.reverse();
                }
                let value = value(raw);
                let wide: f64 = value.into();
                let is_nodata = !wide.is_finite() || nodata.contains(wide) || wide >= nodata_from;
                if is_nodata { T::NODATA } else { value }
            }));
        }
        T::into_samples(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_read_across_gaps_in_either_byte_order() {
        let bytes = [9, 0, 1, 0xee, 0x80, 0, 0xee, 0xee, 0, 2, 0xee, 0, 3];
        let dense = SampleLayout::dense((2, 2), SampleType::I16, ByteOrder::Big, 1);
        let layout = SampleLayout { column_step: 3, row_step: 7, ..dense };
        let raster = layout.read("test", &bytes, NoData::Value(Some(-32768.0))).expect("it fits");
        let Samples::F32(values) = raster.samples else { panic!("16 bits are narrow") };
        assert!(values[0] == 1.0 && values[1].is_nan() && values[2..] == [2.0, 3.0]);
        assert!(layout.read("test", &bytes[..12], NoData::Value(None)).is_err());
    }

    #[test]
    fn columns_and_rows_from_the_south_become_rows_from_the_north() {
        let dense = SampleLayout::dense((2, 3), SampleType::U8, ByteOrder::Little, 0);
        let read = |layout: SampleLayout| layout.read("test", &[1, 2, 3, 4, 5, 6], NoData::From(6.0));
        let south_up = read(dense.south_up()).expect("it fits").samples;
        assert!(south_up.get(0) == 5.0 && south_up.get(1).is_nan() && south_up.get(5) == 2.0);
        let columns = read(dense.by_columns()).expect("it fits").samples;
        assert!(columns.get(0) == 3.0 && columns.get(1).is_nan() && columns.get(4) == 1.0);
    }

    #[test]
    fn no_data_of_32_bit_floats_is_met_in_32_bits() {
        let bytes: Vec<u8> = [-3.4e38f32, 0.1, f32::INFINITY].iter().flat_map(|v| v.to_le_bytes()).collect();
        let layout = SampleLayout::dense((3, 1), SampleType::F32, ByteOrder::Little, 0);
        let samples = layout.read("test", &bytes, NoData::Value(Some(-3.4e38))).expect("it fits").samples;
        assert!(samples.get(0).is_nan() && samples.get(1) == f64::from(0.1f32) && samples.get(2).is_nan());
    }

    #[test]
    fn rows_that_overlap_or_overflow_are_refused() {
        let dense = SampleLayout::dense((4, 4), SampleType::U8, ByteOrder::Little, 0);
        assert!(dense.read("test", &[0; 16], NoData::Value(None)).is_ok());
        for wrong in [
            SampleLayout { row_step: 3, ..dense },
            SampleLayout { column_step: 0, ..dense },
            SampleLayout { start: u64::MAX, ..dense },
            SampleLayout { row_step: u64::MAX, ..dense },
            SampleLayout { column_step: u64::MAX, row_step: u64::MAX, ..dense },
        ] {
            assert!(wrong.read("test", &[0; 16], NoData::Value(None)).is_err(), "{wrong:?}");
        }
    }
}
