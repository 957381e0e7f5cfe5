//! Points as text (`.xyz`, `.csv`, `.txt`): a point a line, with or without a header that names the columns.
//!
//! Fields are parted by semicolons, else commas, else blanks or tabs; with semicolons a number may have a decimal
//! comma. Empty lines and lines that start with `#` or `//` are passed over. A point without a height (an empty field
//! or NaN) is left out and counted; any other line that is no point is refused with its number, because a line that
//! was silently dropped is a hole nobody knows of.

use glam::DVec3;

use crate::dem::points::{MOST_POINTS, PointCloud, PointHints, PointsError};

const X: [&str; 9] = ["x", "lon", "long", "longitude", "lng", "easting", "east", "e", "rechtswert"];
const Y: [&str; 8] = ["y", "lat", "latitude", "northing", "north", "n", "hochwert", "lati"];
const Z: [&str; 9] = ["z", "elevation", "elev", "height", "h", "alt", "altitude", "ele", "hoehe"];

/// What a line must hold, for messages.
const WANTED: &str = "numbers x, y, z";

/// The longest part of a line that a message repeats.
const LONGEST_QUOTE: usize = 60;

/// Reads a table of points.
///
/// # Errors
/// [`PointsError`] for the first line that is no point, a header without x, y or z, or no point at all.
pub fn read(bytes: &[u8], hints: &PointHints) -> Result<PointCloud, PointsError> {
    let text =
        std::str::from_utf8(bytes).map_err(|error| PointsError::NotText { at: error.valid_up_to() })?;
    let mut lines = lines(text).peekable();
    let columns = match lines.peek() {
        Some(&(line, text)) if is_header(text) => {
            lines.next();
            columns(text).ok_or_else(|| PointsError::Columns { line, found: quote(text) })?
        }
        _ => [0, 1, 2],
    };
    let mut points = Vec::new();
    let mut without_height = 0usize;
    for (line, text) in lines {
        match point(text, columns) {
            Some(point) if point.z.is_nan() => without_height += 1,
            Some(point) if points.len() as u64 == MOST_POINTS => {
                return Err(PointsError::TooMany {
                    count: points.len() as u64 + u64::from(point.is_finite()),
                });
            }
            Some(point) => points.push(point),
            None => return Err(PointsError::Line { line, found: quote(text), wanted: WANTED }),
        }
    }
    if points.is_empty() {
        let why = if without_height > 0 { " that have a height" } else { "" };
        return Err(PointsError::Empty { why: why.into() });
    }
    let left_out = format!("{without_height} points without a height were left out");
    Ok(PointCloud {
        points,
        breaklines: Vec::new(),
        crs: hints.crs.cloned(),
        meters_per_z: 1.0,
        vertical_datum: None,
        notes: if without_height > 0 { vec![left_out] } else { Vec::new() },
    })
}

/// The lines that say something, with their numbers from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !(line.is_empty() || line.starts_with('#') || line.starts_with("//")))
}

/// The point of a line; its height NaN where the line gives none. `None` for a line that is no point.
fn point(line: &str, columns: [usize; 3]) -> Option<DVec3> {
    let mut found = [None; 3];
    for (index, field) in fields(line).enumerate() {
        for (column, found) in columns.iter().zip(&mut found) {
            if *column == index {
                *found = Some(field);
            }
        }
    }
    let [x, y, z] = found;
    let z = match z? {
        "" => f64::NAN,
        field => number(field)?,
    };
    let point = DVec3::new(number(x?)?, number(y?)?, z);
    let sound = point.x.is_finite() && point.y.is_finite() && !point.z.is_infinite();
    sound.then_some(point)
}

fn number(field: &str) -> Option<f64> {
    field.parse().ok().or_else(|| field.replacen(',', ".", 1).parse().ok())
}

/// Whether a first line holds names; one with a number in it is a point, or meant to be one.
fn is_header(line: &str) -> bool {
    fields(line).all(|field| number(field).is_none())
}

/// The columns of x, y and z that a header names.
fn columns(header: &str) -> Option<[usize; 3]> {
    let names: Vec<String> = fields(header).map(str::to_lowercase).collect();
    let find = |accepted: &[&str]| names.iter().position(|name| accepted.contains(&name.as_str()));
    Some([find(&X)?, find(&Y)?, find(&Z)?])
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    let separator = [';', ','].into_iter().find(|&separator| line.contains(separator));
    line.split(move |at: char| separator.map_or(at.is_whitespace(), |separator| at == separator))
        .map(|field| field.trim().trim_matches('"'))
        .filter(move |field| separator.is_some() || !field.is_empty())
}

/// A line as a message repeats it.
fn quote(line: &str) -> String {
    line.chars().take(LONGEST_QUOTE).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(text: &str) -> Result<Vec<DVec3>, String> {
        read(text.as_bytes(), &PointHints::default())
            .map(|cloud| cloud.points)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn points_come_with_or_without_a_header_in_any_columns_and_separators() {
        let expected = vec![DVec3::new(1.5, 2.0, 7.0), DVec3::new(-3.0, 4e3, 8.25)];
        for text in [
            "1.5,2,7\n-3,4e3,8.25\n",
            "\u{feff}x,y,z\r\n1.5,2,7\r\n\r\n-3,4e3,8.25",
            "id;lat;lon;elevation\n7;2;1,5;7\n8;4e3;-3;8,25",
            "# surveyed\n1.5  2\t7\n// more\n -3 4e3 8.25",
            "\"z\",\"x\",\"y\"\n7,1.5,2\n8.25,-3,4000",
        ] {
            assert_eq!(points(text), Ok(expected.clone()), "{text}");
        }
    }

    #[test]
    fn a_line_that_is_no_point_is_refused_with_its_number() {
        for (text, wanted) in [
            ("x,y,z\n1,2,3\n3,north,1\n", "line 3: found '3,north,1'"),
            ("1 2 3\n4 5\n", "line 2: found '4 5'"),
            ("1,2,3\ninf,2,3", "line 2"),
            ("x,y,depth\n1,2,3", "line 1: the header 'x,y,depth'"),
            ("", "no points"),
            ("x y z\n", "no points"),
        ] {
            let refused = points(text).expect_err(text);
            assert!(refused.contains(wanted), "{refused}");
        }
        assert!(read(b"1 2 3\n\xff\xfe", &PointHints::default()).is_err());
    }

    #[test]
    fn points_without_a_height_are_left_out_and_counted() {
        let cloud = read(b"x,y,z\n1,2,3\n4,5,\n6,7,nan\n", &PointHints::default()).expect("one point");
        assert_eq!(cloud.points.len(), 1);
        assert_eq!(cloud.notes, ["2 points without a height were left out"]);
    }
}
