//! A flight file: the stations that the eye passes.
//!
//! One station a line, six numbers: the eye's x, y, z and the target's. Meters from the south-west post, x east,
//! y north, z the elevation: the coordinates of the meshes that are written. Separated by commas, semicolons or
//! blanks; a first line without a number is a heading; empty lines and those that start with # are passed over.

use glam::Vec3;

use crate::app::failure::CliError;
use crate::view::flight::FlightStation;

/// Stations that are read: more than any flight has frames.
const MOST: usize = 100_000;

/// No coordinate may be farther from the south-west post, meters: a quarter of the way round the world.
const FARTHEST_M: f32 = 1e7;

/// The stations of the text of the file called `name`, at least two.
///
/// # Errors
/// A line holds no station, or there are too few or too many; the message names the place.
pub fn parse(name: &str, text: &str) -> Result<Vec<FlightStation>, CliError> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let mut lines =
        lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#')).peekable();
    lines.next_if(|(_, line)| fields(line).all(|field| field.parse::<f32>().is_err()));
    let mut stations = Vec::new();
    for (index, line) in lines {
        let wrong = |reason: String| CliError::input(format!("{name}:{}: {reason}", index + 1));
        if stations.len() == MOST {
            return Err(wrong(format!("a flight has at most {MOST} stations")));
        }
        stations.push(parse_station(line).map_err(wrong)?);
    }
    if stations.len() < 2 {
        let found = stations.len();
        return Err(CliError::input(format!(
            "{name}: found {found} stations, a flight needs two or more lines of x,y,z,tx,ty,tz"
        )));
    }
    Ok(stations)
}

fn parse_station(line: &str) -> Result<FlightStation, String> {
    let numbers: Option<Vec<f32>> = fields(line).map(|field| field.parse().ok()).collect();
    let Some([x, y, z, tx, ty, tz]) = numbers.as_deref() else {
        let found: String = line.trim().chars().take(60).collect();
        return Err(format!("found '{found}', each line must hold six numbers x,y,z,tx,ty,tz"));
    };
    let (eye, target) = (Vec3::new(*x, *y, *z), Vec3::new(*tx, *ty, *tz));
    let within = |point: Vec3| point.is_finite() && point.abs().max_element() <= FARTHEST_M;
    if !within(eye) || !within(target) {
        return Err(format!("coordinates are meters from the south-west post, at most {FARTHEST_M}"));
    }
    if eye == target {
        return Err("the eye is its own target; let it look somewhere".into());
    }
    Ok(FlightStation { eye, target })
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split([',', ';', ' ', '\t']).map(str::trim).filter(|field| !field.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_come_with_or_without_a_heading_and_with_any_separator() {
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
            let Err(CliError::Input(reason)) = parse("f.csv", text) else { panic!("{text:?} accepted") };
            assert!(reason.starts_with(wanted), "{text:?}: {reason}");
        }
    }
}
