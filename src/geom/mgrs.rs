//! Zones of UTM and UPS, and the 100 km squares of the military grid reference system (NGA.STND.0037); the one user of
//! `mgrs_convert`.
//!
//! The zones are those of the standard, with the exceptions of Norway and Svalbard, and the polar grid beyond 84° north
//! and 80° south.

use glam::DVec2;
use mgrs_convert::{LatLon, Precision};

use crate::crs::Crs;

/// A zone of UTM, or a polar cap of UPS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GridZone {
    /// 1 to 60; 0 is UPS.
    number: u8,
    is_north: bool,
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
    /// The zone of a longitude and latitude on WGS 84, degrees; `None` where they are out of range.
    pub fn at(place: DVec2) -> Option<Self> {
        let utm = LatLon::new(place.y, place.x).ok()?.to_utmups();
        Some(Self { number: utm.zone(), is_north: utm.is_north() })
    }

    /// Its eastings and northings on WGS 84, meters.
    pub fn crs(self) -> Option<Crs> {
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
mod tests {
    use super::*;

    /// Longitudes and latitudes: spread over the Earth, and as many over Norway, Svalbard and either polar cap.
    fn places() -> impl Iterator<Item = DVec2> {
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
