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
//! The index lists the records, since a file that was edited in place keeps old ones between them; an outdated index
//! is ignored ([`ShapefileReader::records`]). Measures (m) are not kept. Direction and containment decide which ring
//! is a hole in which ([`rings`](crate::rings)).
//!
//! Written by hand. `shapefile` 0.9 refuses two of eighteen real files for their outdated index, allocates 535 MB for a
//! file of 1000 bytes with a count changed, recognizes holes by direction only, and builds ten more crates.

mod dbf;

use glam::DVec3;

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::encoding::TextEncoding;
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::rings::{HoleRule, RingSorter, SortedRings};
use crate::shapefile::dbf::{DbfRow, DbfTable};
use crate::tally::RecordTally;
use sandtable_base::bytes::ByteCursor;
use sandtable_geom::crs::Crs;

const FORMAT: &str = "ESRI shapefile";
const HEADER_BYTES: usize = 100;
/// Smaller numbers mean "no data" (page 2 of the description, there of measures).
const MIN_ELEVATION: f64 = -1e38;

pub(super) struct ShapefileParts<'a> {
    /// `.shp`.
    pub shapes: &'a [u8],
    /// `.shx`.
    pub index: Option<Vec<u8>>,
    /// `.dbf`.
    pub table: Option<Vec<u8>>,
    /// `.prj`.
    pub crs: Option<Vec<u8>>,
    /// `.cpg`.
    pub encoding: Option<Vec<u8>>,
}

/// Returns whether `bytes` are a shapefile's shapes or index.
pub(super) fn is_shapefile(bytes: &[u8]) -> bool {
    bytes.starts_with(&9994u32.to_be_bytes())
}

/// Reads all features. Records without a shape, those marked as deleted and those that contradict themselves are left out
/// and counted.
///
/// # Errors
/// [`VectorError`]: records of which none is sound, a file cut short, no coordinate system.
pub(super) fn read(files: &ShapefileParts<'_>, hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let mut layer = LayerBuilder::new(crs_of(files, hints)?);
    let encoding = encoding_of(files, &mut layer);
    let table = files.table.as_deref().map(|bytes| DbfTable::open(bytes, encoding)).transpose()?;
    let mut reader = ShapefileReader { shapes: files.shapes, sorter: RingSorter::new(HoleRule::Direction) };
    let records = reader.records(files.index.as_deref(), &mut layer)?;
    if let Some(rows) = table.as_ref().map(DbfTable::row_count)
        && rows != records.len()
    {
        layer.fault(format!("{} shapes, but {rows} rows in the .dbf file", records.len()));
    }
    let [mut deleted, mut outside, mut reversed] = [const { RecordTally::new() }; 3];
    for (index, &offset) in records.iter().enumerate() {
        let row = table.as_ref().and_then(|table| table.row(index));
        if row.as_ref().is_some_and(DbfRow::is_deleted) {
            deleted.add(|| record(index));
            continue;
        }
        let Some(content) = reader.content(offset) else {
            outside.add(|| record(index));
            continue;
        };
        match reader.shape(content, index) {
            Ok(shape) => {
                reversed.add_many(usize::from(shape.has_reversed_rings), || record(index));
                let properties = row.map_or_else(Properties::new, |row| row.properties());
                layer.add_at(shape.parts, properties, || record(index));
            }
            Err(ShapeError::Record(error)) => layer.add_broken(record(index), error),
            Err(ShapeError::File(error)) => return Err(error),
        }
    }
    layer.note_omitted(&deleted, "feature marked as deleted", "features marked as deleted");
    if let Some(text) = outside.text("record", "records") {
        layer.fault(format!("the .shx file lists {text} past the end of the .shp file: left out"));
    }
    if let Some(text) = reversed.text("polygon", "polygons") {
        layer.note(format!("rings of {text} run the wrong way: one that lies in another is its hole"));
    }
    layer.finish()
}

fn crs_of(files: &ShapefileParts<'_>, hints: &VectorHints) -> Result<Crs, VectorError> {
    let definition = files.crs.as_deref().map(String::from_utf8_lossy);
    let crs = hints.crs_or(None, definition.as_deref())?;
    crs.ok_or(VectorError::NoCrs { format: FORMAT, reason: "has no .prj file beside it" })
}

/// Returns the encoding that the `.cpg` file names; `None` for that of the table's language driver.
fn encoding_of(files: &ShapefileParts<'_>, layer: &mut LayerBuilder) -> Option<TextEncoding> {
    let name = files.encoding.as_deref().map(|bytes| String::from_utf8_lossy(bytes).trim().to_owned());
    let name = name.filter(|name| !name.is_empty())?;
    let encoding = TextEncoding::from_name(&name);
    if encoding.is_none() {
        let name = shorten(&name);
        layer.fault(format!(
            "the .cpg file names the unknown encoding '{name}': letters beyond ASCII are wrong"
        ));
    }
    encoding.or(Some(TextEncoding::UTF_8))
}

/// The shape of a record.
struct RecordShape {
    parts: FeatureParts,
    has_reversed_rings: bool,
}

