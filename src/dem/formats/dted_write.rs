//! Writing DTED of level 0, 1 or 2: whole meters on the nodes of one degree, as MIL-PRF-89020B (2000) has them.
//!
//! | level | rows | apart |
//! |---|--:|--:|
//! | 0 (`.dt0`) | 121 | 30″ |
//! | 1 (`.dt1`) | 1201 | 3″ |
//! | 2 (`.dt2`) | 3601 | 1″ |
//!
//! Columns are as far apart as rows up to 50° from the equator, and 2, 3, 4 and 6 times as far from 50°, 70°, 75° and 80°
//! on: of a raster with more of them, the ones that the standard has are kept as they are. A raster that is part of a degree
//! is written as a whole one, without data around it.

use glam::DVec2;

use crate::file_name::split_extension;
use crate::formats::degree_square::nodes_in_words;
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
        wanted: "nodes within one degree of EPSG:4326 or EPSG:4322, as .dt0 on its 121 rows 30″ apart and as many columns (61, 41, 31 or 21 from 50°, 70°, 75° or 80° on)",
    },
    DtedLevel {
        extension: "dt1",
        intervals: 1200,
        wanted: "nodes within one degree of EPSG:4326 or EPSG:4322, as .dt1 on its 1201 rows 3″ apart and as many columns (601, 401, 301 or 201 from 50°, 70°, 75° or 80° on)",
    },
    DtedLevel {
        extension: "dt2",
        intervals: 3600,
        wanted: "nodes within one degree of EPSG:4326 or EPSG:4322, as .dt2 on its 3601 rows 1″ apart and as many columns (1801, 1201, 901 or 601 from 50°, 70°, 75° or 80° on)",
    },
];

/// A cell that is written.
struct DtedCell<'a> {
    raster: &'a Raster,
    level: u32,
    /// The south-west corner of the degree.
    corner: DVec2,
    /// The standard's name of the horizontal datum.
    datum: &'static str,
    /// The standard's name of the vertical datum; empty where it has none.
    vertical: &'static str,
    rows: u32,
    columns: u32,
    /// Columns of the raster from one of the cell to the next.
    step: u32,
    /// Columns of the raster's spacing from the western border to its first.
    west: u32,
    /// Rows from the southern border to the raster's last.
    south: u32,
}

/// How far, in samples, the nodes of a raster may lie from those of the cell.
const OFF_SAMPLES: f64 = 1e-3;

