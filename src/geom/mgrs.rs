//! Zones of UTM and UPS, and the 100 km squares of the military grid reference system (NGA.STND.0037); the one user of
//! `mgrs_convert`.
//!
//! The zones are those of the standard, with the exceptions of Norway and Svalbard, and the polar grid beyond 84° north
//! and 80° south.

use std::sync::OnceLock;

use glam::DVec2;
use mgrs_convert::{Error, LatLon, Mgrs, ParseErrorKind, Precision, UtmUps};

use crate::crs::Crs;

/// A zone of UTM, or a polar cap of UPS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GridZone {
    /// 1 to 60; 0 is UPS.
    number: u8,
    is_north: bool,
}

/// Easting and northing in a zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZonePoint {
    /// The zone.
    pub zone: GridZone,
    /// Easting and northing on WGS 84, meters.
    pub at: DVec2,
}

/// The square that a grid reference names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridCell {
    /// Its middle.
    pub middle: ZonePoint,
    /// Its side in meters, 100 km to 1 µm.
    pub side_m: f64,
}

/// Why a text is no grid reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GridFault {
    /// The zone is not a number from 1 to 60 with the letter of a band, or a letter of a polar cap.
    #[error(
        "its zone is not a number from 1 to 60 with a letter from C to X but I and O, or A, B, Y or Z at the poles"
    )]
    Zone,
    /// The letters of the square are none.
    #[error("its two letters are not those of a square of 100 km; I and O are none")]
    Letters,
    /// The square does not lie in the zone.
    #[error("its square of 100 km does not lie in its zone")]
    OtherZone,
    /// The square does not lie in the band.
    #[error("its square of 100 km does not lie in its band of latitude")]
    OtherBand,
    /// The digits are not two equal halves.
    #[error("its digits are not two equal halves, easting and northing")]
    UnevenDigits,
    /// More digits than a micrometer needs.
    #[error("it has more than 22 digits")]
    TooManyDigits,
    /// Something else stands in it.
    #[error("it is not a zone, two letters and digits")]
    Form,
}

/// A square of 100 km of the military grid.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GridSquare {
    /// The zone and the band of latitude, such as `16S`; a letter alone in the polar caps.
    pub designation: String,
    /// The letters of its column and its row, such as `GF`.
    pub letters: String,
}

impl GridZone {
    /// A zone of UTM; `None` for a number that is not from 1 to 60.
    pub fn utm(number: u8, is_north: bool) -> Option<Self> {
        (1..=60).contains(&number).then_some(Self { number, is_north })
    }

    /// A polar cap of UPS.
    pub fn ups(is_north: bool) -> Self {
        Self { number: 0, is_north }
    }

    /// 1 to 60; 0 is UPS.
    pub fn number(self) -> u8 {
        self.number
    }

    /// Whether northings count from the equator, or the cap is the northern one.
    pub fn is_north(self) -> bool {
        self.is_north
    }

    /// The zone or cap of the same number on the other hemisphere.
    pub fn opposite(self) -> Self {
        Self { is_north: !self.is_north, ..self }
    }

    /// The zone of a longitude and latitude on WGS 84, degrees; `None` where they are out of range.
    pub fn at(place: DVec2) -> Option<Self> {
        let utm = LatLon::new(place.y, place.x).ok()?.to_utmups();
        Some(Self { number: utm.zone(), is_north: utm.is_north() })
    }

    /// Its eastings and northings on WGS 84, meters. Each is made once.
    pub fn crs(self) -> Option<Crs> {
        static SYSTEMS: [OnceLock<Option<Crs>>; 122] = [const { OnceLock::new() }; 122];
        let system = SYSTEMS.get(usize::from(self.number) * 2 + usize::from(self.is_north))?;
        system.get_or_init(|| self.made_crs()).clone()
    }

    fn made_crs(self) -> Option<Crs> {
        let base = if self.is_north { 32600 } else { 32700 };
        // EPSG gives the polar caps the number after zone 60.
        Crs::from_epsg(base + if self.number == 0 { 61 } else { u32::from(self.number) }).ok()
    }

