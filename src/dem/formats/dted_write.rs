//! Writing DTED of level 0, 1 or 2: whole meters on the nodes of one degree, as MIL-PRF-89020B (2000) has them.
//!
//! | level | rows | apart |
//! |---|--:|--:|
//! | 0 (`.dt0`) | 121 | 30″ |
//! | 1 (`.dt1`) | 1201 | 3″ |
//! | 2 (`.dt2`) | 3601 | 1″ |
//!
//! Columns are as far apart as rows up to 50° from the equator, and 2, 3, 4 and 6 times as far from 50°, 70°, 75° and 80°
//! on: of a raster with more of them, the ones that the standard has are kept as they are.

use glam::DVec2;

use crate::file_name::split_extension;
use crate::formats::degree_square::{degree_corner, nodes_in_words};
use crate::formats::dted::{FORMAT, LABELS, SENTINEL, VOID};
use crate::written::{WriteError, WrittenDem};
use sandtable_raster::raster::Raster;

/// Heights that the standard allows, in meters.
const HEIGHTS_M: (f64, f64) = (-12_000.0, 9_000.0);

/// EPSG's codes of the systems that the standard allows, and its names for their datums.
const SYSTEMS: [(u32, &str); 2] = [(4326, "WGS84"), (4322, "WGS72")];

/// A level of DTED.
struct DtedLevel {
    extension: &'static str,
    /// Intervals between rows in a degree.
    intervals: u32,
    /// What a cell of this level holds, for messages.
    wanted: &'static str,
}

const LEVELS: [DtedLevel; 3] = [
    DtedLevel {
        extension: "dt0",
        intervals: 120,
        wanted: "one degree of EPSG:4326 or EPSG:4322 with nodes on whole degrees and, as .dt0, 121 rows 30″ apart and as many columns (61, 41, 31 or 21 from 50°, 70°, 75° or 80° on)",
    },
    DtedLevel {
        extension: "dt1",
        intervals: 1200,
        wanted: "one degree of EPSG:4326 or EPSG:4322 with nodes on whole degrees and, as .dt1, 1201 rows 3″ apart and as many columns (601, 401, 301 or 201 from 50°, 70°, 75° or 80° on)",
    },
    DtedLevel {
        extension: "dt2",
        intervals: 3600,
        wanted: "one degree of EPSG:4326 or EPSG:4322 with nodes on whole degrees and, as .dt2, 3601 rows 1″ apart and as many columns (1801, 1201, 901 or 601 from 50°, 70°, 75° or 80° on)",
    },
];

/// A cell that is written.
struct DtedCell<'a> {
    raster: &'a Raster,
    level: u32,
    corner: DVec2,
    /// The standard's name of the horizontal datum.
    datum: &'static str,
    /// The standard's name of the vertical datum; empty where it has none.
    vertical: &'static str,
    rows: u32,
    columns: u32,
    /// Columns of the raster from one of the cell to the next.
    step: u32,
}

pub(super) fn write(raster: &Raster, name: &str) -> Result<WrittenDem, WriteError> {
    let raster = &raster.in_meters();
    let raster = &FORMAT.north_up(raster)?;
    let cell = DtedCell::of(raster, split_extension(name).1)?;
    let (least, greatest) = HEIGHTS_M;
    if let Some(found) = raster.samples.valid().find(|value| !(least..=greatest).contains(&value.round())) {
        return Err(WriteError::OutOfRange { format: FORMAT.name, least, greatest, found });
    }
    let mut bytes = cell.labels();
    for column in 0..cell.columns {
        cell.record(column, &mut bytes);
    }
    Ok(WrittenDem { notes: cell.notes(), ..WrittenDem::new(bytes, "int16") })
}

