//! DTED, levels 0, 1 and 2 (`.dt0`, `.dt1`, `.dt2`): MIL-PRF-89020B, *Digital Terrain Elevation Data*, 2000.
//!
//! ```text
//!    0  UHL1  user header label      80 bytes   origin, intervals, numbers of columns and rows
//!   80  DSI   data set identification 648       datums
//!  728  ACC   accuracy               2700
//! 3428  one record a column, from the west, each from the south:
//!       0xAA, block count u24, longitude count u16, latitude count u16, heights, checksum u32
//! ```
//!
//! A tape's `VOL1` and `HDR1` labels of 80 bytes may precede. Heights are big-endian sign and magnitude, −32767 for no
//! data; some makers wrote two's complement, which shows in depths below −16000 m. Columns may be missing: the
//! longitude count of a record names its column. Checksums are ignored, as in GDAL by default: many files in use have
//! wrong ones over right heights.

use glam::DVec2;

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition, any_size};
use crate::formats::dted_write::write;
use sandtable_base::bytes::ByteFields;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "DTED",
    extensions: &["dt0", "dt1", "dt2"],
    shared_extensions: &[],
    recognition: Recognition::Content { matches: |bytes| label_at(bytes).is_some(), start: "UHL1" },
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: Some(FormatWriter { extensions: &["dt0", "dt1", "dt2"], write }),
    windows_writer: None,
};

pub(super) const VOID: i16 = -32767;

/// Bytes of each label before the records.
pub(super) const LABELS: [usize; 3] = [80, 648, 2700];

/// Bytes of a record besides its heights: eight before and four after.
const AROUND: usize = 12;

/// The first byte of every record.
pub(super) const SENTINEL: u8 = 0xaa;

/// No depth in sign and magnitude is greater; beyond it, the height is in two's complement.
const DEEPEST: i16 = -16_000;

/// Where the user header label starts: after the tape's labels, of which there are at most two.
fn label_at(bytes: &[u8]) -> Option<usize> {
    let at = |index: usize| bytes.get(80 * index..);
    let is_tape =
        |index: usize| at(index).is_some_and(|rest| rest.starts_with(b"VOL") || rest.starts_with(b"HDR"));
    let before = (0..2).take_while(|&index| is_tape(index)).count();
    at(before)?.starts_with(b"UHL1").then_some(80 * before)
}

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let labels = file.bytes.get(label_at(file.bytes).unwrap_or(0)..).unwrap_or_default();
    let data = labels.get(LABELS.iter().sum()..);
    let data = data.ok_or_else(|| FORMAT.broken("it ends before its first column"))?;
    let header = DtedHeader::read(labels)?;
    let identification = &labels[LABELS[0]..];
    let samples = samples(data, &header)?;
    let cell = header.cell_deg;
    let north = header.south_west.y + cell.y * f64::from(header.rows - 1);
    // The standard has WGS 72 and WGS 84; a blank is WGS 84, as in GDAL.
    let code = if text(identification, 144, 5) == "WGS72" { 4322 } else { 4326 };
    Ok(Raster {
        driver: "DTED",
        states_z_unit: true,
        data_type: "Int16",
        crs: file.crs_or(|| Ok(Some(Crs::from_epsg(code)?)))?,
        nodata: Some(f64::from(VOID)),
        vertical_datum: vertical_datum(&text(identification, 141, 3)),
        ..Raster::new(header.columns, samples)
            .placed(north_up_nodes(DVec2::new(header.south_west.x, north), cell))
    })
}

