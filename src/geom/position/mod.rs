//! Positions as people write them, read and written: numbers of a system, grid references, UTM, degrees.
//!
//! | form | examples |
//! |---|---|
//! | two numbers of the system that holds where they stand | `750000,4018000`, `-84.2 36.3` |
//! | MGRS and USNG, of any precision, with and without spaces | `16SGF5000018000`, `16S GF 500 180`, `ZAH1234` |
//! | UTM by zone and band of latitude or hemisphere | `33T 500000 5200000`, `33N 500000 5200000`, `33 south 500000 5200000` |
//! | UPS by the letter of the half cap | `Z 2100000 1900000` |
//! | latitude and longitude, decimal or with minutes and seconds | `36.277N 84.215W`, `W 84°12'54" N 36°16'37"`, `3616N08412W` |
//!
//! A text other than two numbers states a place on WGS 84, whatever system its surroundings are in. What can be read in
//! two ways that are two places is refused, and both are named: `16S 755447 4024162` is in band S or on the southern
//! hemisphere.
//!
//! ```
//! use glam::DVec2;
//! use sandtable_geom::crs::Crs;
//! use sandtable_geom::position::Position;
//!
//! let place = Position::parse("16S GF 500 180").unwrap();
//! let zone = Crs::from_epsg(32616).unwrap();
//! assert_eq!(place.in_system(&zone).unwrap(), DVec2::new(750_050.0, 4_018_050.0));
//! assert_eq!(place.side_m(), Some(100.0));
//! ```

pub mod degrees;
pub mod fault;
mod grid;
pub mod notation;
mod token;

use std::str::FromStr;
use std::sync::OnceLock;

use glam::DVec2;

use crate::crs::{Crs, CrsError};
use crate::crs_fault::CrsFault;
use crate::mgrs::{GridCell, ZonePoint};
use crate::position::degrees::DegreeAxis;
use crate::position::fault::{PositionError, PositionFault};

/// The forms of a position, for messages.
pub const POSITION_FORMS: &str = "write X,Y, two numbers with a comma between (750000,4018000), a grid reference (16S GF 50000 18000), UTM (16N 750000 4018000), or \
     latitude and longitude with their letters (36.277N 84.215W, 36°16'37\"N 84°12'54\"W)";

/// The longest text of a position in bytes; the longest that anyone writes has half of it.
const LONGEST_TEXT: usize = 200;

/// A position as it was stated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    stated: StatedPlace,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum StatedPlace {
    /// Numbers of a system that the position does not name.
    Numbers(DVec2),
    /// Longitude and latitude on WGS 84, degrees.
    Degrees(DVec2),
    Zone(ZonePoint),
    Cell(GridCell),
}

impl Position {
    /// The position that a text states.
    ///
    /// # Errors
    /// [`PositionError`] where it is in none of the forms of this module, out of their range, or can be read in two ways.
    pub fn parse(text: &str) -> Result<Self, PositionError> {
        parsed(text).map(|stated| Self { stated }).map_err(|fault| PositionError::new(text, fault))
    }

    /// The place at a longitude and latitude on WGS 84, degrees.
    pub fn on_earth(lonlat: DVec2) -> Self {
        Self { stated: StatedPlace::Degrees(lonlat) }
    }

    /// Its numbers, where it is two numbers of a system that it does not name.
    pub fn numbers(&self) -> Option<DVec2> {
        match self.stated {
            StatedPlace::Numbers(at) => Some(at),
            _ => None,
        }
    }

    /// The side in meters of the square that a grid reference names, whose middle is the position.
    pub fn side_m(&self) -> Option<f64> {
        match self.stated {
            StatedPlace::Cell(cell) => Some(cell.side_m),
            _ => None,
        }
    }

    /// Its coordinates in `crs`: two numbers are those of `crs`, all else is transformed from WGS 84. An easting and
    /// northing keep their bits in their own zone.
    ///
    /// # Errors
    /// As [`Crs::transform`].
    pub fn in_system(&self, crs: &Crs) -> Result<DVec2, CrsError> {
        let (system, at) = match self.stated {
            StatedPlace::Numbers(at) => return Ok(at),
            StatedPlace::Degrees(place) => (wgs84().clone(), place),
            StatedPlace::Zone(point) | StatedPlace::Cell(GridCell { middle: point, .. }) => {
                match point.zone.crs() {
                    Some(zone) => (zone, point.at),
                    None => (wgs84().clone(), point.lonlat().unwrap_or(DVec2::NAN)),
                }
            }
        };
        system.transform(crs, at).map_err(|error| match error {
            // The shift of a datum is not what is missing.
            CrsError::Datum { from, to, .. } if crs.proj_text().is_empty() => {
                CrsError::Transform { from, to, x: at.x, y: at.y, reason: Box::new(CrsFault::NoSystem) }
            }
            error => error,
        })
    }
}

impl From<DVec2> for Position {
    fn from(at: DVec2) -> Self {
        Self { stated: StatedPlace::Numbers(at) }
    }
}

impl From<[f64; 2]> for Position {
    fn from(at: [f64; 2]) -> Self {
        DVec2::from(at).into()
    }
}

impl FromStr for Position {
    type Err = PositionError;

    fn from_str(text: &str) -> Result<Self, PositionError> {
        Self::parse(text)
    }
}

/// The latitude or longitude on WGS 84 that a text states by itself, in degrees, as a column of a table holds it.
///
/// # Errors
/// The text is no such angle, or its letter belongs to the other axis.
pub fn parse_angle(text: &str, axis: DegreeAxis) -> Result<f64, PositionError> {
    let parsed =
        if text.len() > LONGEST_TEXT { Err(PositionFault::TooLong) } else { degrees::angle(text, axis) };
    parsed.map_err(|fault| PositionError::new(text, fault))
}

/// WGS 84 longitude and latitude, made once.
pub fn wgs84() -> &'static Crs {
    static WGS84: OnceLock<Crs> = OnceLock::new();
    WGS84.get_or_init(Crs::wgs84)
}

fn parsed(text: &str) -> Result<StatedPlace, PositionFault> {
    if text.len() > LONGEST_TEXT {
        return Err(PositionFault::TooLong);
    }
    if let Some(at) = numbers(text) {
        return Ok(StatedPlace::Numbers(at));
    }
    if let Some(cell) = grid::reference(text) {
        return cell.map(StatedPlace::Cell);
    }
    match (grid::zone_point(text), degrees::place(text)) {
        // Eastings of UTM are no degrees, so that one of the two holds at most.
        (Some(Ok(point)), _) => Ok(StatedPlace::Zone(point)),
        (_, Ok(place)) => Ok(StatedPlace::Degrees(place)),
        (Some(Err(fault)), _) | (None, Err(fault)) => Err(fault),
    }
}

/// Two finite numbers with a comma or white space between.
fn numbers(text: &str) -> Option<DVec2> {
    let (x, y) = text.split_once(',').or_else(|| text.trim().split_once(char::is_whitespace))?;
    let at = DVec2::new(x.trim().parse().ok()?, y.trim().parse().ok()?);
    at.is_finite().then_some(at)
}

#[cfg(test)]
mod tests;
