//! Positions and lines as users write them: one position in any of the forms of [`sandtable_geom::position`], a CSV table of
//! them, or the first line of a vector file.

use std::borrow::Cow;
use std::fmt;
use std::path::{Path, PathBuf};

use glam::DVec2;

use sandtable_base::message::numbers::fixed;
use sandtable_files::csv::{LineError, fields, is_header, numbered_lines};
use sandtable_files::disk::{self, ReadFileError};
use sandtable_files::error::FileError;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_geom::datum_shift::DatumShift;
use sandtable_geom::position::degrees::DegreeAxis;
use sandtable_geom::position::fault::PositionError;
use sandtable_geom::position::{Position, parse_angle};
use sandtable_vector::error::VectorError;
use sandtable_vector::feature::Feature;
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read;

/// A position and its text.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenPosition<'a> {
    /// The position in the system that is asked for; finite.
    pub at: DVec2,
    /// Its x and y: as they are written where they are two numbers.
    pub written: [Cow<'a, str>; 2],
    /// The side in meters of the square that a grid reference names, whose middle the position is.
    pub side_m: Option<f64>,
    /// Whether it was brought from WGS 84 to the system that is asked for.
    pub is_brought: bool,
}

/// A position of an argument, in no system as yet.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionArgument {
    /// The position.
    pub position: Position,
    text: String,
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

/// A CSV table that does not hold positions.
pub type PositionsError = LineError<PositionLineFault>;

/// Why a line is not a position.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PositionLineFault {
    /// A header does not name the columns of positions.
    #[error(
        "the header '{0}' must name columns x and y, or lon and lat, or one such as mgrs, utm or position; without a header, \
         each line begins with numbers x,y or is a position"
    )]
    Header(String),
    /// A line does not hold numbers.
    #[error("found '{0}', each line must hold numbers x,y, or a position such as 16S GF 50000 18000")]
    Line(String),
    /// A line holds a position that is wrong.
    #[error("{}", .0.with_forms())]
    Position(Box<PositionError>),
    /// A position has no coordinates in the system.
    #[error(transparent)]
    System(Box<CrsError>),
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

impl PositionArgument {
    /// The position of a text.
    ///
    /// # Errors
    /// As [`Position::parse`].
    pub fn parse(text: &str) -> Result<Self, PositionError> {
        Ok(Self { position: Position::parse(text)?, text: text.to_owned() })
    }

    /// The position in `crs`; two numbers are those of `crs`.
    ///
    /// # Errors
    /// As [`Position::in_system`].
    pub fn written(&self, crs: &Crs) -> Result<WrittenPosition<'static>, CrsError> {
        match self.text.split_once(',').and_then(|(x, y)| WrittenPosition::numbers(x.trim(), y.trim())) {
            Some(numbers) => {
                let written = numbers.written.map(|number| number.into_owned().into());
                Ok(WrittenPosition { written, ..numbers })
            }
            None => WrittenPosition::brought(&self.position, crs),
        }
    }
}

impl fmt::Display for PositionArgument {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.text)
    }
}

/// The positions of a text: one, or several with semicolons or spaces between.
///
/// # Errors
/// What is wrong with the first that is none, with the forms that positions have.
pub fn position_list(text: &str) -> Result<Vec<PositionArgument>, String> {
    let whole = match PositionArgument::parse(text) {
        Ok(position) => return Ok(vec![position]),
        Err(error) => error,
    };
    let parts: Vec<&str> = match text.contains(';') {
        true => text.split(';').map(str::trim).filter(|part| !part.is_empty()).collect(),
        false => text.split_whitespace().collect(),
    };
    let positions: Result<Vec<PositionArgument>, _> =
        parts.iter().map(|part| PositionArgument::parse(part)).collect();
    match positions {
        Ok(positions) if !positions.is_empty() => Ok(positions),
        Err(error) if whole.is_unlike_any() => Err(error.with_forms()),
        _ => Err(whole.with_forms()),
    }
}