/// The heights by rows from the north.
fn samples(data: &[u8], header: &DtedHeader) -> Result<Samples, DemErrorKind> {
    let (columns, rows) = (header.columns as usize, header.rows as usize);
    let record = AROUND + 2 * rows;
    let records = data.len() / record;
    // Missing columns take no bytes, but a cell without a single record is cut off.
    SizeClaim::new(header.columns.into(), header.rows.into(), 0).check(data.len())?;
    if records == 0 || records > columns || !data.len().is_multiple_of(record) && records < columns {
        let bytes = data.len();
        return Err(
            FORMAT.broken(format!("{bytes} bytes are not those of up to {columns} columns of {record}"))
        );
    }
    let mut values = vec![f32::NAN; columns * rows];
    let are_counted = counts_are_columns(data.chunks_exact(record), columns);
    for (index, record) in data.chunks_exact(record).take(columns).enumerate() {
        if record[0] != SENTINEL {
            let (column, found) = (index + 1, record[0]);
            return Err(
                FORMAT.broken(format!("column {column} starts with {found:#04x}, not with {SENTINEL:#04x}"))
            );
        }
        let column = if are_counted { longitude_count(record) } else { index };
        for (up, pair) in record[8..8 + 2 * rows].chunks_exact(2).enumerate() {
            values[(rows - 1 - up) * columns + column] = height([pair[0], pair[1]]);
        }
    }
    Ok(Samples::F32(values))
}

/// Whether the records' longitude counts name columns, each at most once. A few writers leave them 0.
fn counts_are_columns<'a>(mut records: impl Iterator<Item = &'a [u8]>, columns: usize) -> bool {
    let mut seen = vec![false; columns];
    let mut is_new = |column: usize| seen.get_mut(column).is_some_and(|seen| !std::mem::replace(seen, true));
    records.all(|record| is_new(longitude_count(record)))
}

fn longitude_count(record: &[u8]) -> usize {
    ByteFields::big_endian(record).u16(4).unwrap_or_default().into()
}

fn height(pair: [u8; 2]) -> f32 {
    let word = u16::from_be_bytes(pair);
    let magnitude = (word & 0x7fff) as i16;
    let signed = if word & 0x8000 == 0 { magnitude } else { -magnitude };
    match signed {
        VOID => f32::NAN,
        signed if signed < DEEPEST => f32::from(i16::from_be_bytes(pair)),
        signed => f32::from(signed),
    }
}

struct DtedHeader {
    south_west: DVec2,
    cell_deg: DVec2,
    columns: u32,
    rows: u32,
}

impl DtedHeader {
    fn read(label: &[u8]) -> Result<Self, DemErrorKind> {
        let whole = |at: usize, what: &str| -> Result<u32, DemErrorKind> {
            let digits = text(label, at, 4);
            let wrong =
                |_| FORMAT.broken(format!("{what} at byte {at} of its header is '{digits}', not a number"));
            digits.trim().parse().map_err(wrong)
        };
        let columns = whole(47, "the number of columns")?;
        let rows = whole(51, "the number of rows")?;
        if columns == 0 || rows == 0 {
            return Err(FORMAT.broken(format!("it has {columns} columns and {rows} rows")));
        }
        // Tenths of seconds.
        let steps = [whole(20, "the longitude interval")?, whole(24, "the latitude interval")?];
        let cell_deg = DVec2::from(steps.map(f64::from)) / 36_000.0;
        if cell_deg.min_element() <= 0.0 {
            return Err(unplaced("its header states no interval between heights".into()));
        }
        let south_west = DVec2::new(angle(label, 4, b"EW", 180.0)?, angle(label, 12, b"NS", 90.0)?);
        Ok(Self { south_west, cell_deg, columns, rows })
    }
}

fn unplaced(reason: String) -> DemErrorKind {
    DemErrorKind::Georeference { reason, remedy: "fetch the cell again" }
}

/// `DDDMMSSH`, the hemisphere one of `letters`, in degrees.
fn angle(label: &[u8], at: usize, letters: &[u8; 2], most: f64) -> Result<f64, DemErrorKind> {
    let field = text(label, at, 8);
    let wrong = || unplaced(format!("its origin at byte {at} is '{field}', not as 0800000W"));
    let letter = field.bytes().last().filter(|letter| letters.contains(letter)).ok_or_else(wrong)?;
    // Some write a latitude with two digits for degrees and a blank at the end.
    let digits: String = field.chars().filter(char::is_ascii_digit).collect();
    if digits.len() < 6 || digits.len() > 7 {
        return Err(wrong());
    }
    let number: u32 = digits.parse().map_err(|_| wrong())?;
    let degrees =
        f64::from(number / 10_000) + f64::from(number / 100 % 100) / 60.0 + f64::from(number % 100) / 3600.0;
    let signed = if letter == letters[0] { degrees } else { -degrees };
    if degrees <= most { Ok(signed) } else { Err(wrong()) }
}