/// Why a shape cannot be read.
enum ShapeError {
    /// The record is broken; the others may be sound.
    Record(VectorError),
    /// The file exceeds a limit.
    File(VectorError),
}

struct ShapefileReader<'a> {
    shapes: &'a [u8],
    sorter: RingSorter,
}

impl<'a> ShapefileReader<'a> {
    /// Returns the byte at which each record starts: as the index lists them, unless that is outdated.
    ///
    /// An index is outdated where it does not point at records with successive numbers although the file consists of
    /// such. Reading by it would lose shapes; GDAL does.
    fn records(&self, index: Option<&[u8]>, layer: &mut LayerBuilder) -> Result<Vec<usize>, VectorError> {
        let Some(index) = index else { return self.successive_records() };
        let listed = listed_records(index)?;
        if !self.are_numbered(&listed)
            && let Ok(successive) = self.successive_records()
            && self.are_numbered(&successive)
        {
            layer.note("the .shx file is outdated: the records of the .shp file are read in sequence");
            return Ok(successive);
        }
        Ok(listed)
    }

    fn successive_records(&self) -> Result<Vec<usize>, VectorError> {
        let mut offset = HEADER_BYTES;
        let mut records = Vec::new();
        while offset + 8 <= self.shapes.len() {
            let content = self.content(offset).ok_or_else(|| {
                let reason = format!("it reaches from byte {offset} past the end of the file");
                VectorError::broken(FORMAT, record(records.len()), reason)
            })?;
            records.push(offset);
            offset += 8 + content.len();
        }
        Ok(records)
    }

    /// Whether records start at all of `offsets`, numbered from 1.
    fn are_numbered(&self, offsets: &[usize]) -> bool {
        offsets.iter().enumerate().all(|(index, &offset)| {
            let number = self.shapes.get(offset..).and_then(|bytes| bytes.first_chunk());
            self.content(offset).is_some()
                && number.is_some_and(|&number| u32::from_be_bytes(number) as usize == index + 1)
        })
    }

    /// Returns the content of the record at `offset`, by the length in its own header: indices may state others.
    fn content(&self, offset: usize) -> Option<&'a [u8]> {
        let mut cursor = ByteCursor::new(self.shapes.get(offset..)?);
        cursor.take(4)?;
        let words = cursor.array().map(u32::from_be_bytes)?;
        cursor.take(2 * words as usize)
    }

    /// Reads the shape that is the content of the record `index`.
    fn shape(&mut self, content: &[u8], index: usize) -> Result<RecordShape, ShapeError> {
        let broken = |reason: String| ShapeError::Record(VectorError::broken(FORMAT, record(index), reason));
        let short = || broken("its counts of parts and points do not fit its length".into());
        let mut cursor = ByteCursor::new(content);
        let kind = cursor.u32_le().ok_or_else(short)?;
        let mut reader = ShapeCursor { cursor, has_z: matches!(kind, 11 | 13 | 15 | 18) };
        let mut parts = FeatureParts::default();
        let mut has_reversed_rings = false;
        match kind {
            0 => {}
            1 | 11 | 21 => parts.add_points(vec![reader.point().ok_or_else(short)?]),
            8 | 18 | 28 => parts.add_points(reader.multipoint().ok_or_else(short)?),
            3 | 13 | 23 => {
                let lines = reader.lines().ok_or_else(short)?;
                lines.into_iter().for_each(|line| parts.add_line(line));
            }
            5 | 15 | 25 => {
                let sorted = self.sorter.polygons(reader.lines().ok_or_else(short)?);
                let SortedRings { polygons, are_reversed } = sorted
                    .map_err(|error| ShapeError::File(VectorError::broken(FORMAT, record(index), error)))?;
                polygons.into_iter().for_each(|rings| parts.add_polygon(rings));
                has_reversed_rings = are_reversed;
            }
            31 => {
                return Err(ShapeError::Record(VectorError::Unsupported {
                    format: FORMAT,
                    content: "surfaces (multipatch)".into(),
                    remedy: "convert it to polygons, for example with: ogr2ogr -nlt MULTIPOLYGON",
                }));
            }
            other => return Err(broken(format!("it has the unknown shape type {other}"))),
        }
        Ok(RecordShape { parts, has_reversed_rings })
    }
}

/// Returns the byte at which each record starts by the index.
fn listed_records(index: &[u8]) -> Result<Vec<usize>, VectorError> {
    let entries = index.get(HEADER_BYTES..).filter(|_| is_shapefile(index)).ok_or_else(|| {
        VectorError::broken(FORMAT, "the start of its .shx file", "it does not start as an index does")
    })?;
    let (entries, _) = entries.as_chunks::<8>();
    Ok(entries.iter().map(|&[a, b, c, d, ..]| 2 * u32::from_be_bytes([a, b, c, d]) as usize).collect())
}

fn record(index: usize) -> String {
    format!("record {}", index + 1)
}

/// Reads the vertices of one shape. Its functions return `None` where the record is too short.
struct ShapeCursor<'a> {
    cursor: ByteCursor<'a>,
    has_z: bool,
}