impl<'a> WrittenPosition<'a> {
    fn numbers(x: &'a str, y: &'a str) -> Option<Self> {
        let at = DVec2::new(x.parse().ok()?, y.parse().ok()?);
        at.is_finite().then_some(Self { at, written: [x.into(), y.into()], side_m: None, is_brought: false })
    }

    /// A position, brought to `crs`.
    fn brought(position: &Position, crs: &Crs) -> Result<Self, CrsError> {
        let at = position.in_system(crs)?;
        // Millimeters, and less than that in degrees.
        let decimals = if crs.is_geographic() { 9 } else { 3 };
        let written = at.to_array().map(|number| Cow::Owned(format!("{number:.decimals$}")));
        Ok(Self { at, written, side_m: position.side_m(), is_brought: position.numbers().is_none() })
    }
}

/// The columns of a CSV table that hold positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionColumns {
    layout: PositionLayout,
    /// Whether the first line names them.
    pub has_header: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PositionLayout {
    /// Columns of x and y that a header names.
    Named { x: usize, y: usize, axes: NamedAxes },
    /// One column of positions.
    Column(usize),
    /// The whole line.
    Line,
    /// No header: numbers x,y in the first two fields, a position in the first, or a line that is one.
    Unnamed,
}

/// What columns of x and y are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NamedAxes {
    /// x and y, easting and northing.
    Plain,
    /// Longitude and latitude.
    Degrees,
}

/// The names of columns, lower case.
const PLAIN_NAMES: [&[&str]; 2] = [&["x", "easting", "east"], &["y", "northing", "north"]];
const DEGREE_NAMES: [&[&str]; 2] = [&["lon", "long", "lng", "longitude"], &["lat", "latitude"]];
const POSITION_NAMES: &[&str] = &[
    "mgrs",
    "usng",
    "utm",
    "grid",
    "grid reference",
    "grid_reference",
    "gridref",
    "grid ref",
    "position",
    "location",
    "coordinates",
    "coords",
    "coord",
];

impl PositionColumns {
    /// The columns that the first line of a table names, or the first fields where it names none.
    ///
    /// # Errors
    /// [`PositionLineFault::Header`].
    pub fn of_first_line(line: &str) -> Result<Self, PositionLineFault> {
        let is_position =
            |text: &str| Position::parse(text).is_ok_and(|position| position.numbers().is_none());
        if !is_header(line) || is_position(line) || fields(line).next().is_some_and(is_position) {
            return Ok(Self { layout: PositionLayout::Unnamed, has_header: false });
        }
        let with = |layout| Ok(Self { layout, has_header: true });
        let names: Vec<String> = fields(line).map(str::to_lowercase).collect();
        let find = |accepted: &[&str]| names.iter().position(|name| accepted.contains(&name.as_str()));
        let axis = |axis: usize| find(&[PLAIN_NAMES[axis], DEGREE_NAMES[axis]].concat());
        if let (Some(x), Some(y)) = (axis(0), axis(1)) {
            let are_degrees =
                [x, y].iter().zip(DEGREE_NAMES).all(|(&at, known)| known.contains(&names[at].as_str()));
            let axes = if are_degrees { NamedAxes::Degrees } else { NamedAxes::Plain };
            return with(PositionLayout::Named { x, y, axes });
        }
        if POSITION_NAMES.contains(&line.trim().trim_matches('"').to_lowercase().as_str()) {
            return with(PositionLayout::Line);
        }
        let column = find(POSITION_NAMES).ok_or_else(|| PositionLineFault::Header(line.into()))?;
        with(PositionLayout::Column(column))
    }

