//! Positions and lines as users write them: two numbers, a CSV table, or the first line of a vector file.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::DVec2;

use sandtable_base::message::numbers::fixed;
use sandtable_files::csv::{LineError, fields, is_header, numbered_lines};
use sandtable_files::disk::{self, ReadFileError};
use sandtable_files::error::FileError;
use sandtable_geom::crs::Crs;
use sandtable_vector::error::VectorError;
use sandtable_vector::feature::Feature;
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read;

/// A position and its text.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenPosition<'a> {
    /// The position; finite.
    pub at: DVec2,
    /// Its x and y as they are written.
    pub written: [Cow<'a, str>; 2],
}

/// A line and the system of its coordinates.
#[derive(Clone, Debug)]
pub struct InputLine {
    /// Its vertices, at least two.
    pub vertices: Vec<DVec2>,
    /// The system of its coordinates.
    pub crs: Crs,
    /// What the file holds besides, and what reading it left out.
    pub notes: Vec<String>,
}

/// A text that is not a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("write two numbers as in 530250,4021300")]
pub struct PositionError;

/// A CSV table that does not hold positions.
pub type PositionsError = LineError<PositionFault>;

/// Why a line, which is quoted, is not a position.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PositionFault {
    /// A header does not name the columns of x and y.
    #[error("the header '{0}' must name columns x and y, or lon and lat")]
    Header(String),
    /// A line does not hold a position.
    #[error("found '{0}', each line must hold numbers x,y")]
    Line(String),
}

/// A file that does not give a line.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ReadLineError {
    #[error(transparent)]
    File(#[from] ReadFileError),
    #[error(transparent)]
    Table(#[from] PositionsError),
    #[error("{name}: a line needs at least two positions, found {found}")]
    TooShort { name: String, found: usize },
    #[error(transparent)]
    Vector(#[from] FileError<VectorError>),
    #[error("{}: it holds no line; a profile follows the first line of a vector file", .0.display())]
    NoLine(PathBuf),
}

impl FromStr for WrittenPosition<'static> {
    type Err = PositionError;

    fn from_str(text: &str) -> Result<Self, PositionError> {
        let (x, y) = text.split_once(',').ok_or(PositionError)?;
        let position = WrittenPosition::parse(x.trim(), y.trim()).ok_or(PositionError)?;
        Ok(Self { at: position.at, written: position.written.map(|number| number.into_owned().into()) })
    }
}

impl<'a> WrittenPosition<'a> {
    fn parse(x: &'a str, y: &'a str) -> Option<Self> {
        let at = DVec2::new(x.parse().ok()?, y.parse().ok()?);
        at.is_finite().then_some(Self { at, written: [x.into(), y.into()] })
    }
}

/// The columns of a CSV table that hold positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionColumns {
    x: usize,
    y: usize,
    /// Whether the first line names them.
    pub has_header: bool,
}

impl PositionColumns {
    /// The columns that the first line of a table names, or the first two where it names none.
    ///
    /// # Errors
    /// [`PositionFault::Header`].
    pub fn of_first_line(line: &str) -> Result<Self, PositionFault> {
        if !is_header(line) {
            return Ok(Self { x: 0, y: 1, has_header: false });
        }
        let names: Vec<String> = fields(line).map(str::to_lowercase).collect();
        let find = |accepted: &[&str]| names.iter().position(|name| accepted.contains(&name.as_str()));
        let x = find(&["x", "lon", "long", "longitude", "easting", "east"]);
        let y = find(&["y", "lat", "latitude", "northing", "north"]);
        let columns = x.zip(y).map(|(x, y)| Self { x, y, has_header: true });
        columns.ok_or_else(|| PositionFault::Header(line.into()))
    }

    /// The position in a line.
    ///
    /// # Errors
    /// [`PositionFault::Line`].
    pub fn position<'a>(&self, line: &'a str) -> Result<WrittenPosition<'a>, PositionFault> {
        let [x, y] = [self.x, self.y].map(|column| fields(line).nth(column).unwrap_or_default());
        WrittenPosition::parse(x, y).ok_or_else(|| PositionFault::Line(line.into()))
    }
}