/// `value` as a whole number from 0 on, from which it is hardly off.
fn whole(value: f64) -> Option<u32> {
    let near = value.round();
    ((value - near).abs() < OFF_SAMPLES && (0.0..1e6).contains(&near)).then_some(near as u32)
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
        let of_rows = |level: &&DtedLevel| whole(raster.spacing().y * f64::from(level.intervals)) == Some(1);
        let named = LEVELS.iter().position(|level| level.extension.eq_ignore_ascii_case(extension));
        // Without an extension, the level that the rows are of.
        let level = named.or_else(|| LEVELS.iter().position(|level| of_rows(&level)));
        let level = level.unwrap_or(LEVELS.len() - 1);
        let refused = || {
            let hint = LEVELS.iter().find(of_rows).map(|level| format!(", rows of a .{}", level.extension));
            WriteError::Shape {
                format: FORMAT.name,
                wanted: LEVELS[level].wanted,
                found: nodes_in_words(raster) + &hint.unwrap_or_default(),
            }
        };
        let code = raster.crs.as_ref().map_or(Some(SYSTEMS[0].0), |crs| crs.epsg());
        let system = SYSTEMS.iter().find(|system| Some(system.0) == code).ok_or_else(refused)?;
        let cell = Self {
            raster,
            level: level as u32,
            datum: system.1,
            vertical: vertical_datum(raster.vertical_datum.as_deref()),
            ..Self::around(raster, LEVELS[level].intervals).ok_or_else(refused)?
        };
        Ok(cell)
    }

    /// The cell that all nodes of a raster are nodes of; `None` where there is none.
    fn around(raster: &'a Raster, intervals: u32) -> Option<Self> {
        let (nodes, spacing) = (raster.node_extent(), raster.spacing());
        let corner = (nodes.min + OFF_SAMPLES * spacing).floor();
        let is_on_earth = (-180.0..180.0).contains(&corner.x) && (-90.0..90.0).contains(&corner.y);
        if !is_on_earth {
            return None;
        }
        let columns = intervals / column_factor(corner.y);
        let step = whole((f64::from(columns) * spacing.x).recip())?.max(1);
        let (per_degree, rows) = (step * columns, intervals);
        let is_within = |node: DVec2| {
            let at = (node - corner) * DVec2::new(per_degree.into(), rows.into());
            Some((whole(at.x).filter(|&x| x <= per_degree)?, whole(at.y).filter(|&y| y <= rows)?))
        };
        let ((west, south), (east, north)) = (is_within(nodes.min)?, is_within(nodes.max)?);
        if east - west != raster.width - 1 || north - south != raster.height - 1 {
            return None;
        }
        Some(Self {
            raster,
            level: 0,
            corner,
            datum: "",
            vertical: "",
            rows: rows + 1,
            columns: columns + 1,
            step,
            west,
            south,
        })
    }

    /// The height at a column and a row from the south-west; NaN where there is none.
    fn height(&self, column: u32, row: u32) -> f64 {
        let column = (column * self.step).checked_sub(self.west).filter(|&column| column < self.raster.width);
        let up = row.checked_sub(self.south).filter(|&up| up < self.raster.height);
        column.zip(up).map_or(f64::NAN, |(column, up)| self.raster.at(column, self.raster.height - 1 - up))
    }

    /// Percent of the degree that the raster covers, 0 for all of it.
    fn partial_cell(&self) -> u32 {
        let share = |samples: u32, of: u32| f64::from(samples) / f64::from(of);
        let columns = share(self.raster.width, (self.columns - 1) * self.step + 1);
        match columns * share(self.raster.height, self.rows) {
            1.0.. => 0,
            part => ((100.0 * part) as u32).clamp(1, 99),
        }
    }

    fn notes(&self) -> Vec<String> {
        let is_rounded = self.raster.samples.valid().any(|value| value.fract() != 0.0);
        let mut notes = Vec::new();
        if is_rounded {
            notes.push("heights are rounded to whole meters".to_owned());
        }
        if self.partial_cell() > 0 {
            notes.push("the rest of the degree has no data".to_owned());
        }
        if self.step > 1 {
            notes.push(format!(
                "every {} column is kept: DTED has fewer of them far from the equator",
                ordinal(self.step)
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
        let (counts, part) = (format!("{rows:04}{columns:04}"), self.partial_cell());
        identification.put(264, &format!("0000000.0{:04}{:04}{counts}{part:02}", intervals[1], intervals[0]));
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
        for row in 0..self.rows {
            let height = self.height(column, row);
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
    fn a_part_of_a_degree_lies_in_a_whole_one() {
        for (corner, columns) in [(DVec2::new(7.0, 43.0), 121), (DVec2::new(-8.0, -62.0), 61)] {
            let cell = DVec2::new(1.0 / f64::from(columns - 1), 1.0 / 120.0);
            let values = (0..5 * 4).map(|at| at as f32).collect();
            let north_west = corner + DVec2::new(10.0, 33.0) * cell;
            let part = Raster {
                crs: Some(Crs::wgs84()),
                ..Raster::new(5, Samples::F32(values)).placed(north_up_nodes(north_west, cell))
            };
            let written = written(&part, "a.dt0").expect("it has the nodes of a degree");
            assert_eq!(written.notes, ["the rest of the degree has no data"]);
            assert_eq!(&written.bytes[80 + 289..80 + 291], b"01");
            let again = read("a.dt0", &written.bytes, &DemHints::default()).expect("our own");
            assert_eq!((again.width, again.height, again.samples.valid().count()), (columns, 121, 20));
            assert!((0..20).all(|at| again.at(10 + at % 5, 120 - 33 + at / 5) == f64::from(at)));
        }
    }

    #[test]
    fn far_from_the_equator_columns_lie_further_apart() {
        let one = degree(DVec2::new(20.0, 60.0), 121, 121);
        let written_ = written(&one, "n60.dt0").expect("a degree");
        assert_eq!(written_.notes, ["every 2nd column is kept: DTED has fewer of them far from the equator"]);
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
        for west in [7.25, 7.001, 200.0] {
            let beside = degree(DVec2::new(west, 43.0), 121, 121);
            assert!(refused(&beside, "n43.dt0").contains("nodes within one degree"), "{west}");
        }
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
