//! Points in a CSV text, as every command reads them.

use glam::DVec2;

use crate::app::failure::CliError;

/// A point and how it was written.
#[derive(Debug, PartialEq)]
pub struct WrittenPoint<'a> {
    /// Where it is; finite.
    pub at: DVec2,
    /// Its x and y as they stand in the text.
    pub written: [&'a str; 2],
}

/// The points of a CSV text: a header that names columns `x` and `y` (or `lon` and `lat`), or none and x, y first.
///
/// # Errors
/// A line is no point, or the header names no such columns; the message names `name` and the line.
pub fn parse_points<'a>(name: &str, text: &'a str) -> Result<Vec<WrittenPoint<'a>>, CliError> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
        .peekable();
    let columns = match lines.peek() {
        Some(&(index, line)) if is_header(line) => {
            lines.next();
            columns(line).ok_or_else(|| {
                let place = index + 1;
                CliError::input(format!(
                    "{name}:{place}: the header '{line}' must name columns x and y, or lon and lat"
                ))
            })?
        }
        _ => [0, 1],
    };
    lines
        .map(|(index, line)| {
            parse_point(line, columns).ok_or_else(|| {
                let place = index + 1;
                CliError::input(format!("{name}:{place}: found '{line}', each line must hold numbers x,y"))
            })
        })
        .collect()
}

fn parse_point(line: &str, columns: [usize; 2]) -> Option<WrittenPoint<'_>> {
    let fields: Vec<&str> = fields(line).collect();
    let written = [*fields.get(columns[0])?, *fields.get(columns[1])?];
    let at = DVec2::new(written[0].parse().ok()?, written[1].parse().ok()?);
    at.is_finite().then_some(WrittenPoint { at, written })
}

/// Whether a first line holds names; one with a number in it is a point, or meant to be one.
fn is_header(line: &str) -> bool {
    fields(line).all(|field| field.parse::<f64>().is_err())
}

/// The columns of x and y that a header names.
fn columns(header: &str) -> Option<[usize; 2]> {
    let names: Vec<String> = fields(header).map(str::to_lowercase).collect();
    let find = |accepted: &[&str]| names.iter().position(|name| accepted.contains(&name.as_str()));
    let x = find(&["x", "lon", "long", "longitude", "easting", "east"])?;
    let y = find(&["y", "lat", "latitude", "northing", "north"])?;
    Some([x, y])
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    let separator = [',', ';'].into_iter().find(|&separator| line.contains(separator));
    line.split(move |at: char| separator.map_or(at.is_whitespace(), |separator| at == separator))
        .map(|field| field.trim().trim_matches('"'))
        .filter(move |field| separator.is_some() || !field.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_with_or_without_a_header_and_in_any_columns() {
        let at = |text: &str| {
            parse_points("p.csv", text).expect("sound").iter().map(|point| point.at).collect::<Vec<_>>()
        };
        let expected = vec![DVec2::new(1.5, 2.0), DVec2::new(-3.0, 4e3)];
        assert_eq!(at("1.5,2\n-3,4e3\n"), expected);
        assert_eq!(at("x,y\r\n1.5,2\r\n\r\n-3,4e3"), expected);
        assert_eq!(at("id;lat;lon\n7;2;1.5\n8;4e3;-3"), expected);
        assert_eq!(at("1.5  2\n-3 4e3"), expected);
    }

    #[test]
    fn a_line_that_is_no_point_is_named() {
        let Err(CliError::Input(reason)) = parse_points("p.csv", "x,y\n1,2\n3,north\n") else {
            panic!("accepted");
        };
        assert!(reason.contains("p.csv:3:") && reason.contains("3,north"), "{reason}");
    }

    #[test]
    fn comments_are_passed_over_and_the_wrong_line_is_counted_with_them() {
        let points = parse_points("p.csv", "# a line\n1.5 2\n-3 4e3").expect("sound");
        assert_eq!(
            points.iter().map(|point| point.at).collect::<Vec<_>>(),
            [DVec2::new(1.5, 2.0), DVec2::new(-3.0, 4e3)]
        );
        for (text, place) in [("x,y\n1,2\n3,north\n", 3), ("1,2\n3\n", 2), ("a,b\n1,2\n", 1)] {
            let Err(CliError::Input(reason)) = parse_points("p.csv", text) else {
                panic!("accepted: {text}")
            };
            assert!(reason.contains(&format!("p.csv:{place}:")), "{reason}");
        }
    }
}