impl<'a> DtedCell<'a> {
    fn of(raster: &'a Raster, extension: &str) -> Result<Self, WriteError> {
        let level = LEVELS.iter().position(|level| level.extension.eq_ignore_ascii_case(extension));
        // Without an extension, the level that the rows are of.
        let level = level.or_else(|| LEVELS.iter().position(|level| level.intervals + 1 == raster.height));
        let level = level.unwrap_or(LEVELS.len() - 1);
        let refused = || {
            let named = LEVELS.iter().find(|level| level.intervals + 1 == raster.height);
            let hint = named.map_or(String::new(), |level| format!(", rows of a .{}", level.extension));
            WriteError::Shape {
                format: FORMAT.name,
                wanted: LEVELS[level].wanted,
                found: nodes_in_words(raster) + &hint,
            }
        };
        let code = raster.crs.as_ref().map_or(Some(SYSTEMS[0].0), |crs| crs.epsg());
        let system = SYSTEMS.iter().find(|system| Some(system.0) == code).ok_or_else(refused)?;
        let corner = degree_corner(raster).ok_or_else(refused)?;
        let intervals = LEVELS[level].intervals;
        let columns = intervals / column_factor(corner.y);
        let step = (raster.width - 1) / columns;
        if raster.height != intervals + 1 || step * columns != raster.width - 1 {
            return Err(refused());
        }
        Ok(Self {
            raster,
            level: level as u32,
            corner,
            datum: system.1,
            vertical: vertical_datum(raster.vertical_datum.as_deref()),
            rows: intervals + 1,
            columns: columns + 1,
            step,
        })
    }

    fn notes(&self) -> Vec<String> {
        let is_rounded = self.raster.samples.valid().any(|value| value.fract() != 0.0);
        let mut notes = Vec::new();
        if is_rounded {
            notes.push("heights are rounded to whole meters".to_owned());
        }
        if self.step > 1 {
            notes.push(format!(
                "every {} of {} columns is kept: DTED has fewer of them far from the equator",
                ordinal(self.step),
                self.raster.width
            ));
        }
        if let (Some(datum), "") = (&self.raster.vertical_datum, self.vertical) {
            notes.push(format!("DTED has no name for the vertical datum {datum}: none is stated"));
        }
        notes
    }

    /// The three labels before the records.
    fn labels(&self) -> Vec<u8> {
        let Self { corner, rows, columns, .. } = *self;
        let (south, north) = (latitude(corner.y), latitude(corner.y + 1.0));
        let (west, east) = (longitude(corner.x), longitude(corner.x + 1.0));
        // Tenths of seconds.
        let intervals = [36_000 / (columns - 1), 36_000 / (rows - 1)];
        let mut user = DtedLabel::new("UHL1");
        user.put(4, &format!("{west:0>8}{south:0>8}{:04}{:04}", intervals[0], intervals[1]));
        user.put(28, "NA  U");
        user.put(47, &format!("{columns:04}{rows:04}0"));
        let mut identification = DtedLabel::new("DSIU");
        identification.put(59, &format!("DTED{}", self.level));
        identification.put(87, "01A000000000000");
        identification.put(126, "PRF89020B000005");
        identification.put(141, &format!("{:<3}{}", self.vertical, self.datum));
        identification.put(159, "0000");
        let origin = |text: &str| format!("{}.0{}", &text[..text.len() - 1], &text[text.len() - 1..]);
        identification.put(185, &format!("{}{}", origin(&south), origin(&west)));
        identification.put(204, &format!("{south}{west}{north}{west}{north}{east}{south}{east}"));
        identification
            .put(264, &format!("0000000.0{:04}{:04}{rows:04}{columns:04}00", intervals[1], intervals[0]));
        let mut accuracy = DtedLabel::new("ACC");
        accuracy.put(3, "NA  NA  NA  NA  ");
        accuracy.put(55, "00");
        let labels = [user, identification, accuracy];
        labels.into_iter().zip(LABELS).flat_map(|(label, length)| label.padded(length)).collect()
    }

