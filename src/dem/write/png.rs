//! Gray PNG of 16 bits (W3C, 2003), meters by a scale and an offset that the user is told, with a world file beside it.
//!
//! Gray value 0 is no data, and said so in the picture (tRNS); heights take 1 to 65535. Whole meters that fit are kept
//! as they are; any others are spread over all values, and rounded to half a step.

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};

use crate::dem::raster::Raster;
use crate::dem::write::{Companion, WriteError, WrittenDem, projection_file};

/// Steps from the lowest height to the highest: the 65,534 between the gray values for heights, less one for an offset
/// on a multiple of the step.
const STEPS: f64 = 65533.0;

/// Writes a raster in meters.
///
/// # Errors
/// All samples are no data.
pub(crate) fn write(raster: &Raster) -> Result<WrittenDem, WriteError> {
    let valid = || raster.samples.iter().filter(|value| !value.is_nan());
    let (least, most) = valid().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
        (f64::min(least, value), f64::max(most, value))
    });
    if least > most {
        return Err(WriteError::Empty);
    }
    let whole = valid().all(|value| value.fract() == 0.0) && most - least <= STEPS;
    let scale = if whole { 1.0 } else { readable(((most - least) / STEPS).max(f64::MIN_POSITIVE)) };
    let offset = (least / scale).floor() * scale - scale;
    let gray = |value: f64| if value.is_nan() { 0 } else { ((value - offset) / scale).round() as u16 };
    let mut notes = vec![format!("read it with --height-scale {scale} --height-offset {offset}")];
    if !whole {
        notes.push(format!("heights are rounded to multiples of {scale} m"));
    }
    let companions = world_file(raster).into_iter().chain(projection_file(raster.crs.as_ref()));
    Ok(WrittenDem {
        bytes: picture(raster, gray),
        companions: companions.collect(),
        stored: "uint16".into(),
        notes,
    })
}

/// The least number of two digits that is no smaller: a scale that can be typed.
fn readable(scale: f64) -> f64 {
    let power = scale.log10().floor() as i32 - 1;
    let digits = (scale / 10f64.powi(power)).ceil();
    // Parsed, so that the number that is told is the number that is used.
    format!("{digits}e{power}").parse().unwrap_or(scale)
}

fn picture(raster: &Raster, gray: impl Fn(f64) -> u16) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut header = [raster.width.to_be_bytes(), raster.height.to_be_bytes()].concat();
    header.extend([16, 0, 0, 0, 0]);
    chunk(&mut bytes, b"IHDR", &header);
    chunk(&mut bytes, b"tRNS", &[0, 0]);
    chunk(&mut bytes, b"IDAT", &rows(raster, gray));
    chunk(&mut bytes, b"IEND", &[]);
    bytes
}

/// The packed rows, each less the one above it: filter 2.
fn rows(raster: &Raster, gray: impl Fn(f64) -> u16) -> Vec<u8> {
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
    let mut above = vec![0u8; raster.width as usize * 2];
    for row in 0..raster.height {
        let line: Vec<u8> =
            (0..raster.width).flat_map(|column| gray(raster.at(column, row)).to_be_bytes()).collect();
        let filtered: Vec<u8> =
            line.iter().zip(&above).map(|(byte, above)| byte.wrapping_sub(*above)).collect();
        packer
            .write_all(&[2])
            .and_then(|()| packer.write_all(&filtered))
            .expect("memory takes what is written");
        above = line;
    }
    packer.finish().expect("memory takes what is written")
}

fn chunk(bytes: &mut Vec<u8>, kind: &[u8; 4], content: &[u8]) {
    bytes.extend((content.len() as u32).to_be_bytes());
    let mut crc = Crc::new();
    for part in [&kind[..], content] {
        crc.update(part);
        bytes.extend(part);
    }
    bytes.extend(crc.sum().to_be_bytes());
}

/// The six numbers of a world file; nothing where nobody said where the raster lies.
fn world_file(raster: &Raster) -> Option<Companion> {
    let axes = raster.map_from_grid.matrix2;
    let first = raster.map_from_grid.transform_point2(glam::DVec2::splat(0.5));
    let numbers = [axes.x_axis.x, axes.x_axis.y, axes.y_axis.x, axes.y_axis.y, first.x, first.y];
    let text: String = numbers.iter().map(|number| format!("{number}\n")).collect();
    raster.georeferenced.then(|| Companion { extension: "pgw", bytes: text.into_bytes() })
}
