//! ESRI shapefiles: shapes (`.shp`), their index (`.shx`), attributes (`.dbf`) and system (`.prj`, `.cpg`).
//!
//! ESRI Shapefile Technical Description, July 1998. A header of 100 bytes, then records of a big-endian number and
//! length (in words of two bytes) and a little-endian shape:
//!
//! ```text
//! point       type  x y  [z]  [m]
//! multipoint  type  box  points        xy×points  [range z×points]  [range m×points]
//! line, area  type  box  parts points  first×parts  xy×points  [range z×points]  [range m×points]
//! ```
//!
//! Where the index is there, it says which records there are and where: a file that was edited in place keeps
//! the old ones between. An index of another version of the file is not followed ([`indexed_or_whole`]). Measures (m) are not kept. Which ring is a hole in which is told by direction and
//! containment ([`rings`]).
//!
//! Read by hand: the counts of a forged record must be held against its length before anything is allocated,
//! which takes reading it anyway.

mod dbf;

use glam::DVec3;

use crate::geom::crs::Crs;
use crate::vector::codepage::Encoding;
use crate::vector::collect::{Collector, FeatureParts, Properties, position};
use crate::vector::cursor::ByteCursor;
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;
use crate::vector::rings::{self, HoleRule};
use crate::vector::shapefile::dbf::DbfTable;

const FORMAT: &str = "ESRI shapefile";
const HEADER_BYTES: usize = 100;
/// Whatever is smaller is no elevation but "no data" (page 2 of the description, there said of measures).
const NO_DATA: f64 = -1e38;

/// The files that make one shapefile.
pub(super) struct Files<'a> {
    /// `.shp`.
    pub shapes: &'a [u8],
    /// `.shx`.
    pub index: Option<Vec<u8>>,
    /// `.dbf`.
    pub table: Option<Vec<u8>>,
    /// `.prj`.
    pub system: Option<Vec<u8>>,
    /// `.cpg`.
    pub encoding: Option<Vec<u8>>,
}

/// Whether `bytes` are a shapefile's shapes.
pub(super) fn is_shapefile(bytes: &[u8]) -> bool {
    bytes.starts_with(&9994u32.to_be_bytes())
}

/// All features of a shapefile.
///
/// Records without a shape and those marked deleted are left out and counted.
///
/// # Errors
/// [`VectorError`]: a record that contradicts itself, no system where none is `stated`, surfaces (multipatch).
pub(super) fn read(files: &Files<'_>, stated: Option<&Crs>) -> Result<VectorLayer, VectorError> {
    let crs = match (stated, &files.system) {
        (Some(crs), _) => crs.clone(),
        (None, Some(text)) => Crs::parse(&String::from_utf8_lossy(text)).map_err(VectorError::Crs)?,
        (None, None) => {
            return Err(VectorError::NoCrs { format: FORMAT, wanting: "has no .prj file beside it" });
        }
    };
    let mut collector = Collector::new(crs);
    let encoding = encoding(files, &mut collector);
    let table = files.table.as_deref().map(|bytes| DbfTable::open(bytes, encoding)).transpose()?;
    let places = match &files.index {
        Some(index) => indexed_or_whole(files.shapes, index, &mut collector)?,
        None => one_after_another(files.shapes)?,
    };
    let rows = table.as_ref().map_or(0, DbfTable::rows);
    if table.is_some() && rows != places.len() {
        collector.note(format!("{} shapes, but {rows} rows in the .dbf file", places.len()));
    }
    let (mut steps, mut deleted, mut outside) = (rings::MOST_STEPS, 0, 0);
    for (index, &place) in places.iter().enumerate() {
        let row = table.as_ref().and_then(|table| table.row(index));
        if row.as_ref().is_some_and(dbf::DbfRow::is_deleted) {
            deleted += 1;
            continue;
        }
        let shape = match content(files.shapes, place) {
            Some(content) => shape(content, index, &mut steps)?,
            None => {
                outside += 1;
                FeatureParts::default()
            }
        };
        collector.add(shape, row.map_or_else(Properties::new, |row| row.properties()))?;
    }
    collector.left_out(deleted, "features marked as deleted");
    if outside > 0 {
        collector.note(format!("{outside} records lie past the end of the file, says its .shx file"));
    }
    Ok(collector.finish())
}

