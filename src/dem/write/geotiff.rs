//! GeoTIFF (TIFF 6.0; OGC 19-008r4): one band in deflated tiles, with what it lies in and on.
//!
//! ```text
//! header │ directory │ long values of tags │ tile 0 │ tile 1 │ …
//! ```
//!
//! The directory comes first, so that a reader has all it needs to know with the first bytes. Tiles are packed side by
//! side and laid down in their order: the same bytes for every number of threads. Floats go through the floating-point
//! predictor, integers through differences: both pack terrain a third smaller than plain.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;

use crate::dem::raster::Raster;
use crate::dem::write::WrittenDem;
use crate::dem::write::keys;
use crate::dem::write::values::{Stored, ValueType, stored};

/// Samples along a side of a tile: what GDAL writes, and readers of single heights are glad of.
const TILE: u32 = 256;

/// Writes a raster; every raster can be.
pub(crate) fn write(raster: &Raster) -> WrittenDem {
    // A unit of heights without a name is brought to meters.
    let named = unit_name(raster.meters_per_z).is_some();
    let metric = (!named).then(|| super::metric(raster));
    let raster = metric.as_ref().unwrap_or(raster);
    let stored = stored(raster);
    let across = raster.width.div_ceil(TILE);
    let tiles: Vec<Vec<u8>> = (0..across * raster.height.div_ceil(TILE))
        .into_par_iter()
        .map(|index| tile(raster, stored, (index % across) * TILE, (index / across) * TILE))
        .collect();
    let notes = if named { vec![] } else { vec!["heights are brought to meters".to_owned()] };
    let bytes = file(tags(raster, stored), &tiles);
    WrittenDem { bytes, companions: Vec::new(), stored: stored.value_type.name().into(), notes }
}

/// GDAL's name of a vertical unit.
fn unit_name(meters: f64) -> Option<&'static str> {
    match keys::length_code(meters)? {
        9001 => Some("m"),
        9002 => Some("ft"),
        9003 => Some("US survey foot"),
        _ => None,
    }
}

/// One packed tile; beyond the raster its last samples are repeated, which packs to almost nothing.
fn tile(raster: &Raster, Stored { value_type, nodata }: Stored, column: u32, row: u32) -> Vec<u8> {
    let hole = nodata.unwrap_or(f64::NAN);
    let size = value_type.bytes();
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
    let mut line = Vec::with_capacity(TILE as usize * size);
    for y in row..row + TILE {
        line.clear();
        for x in column..column + TILE {
            let value = raster.at(x.min(raster.width - 1), y.min(raster.height - 1));
            push(&mut line, value_type, if value.is_nan() { hole } else { value });
        }
        let predicted =
            if value_type.is_float() { float_bytes(&line, size) } else { differences(&line, size) };
        packer.write_all(&predicted).expect("memory takes what is written");
    }
    packer.finish().expect("memory takes what is written")
}

/// A value that the type keeps, little-endian.
fn push(line: &mut Vec<u8>, value_type: ValueType, value: f64) {
    match value_type {
        ValueType::I16 => line.extend((value as i16).to_le_bytes()),
        ValueType::U16 => line.extend((value as u16).to_le_bytes()),
        ValueType::I32 => line.extend((value as i32).to_le_bytes()),
        ValueType::U32 => line.extend((value as u32).to_le_bytes()),
        ValueType::F32 => line.extend((value as f32).to_le_bytes()),
        ValueType::F64 => line.extend(value.to_le_bytes()),
    }
}

/// Predictor 2: each value less the one before, in the type's own arithmetic.
fn differences(line: &[u8], size: usize) -> Vec<u8> {
    let mut out = line.to_vec();
    for at in (size..line.len()).step_by(size).rev() {
        let mut borrow = 0u16;
        for byte in 0..size {
            let difference =
                u16::from(line[at + byte]).wrapping_sub(u16::from(line[at - size + byte]) + borrow);
            out[at + byte] = difference as u8;
            borrow = u16::from(difference > 0xff);
        }
    }
    out
}

/// Predictor 3: bytes sorted by significance, highest first, each less the one before.
fn float_bytes(line: &[u8], size: usize) -> Vec<u8> {
    let count = line.len() / size;
    let sorted: Vec<u8> =
        (0..size).rev().flat_map(|byte| (0..count).map(move |at| line[at * size + byte])).collect();
    let before = std::iter::once(0).chain(sorted.iter().copied());
    sorted.iter().zip(before).map(|(byte, before)| byte.wrapping_sub(before)).collect()
}

/// What a tag holds.
enum TiffField {
    Shorts(Vec<u16>),
    Longs(Vec<u32>),
    Doubles(Vec<f64>),
    Text(String),
}

impl TiffField {
    /// TIFF's number of the type, how many values there are, and their bytes.
    fn encoded(&self) -> (u16, u32, Vec<u8>) {
        let (kind, count, bytes) = match self {
            Self::Shorts(values) => (3, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect()),
            Self::Longs(values) => (4, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect()),
            Self::Doubles(values) => {
                (12, values.len(), values.iter().flat_map(|v| v.to_le_bytes()).collect())
            }
            Self::Text(text) => (2, text.len() + 1, [text.as_bytes(), &[0]].concat()),
        };
        (kind, count as u32, bytes)
    }
}

