//! `sandtable height`: heights at points, as CSV or JSON.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::DVec2;
use serde_json::json;

use crate::app::arguments::{Access, InterpolationChoice, StatedHeights};
use crate::app::dataset::Dataset;
use crate::app::failure::Failure;
use crate::app::{files, output};
use crate::geom::crs::Crs;
use crate::terrain::query::{Answer, Surface};

/// `height`.
#[derive(Debug, Args)]
#[command(
    after_help = "Heights are metres, whatever unit the file has. A point without one has a status that says why:\n\
                        NoData where the model has a hole, Outside beyond it."
)]
pub struct HeightOptions {
    /// The elevation file or scene
    pub file: PathBuf,
    /// A point; may be given several times
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, required_unless_present = "points")]
    pub at: Vec<Position>,
    /// A CSV file of x,y, with or without a header; - reads standard input
    #[arg(long, value_name = "CSV", conflicts_with = "at")]
    pub points: Option<PathBuf>,
    /// The coordinate system of the points, for example EPSG:4326 for longitude,latitude [default: the file's, or the
    /// scene's]
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// Which surface is asked [default: source of a file, ground of a scene]
    #[arg(long, value_enum)]
    pub surface: Option<SurfaceChoice>,
    /// How heights between posts are found
    #[arg(long, value_enum, default_value_t)]
    pub interpolation: InterpolationChoice,
    /// Print a JSON array with one object per point
    #[arg(long)]
    pub json: bool,
    /// What grey values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
    /// What may be read.
    #[command(flatten)]
    pub access: Access,
}

/// A surface by its name on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SurfaceChoice {
    /// The raster as read, in its own grid
    Source,
    /// The ground in metres, after a scene's earthworks
    Ground,
    /// The higher of the ground and the decks over it
    Scene,
}

impl From<SurfaceChoice> for Surface {
    fn from(choice: SurfaceChoice) -> Self {
        match choice {
            SurfaceChoice::Source => Self::Source,
            SurfaceChoice::Ground => Self::Ground,
            SurfaceChoice::Scene => Self::Scene,
        }
    }
}

/// A position of the command line and how it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    at: DVec2,
    written: [String; 2],
}

impl FromStr for Position {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once(',').and_then(|(x, y)| {
            let written = [x.trim(), y.trim()];
            let at = DVec2::new(written[0].parse().ok()?, written[1].parse().ok()?);
            at.is_finite().then(|| Self { at, written: written.map(str::to_owned) })
        });
        parsed.ok_or_else(|| "write two numbers as in 530250,4021300".into())
    }
}

/// Prints `x,y,height,status` for every point, in order; x and y as they were written.
///
/// # Errors
/// The file, the scene or the points cannot be had or read, or the points cannot be brought to its coordinate system.
pub fn run(options: &HeightOptions) -> Result<(), Failure> {
    let stated = options.crs.as_deref().map(Crs::parse).transpose();
    let stated = stated.map_err(|error| Failure::Usage(format!("--crs: {error}")))?;
    let dataset = Dataset::open(&options.file, options.heights, &options.access)?;
    let text = options.points.as_deref().map(files::read_text).transpose()?;
    let points = match (&options.points, &text) {
        (Some(path), Some(text)) => parse_points(&files::text_name(path), text)?,
        _ => options.at.iter().map(Point::of).collect(),
    };
    let at: Vec<DVec2> = points.iter().map(|point| point.at).collect();
    let surface = options.surface.map_or(dataset.usual_surface(), Surface::from);
    let crs = stated.unwrap_or_else(|| dataset.crs());
    let mut answers = vec![Answer::Outside; points.len()];
    dataset.heights(surface, options.interpolation.into(), &crs, &at, &mut answers)?;
    let mut out = BufWriter::new(io::stdout().lock());
    output::forgive_leaving(match options.json {
        true => write_json(&mut out, &points, &answers),
        false => write_csv(&mut out, &points, &answers),
    })
}

fn write_csv(out: &mut impl Write, points: &[Point<'_>], answers: &[Answer]) -> io::Result<()> {
    writeln!(out, "x,y,height,status")?;
    for (point, answer) in points.iter().zip(answers) {
        let [x, y] = point.written;
        match answer.height_m() {
            Some(height) => writeln!(out, "{x},{y},{height},{}", answer.status())?,
            None => writeln!(out, "{x},{y},,{}", answer.status())?,
        }
    }
    out.flush()
}

/// One object a line; a height that there is not is null.
fn write_json(out: &mut impl Write, points: &[Point<'_>], answers: &[Answer]) -> io::Result<()> {
    write!(out, "[")?;
    for (index, (point, answer)) in points.iter().zip(answers).enumerate() {
        let object = json!({
            "x": point.at.x, "y": point.at.y, "height": answer.height_m(), "status": answer.status()
        });
        write!(out, "{}\n  {object}", if index == 0 { "" } else { "," })?;
    }
    writeln!(out, "\n]")?;
    out.flush()
}

/// A point and how it was written.
#[derive(Debug, PartialEq)]
struct Point<'a> {
    at: DVec2,
    written: [&'a str; 2],
}

impl<'a> Point<'a> {
    fn of(position: &'a Position) -> Self {
        let [x, y] = &position.written;
        Self { at: position.at, written: [x, y] }
    }
}

/// The points of a CSV text: a header that names columns `x` and `y` (or `lon` and `lat`), or none and x, y first.
fn parse_points<'a>(name: &str, text: &'a str) -> Result<Vec<Point<'a>>, Failure> {
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
                Failure::input(format!(
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
                Failure::input(format!("{name}:{place}: found '{line}', each line must hold numbers x,y"))
            })
        })
        .collect()
}

fn parse_point(line: &str, columns: [usize; 2]) -> Option<Point<'_>> {
    let fields: Vec<&str> = fields(line).collect();
    let written = [*fields.get(columns[0])?, *fields.get(columns[1])?];
    let at = DVec2::new(written[0].parse().ok()?, written[1].parse().ok()?);
    at.is_finite().then_some(Point { at, written })
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
        let Err(Failure::Input(reason)) = parse_points("p.csv", "x,y\n1,2\n3,north\n") else {
            panic!("accepted");
        };
        assert!(reason.contains("p.csv:3:") && reason.contains("3,north"), "{reason}");
    }
}