    /// Appends the record of a column, its heights from the south.
    fn record(&self, column: u32, bytes: &mut Vec<u8>) {
        let start = bytes.len();
        bytes.push(SENTINEL);
        bytes.extend(&column.to_be_bytes()[1..]);
        bytes.extend((column as u16).to_be_bytes());
        bytes.extend([0, 0]);
        for row in (0..self.rows).rev() {
            let height = self.raster.at(column * self.step, row);
            let height = if height.is_nan() { VOID } else { height.round() as i16 };
            let sign = if height < 0 { 0x8000 } else { 0 };
            bytes.extend((height.unsigned_abs() | sign).to_be_bytes());
        }
        let sum: u32 = bytes[start..].iter().map(|byte| u32::from(*byte)).sum();
        bytes.extend(sum.to_be_bytes());
    }
}

/// The intervals between rows in one between columns of the cell whose southern border is at a latitude.
fn column_factor(south: f64) -> u32 {
    let from_equator = if south < 0.0 { -south - 1.0 } else { south };
    match from_equator {
        ..50.0 => 1,
        ..70.0 => 2,
        ..75.0 => 3,
        ..80.0 => 4,
        _ => 6,
    }
}

/// The standard's name of a vertical datum; empty where it has none, or the raster names none.
fn vertical_datum(name: Option<&str>) -> &'static str {
    let name = name.unwrap_or_default().to_ascii_lowercase();
    let names = [("egm96", "E96"), ("egm2008", "E08"), ("mean sea level", "MSL")];
    names.into_iter().find(|(known, _)| name.contains(known)).map_or("", |(_, code)| code)
}

/// A latitude of whole degrees as `DDMMSSH`.
fn latitude(degrees: f64) -> String {
    format!("{:02}0000{}", degrees.abs(), if degrees < 0.0 { 'S' } else { 'N' })
}

/// A longitude of whole degrees as `DDDMMSSH`.
fn longitude(degrees: f64) -> String {
    format!("{:03}0000{}", degrees.abs(), if degrees < 0.0 { 'W' } else { 'E' })
}

fn ordinal(number: u32) -> String {
    match number {
        2 => "2nd".into(),
        3 => "3rd".into(),
        other => format!("{other}th"),
    }
}

/// A label, of which only what is stated is no blank.
struct DtedLabel(Vec<u8>);

impl DtedLabel {
    fn new(start: &str) -> Self {
        Self(start.as_bytes().to_vec())
    }

    fn put(&mut self, at: usize, text: &str) {
        let end = at + text.len();
        if self.0.len() < end {
            self.0.resize(end, b' ');
        }
        self.0[at..end].copy_from_slice(text.as_bytes());
    }

