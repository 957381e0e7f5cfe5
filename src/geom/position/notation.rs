//! Positions as text in the forms that [`Position::parse`](crate::position::Position::parse) reads.

use glam::DVec2;

use crate::crs::{Crs, CrsError};
use crate::crs_fault::CrsFault;
use crate::mgrs::ZonePoint;
use crate::position::wgs84;

/// Digits of an easting and of a northing in a grid reference: a meter.
const GRID_DIGITS: u8 = 5;

/// A form in which positions are written, each on WGS 84.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionForm {
    /// `16SGF5000018000`: the square of a meter that holds the position.
    Mgrs,
    /// `16S GF 50000 18000`: the same with spaces.
    Usng,
    /// `16N 750000.00 4018000.00`: zone, hemisphere, easting and northing to a centimeter; UPS by the poles.
    Utm,
    /// `36.2770000°N 84.2150000°W`: latitude and longitude.
    Degrees,
    /// `36°16.62000′N 84°12.90000′W`.
    Minutes,
    /// `36°16′37.200″N 84°12′54.000″W`.
    Seconds,
}

impl PositionForm {
    /// All forms with their words and meanings, in the order in which messages list them.
    pub const WORDS: [(Self, &'static str, &'static str); 6] = [
        (Self::Mgrs, "mgrs", "a grid reference to a meter, such as 16SGF5000018000"),
        (Self::Usng, "usng", "a grid reference with spaces, such as 16S GF 50000 18000"),
        (Self::Utm, "utm", "UTM, such as 16N 750000.00 4018000.00; UPS by the poles"),
        (Self::Degrees, "dd", "decimal degrees, such as 36.2770000°N 84.2150000°W"),
        (Self::Minutes, "dm", "degrees and minutes, such as 36°16.62000′N 84°12.90000′W"),
        (Self::Seconds, "dms", "degrees, minutes and seconds, such as 36°16′37.200″N 84°12′54.000″W"),
    ];

    /// The form that a word of [`Self::WORDS`] names.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(_, known, _)| *known == word).map(|(form, ..)| *form)
    }

    /// The position at `at` in `crs` as text.
    ///
    /// # Errors
    /// As [`Crs::transform`] to WGS 84; also where the result is no place on Earth.
    pub fn write(self, crs: &Crs, at: DVec2) -> Result<String, CrsError> {
        let place = crs.transform(wgs84(), at)?;
        let off_earth = || CrsError::Transform {
            from: crs.name().into(),
            to: wgs84().name().into(),
            x: at.x,
            y: at.y,
            reason: Box::new(CrsFault::NoPlaceOnEarth),
        };
        let point = ZonePoint::of(place).ok_or_else(off_earth)?;
        // Coordinates of the zone itself keep their bits.
        let point = if point.zone.crs().as_ref() == Some(crs) { ZonePoint { at, ..point } } else { point };
        match self {
            Self::Mgrs => point.reference(GRID_DIGITS).ok_or_else(off_earth),
            Self::Usng => point.reference(GRID_DIGITS).map(|text| spaced(&text)).ok_or_else(off_earth),
            Self::Utm => utm(point).ok_or_else(off_earth),
            Self::Degrees => Ok(angles(place, |size| format!("{size:.7}°"))),
            Self::Minutes => Ok(angles(place, minutes)),
            Self::Seconds => Ok(angles(place, seconds)),
        }
    }
}

/// A grid reference with spaces between zone, square, easting and northing.
pub fn spaced(reference: &str) -> String {
    let letters = |text: &str| text.bytes().take_while(u8::is_ascii_alphabetic).count();
    let zone_digits = reference.bytes().take_while(u8::is_ascii_digit).count();
    let square = zone_digits + 1;
    let digits = zone_digits + letters(&reference[zone_digits..]);
    let middle = digits + (reference.len() - digits) / 2;
    let cuts = [0, square, digits, middle, reference.len()];
    let parts = cuts.windows(2).filter_map(|cut| reference.get(cut[0]..cut[1]));
    parts.filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
}

fn utm(ZonePoint { zone, at }: ZonePoint) -> Option<String> {
    let band = ZonePoint { zone, at }.band()?;
    let designation = match (zone.number(), zone.is_north()) {
        (0, _) => band.to_string(),
        (number, true) => format!("{number}N"),
        // The letter by itself would be read as band S, too.
        (number, false) if ZonePoint { zone: zone.opposite(), at }.band() == Some('S') => {
            format!("{number} south")
        }
        (number, false) => format!("{number}S"),
    };
    Some(format!("{designation} {:.2} {:.2}", at.x, at.y))
}

/// Latitude and longitude, each written by `angle` without its sign.
fn angles(place: DVec2, angle: impl Fn(f64) -> String) -> String {
    let north = if place.y < 0.0 { 'S' } else { 'N' };
    let east = if place.x < 0.0 { 'W' } else { 'E' };
    format!("{}{north} {}{east}", angle(place.y.abs()), angle(place.x.abs()))
}

fn minutes(degrees: f64) -> String {
    /// Parts of a minute.
    const PARTS: u64 = 100_000;
    let all = (degrees * 60.0 * PARTS as f64).round() as u64;
    let (whole, parts) = (all / PARTS, all % PARTS);
    format!("{}°{:02}.{parts:05}′", whole / 60, whole % 60)
}

fn seconds(degrees: f64) -> String {
    /// Parts of a second.
    const PARTS: u64 = 1000;
    let all = (degrees * 3600.0 * PARTS as f64).round() as u64;
    let (whole, parts) = (all / PARTS, all % PARTS);
    format!("{}°{:02}′{:02}.{parts:03}″", whole / 3600, whole / 60 % 60, whole % 60)
}