/// How texts are encoded: what the `.cpg` file says, else `None` for the table's own language driver.
fn encoding(files: &Files<'_>, collector: &mut Collector) -> Option<Encoding> {
    let named = files.encoding.as_deref().map(|bytes| String::from_utf8_lossy(bytes).trim().to_owned());
    let named = named.filter(|name| !name.is_empty())?;
    let encoding = Encoding::named(&named);
    if encoding.is_none() {
        let named: String = named.chars().take(40).collect();
        collector.note(format!(
            "texts are in the encoding '{named}', which is not read: letters beyond ASCII are wrong"
        ));
    }
    encoding.or(Some(Encoding::Utf8))
}

/// Where each record starts, by the index, unless it belongs to another version of the file.
///
/// An index that points where no record with its number starts, beside shapes that are whole and numbered through, is
/// out of date: followed, it would lose shapes. GDAL follows it.
fn indexed_or_whole(
    shapes: &[u8],
    index: &[u8],
    collector: &mut Collector,
) -> Result<Vec<usize>, VectorError> {
    let is_record = |(index, &at): (usize, &usize)| {
        content(shapes, at).is_some() && number(shapes, at) == Some(index + 1)
    };
    let indexed = indexed(index)?;
    if !indexed.iter().enumerate().all(is_record)
        && let Ok(whole) = one_after_another(shapes)
        && whole.iter().enumerate().all(is_record)
    {
        collector
            .note("its .shx file is of another version of it: records are read one after another".into());
        return Ok(whole);
    }
    Ok(indexed)
}

/// The number of the record at `at`, from 1.
fn number(shapes: &[u8], at: usize) -> Option<usize> {
    let bytes = *shapes.get(at..)?.first_chunk::<4>()?;
    Some(u32::from_be_bytes(bytes) as usize)
}

/// Where each record starts, by the index.
fn indexed(index: &[u8]) -> Result<Vec<usize>, VectorError> {
    let entries = index.get(HEADER_BYTES..).filter(|_| is_shapefile(index));
    let entries = entries
        .ok_or_else(|| VectorError::broken(FORMAT, "the start of its .shx file", "no index is there"))?;
    let (entries, _) = entries.as_chunks::<8>();
    Ok(entries.iter().map(|&[a, b, c, d, ..]| 2 * u32::from_be_bytes([a, b, c, d]) as usize).collect())
}

/// Where each record starts, by the lengths of those before it.
fn one_after_another(shapes: &[u8]) -> Result<Vec<usize>, VectorError> {
    let mut at = HEADER_BYTES;
    let mut places = Vec::new();
    while at + 8 <= shapes.len() {
        let content = content(shapes, at).ok_or_else(|| out_of_file(places.len(), at))?;
        places.push(at);
        at += 8 + content.len();
    }
    Ok(places)
}

/// The content of the record at `at`, by the length in its own header: some writers' indices state others.
fn content(shapes: &[u8], at: usize) -> Option<&[u8]> {
    let mut record = ByteCursor::new(shapes.get(at..)?);
    record.take(4)?;
    let words = record.array().map(u32::from_be_bytes)?;
    record.take(2 * words as usize)
}

fn out_of_file(index: usize, at: usize) -> VectorError {
    broken(index, format!("it reaches from byte {at} past the end of the file"))
}

fn broken(index: usize, reason: impl Into<String>) -> VectorError {
    VectorError::broken(FORMAT, format!("record {}", index + 1), reason)
}

/// The shape that a record's content is.
fn shape(content: &[u8], index: usize, steps: &mut u64) -> Result<FeatureParts, VectorError> {
    let short = || broken(index, "its counts of parts and points do not fit its length");
    let mut cursor = ByteCursor::new(content);
    let kind = cursor.u32_le().ok_or_else(short)?;
    let has_z = matches!(kind, 11 | 13 | 15 | 18);
    let mut parts = FeatureParts::default();
    match kind {
        0 => {}
        1 | 11 | 21 => parts.point(point(cursor, has_z).ok_or_else(short)?),
        8 | 18 | 28 => {
            let points = multipoint(cursor, has_z).ok_or_else(short)?;
            points.into_iter().for_each(|at| parts.point(at));
        }
        3 | 13 | 23 => {
            let lines = lines(cursor, has_z).ok_or_else(short)?;
            lines.into_iter().for_each(|line| parts.line(line));
        }
        5 | 15 | 25 => {
            let rings = lines(cursor, has_z).ok_or_else(short)?;
            let polygons = rings::polygons(rings, HoleRule::Direction, steps)
                .map_err(|_| broken(index, "its rings are too many, too much inside each other"))?;
            polygons.into_iter().for_each(|rings| parts.polygon(rings));
        }
        31 => {
            return Err(VectorError::Unsupported {
                format: FORMAT,
                what: "surfaces (multipatch)".into(),
                remedy: "convert it to polygons, for example with: ogr2ogr -nlt MULTIPOLYGON".into(),
            });
        }
        other => return Err(broken(index, format!("{other} is no type of shape"))),
    }
    Ok(parts)
}

