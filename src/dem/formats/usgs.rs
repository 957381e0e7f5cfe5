//! USGS ASCII elevation models (`.dem`), and the Canadian CDED written alike: USGS, *Standards for Digital Elevation
//! Models*, part 2, 1998.
//!
//! ```text
//! A  1024 bytes (864 in old files): name, system, units, corners, resolution, number of profiles, datums
//! B  one a profile, from the west: row column, points 1, x y, datum, low high, then the heights northward
//! C  accuracy; not read
//! ```
//!
//! Everything is text of fixed widths: whole numbers of 6, Fortran doubles of 24 (`0.5578D+06`). Profiles of a quad
//! cut from UTM start and end where the quad does: they are set into the smallest raster around all, the rest is no
//! data. Each profile starts at a multiple of 1024 bytes where record A takes as many. Where the record states less
//! than is needed, this follows GDAL's reader.

use glam::DVec2;

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use sandtable_geom::crs::Crs;
use sandtable_geom::length_unit::{FOOT_M, US_SURVEY_FOOT_M};
use sandtable_geom::projection::utm_code;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "USGS elevation model",
    extensions: &["dem"],
    shared_extensions: &[],
    recognition: Recognition::Content { matches: recognizes, start: "a record A" },
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

const VOID: i64 = -32767;

/// Bytes of record A, and the unit that profiles are padded to.
const RECORD: usize = 1024;

/// The file holds at least one height in this many: quads lie askew in their raster, but fill most of it.
const SPARSEST: u64 = 4;

/// Whether the content is a record A: by its level code and its coordinate system, as in GDAL.
fn recognizes(bytes: &[u8]) -> bool {
    let field = |at: usize| bytes.get(at..at + 6);
    let one_of = |at: usize, known: &[&[u8; 6]]| known.iter().any(|known| field(at) == Some(&known[..]));
    one_of(156, &[b"     0", b"     1", b"     2", b"     3", b" -9999"])
        && one_of(150, &[b"     1", b"     4"])
}

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let text = FixedText(file.bytes);
    let header = UsgsHeader::read(&text)?;
    let samples = profiles(&text, &header)?;
    Ok(Raster {
        driver: "USGSDEM",
        // As in GDAL, whole meters of a resolution of a meter or more are integers.
        data_type: if header.is_in_feet || header.resolution < 1.0 { "Float32" } else { "Int16" },
        meters_per_z: if header.is_in_feet { FOOT_M } else { 1.0 },
        states_z_unit: true,
        crs: file.crs_or(|| header.system())?,
        nodata: Some(VOID as f64),
        vertical_datum: header.vertical_datum.map(str::to_owned),
        notes: header.note().filter(|_| file.hints.options.crs.is_none()).into_iter().collect(),
        ..Raster::new(header.columns, samples).placed(north_up_nodes(header.first, header.cell))
    })
}

/// The heights by rows from the north.
fn profiles(text: &FixedText, header: &UsgsHeader) -> Result<Samples, DemErrorKind> {
    let (columns, rows) = (header.columns as usize, header.rows as usize);
    let mut values = vec![f32::NAN; columns * rows];
    let south = header.first.y - header.cell.y * f64::from(header.rows - 1);
    let mut at = header.profiles_at;
    for column in 0..columns {
        let cut = || FORMAT.broken(format!("it ends in profile {} of {columns}", column + 1));
        let mut whole = || text.whole(&mut at).ok_or_else(cut);
        let (_row, _column, points, width) = (whole()?, whole()?, whole()?, whole()?);
        if width != 1 {
            let profile = column + 1;
            return Err(
                FORMAT.broken(format!("profile {profile} is {width} wide; such models are not in use"))
            );
        }
        let mut real = || text.real(&mut at, 24).ok_or_else(cut);
        let (_x, y, base, _low, _high) = (real()?, real()?, real()?, real()?, real()?);
        let first = ((y * header.degrees - south) / header.cell.y + 0.5).floor();
        for index in 0..points.max(0) {
            let height = text.whole(&mut at).ok_or_else(cut)?;
            let up = first + index as f64;
            if height != VOID && up >= 0.0 && up < rows as f64 {
                let height = (height as f64 * header.resolution + base) as f32;
                let value = &mut values[(rows - 1 - up as usize) * columns + column];
                *value = if height.is_finite() { height } else { f32::NAN };
            }
        }
        if header.profiles_at == RECORD {
            at = at.next_multiple_of(RECORD);
        }
    }
    Ok(Samples::F32(values))
}

