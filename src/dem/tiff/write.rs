//! Writing GeoTIFF (TIFF 6.0; OGC 19-008r4): one band in deflated tiles, with its georeference.
//!
//! ```text
//! header │ directory │ long values of tags │ tile 0 │ tile 1 │ …
//! ```
//!
//! The directory comes first, so that a reader has all it needs to know with the first bytes. Tiles are packed in
//! parallel and written in their order: the same bytes for every number of threads. Floats go through the floating-point
//! predictor, integers through differences: both pack terrain a third smaller than plain. (The `tiff` crate's encoder
//! writes no tiles and no floating-point predictor.)

use std::borrow::Cow;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;

use crate::dem::raster::Raster;
use crate::dem::sample_type::NumberKind;
use crate::dem::stored::StoredSamples;
use crate::dem::tiff::gdal_metadata::GDAL_METADATA;
use crate::dem::tiff::write_geokeys::GeoKeyTags;
use crate::dem::units::name_of_length;
use crate::dem::write::{WriteError, WrittenDem};

/// Samples along a side of a tile, as GDAL writes them.
const TILE: u32 = 256;

/// Writes a raster; every raster can be.
pub(crate) fn write(raster: &Raster, _stem: &str) -> Result<WrittenDem, WriteError> {
    let is_named = name_of_length(raster.meters_per_z).is_some();
    let raster = if is_named { Cow::Borrowed(raster) } else { raster.in_meters() };
    let stored = StoredSamples::of(&raster);
    let across = raster.width.div_ceil(TILE);
    let tiles: Vec<Vec<u8>> = (0..across * raster.height.div_ceil(TILE))
        .into_par_iter()
        .map(|index| tile(&raster, stored, (index % across) * TILE, (index / across) * TILE))
        .collect();
    let notes = if is_named { vec![] } else { vec!["heights are converted to meters".to_owned()] };
    Ok(WrittenDem {
        notes,
        ..WrittenDem::new(file(tags(&raster, stored), &tiles), stored.sample.gdal_name())
    })
}

/// One packed tile; beyond the raster its last samples are repeated, which packs to almost nothing.
fn tile(raster: &Raster, StoredSamples { sample, nodata }: StoredSamples, column: u32, row: u32) -> Vec<u8> {
    let nodata = nodata.unwrap_or(f64::NAN);
    let size = sample.bytes();
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
    let mut line = Vec::with_capacity(TILE as usize * size);
    for y in row..row + TILE {
        line.clear();
        for x in column..column + TILE {
            let value = raster.at(x.min(raster.width - 1), y.min(raster.height - 1));
            sample.write(if value.is_nan() { nodata } else { value }, &mut line);
        }
        let predicted = if sample.is_float() { float_bytes(&line, size) } else { differences(&line, size) };
        packer.write_all(&predicted).expect("memory takes what is written");
    }
    packer.finish().expect("memory takes what is written")
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

enum TiffField {
    Shorts(Vec<u16>),
    Longs(Vec<u32>),
    Doubles(Vec<f64>),
    Text(String),
}

impl TiffField {
    /// TIFF's number of the type, and the bytes of one value.
    fn kind(&self) -> (u16, usize) {
        match self {
            Self::Text(_) => (2, 1),
            Self::Shorts(_) => (3, 2),
            Self::Longs(_) => (4, 4),
            Self::Doubles(_) => (12, 8),
        }
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Text(text) => [text.as_bytes(), &[0]].concat(),
            Self::Shorts(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Longs(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Doubles(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        }
    }
}

/// All tags but those that list the tiles.
fn tags(raster: &Raster, stored: StoredSamples) -> Vec<(u16, TiffField)> {
    let sample = stored.sample;
    let format = match sample.kind() {
        NumberKind::Unsigned => 1,
        NumberKind::Signed => 2,
        NumberKind::Float => 3,
    };
    let short = |value: u16| TiffField::Shorts(vec![value]);
    let mut tags = vec![
        (256, TiffField::Longs(vec![raster.width])),
        (257, TiffField::Longs(vec![raster.height])),
        (258, short(sample.bytes() as u16 * 8)),
        (259, short(8)),
        (262, short(1)),
        (277, short(1)),
        (284, short(1)),
        (317, short(if sample.is_float() { 3 } else { 2 })),
        (322, short(TILE as u16)),
        (323, short(TILE as u16)),
        (339, short(format)),
    ];
    tags.extend(place(raster));
    let keys = GeoKeyTags::new(raster);
    tags.push((34735, TiffField::Shorts(keys.directory)));
    if !keys.doubles.is_empty() {
        tags.push((34736, TiffField::Doubles(keys.doubles)));
    }
    if !keys.text.is_empty() {
        tags.push((34737, TiffField::Text(keys.text)));
    }
    if let Some(unit) = name_of_length(raster.meters_per_z).filter(|unit| *unit != "m") {
        let xml = format!(
            "<GDALMetadata>\n  <Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{unit}</Item>\n</GDALMetadata>\n"
        );
        tags.push((GDAL_METADATA, TiffField::Text(xml)));
    }
    if let Some(nodata) = stored.nodata {
        tags.push((42113, TiffField::Text(if nodata.is_nan() { "nan".into() } else { nodata.to_string() })));
    }
    tags
}

/// The georeference: a tie point and a scale with north up, a matrix otherwise, nothing where there is none.
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
    if let Some((_, TiffField::Longs(starts))) = tags.iter_mut().find(|(tag, _)| *tag == 324) {
        for (start, length) in starts.iter_mut().zip(lengths) {
            *start = tile_start;
            tile_start += length;
        }
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
        let ((kind, size), mut value) = (field.kind(), field.bytes());
        let count = (value.len() / size) as u32;
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
