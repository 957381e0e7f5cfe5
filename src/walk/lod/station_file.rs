//! A flight file: the stations that the eye passes.
//!
//! One station a line, six numbers: x, y, z of the eye, then of its target. Meters from the south-west post, x east, y
//! north, z the elevation, as in the meshes that are written. Commas, semicolons or white space separate the numbers; a
//! first line without a number is a header; empty lines and lines that begin with # are skipped.

use glam::Vec3;

use sandtable_files::csv::{LineError, fields, is_header, numbered_lines};
use sandtable_view::flight::FlightStation;

/// The most stations: more than any flight has frames.
const MOST: usize = 100_000;

/// The farthest coordinate from the south-west post, meters: a quarter of the Earth's circumference.
const FARTHEST_M: f32 = 1e7;

/// The longest text of a line in a message, in characters.
const LONGEST_QUOTE: usize = 60;

/// A text that is not a flight.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum StationFileError {
    #[error(transparent)]
    Line(#[from] LineError<StationFault>),
    #[error("{name}: found {found} stations, a flight needs two or more lines of x,y,z,tx,ty,tz")]
    TooFew { name: String, found: usize },
}

/// A fault of a station.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum StationFault {
    #[error("found '{0}', each line must hold six numbers x,y,z,tx,ty,tz")]
    Numbers(String),
    #[error("coordinates are meters from the south-west post, at most {FARTHEST_M}")]
    Range,
    #[error("the eye is its own target; let it look somewhere")]
    NoDirection,
    #[error("a flight has at most {MOST} stations")]
    TooMany,
}

/// The stations in the text of the file `name`, at least two.
///
/// # Errors
/// See [`StationFileError`].
pub fn parse(name: &str, text: &str) -> Result<Vec<FlightStation>, StationFileError> {
    let mut lines = numbered_lines(text).peekable();
    lines.next_if(|(_, line)| is_header(line));
    let mut stations = Vec::new();
    for (line, text) in lines {
        let station = if stations.len() < MOST { parse_station(text) } else { Err(StationFault::TooMany) };
        let at_line = |fault| LineError { name: name.into(), line, fault };
        stations.push(station.map_err(at_line)?);
    }
    match stations.len() {
        found @ 0..2 => Err(StationFileError::TooFew { name: name.into(), found }),
        _ => Ok(stations),
    }
}

fn parse_station(line: &str) -> Result<FlightStation, StationFault> {
    let numbers = fields(line).flat_map(str::split_whitespace).map(|number| number.parse().ok());
    let numbers: Option<Vec<f32>> = numbers.collect();
    let Some([x, y, z, tx, ty, tz]) = numbers.as_deref() else {
        return Err(StationFault::Numbers(line.trim().chars().take(LONGEST_QUOTE).collect()));
    };
    let (eye, target) = (Vec3::new(*x, *y, *z), Vec3::new(*tx, *ty, *tz));
    let is_valid = |point: Vec3| point.is_finite() && point.abs().max_element() <= FARTHEST_M;
    if !is_valid(eye) || !is_valid(target) {
        return Err(StationFault::Range);
    }
    if eye == target { Err(StationFault::NoDirection) } else { Ok(FlightStation { eye, target }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_come_with_or_without_a_header_and_with_any_separator() {
        let expected =
            [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [7.0, 8.0, 9.0, -1.0, 0.5, 1e3]].map(|n: [f32; 6]| {
                FlightStation { eye: Vec3::new(n[0], n[1], n[2]), target: Vec3::new(n[3], n[4], n[5]) }
            });
        for text in [
            "1,2,3,4,5,6\n7,8,9,-1,0.5,1e3\n",
            "\u{feff}x,y,z,tx,ty,tz\r\n1, 2, 3, 4, 5, 6\r\n\r\n7,8,9,-1,.5,1000",
            "# over the pass\n1;2;3;4;5;6\n  # on\n7\t8 9  -1 0.5 1e3",
        ] {
            assert_eq!(parse("f.csv", text).expect("sound"), expected, "{text:?}");
        }
    }

    #[test]
    fn a_line_that_is_no_station_is_named_with_what_was_found() {
        for (text, wanted) in [
            ("1,2,3,4,5,6\n1,2,3,4,5\n", "f.csv:2: found '1,2,3,4,5'"),
            ("1,2,3,4,5,6\n1,2,3,4,5,6,7\n", "f.csv:2: found"),
            ("x,y,z,tx,ty,tz\n\n1,2,3,4,five,6\n", "f.csv:3: found '1,2,3,4,five,6'"),
            ("1,2,3,4,5,NaN\n", "f.csv:1: coordinates"),
            ("1,2,3,4,5,1e9\n", "f.csv:1: coordinates"),
            ("1,2,3,1,2,3\n", "f.csv:1: the eye"),
            ("", "f.csv: found 0 stations"),
            ("x,y,z,tx,ty,tz\nx,y,z,tx,ty,tz\n", "f.csv:2: found"),
            ("1,2,3,4,5,6\n", "f.csv: found 1 stations"),
        ] {
            let error = parse("f.csv", text).expect_err(text).to_string();
            assert!(error.starts_with(wanted), "{text:?}: {error}");
        }
    }
}