struct UsgsHeader {
    columns: u32,
    rows: u32,
    /// The north-west height's position, in degrees or ground units.
    first: DVec2,
    cell: DVec2,
    /// The factor of positions in the file: a 3600th for seconds, 1 otherwise.
    degrees: f64,
    resolution: f64,
    is_in_feet: bool,
    /// 0 geographic, 1 UTM, 2 state plane, -9999 unstated.
    system: i64,
    /// Of UTM or state plane; negative in the south.
    zone: i64,
    /// 1 US survey foot, 2 meter, 3 second.
    ground_unit: i64,
    datum: i64,
    vertical_datum: Option<&'static str>,
    profiles_at: usize,
    /// Whether record A ends before it states the datum.
    is_old: bool,
}

impl UsgsHeader {
    fn read(text: &FixedText) -> Result<Self, DemErrorKind> {
        let real = |at: usize, width: usize, what: &str| {
            let wrong = || FORMAT.broken(format!("{what} at byte {at} of record A is no number"));
            text.real(&mut { at }, width).ok_or_else(wrong)
        };
        let profiles_at = text.profiles_at()?;
        let is_old = profiles_at == 864;
        let system = text.whole(&mut { 156 }).unwrap_or(0);
        let cell = DVec2::new(real(816, 12, "the x resolution")?, real(828, 12, "the y resolution")?);
        let resolution = real(840, 12, "the z resolution")?;
        if !(cell.min_element() > 0.0 && resolution > 0.0) {
            return Err(FORMAT.broken(format!("its resolution is {} by {} by {resolution}", cell.x, cell.y)));
        }
        let corner = |index: usize| -> Result<DVec2, DemErrorKind> {
            let at = 546 + 48 * index;
            Ok(DVec2::new(real(at, 24, "a corner")?, real(at + 24, 24, "a corner")?))
        };
        let corners = [corner(0)?, corner(1)?, corner(2)?, corner(3)?];
        let is_in_map_units = matches!(system, 1 | 2 | -9999);
        // Corners come in the order south-west, north-west, north-east, south-east.
        let (mut south, mut north) = (corners[0].y.min(corners[3].y), corners[1].y.max(corners[2].y));
        let mut west = corners[0].x.min(corners[1].x);
        if is_in_map_units {
            // The quad lies askew: y runs over whole multiples of the resolution, x from the first profile on.
            (south, north) = ((south / cell.y).floor() * cell.y, (north / cell.y).ceil() * cell.y);
            west = text.first_profile_x(profiles_at).unwrap_or(f64::NAN);
        }
        let rows = ((north - south) / cell.y + 1.5) as u64;
        let columns = u64::try_from(text.field(858, 6).unwrap_or(0)).unwrap_or(0);
        let claim = SizeClaim { expansion: SPARSEST, ..SizeClaim::new(columns, rows, 6) };
        let size = claim.check(text.0.len())?;
        let degrees = if is_in_map_units { 1.0 } else { 1.0 / 3600.0 };
        let first = DVec2::new(west, north) * degrees;
        if !first.is_finite() {
            return Err(FORMAT.broken("its corners are not finite"));
        }
        Ok(Self {
            columns: size.x,
            rows: size.y,
            first,
            cell: cell * degrees,
            degrees,
            resolution,
            is_in_feet: text.field(534, 6) == Some(1),
            system,
            zone: text.field(162, 6).unwrap_or(0),
            ground_unit: text.field(528, 6).unwrap_or(0),
            datum: if is_old { 1 } else { text.field(890, 2).unwrap_or(0) },
            vertical_datum: vertical_datum(text.field(888, 2).filter(|_| !is_old)),
            profiles_at,
            is_old,
        })
    }

    fn system(&self) -> Result<Option<Crs>, DemErrorKind> {
        let geographic = match self.datum {
            2 => 4322,
            3 => 4326,
            4 => 4269,
            _ => 4267,
        };
        let meters = if self.ground_unit == 1 { US_SURVEY_FOOT_M } else { 1.0 };
        let unknown =
            |reason: String| Err(DemErrorKind::Georeference { reason, remedy: "state crs under [terrain]" });
        match self.system {
            -9999 => Ok(None),
            0 => Ok(Some(Crs::from_epsg(geographic)?)),
            1 if (1..=60).contains(&self.zone.unsigned_abs()) => {
                Ok(Some(Crs::utm_on(geographic, self.zone, meters)?))
            }
            2 => unknown(format!("it is in state plane zone {}", self.zone)),
            system => unknown(format!(
                "coordinate system {system}, zone {} on datum {} is not known",
                self.zone, self.datum
            )),
        }
    }