fn vertical_datum(name: &str) -> Option<String> {
    match name.trim() {
        "" => None,
        "E96" => Some("EGM96 geoid".into()),
        "E08" => Some("EGM2008 geoid".into()),
        "MSL" => Some("mean sea level".into()),
        other => Some(other.into()),
    }
}

/// Text of a fixed length, NULs as blanks.
fn text(bytes: &[u8], at: usize, length: usize) -> String {
    let field = bytes.get(at..at + length).unwrap_or_default();
    String::from_utf8_lossy(field).replace('\0', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

    /// A cell of two columns and three rows at 7° W, 43° N, ten minutes apart.
    fn cell(records: &[(u16, [i32; 3])]) -> Vec<u8> {
        let mut bytes =
            format!("{:<80}", "UHL10070000W0430000N6000600000  U              00020003").into_bytes();
        bytes.extend(format!("{:<141}E96WGS84", "DSIU").into_bytes());
        bytes.resize(LABELS.iter().sum(), b' ');
        for (count, heights) in records {
            bytes.extend([SENTINEL, 0, 0, 0]);
            bytes.extend(count.to_be_bytes());
            bytes.extend([0, 0]);
            for height in heights {
                let sign = if *height < 0 { 0x8000 } else { 0 };
                bytes.extend((height.unsigned_abs() as u16 | sign).to_be_bytes());
            }
            bytes.extend([0; 4]);
        }
        bytes
    }

    fn raster(bytes: &[u8]) -> Result<Raster, String> {
        read("n43.dt0", bytes, &DemHints::default()).map_err(|error| error.to_string())
    }

    #[test]
    fn columns_from_the_south_become_rows_from_the_north() {
        let raster = raster(&cell(&[(0, [1, -2, 3]), (1, [4, -32767, 6])])).expect("a cell");
        assert_eq!(
            [raster.at(0, 0), raster.at(1, 0), raster.at(0, 1), raster.at(0, 2)],
            [3.0, 6.0, -2.0, 1.0]
        );
        assert!(raster.at(1, 1).is_nan());
        let first = raster.map_from_grid.transform_point2(DVec2::splat(0.5));
        assert!(first.distance(DVec2::new(-7.0, 43.0 + 2.0 / 6.0)) < 1e-12, "{first}");
        assert_eq!(raster.vertical_datum.as_deref(), Some("EGM96 geoid"));
    }

    #[test]
    fn a_missing_column_is_no_data_and_a_tape_label_is_passed_over() {
        let sparse = cell(&[(1, [4, 5, 6])]);
        let taped = [format!("{:<80}", "HDR1").into_bytes(), sparse.clone()].concat();
        for bytes in [sparse, taped] {
            let raster = raster(&bytes).expect("a cell");
            assert!(raster.at(0, 0).is_nan() && raster.at(1, 0) == 6.0);
        }
    }

    #[test]
    fn two_s_complement_shows_in_depths_that_there_are_not() {
        assert_eq!(height((-200i16).to_be_bytes()), -200.0);
        assert_eq!(height([0x80, 200]), -200.0);
        assert!(height([0xff, 0xff]).is_nan());
    }

    #[test]
    fn a_cell_cut_anywhere_is_refused() {
        let whole = cell(&[(0, [1, 2, 3]), (1, [4, 5, 6])]);
        let one_column = whole.len() - 18;
        for end in (0..whole.len()).filter(|&end| end != one_column) {
            assert!(raster(&whole[..end]).is_err(), "{end}");
        }
        assert!(raster(&whole[..one_column]).expect("a column is missing").at(1, 0).is_nan());
    }

    #[test]
    fn every_byte_changed_in_turn_is_an_error_or_a_raster() {
        let whole = cell(&[(0, [1, 2, 3]), (1, [4, 5, 6])]);
        for at in (0..300).chain(LABELS.iter().sum()..whole.len()) {
            for value in [0, b'9', 0x7f, 0x80, 0xff] {
                let mut broken = whole.clone();
                broken[at] = value;
                if let Ok(raster) = raster(&broken) {
                    assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
                }
            }
        }
    }
}