    /// The position in a line, in `crs`.
    ///
    /// # Errors
    /// The line holds none, or it has no coordinates in `crs`.
    pub fn position<'a>(&self, line: &'a str, crs: &Crs) -> Result<WrittenPosition<'a>, PositionLineFault> {
        let field = |column: usize| fields(line).nth(column).unwrap_or_default();
        let position = match self.layout {
            PositionLayout::Named { x, y, axes } => {
                let (x, y) = (field(x), field(y));
                if let Some(numbers) = WrittenPosition::numbers(x, y) {
                    return Ok(numbers);
                }
                named_angles(x, y, axes).unwrap_or_else(|| Err(PositionLineFault::Line(line.into())))?
            }
            PositionLayout::Column(column) => parsed(field(column))?,
            PositionLayout::Line => parsed(line.trim().trim_matches('"'))?,
            PositionLayout::Unnamed => {
                if let Some(numbers) = WrittenPosition::numbers(field(0), field(1)) {
                    return Ok(numbers);
                }
                unnamed(line, field(0))?
            }
        };
        WrittenPosition::brought(&position, crs).map_err(|error| PositionLineFault::System(Box::new(error)))
    }
}

impl PositionLineFault {
    fn position(error: PositionError) -> Self {
        Self::Position(Box::new(error))
    }
}

fn parsed(text: &str) -> Result<Position, PositionLineFault> {
    Position::parse(text).map_err(PositionLineFault::position)
}

/// The place of two angles in columns of their own; `None` where they are not angles.
fn named_angles(x: &str, y: &str, axes: NamedAxes) -> Option<Result<Position, PositionLineFault>> {
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    // Numbers in columns x and y are those of the system, of which none goes with an angle.
    let is_mixed = axes == NamedAxes::Plain && (is_number(x) || is_number(y));
    let has_digits = |text: &str| text.bytes().any(|byte| byte.is_ascii_digit());
    if is_mixed || !has_digits(x) || !has_digits(y) {
        return None;
    }
    let longitude = parse_angle(x, DegreeAxis::Longitude);
    let place = longitude.and_then(|x| Ok(DVec2::new(x, parse_angle(y, DegreeAxis::Latitude)?)));
    Some(place.map(Position::on_earth).map_err(PositionLineFault::position))
}

/// The position of a line without a header: all of it, or its first field.
fn unnamed(line: &str, first: &str) -> Result<Position, PositionLineFault> {
    let whole = match Position::parse(line) {
        Ok(position) => return Ok(position),
        Err(error) => error,
    };
    match Position::parse(first) {
        Ok(position) => Ok(position),
        // What is wrong is said of a line that looks like a position; others have no numbers.
        Err(_) if !whole.is_unlike_any() => Err(PositionLineFault::position(whole)),
        Err(error) if error.is_unlike_any() => Err(PositionLineFault::Line(line.into())),
        Err(error) => Err(PositionLineFault::position(error)),
    }
}