    /// A note where the datum is taken that GDAL takes too.
    fn note(&self) -> Option<String> {
        let is_told = (1..=4).contains(&self.datum) && !self.is_old;
        let is_of_nad27 = !matches!(self.system, 1) || utm_code(4267, self.zone).is_some();
        if is_told || self.system == -9999 || self.is_old && is_of_nad27 {
            return None;
        }
        let beyond = if is_of_nad27 { "" } else { ", although its zone lies beyond those of that datum" };
        Some(format!(
            "it states no datum, so that NAD27 is taken, as GDAL does{beyond}; `crs` states another"
        ))
    }
}

fn vertical_datum(code: Option<i64>) -> Option<&'static str> {
    match code? {
        1 => Some("local mean sea level"),
        2 => Some("NGVD29"),
        3 => Some("NAVD88"),
        _ => None,
    }
}

struct FixedText<'a>(&'a [u8]);

impl FixedText<'_> {
    /// The next whole number from `at` on, of up to six characters; moves `at` past it.
    fn whole(&self, at: &mut usize) -> Option<i64> {
        let rest = self.0.get(*at..)?;
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let word = &rest[start..rest.len().min(start + 6)];
        let is_part =
            |(index, byte): (usize, &u8)| byte.is_ascii_digit() || (index == 0 && b"+-".contains(byte));
        let length = word.iter().enumerate().take_while(|&part| is_part(part)).count();
        *at += start + length;
        std::str::from_utf8(&word[..length]).ok()?.parse().ok()
    }

    /// The number in `width` characters at `at`, also with a Fortran exponent of `D`; moves `at` past it.
    fn real(&self, at: &mut usize, width: usize) -> Option<f64> {
        let field = std::str::from_utf8(self.0.get(*at..*at + width)?).ok()?;
        *at += width;
        let value: f64 = field.trim().replace(['D', 'd'], "E").parse().ok()?;
        value.is_finite().then_some(value)
    }

    /// The whole number in `width` characters at `at`; `None` where the field is blank.
    fn field(&self, at: usize, width: usize) -> Option<i64> {
        std::str::from_utf8(self.0.get(at..at + width)?).ok()?.trim().parse().ok()
    }

    /// Where the first profile starts: the first place known that states row 1, column 1.
    fn profiles_at(&self) -> Result<usize, DemErrorKind> {
        let pair = |mut at: usize| (self.whole(&mut at), self.whole(&mut at), at);
        if let (Some(1), Some(1), ..RECORD) = pair(864) {
            return Ok(864);
        }
        if let (Some(1), Some(0 | 1), _) = pair(RECORD) {
            // Some end every record with a line feed.
            let ends = |record: usize| self.0.get(record * (RECORD + 1) - 1) == Some(&b'\n');
            return Ok(if ends(1) && ends(2) { RECORD + 1 } else { RECORD });
        }
        let found = [893, 918].into_iter().find(|&at| matches!(pair(at), (Some(1), Some(1), _)));
        found.ok_or_else(|| FORMAT.broken("no profile states that it is row 1, column 1"))
    }

    /// The x that the first profile states.
    fn first_profile_x(&self, mut at: usize) -> Option<f64> {
        for _ in 0..4 {
            self.whole(&mut at)?;
        }
        self.real(&mut at, 24)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

    /// Two profiles of three and two heights, 30 m apart, in UTM zone 10; the second starts a row further north.
    fn model(unit: u32, datums: &str) -> Vec<u8> {
        model_in_zone(10, unit, datums)
    }

    fn model_in_zone(zone: i32, unit: u32, datums: &str) -> Vec<u8> {
        let mut a = format!("{:<150}     1     1{zone:6}", "TEST");
        a = format!("{a:<528}     2{unit:6}     4");
        for corner in
            [600_000.0, 5_000_013.0, 600_000.0, 5_000_069.0, 600_030.0, 5_000_069.0, 600_030.0, 5_000_020.0]
        {
            a.push_str(&format!("{corner:24.6}"));
        }
        a = format!("{a:<816}0.300000D+020.300000E+020.100000E+01     1     2");
        a = format!("{a:<888}{datums}");
        let mut bytes = format!("{a:<1024}").into_bytes();
        for (column, y, heights) in
            [(1, "0.500001D+07", "   100  -200   300"), (2, "0.500004D+07", "-32767 10000")]
        {
            let points = heights.len() / 6;
            let mut b = format!("     1{column:6}{points:6}     1{:>24}{y:>24}", 600_000 + 30 * (column - 1));
            b.push_str(&format!("{:>24}{:>24}{:>24}{heights}", "0.5D+01", "0.0", "0.0"));
            bytes.extend(format!("{b:<1024}").into_bytes());
        }
        bytes
    }

    fn raster(bytes: &[u8]) -> Result<Raster, String> {
        read("a.dem", bytes, &DemHints::default()).map_err(|error| error.to_string())
    }

    #[test]
    fn ragged_profiles_are_set_into_one_raster() {
        let raster = raster(&model(2, " 3 4")).expect("a model");
        assert_eq!((raster.width, raster.height), (2, 3));
        assert_eq!(raster.geotransform(), [599_985.0, 30.0, 0.0, 5_000_085.0, 0.0, -30.0]);
        assert_eq!([raster.at(0, 2), raster.at(0, 1), raster.at(0, 0)], [105.0, -195.0, 305.0]);
        assert!(raster.at(1, 2).is_nan() && raster.at(1, 1).is_nan());
        assert_eq!(raster.at(1, 0), 10_005.0);
        assert_eq!(raster.crs.as_ref().and_then(Crs::epsg), Some(26910));
        assert_eq!(raster.vertical_datum.as_deref(), Some("NAVD88"));
        assert_eq!(raster.data_type, "Int16");
    }

    #[test]
    fn feet_and_an_old_datum_are_told() {
        let raster = raster(&model(1, " 2 1")).expect("a model");
        assert_eq!((raster.meters_per_z, raster.data_type), (0.3048, "Float32"));
        assert_eq!(raster.vertical_datum.as_deref(), Some("NGVD29"));
        assert_eq!(raster.crs.as_ref().and_then(Crs::epsg), Some(26710));
    }

    #[test]
    fn a_zone_is_never_taken_for_a_system_with_the_code_behind_it() {
        let found = |zone: i32, datums: &str| {
            let raster = raster(&model_in_zone(zone, 2, datums)).expect("a model");
            let crs = raster.crs.expect("a system");
            (crs.epsg(), crs.definition().map(|it| (it.longitude_deg, it.false_northing_m)), raster.notes)
        };
        let zone = |zone: i32| Some((f64::from(zone.abs()) * 6.0 - 183.0, if zone < 0 { 1e7 } else { 0.0 }));
        assert_eq!(found(10, " 3 1"), (Some(26710), zone(10), vec![]));
        // EPSG:26732 is in Alaska, EPSG:26948 in Arizona.
        for (number, datums, code) in [
            (32, " 3 1", None),
            (48, " 3 1", None),
            (60, " 3 1", Some(3371)),
            (48, " 3 4", None),
            (48, " 3 2", Some(32248)),
            (48, " 3 3", Some(32648)),
            (-33, " 3 3", Some(32733)),
            (-33, " 3 1", None),
        ] {
            assert_eq!(found(number, datums), (code, zone(number), vec![]), "{number} {datums}");
        }
        for (number, beyond) in [(10, false), (48, true)] {
            let (_, _, notes) = found(number, "    ");
            assert!(notes[0].contains("NAD27") && notes[0].contains("beyond") == beyond, "{notes:?}");
        }
        assert!(raster(&model_in_zone(61, 2, " 3 1")).expect_err("no zone").contains("zone 61"));
    }

    #[test]
    fn numbers_may_touch_and_are_six_wide() {
        let text = FixedText(b"-32767-32767123456  -12");
        let mut at = 0;
        let numbers: Vec<_> = std::iter::from_fn(|| text.whole(&mut at)).collect();
        assert_eq!(numbers, [-32767, -32767, 123_456, -12]);
    }

    #[test]
    fn a_model_cut_anywhere_before_its_last_height_is_refused() {
        let whole = model(2, " 3 4");
        let last = 2 * 1024 + 24 + 120 + 12;
        for end in 0..last {
            let refused = raster(&whole[..end]);
            // The rest of the last height is also a number.
            assert!(refused.is_err() || end > last - 5, "{end}");
        }
        assert!(raster(&whole[..last]).is_ok());
    }

    #[test]
    fn every_byte_changed_in_turn_is_an_error_or_a_raster() {
        let whole = model(2, " 3 4");
        for at in 0..whole.len() {
            for value in [0, b'-', b'9', 0xff] {
                let mut broken = whole.clone();
                broken[at] = value;
                if let Ok(raster) = raster(&broken) {
                    assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
                }
            }
        }
    }
}