/// The positions of a CSV table. A header names columns `x` and `y` (or `lon` and `lat`); without one, x and y come
/// first. `name` is the file's name in messages.
///
/// # Errors
/// A line is not a position, or the header does not name the columns.
pub fn parse_positions<'a>(name: &str, text: &'a str) -> Result<Vec<WrittenPosition<'a>>, PositionsError> {
    let mut lines = numbered_lines(text).peekable();
    let at_line = |line| move |fault| LineError { name: name.to_owned(), line, fault };
    let Some(&(first, line)) = lines.peek() else { return Ok(Vec::new()) };
    let columns = PositionColumns::of_first_line(line).map_err(at_line(first))?;
    lines
        .skip(usize::from(columns.has_header))
        .map(|(line, text)| columns.position(text).map_err(at_line(line)))
        .collect()
}

/// The line in the file at `path` (`-` for standard input): all vertices of a CSV table, or the first line of a vector
/// file.
///
/// `stated` is the system of its coordinates. Without it a vector file's own system holds, and `native` for a table.
///
/// # Errors
/// The file cannot be read, or has no line.
pub fn read_line(path: &Path, stated: Option<Crs>, native: &Crs) -> Result<InputLine, ReadLineError> {
    let is_table = path.extension().is_none_or(|extension| {
        ["csv", "txt", "xy", "xyz"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    });
    if !is_table {
        return first_line(path, stated);
    }
    let (name, text) = (disk::display_name(path), disk::read_text(path)?);
    let vertices: Vec<DVec2> = parse_positions(&name, &text)?.iter().map(|position| position.at).collect();
    match vertices.len() {
        found @ 0..2 => Err(ReadLineError::TooShort { name, found }),
        _ => Ok(InputLine { vertices, crs: stated.unwrap_or_else(|| native.clone()), notes: Vec::new() }),
    }
}

fn first_line(path: &Path, stated: Option<Crs>) -> Result<InputLine, ReadLineError> {
    let bytes = disk::read(path)?;
    let hints =
        VectorHints { crs: stated.as_ref(), companions: &disk::beside(path), ..VectorHints::default() };
    let layer = read::read(&disk::file_name(path), &bytes, &hints).map_err(FileError::at(path))?;
    let mut lines = layer.features.iter().flat_map(Feature::lines);
    let vertices = lines.next().cloned().ok_or_else(|| ReadLineError::NoLine(path.to_owned()))?;
    let mut notes: Vec<String> = layer.reading_notes().cloned().collect();
    if let more @ 1.. = lines.count() {
        notes.push(format!("it holds {} lines, of which the first is followed", more + 1));
    }
    Ok(InputLine { vertices, crs: layer.crs, notes })
}

/// `x, y` for a reader: degrees with five decimals (about a meter), meters without.
pub fn format_position(crs: &Crs, at: DVec2) -> String {
    let decimals = if crs.is_geographic() { 5 } else { 0 };
    format!("{}, {}", fixed(at.x, decimals), fixed(at.y, decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn positions(text: &str) -> Vec<DVec2> {
        parse_positions("p.csv", text).expect("sound").iter().map(|position| position.at).collect()
    }

    #[test]
    fn positions_come_with_or_without_a_header_and_in_any_columns() {
        let expected = vec![DVec2::new(1.5, 2.0), DVec2::new(-3.0, 4e3)];
        assert_eq!(positions("1.5,2\n-3,4e3\n"), expected);
        assert_eq!(positions("x,y\r\n1.5,2\r\n\r\n-3,4e3"), expected);
        assert_eq!(positions("id;lat;lon\n7;2;1.5\n8;4e3;-3"), expected);
        assert_eq!(positions("1.5  2\n-3 4e3"), expected);
    }

    #[test]
    fn comments_are_skipped_and_still_counted_in_the_number_of_a_wrong_line() {
        assert_eq!(positions("# a line\n1.5 2\n-3 4e3"), [DVec2::new(1.5, 2.0), DVec2::new(-3.0, 4e3)]);
        for (text, place) in [
            ("x,y\n1,2\n3,north\n", "p.csv:3: found '3,north'"),
            ("1,2\n3\n", "p.csv:2:"),
            ("a,b\n1,2\n", "p.csv:1:"),
        ] {
            let error = parse_positions("p.csv", text).expect_err(text).to_string();
            assert!(error.contains(place), "{error}");
        }
    }
}