fn point(mut cursor: ByteCursor<'_>, has_z: bool) -> Option<DVec3> {
    let (x, y) = (cursor.f64_le()?, cursor.f64_le()?);
    Some(position(x, y, if has_z { Some(elevation(cursor.f64_le()?)) } else { None }))
}

fn multipoint(mut cursor: ByteCursor<'_>, has_z: bool) -> Option<Vec<DVec3>> {
    cursor.take(4 * 8)?;
    let count = cursor.u32_le()? as usize;
    points(&mut cursor, count, has_z)
}

/// The vertices of each part of a line or an area.
fn lines(mut cursor: ByteCursor<'_>, has_z: bool) -> Option<Vec<Vec<DVec3>>> {
    cursor.take(4 * 8)?;
    let (parts, count) = (cursor.u32_le()? as usize, cursor.u32_le()? as usize);
    let (starts, _) = cursor.take(parts.checked_mul(4)?)?.as_chunks::<4>();
    let mut starts: Vec<usize> = starts.iter().map(|&start| u32::from_le_bytes(start) as usize).collect();
    let points = points(&mut cursor, count, has_z)?;
    starts.push(count);
    starts.windows(2).map(|pair| points.get(pair[0]..pair[1]).map(<[_]>::to_vec)).collect()
}

fn points(cursor: &mut ByteCursor<'_>, count: usize, has_z: bool) -> Option<Vec<DVec3>> {
    let number = |bytes: &[u8; 8]| f64::from_le_bytes(*bytes);
    let (places, _) = cursor.take(count.checked_mul(16)?)?.as_chunks::<8>();
    let elevations = if has_z {
        cursor.take(2 * 8)?;
        cursor.take(count.checked_mul(8)?)?.as_chunks::<8>().0
    } else {
        &[]
    };
    let place = |(index, pair): (usize, &[[u8; 8]])| {
        let elevation = elevations.get(index).map(|bytes| elevation(number(bytes)));
        position(number(&pair[0]), number(&pair[1]), elevation)
    };
    Some(places.chunks_exact(2).enumerate().map(place).collect())
}