impl ShapeCursor<'_> {
    fn point(&mut self) -> Option<DVec3> {
        let (x, y) = (self.cursor.f64_le()?, self.cursor.f64_le()?);
        let z = if self.has_z { Some(elevation(self.cursor.f64_le()?)) } else { None };
        Some(position(x, y, z))
    }

    fn multipoint(&mut self) -> Option<Vertices> {
        self.cursor.take(4 * 8)?;
        let count = self.cursor.u32_le()? as usize;
        self.vertices(count)
    }

    /// Reads the vertices of each part of a line or an area.
    fn lines(&mut self) -> Option<Vec<Vertices>> {
        self.cursor.take(4 * 8)?;
        let (parts, count) = (self.cursor.u32_le()? as usize, self.cursor.u32_le()? as usize);
        let (starts, _) = self.cursor.take(parts.checked_mul(4)?)?.as_chunks::<4>();
        let vertices = self.vertices(count)?;
        let starts = starts.iter().map(|&start| u32::from_le_bytes(start) as usize);
        let bounds: Vec<usize> = starts.chain([count]).collect();
        bounds.windows(2).map(|pair| vertices.get(pair[0]..pair[1]).map(<[_]>::to_vec)).collect()
    }

    fn vertices(&mut self, count: usize) -> Option<Vertices> {
        let (numbers, _) = self.cursor.take(count.checked_mul(16)?)?.as_chunks::<8>();
        let mut elevations: &[[u8; 8]] = &[];
        if self.has_z {
            self.cursor.take(2 * 8)?;
            (elevations, _) = self.cursor.take(count.checked_mul(8)?)?.as_chunks::<8>();
        }
        let vertex = |(index, pair): (usize, &[[u8; 8]])| {
            let z = elevations.get(index).map(|&bytes| elevation(f64::from_le_bytes(bytes)));
            position(f64::from_le_bytes(pair[0]), f64::from_le_bytes(pair[1]), z)
        };
        Some(numbers.chunks_exact(2).enumerate().map(vertex).collect())
    }
}

fn elevation(z: f64) -> f64 {
    if z > MIN_ELEVATION { z } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::LazyLock;

    use crate::feature::Geometry;
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

    fn files(shapes: &[u8]) -> ShapefileParts<'_> {
        ShapefileParts { shapes, index: None, table: None, crs: None, encoding: None }
    }

    fn local() -> VectorHints<'static> {
        static LOCAL: LazyLock<Crs> = LazyLock::new(Crs::local);
        VectorHints { crs: Some(&LOCAL), ..VectorHints::default() }
    }

    fn read_plain(shapes: &[u8]) -> Result<VectorLayer, VectorError> {
        read(&files(shapes), &local())
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
        assert_eq!(layer.notes, ["left out: 1 feature without a usable geometry (record 3)"]);
    }

    #[test]
    fn the_index_lists_the_records_unless_it_is_outdated() {
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
            let files = ShapefileParts { index: index(places), ..files(shapes) };
            let layer = super::read(&files, &local()).expect("sound");
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
    fn a_broken_record_is_left_out_and_the_others_are_read() {
        let line = || content(3, &[&[[1.0, 2.0], [3.0, 4.0]]], &[]);
        let mut forged = content(5, &[&SQUARE], &[]);
        forged[36..40].copy_from_slice(&u32::MAX.to_le_bytes());
        let surface = 31u32.to_le_bytes().to_vec();
        let layer = read_plain(&file(&[line(), forged, surface, line()])).expect("two are sound");
        assert_eq!(layer.features.len(), 2);
        let [fault] = &layer.faults[..] else { panic!("one sentence: {:?}", layer.faults) };
        for part in ["2 records", "record 2: its counts of parts", "record 3: surfaces (multipatch)"] {
            assert!(fault.contains(part), "{fault}");
        }
    }

    #[test]
    fn rings_that_run_the_wrong_way_are_a_polygon_with_a_hole() {
        let turned = |ring: &[[f64; 2]]| -> Vec<[f64; 2]> { ring.iter().rev().copied().collect() };
        let (outer, hole) = (turned(&SQUARE), turned(&HOLE));
        let layer = read_plain(&file(&[content(5, &[&outer, &hole], &[])])).expect("sound");
        let [polygon] = layer.features[0].polygons() else { panic!("one polygon") };
        assert_eq!((polygon.exterior.len(), polygon.holes.len()), (4, 1));
        let expected =
            "rings of 1 polygon (record 1) run the wrong way: one that lies in another is its hole";
        assert_eq!(layer.notes, [expected]);
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
    fn a_file_without_a_system_is_refused_unless_one_is_stated() {
        let shapes = file(&[]);
        let error = read(&files(&shapes), &VectorHints::default()).expect_err("no system").to_string();
        assert!(error.contains("no .prj") && error.contains("'crs'"), "{error}");
        let crs = Some(b"EPSG:32633".to_vec());
        assert_eq!(
            read(&ShapefileParts { crs, ..files(&shapes) }, &VectorHints::default())
                .expect("stated")
                .crs
                .epsg(),
            Some(32633)
        );
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
