//! Writing computed values as a GeoTIFF in one pass: strips of whole rows, in the order in which they are computed.
//!
//! Values such as slopes have digits without meaning, which hardly pack: f32 are stored as they are, as GDAL does, so that
//! a file is written as fast as its values come. Codes pack to a fraction and are deflated, strip by strip on all threads.

use rayon::prelude::*;

use crate::tiff::write::{BYTES_LEVEL, TiffField, described, head_before, packed};
use crate::written::{WriteWindowsError, WrittenWindows};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_raster::content::WrittenContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Samples;
use sandtable_raster::read_ahead::read_ahead;
use sandtable_raster::sample_type::SampleType;
use sandtable_raster::stored::StoredSamples;
use sandtable_raster::windows::{RasterWindow, Windows};

/// Samples of a strip, about: enough that packing does not start anew all the time.
const STRIP: u32 = 1 << 16;

/// The tags that list where strips are and how long.
const STRIPS: (u16, u16) = (273, 279);

/// The value for no data of numbers that name none.
const NO_DATA: f64 = -9999.0;

/// Writes a raster whose samples are computed `rows` rows at a time; holds two such bands.
pub(super) fn write_computed(
    source: &mut (dyn Windows + Send),
    rows: u32,
    out: &mut dyn WrittenContent,
) -> Result<WrittenWindows, WriteWindowsError> {
    let header = source.metadata().without_samples();
    let (width, height) = source.size();
    // A classic TIFF has 4 GiB, of which the head takes little.
    if u64::from(width) * u64::from(height) > u64::from(u32::MAX / 4 - (1 << 20)) {
        let size = glam::U64Vec2::new(width.into(), height.into());
        return Err(DemErrorKind::TooLarge { size, most: &RASTER_SAMPLES }.into());
    }
    let sample = if header.data_type == "Byte" { SampleType::U8 } else { SampleType::F32 };
    let nodata = header.nodata.unwrap_or(NO_DATA);
    let strip_rows = (STRIP / width).clamp(1, height);
    let mut lengths: Vec<u32> = (0..height)
        .step_by(strip_rows as usize)
        .map(|row| strip_rows.min(height - row) * width * sample.bytes() as u32)
        .collect();
    let tags = || {
        let mut tags = described(&header, StoredSamples { sample, nodata: Some(nodata) });
        tags.push((259, TiffField::shorts(&[if sample == SampleType::U8 { 8 } else { 1 }])));
        tags.push((278, TiffField::longs(&[strip_rows])));
        tags
    };
    out.write_all(&head_before(tags(), STRIPS, &lengths))?;
    let (mut strips, mut outcome, mut valid) = (lengths.iter_mut(), Ok(()), 0);
    let band = strip_rows * (rows / strip_rows).max(1);
    let bands = RasterWindow::all((width, height)).bands(band.saturating_mul(width));
    read_ahead(source, bands, Windows::samples, |_, samples| {
        let stored = StoredBand::of(&samples, sample, nodata, (strip_rows * width) as usize);
        valid += stored.valid;
        for strip in stored.strips {
            if let Some(length) = strips.next() {
                *length = strip.len() as u32;
            }
            if outcome.is_ok() {
                outcome = out.write_all(&strip);
            }
        }
    })?;
    outcome?;
    if sample == SampleType::U8 {
        // How long packed strips are is known now.
        out.rewind()?;
        out.write_all(&head_before(tags(), STRIPS, &lengths))?;
    }
    Ok(WrittenWindows { stored: sample.gdal_name().to_ascii_lowercase(), valid, notes: Vec::new() })
}

/// Rows as they are stored.
struct StoredBand {
    strips: Vec<Vec<u8>>,
    valid: u64,
}

impl StoredBand {
    /// The strips of rows that are whole strips, but for the raster's last.
    fn of(samples: &Samples, sample: SampleType, nodata: f64, strip: usize) -> Self {
        let (strips, valid): (Vec<Vec<u8>>, Vec<u64>) = match samples {
            Samples::F32(samples) => samples.par_chunks(strip).map(|few| stored(few, sample, nodata)).unzip(),
            Samples::F64(samples) => {
                let narrow = |few: &[f64]| few.iter().map(|&value| value as f32).collect::<Vec<f32>>();
                samples.par_chunks(strip).map(|few| stored(&narrow(few), sample, nodata)).unzip()
            }
        };
        Self { strips, valid: valid.into_iter().sum() }
    }
}

/// A strip's bytes, and how many of its values are data.
fn stored(values: &[f32], sample: SampleType, nodata: f64) -> (Vec<u8>, u64) {
    let valid = values.iter().map(|value| u64::from(!value.is_nan())).sum();
    let bytes = if sample == SampleType::U8 {
        let codes: Vec<u8> =
            values.iter().map(|&value| if value.is_nan() { nodata as u8 } else { value as u8 }).collect();
        packed(&codes, BYTES_LEVEL)
    } else {
        let nodata = nodata as f32;
        let mut bytes = vec![0; values.len() * 4];
        for (out, &value) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(values) {
            *out = (if value.is_nan() { nodata } else { value }).to_le_bytes();
        }
        bytes
    };
    (bytes, valid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;
    use sandtable_raster::raster::Raster;
    use std::io::Cursor;

    /// A raster in memory whose values were computed.
    struct ComputedRaster(Raster);

    impl Windows for ComputedRaster {
        fn metadata(&self) -> &Raster {
            &self.0
        }

        fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
            self.0.samples(window)
        }

        fn computed_rows(&self) -> Option<u32> {
            Some(250)
        }
    }

    fn written(raster: Raster) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        let valid = raster.samples.valid().count() as u64;
        let mut source = ComputedRaster(raster);
        let written = write_computed(&mut source, 250, &mut out).expect("memory");
        assert_eq!(written.valid, valid);
        out.into_inner()
    }

    fn raster(data_type: &'static str, nodata: f64, value: impl Fn(u32) -> f32) -> Raster {
        let samples = (0..530 * 600).map(|at| if at % 977 == 5 { f32::NAN } else { value(at) }).collect();
        Raster { nodata: Some(nodata), data_type, ..Raster::new(530, Samples::F32(samples)) }
    }

    #[test]
    fn computed_numbers_and_codes_are_read_back_bit_for_bit() {
        let rasters = [
            raster("Float32", -9999.0, |at| (at % 9001) as f32 / 7.0),
            raster("Float32", -9999.0, |at| (at % 90) as f32),
            raster("Byte", 255.0, |at| (at / 5000 % 11) as f32),
        ];
        for raster in rasters {
            let (wanted, data_type) = (raster.samples.clone(), raster.data_type);
            let again = read("a.tif", &written(raster), &DemHints::default()).expect("a GeoTIFF");
            assert_eq!((again.width, again.height, again.data_type), (530, 600, data_type));
            assert_eq!(again.samples.iter().count(), wanted.iter().count());
            let pairs = again.samples.iter().zip(wanted.iter());
            assert!(pairs.into_iter().all(|(a, b)| a == b || a.is_nan() && b.is_nan()));
        }
    }

    #[test]
    fn the_bytes_do_not_depend_on_how_many_rows_are_computed_together() {
        let of = |rows: u32| {
            let mut out = Cursor::new(Vec::new());
            let mut source = ComputedRaster(raster("Byte", 255.0, |at| (at / 3000 % 11) as f32));
            write_computed(&mut source, rows, &mut out).expect("memory");
            out.into_inner()
        };
        assert!(of(1) == of(250) && of(1) == of(600));
    }
}
