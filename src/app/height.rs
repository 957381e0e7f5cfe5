//! `sandtable height`: heights at points, as CSV or JSON.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::DVec2;
use serde_json::json;

use crate::app::arguments::{Access, InterpolationChoice, StatedHeights};
use crate::app::dataset::Dataset;
use crate::app::failure::CliError;
use crate::app::places::stated_crs;
use crate::app::points::{WrittenPoint, parse_points};
use crate::app::{files, output};
use crate::terrain::query::{Answer, Surface};

/// `height`.
#[derive(Debug, Args)]
#[command(
    after_help = "Heights are meters, whatever unit the file has. A point without one has a status that says why:\n\
                        NoData where the model has a hole, Outside beyond it."
)]
pub struct HeightOptions {
    /// The elevation file or scene
    pub file: PathBuf,
    /// A point; may be given several times
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, required_unless_present = "points")]
    pub at: Vec<WrittenPosition>,
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
    /// What gray values mean.
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
    /// The ground in meters, after a scene's earthworks
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
pub struct WrittenPosition {
    at: DVec2,
    written: [String; 2],
}

impl FromStr for WrittenPosition {
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
pub fn run(options: &HeightOptions) -> Result<(), CliError> {
    let stated = stated_crs(options.crs.as_deref())?;
    let dataset = Dataset::open(&options.file, options.heights, &options.access)?;
    let text = options.points.as_deref().map(files::read_text).transpose()?;
    let points = match (&options.points, &text) {
        (Some(path), Some(text)) => parse_points(&files::text_name(path), text)?,
        _ => options.at.iter().map(WrittenPosition::point).collect(),
    };
    let at: Vec<DVec2> = points.iter().map(|point| point.at).collect();
    let surface = options.surface.map_or(dataset.usual_surface(), Surface::from);
    let crs = stated.unwrap_or_else(|| dataset.crs());
    let mut answers = vec![Answer::Outside; points.len()];
    dataset.heights(surface, options.interpolation.into(), &crs, &at, &mut answers)?;
    let mut out = BufWriter::new(io::stdout().lock());
    output::ignore_broken_pipe(match options.json {
        true => write_json(&mut out, &points, &answers),
        false => write_csv(&mut out, &points, &answers),
    })
}

fn write_csv(out: &mut impl Write, points: &[WrittenPoint<'_>], answers: &[Answer]) -> io::Result<()> {
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
fn write_json(out: &mut impl Write, points: &[WrittenPoint<'_>], answers: &[Answer]) -> io::Result<()> {
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

impl WrittenPosition {
    fn point(&self) -> WrittenPoint<'_> {
        let [x, y] = &self.written;
        WrittenPoint { at: self.at, written: [x, y] }
    }
}