    /// Its name in a sentence, such as `UTM zone 16 N`.
    pub fn name(self) -> String {
        match (self.number, self.is_north) {
            (0, true) => "UPS north".to_owned(),
            (0, false) => "UPS south".to_owned(),
            (number, true) => format!("UTM zone {number} N"),
            (number, false) => format!("UTM zone {number} S"),
        }
    }
}

impl ZonePoint {
    /// The easting and northing of a longitude and latitude on WGS 84, degrees, in their own zone; `None` where they are
    /// out of range.
    pub fn of(place: DVec2) -> Option<Self> {
        let utm = LatLon::new(place.y, place.x).ok()?.to_utmups();
        let zone = GridZone { number: utm.zone(), is_north: utm.is_north() };
        Some(Self { zone, at: DVec2::new(utm.easting(), utm.northing()) })
    }

    /// The longitude and latitude on WGS 84, degrees; `None` far out of the zone.
    pub fn lonlat(self) -> Option<DVec2> {
        let place = self.utm_ups()?.to_latlon();
        Some(DVec2::new(place.lon(), place.lat()))
    }

    /// The letter of its band of latitude, C to X, or of its half of a polar cap, A, B, Y or Z; `None` far out of the
    /// zone.
    pub fn band(self) -> Option<char> {
        let text = self.utm_ups()?.to_mgrs(Precision::new(0).ok()?).ok()?.to_string();
        text.chars().find(char::is_ascii_alphabetic)
    }

    /// The grid reference with `digits` digits each, 0 to 5; `None` far out of the zone.
    ///
    /// Coordinates count to 0.1 mm: a whole meter that a transform has brought to just below stays that meter.
    pub fn reference(self, digits: u8) -> Option<String> {
        let precision = Precision::new(digits.min(5)).ok()?;
        let rounded = Self { at: (self.at * 1e4).round() / 1e4, ..self };
        Some(rounded.utm_ups()?.to_mgrs(precision).ok()?.to_string())
    }

    fn utm_ups(self) -> Option<UtmUps> {
        let Self { zone: GridZone { number, is_north }, at } = self;
        match number {
            0 => UtmUps::ups(is_north, at.x, at.y).ok(),
            _ => UtmUps::utm(number, is_north, at.x, at.y).ok(),
        }
    }
}

impl GridCell {
    /// The square of a grid reference without spaces, such as `16SGF5012`, in any case.
    ///
    /// # Errors
    /// [`GridFault`].
    pub fn parse(reference: &str) -> Result<Self, GridFault> {
        let cell: Mgrs = reference.parse().map_err(grid_fault)?;
        let middle = cell.to_utmups();
        let zone = GridZone { number: middle.zone(), is_north: middle.is_north() };
        let at = DVec2::new(middle.easting(), middle.northing());
        let side_m = 10f64.powi(5 - i32::from(cell.precision().get()));
        Ok(Self { middle: ZonePoint { zone, at }, side_m })
    }
}

fn grid_fault(error: Error) -> GridFault {
    match error {
        Error::Parse(ParseErrorKind::BadZoneNumber | ParseErrorKind::BadBandLetter) => GridFault::Zone,
        Error::Parse(ParseErrorKind::BadSquareLetters) => GridFault::Letters,
        Error::Parse(ParseErrorKind::SquareZoneMismatch) => GridFault::OtherZone,
        Error::Parse(ParseErrorKind::SquareBandMismatch) => GridFault::OtherBand,
        Error::Parse(ParseErrorKind::OddDigitCount) => GridFault::UnevenDigits,
        Error::Parse(ParseErrorKind::TooManyDigits) => GridFault::TooManyDigits,
        _ => GridFault::Form,
    }
}

impl GridSquare {
    /// The square that holds a longitude and latitude on WGS 84, degrees; `None` where they are out of range.
    pub fn at(place: DVec2) -> Option<Self> {
        let text = reference(place, 0)?;
        let (designation, letters) = text.split_at_checked(text.len().checked_sub(2)?)?;
        Some(Self { designation: designation.to_owned(), letters: letters.to_owned() })
    }
}