/// All tags but those that list the tiles.
fn tags(raster: &Raster, stored: Stored) -> Vec<(u16, TiffField)> {
    let value_type = stored.value_type;
    let format = match value_type {
        ValueType::U16 | ValueType::U32 => 1,
        ValueType::I16 | ValueType::I32 => 2,
        ValueType::F32 | ValueType::F64 => 3,
    };
    let short = |value: u16| TiffField::Shorts(vec![value]);
    let mut tags = vec![
        (256, TiffField::Longs(vec![raster.width])),
        (257, TiffField::Longs(vec![raster.height])),
        (258, short(value_type.bytes() as u16 * 8)),
        (259, short(8)),
        (262, short(1)),
        (277, short(1)),
        (284, short(1)),
        (317, short(if value_type.is_float() { 3 } else { 2 })),
        (322, short(TILE as u16)),
        (323, short(TILE as u16)),
        (339, short(format)),
    ];
    tags.extend(place(raster));
    let keys = keys::of(raster);
    tags.push((34735, TiffField::Shorts(keys.directory)));
    if !keys.doubles.is_empty() {
        tags.push((34736, TiffField::Doubles(keys.doubles)));
    }
    if !keys.text.is_empty() {
        tags.push((34737, TiffField::Text(keys.text)));
    }
    if let Some(unit) = unit_name(raster.meters_per_z).filter(|unit| *unit != "m") {
        let xml = format!(
            "<GDALMetadata>\n  <Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{unit}</Item>\n</GDALMetadata>\n"
        );
        tags.push((42112, TiffField::Text(xml)));
    }
    if let Some(nodata) = stored.nodata {
        tags.push((42113, TiffField::Text(if nodata.is_nan() { "nan".into() } else { nodata.to_string() })));
    }
    tags
}

/// Where the raster lies: a tie point and a scale with north up, a matrix otherwise, nothing where nobody said.
fn place(raster: &Raster) -> Vec<(u16, TiffField)> {
    let [x, x_per_column, x_per_row, y, y_per_column, y_per_row] = raster.geotransform();
    if !raster.georeferenced {
        Vec::new()
    } else if raster.is_north_up() {
        vec![
            (33550, TiffField::Doubles(vec![x_per_column, -y_per_row, 0.0])),
            (33922, TiffField::Doubles(vec![0.0, 0.0, 0.0, x, y, 0.0])),
        ]
    } else {
        let rows = [[x_per_column, x_per_row, 0.0, x], [y_per_column, y_per_row, 0.0, y]];
        let matrix = [rows[0], rows[1], [0.0; 4], [0.0, 0.0, 0.0, 1.0]].concat();
        vec![(34264, TiffField::Doubles(matrix))]
    }
}

/// Header, directory, long values and tiles. At most 2²⁸ samples of eight bytes, they stay within the 4 GiB that a
/// classic TIFF can point into.
fn file(mut tags: Vec<(u16, TiffField)>, tiles: &[Vec<u8>]) -> Vec<u8> {
    let lengths: Vec<u32> = tiles.iter().map(|tile| tile.len() as u32).collect();
    tags.push((324, TiffField::Longs(vec![0; tiles.len()])));
    tags.push((325, TiffField::Longs(lengths.clone())));
    tags.sort_by_key(|(tag, _)| *tag);
    let mut tile_start = 8 + directory(&tags, 8).len() as u32;
    let starts = lengths.iter().map(|length| {
        let start = tile_start;
        tile_start += length;
        start
    });
    let starts = TiffField::Longs(starts.collect());
    if let Some((_, field)) = tags.iter_mut().find(|(tag, _)| *tag == 324) {
        *field = starts;
    }
    let mut bytes = b"II*\0\x08\0\0\0".to_vec();
    bytes.extend(directory(&tags, 8));
    for tile in tiles {
        bytes.extend(tile);
    }
    bytes
}

/// A directory that starts at `start`, and behind it the values that do not fit its entries.
fn directory(tags: &[(u16, TiffField)], start: usize) -> Vec<u8> {
    let mut entries = (tags.len() as u16).to_le_bytes().to_vec();
    let mut long = Vec::new();
    let long_start = start + 2 + tags.len() * 12 + 4;
    for (tag, field) in tags {
        let (kind, count, mut value) = field.encoded();
        if value.len() > 4 {
            let at = (long_start + long.len()) as u32;
            // Values start at even places.
            value.resize(value.len().next_multiple_of(2), 0);
            long.extend(value);
            value = at.to_le_bytes().to_vec();
        }
        value.resize(4, 0);
        entries.extend(tag.to_le_bytes());
        entries.extend(kind.to_le_bytes());
        entries.extend(count.to_le_bytes());
        entries.extend(value);
    }
    entries.extend([0; 4]);
    entries.extend(long);
    entries
}