fn elevation(z: f64) -> f64 {
    if z > NO_DATA { z } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::feature::Geometry;
    use glam::DVec2;

    /// A file of records with this content.
    fn file(contents: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = 9994u32.to_be_bytes().to_vec();
        bytes.resize(HEADER_BYTES, 0);
        for (index, content) in contents.iter().enumerate() {
            bytes.extend((index as u32 + 1).to_be_bytes());
            bytes.extend((content.len() as u32 / 2).to_be_bytes());
            bytes.extend(content);
        }
        bytes
    }

    fn content(kind: u32, parts: &[&[[f64; 2]]], elevations: &[f64]) -> Vec<u8> {
        let count: usize = parts.iter().map(|part| part.len()).sum();
        let mut bytes = kind.to_le_bytes().to_vec();
        bytes.extend([0; 32]);
        bytes.extend((parts.len() as u32).to_le_bytes());
        bytes.extend((count as u32).to_le_bytes());
        let mut first = 0u32;
        for part in parts {
            bytes.extend(first.to_le_bytes());
            first += part.len() as u32;
        }
        let numbers = parts.iter().flat_map(|part| part.as_flattened());
        bytes.extend(numbers.flat_map(|number| number.to_le_bytes()));
        if !elevations.is_empty() {
            bytes.extend([0; 16]);
            bytes.extend(elevations.iter().flat_map(|number| number.to_le_bytes()));
        }
        bytes
    }

    fn files(shapes: &[u8]) -> Files<'_> {
        Files { shapes, index: None, table: None, system: None, encoding: None }
    }

    fn read_plain(shapes: &[u8]) -> Result<VectorLayer, VectorError> {
        read(&files(shapes), Some(&Crs::local()))
    }

    const SQUARE: [[f64; 2]; 5] = [[0.0, 0.0], [0.0, 9.0], [9.0, 9.0], [9.0, 0.0], [0.0, 0.0]];
    const HOLE: [[f64; 2]; 4] = [[1.0, 1.0], [2.0, 1.0], [1.0, 2.0], [1.0, 1.0]];

    #[test]
    fn lines_areas_with_holes_and_elevations_are_read() {
        let line = content(13, &[&[[1.0, 2.0], [3.0, 4.0]]], &[7.0, f64::MIN]);
        let area = content(5, &[&HOLE, &SQUARE], &[]);
        let shapes = file(&[line, area, vec![0; 4]]);
        let layer = read_plain(&shapes).expect("sound");
        assert_eq!(layer.features.len(), 2);
        let [line, area] = &layer.features[..] else { panic!("two features") };
        assert_eq!(line.geometry, Geometry::Lines(vec![vec![DVec2::new(1.0, 2.0), DVec2::new(3.0, 4.0)]]));
        let elevations = line.elevations.as_ref().expect("one is known");
        assert!(elevations[0] == 7.0 && elevations[1].is_nan());
        let [polygon] = area.polygons() else { panic!("one polygon") };
        assert_eq!((polygon.exterior.len(), polygon.holes.len()), (4, 1));
        assert_eq!(layer.notes, ["left out: 1 features without a usable geometry"]);
    }

    #[test]
    fn the_index_decides_which_records_there_are_unless_it_points_astray() {
        let line = |x: f64| content(3, &[&[[x, 2.0], [3.0, 4.0]]], &[]);
        let index = |places: &[usize]| {
            let mut index = 9994u32.to_be_bytes().to_vec();
            index.resize(HEADER_BYTES, 0);
            for &place in places {
                index.extend((place as u32 / 2).to_be_bytes());
                index.extend([0; 4]);
            }
            Some(index)
        };
        let read = |shapes: &[u8], places: &[usize]| {
            let files = Files { index: index(places), ..files(shapes) };
            let layer = super::read(&files, Some(&Crs::local())).expect("sound");
            let starts = layer.features.iter().map(|feature| feature.lines()[0][0].x);
            (starts.collect::<Vec<_>>(), layer.notes.len())
        };
        let second = HEADER_BYTES + 8 + line(1.0).len();
        let mut shapes = file(&[line(1.0), line(5.0)]);
        assert_eq!(read(&shapes, &[HEADER_BYTES, second + 4]), (vec![1.0, 5.0], 1), "astray");
        // The second record is the new version of the first.
        shapes[second + 3] = 1;
        assert_eq!(read(&shapes, &[second]), (vec![5.0], 0));
    }

    #[test]
    fn counts_that_do_not_fit_are_refused_before_anything_is_allocated() {
        for at in [36, 40] {
            let mut forged = content(5, &[&SQUARE], &[]);
            forged[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
            let error = read_plain(&file(&[forged])).expect_err("forged").to_string();
            assert!(error.contains("record 1") && error.contains("do not fit"), "{error}");
        }
        let error = read_plain(&file(&[31u32.to_le_bytes().to_vec()])).expect_err("surfaces").to_string();
        assert!(error.contains("multipatch"), "{error}");
    }

    #[test]
    fn without_a_system_it_is_refused_unless_one_is_stated() {
        let shapes = file(&[]);
        let error = read(&files(&shapes), None).expect_err("no system").to_string();
        assert!(error.contains("no .prj") && error.contains("'crs'"), "{error}");
        let system = Some(b"EPSG:32633".to_vec());
        assert_eq!(read(&Files { system, ..files(&shapes) }, None).expect("stated").crs.epsg(), Some(32633));
    }

    #[test]
    fn a_file_cut_anywhere_or_with_a_byte_turned_is_read_or_refused() {
        let shapes = file(&[content(15, &[&SQUARE, &HOLE], &[1.0; 9]), content(3, &[&HOLE], &[])]);
        for end in 0..shapes.len() {
            let _ = read_plain(&shapes[..end]);
            let mut turned = shapes.clone();
            turned[end] ^= 0xff;
            let _ = read_plain(&turned);
        }
    }
}