/// The positions of a CSV table in `crs`, of which its numbers are. A header names columns `x` and `y` (or `lon` and `lat`),
/// or one of positions, such as `mgrs`; without one, numbers or a position come first. `name` is the file's name in messages.
///
/// # Errors
/// A line is not a position, or has no coordinates in `crs`, or the header does not name the columns.
pub fn parse_positions<'a>(
    name: &str,
    text: &'a str,
    crs: &Crs,
) -> Result<Vec<WrittenPosition<'a>>, PositionsError> {
    let mut lines = numbered_lines(text).peekable();
    let at_line = |line| move |fault| LineError { name: name.to_owned(), line, fault };
    let Some(&(first, line)) = lines.peek() else { return Ok(Vec::new()) };
    let columns = PositionColumns::of_first_line(line).map_err(at_line(first))?;
    lines
        .skip(usize::from(columns.has_header))
        .map(|(line, text)| columns.position(text, crs).map_err(at_line(line)))
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
    let crs = stated.unwrap_or_else(|| native.clone());
    let vertices: Vec<DVec2> =
        parse_positions(&name, &text, &crs)?.iter().map(|position| position.at).collect();
    match vertices.len() {
        found @ 0..2 => Err(ReadLineError::TooShort { name, found }),
        _ => Ok(InputLine { vertices, crs, notes: Vec::new() }),
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

/// A sentence about the shift between the datums of two systems, where that is not exact.
pub fn shift_note(from: &Crs, to: &Crs) -> Option<String> {
    // A shift that is not known is an error of the query.
    let Ok(shift @ DatumShift::ByWgs84 { .. }) = from.datum_shift_to(to) else { return None };
    let (from, to, most_m) = (from.name(), to.name(), shift.accuracy_m().unwrap_or_default());
    Some(format!(
        "positions are brought from {from} to {to} by the datum shift {shift}, good to about {most_m} m"
    ))
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
        let positions = parse_positions("p.csv", text, &Crs::local()).expect("sound");
        positions.iter().map(|position| position.at).collect()
    }

    fn in_zone(text: &str) -> Vec<DVec2> {
        let zone = Crs::from_epsg(32616).expect("a zone");
        let positions = parse_positions("p.csv", text, &zone).unwrap_or_else(|error| panic!("{error}"));
        positions.iter().map(|position| position.at).collect()
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
            let error = parse_positions("p.csv", text, &Crs::local()).expect_err(text).to_string();
            assert!(error.contains(place), "{error}");
        }
    }

    #[test]
    fn a_table_may_hold_positions_in_a_column_or_a_line_each() {
        let at = DVec2::new(750_050.0, 4_018_050.0);
        for text in [
            "16SGF500180",
            "16S GF 500 180",
            "16SGF500180,the hill",
            "mgrs\n16S GF 500 180",
            "grid reference\n16S GF 500 180\n",
            "name,MGRS\nthe hill,16S GF 500 180",
            "\"name\";\"position\"\n\"hill; and lake\";\"16N 750050, 4018050\"",
            "x,y\n750050,4018050",
            "name,utm\nhill,16N 750050 4018050",
        ] {
            assert_eq!(in_zone(text), [at], "{text}");
        }
        assert_eq!(in_zone("750050,4018050\n16SGF500180\n"), [at, at]);
    }

    #[test]
    fn columns_of_longitude_and_latitude_may_hold_degrees_minutes_and_seconds() {
        let [plain] = in_zone("36.2775N 84.215W")[..] else { panic!("one") };
        for text in [
            "lat,lon\n36°16'39\"N,84°12'54\"W",
            "lat;lon\n\"36°16'39\"\"\";\"-84°12'54\"\"\"",
            "lon,lat\n84 12.9 W,36 16.65 N",
            "x,y\n84°12'54\"W,36°16'39\"N",
            "position,x1\n\"36.2775N, 84.215W\",1",
        ] {
            assert!(in_zone(text)[0].distance(plain) < 0.01, "{text}: {:?}, {plain}", in_zone(text));
        }
        // Numbers are those of the system that is asked for.
        assert_eq!(in_zone("lon,lat\n750050,4018050"), [DVec2::new(750_050.0, 4_018_050.0)]);
    }

    #[test]
    fn a_wrong_position_of_a_table_has_its_line_and_what_is_wrong() {
        let zone = Crs::from_epsg(32616).expect("a zone");
        for (text, part) in [
            ("mgrs\n16SGF500180\n16SGF50018\n", "p.csv:3: '16SGF50018' is not a grid reference: its digits"),
            ("16SGF500180\n16S 755447 4024162\n", "p.csv:2: '16S 755447 4024162' can be read as"),
            ("lat,lon\n84W,36N\n", "p.csv:2: '36N' is not a longitude"),
            ("x,y\n84W,36\n", "p.csv:2: found '84W,36'"),
            ("name,place\nhill,16SGF500180\n", "p.csv:1: the header 'name,place'"),
        ] {
            let error = parse_positions("p.csv", text, &zone).expect_err(text).to_string();
            assert!(error.contains(part), "{error}");
        }
        let nowhere = parse_positions("p.csv", "16SGF500180", &Crs::local()).expect_err("no place");
        assert!(nowhere.to_string().contains("p.csv:1:"), "{nowhere}");
    }
}