/// The grid reference of a longitude and latitude on WGS 84, degrees, with `digits` digits each, 0 to 5: `16SGF5012`
/// with 2. `None` where they are out of range.
pub fn reference(place: DVec2, digits: u8) -> Option<String> {
    let precision = Precision::new(digits.min(5)).ok()?;
    Some(LatLon::new(place.y, place.x).ok()?.to_mgrs(precision).to_string())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Longitudes and latitudes: spread over the Earth, and as many over Norway, Svalbard and either polar cap.
    pub(crate) fn places() -> impl Iterator<Item = DVec2> {
        let areas = [
            ((-180.0, 180.0), (-79.9, 83.9)),
            ((0.0, 13.0), (55.5, 64.5)),
            ((-1.0, 43.0), (71.5, 84.0)),
            ((-180.0, 180.0), (84.0, 90.0)),
            ((-180.0, 180.0), (-90.0, -80.0)),
        ];
        // Halton's sequence in bases 2 and 3.
        let radical = |mut index: u32, base: u32| {
            let (mut value, mut share) = (0.0, 1.0);
            while index > 0 {
                share /= f64::from(base);
                value += f64::from(index % base) * share;
                index /= base;
            }
            value
        };
        areas.into_iter().flat_map(move |((west, east), (south, north))| {
            (1..=2000).map(move |index| {
                let share = DVec2::new(radical(index, 2), radical(index, 3));
                DVec2::new(west + (east - west) * share.x, south + (north - south) * share.y)
            })
        })
    }

    #[test]
    fn references_are_those_of_an_independent_program_at_ten_thousand_places() {
        let mut count = 0;
        for place in places() {
            let expected = geoconvert::LatLon::create(place.y, place.x).expect("in range").to_mgrs(5);
            assert_eq!(reference(place, 5), Some(expected.to_string()), "{place}");
            count += 1;
        }
        assert_eq!(count, 10_000);
    }

    #[test]
    fn a_zone_has_the_coordinates_that_its_references_are_made_of() {
        for place in places().step_by(7) {
            let crs = GridZone::at(place).and_then(GridZone::crs).expect("a zone");
            let at = Crs::wgs84().transform(&crs, place).expect("in its zone");
            let text = reference(place, 5).expect("in range");
            let digits = &text[text.len() - 10..];
            let whole = |value: f64| (libm::floor(value + 1e-3) as i64).rem_euclid(100_000);
            let off = |digits: &str, value: f64| {
                let off = (digits.parse::<i64>().expect("digits") - whole(value)).rem_euclid(100_000);
                off.min(100_000 - off)
            };
            assert!(off(&digits[..5], at.x) <= 1 && off(&digits[5..], at.y) <= 1, "{place}: {text}, {at}");
        }
    }

    #[test]
    fn norway_and_svalbard_have_zones_of_their_own() {
        let name = |x: f64, y: f64| GridZone::at(DVec2::new(x, y)).expect("in range").name();
        assert_eq!(name(5.3, 60.4), "UTM zone 32 N");
        assert_eq!(name(15.6, 78.2), "UTM zone 33 N");
        assert_eq!(name(-84.2, 36.3), "UTM zone 16 N");
        assert_eq!(name(20.4, -34.0), "UTM zone 34 S");
        assert_eq!(name(10.0, 88.0), "UPS north");
        assert!(GridZone::at(DVec2::new(10.0, 91.0)).is_none());
    }

    #[test]
    fn a_square_is_named_by_zone_band_and_two_letters() {
        let square = GridSquare::at(DVec2::new(-84.2, 36.3)).expect("in range");
        assert_eq!((square.designation.as_str(), square.letters.as_str()), ("16S", "GF"));
        let polar = GridSquare::at(DVec2::new(10.0, 88.0)).expect("in range");
        assert_eq!((polar.designation.len(), polar.letters.len()), (1, 2));
    }
}