    fn padded(mut self, length: usize) -> Vec<u8> {
        self.0.resize(length, b' ');
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem_format::DemFormat;
    use crate::hints::DemHints;
    use crate::read::read;
    use crate::write;
    use sandtable_geom::crs::Crs;
    use sandtable_raster::raster::{Samples, north_up_nodes};

    /// A degree whose heights name their column and row.
    fn degree(corner: DVec2, columns: u32, rows: u32) -> Raster {
        let height = |at: u32| (at % columns) as f32 - (at / columns) as f32;
        let cell = DVec2::new(f64::from(columns - 1), f64::from(rows - 1)).recip();
        Raster {
            crs: Some(Crs::wgs84()),
            vertical_datum: Some("EGM96 geoid".into()),
            ..Raster::new(columns, Samples::F32((0..columns * rows).map(height).collect()))
                .placed(north_up_nodes(corner + DVec2::Y, cell))
        }
    }

    fn written(raster: &Raster, name: &str) -> Result<WrittenDem, WriteError> {
        write::write(raster, DemFormat::to_write(split_extension(name).1).expect("written"), name)
    }

    #[test]
    fn a_degree_comes_back_as_it_was() {
        for (name, rows) in [("n.dt0", 121), ("n.DT1", 1201)] {
            for corner in [DVec2::new(7.0, 43.0), DVec2::new(-71.0, -34.0)] {
                let mut one = degree(corner, rows, rows);
                one.samples.set(5, f64::NAN);
                let written = written(&one, name).expect("a degree");
                assert!(written.notes.is_empty(), "{:?}", written.notes);
                let again = read(name, &written.bytes, &DemHints::default()).expect("our own");
                assert!(again.samples.iter().map(f64::to_bits).eq(one.samples.iter().map(f64::to_bits)));
                assert_eq!((again.crs, again.vertical_datum), (one.crs, one.vertical_datum));
                for (again, one) in
                    again.map_from_grid.to_cols_array().iter().zip(one.map_from_grid.to_cols_array())
                {
                    assert!((again - one).abs() < 1e-12, "{again} for {one}");
                }
            }
        }
    }

    #[test]
    fn far_from_the_equator_columns_lie_further_apart() {
        let one = degree(DVec2::new(20.0, 60.0), 121, 121);
        let written_ = written(&one, "n60.dt0").expect("a degree");
        assert_eq!(
            written_.notes,
            ["every 2nd of 121 columns is kept: DTED has fewer of them far from the equator"]
        );
        let again = read("n60.dt0", &written_.bytes, &DemHints::default()).expect("our own");
        assert_eq!((again.width, again.height), (61, 121));
        assert_eq!([again.at(1, 0), again.at(60, 3)], [2.0, 117.0]);
        let sparse = degree(DVec2::new(20.0, -61.0), 61, 121);
        assert!(written(&sparse, "s61.dt0").expect("a degree").notes.is_empty());
        assert_eq!([column_factor(-51.0), column_factor(-50.0), column_factor(89.0)], [2, 1, 6]);
    }

    #[test]
    fn the_labels_lie_where_the_standard_has_them() {
        let bytes = written(&degree(DVec2::new(-7.0, 43.0), 121, 121), "n43.dt0").expect("a degree").bytes;
        assert!(bytes.starts_with(b"UHL10070000W0430000N03000300NA  U"));
        assert_eq!(&bytes[47..56], b"012101210");
        let identification = &bytes[80..728];
        assert_eq!(&identification[59..64], b"DTED0");
        assert_eq!(&identification[141..149], b"E96WGS84");
        assert_eq!(&identification[185..204], b"430000.0N0070000.0W");
        assert_eq!(&identification[204..219], b"430000N0070000W");
        assert_eq!(&identification[264..291], b"0000000.0030003000121012100");
        assert_eq!(bytes.len(), 3428 + 121 * (12 + 2 * 121));
        let record = &bytes[3428..3428 + 254];
        let sum: u32 = record[..250].iter().map(|byte| u32::from(*byte)).sum();
        assert_eq!(record[250..], sum.to_be_bytes());
    }

    #[test]
    fn what_dted_cannot_hold_is_refused_with_its_limits() {
        let one = degree(DVec2::new(7.0, 43.0), 121, 121);
        let refused = |raster: &Raster, name: &str| written(raster, name).expect_err("refused").to_string();
        let message = refused(&one, "n43.dt2");
        assert!(message.contains("3601 rows 1″ apart") && message.contains("rows of a .dt0"), "{message}");
        let utm = Raster { crs: Some(Crs::from_epsg(32632).expect("known")), ..one.clone() };
        assert!(refused(&utm, "n43.dt0").contains("EPSG:4326"));
        let beside = degree(DVec2::new(7.25, 43.0), 121, 121);
        assert!(refused(&beside, "n43.dt0").contains("whole degrees"));
        let mut high = one.clone();
        high.samples.set(0, 9001.0);
        assert!(refused(&high, "n43.dt0").contains("-12000 to 9000"));
        let mut half = one;
        half.samples.set(0, 0.4);
        half.vertical_datum = Some("NAVD88".into());
        let notes = written(&half, "n43.dt0").expect("rounded").notes;
        assert!(notes[0].contains("whole meters") && notes[1].contains("NAVD88"), "{notes:?}");
    }
}
