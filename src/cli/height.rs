//! `sandtable height`: heights at points, as CSV or JSON.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use glam::DVec2;
use serde_json::json;

use crate::error::CliError;
use crate::options::DatasetArguments;
use crate::output::{stream, warn};
use crate::positions::{PositionPrinter, PositionsArguments, note, placed};
use crate::values::{choice, position};
use sandtable_files::disk;
use sandtable_files::error::FileError;
use sandtable_geom::geoid::Geoid;
use sandtable_query::heights_above::bring_heights;
use sandtable_query::outside_note::outside_note;
use sandtable_query::positions::{PositionArgument, WrittenPosition, parse_positions};
use sandtable_raster::answer::Answer;
use sandtable_raster::height_datum::HeightDatum;
use sandtable_shards::heights::csv::write_row;
use sandtable_terrain::query::{Interpolation, Surface};

#[derive(Debug, Args)]
#[command(
    after_help = "Heights are meters, whatever unit the file has. A point without a height has a status that says why:\n\
                  NoData where the model has a hole, Outside beyond it.\n\
                  x and y of a position in words are those in the system of positions."
)]
pub struct HeightQueryArguments {
    #[command(flatten)]
    pub dataset: DatasetArguments,
    /// A point: X,Y, a grid reference, UTM, or latitude and longitude with letters; may be given several times
    #[arg(long, value_name = "POSITION", allow_hyphen_values = true, required_unless_present = "points", value_parser = position)]
    pub at: Vec<PositionArgument>,
    /// A CSV file of x,y or positions, with or without a header; - reads standard input
    #[arg(long, value_name = "CSV", conflicts_with = "at")]
    pub points: Option<PathBuf>,
    #[command(flatten)]
    pub query: PointQueryArguments,
    #[command(flatten)]
    pub positions: PositionsArguments,
}

/// What is asked about each point.
#[derive(Debug, Args)]
pub struct PointQueryArguments {
    /// The surface to query [default: source of a file, ground of a scene]
    #[arg(long, value_parser = choice::<Surface>())]
    pub surface: Option<Surface>,
    /// The interpolation of heights between posts
    #[arg(long, default_value = "bilinear", value_parser = choice::<Interpolation>())]
    pub interpolation: Interpolation,
    /// Heights above the WGS 84 ellipsoid or the EGM96 geoid [default: the datum of the model]
    #[arg(long, value_parser = choice::<HeightDatum>())]
    pub above: Option<HeightDatum>,
}

/// Prints `x,y,height,status` for every point, in order; x and y as they were written.
pub fn run(arguments: &HeightQueryArguments) -> Result<(), CliError> {
    let dataset = arguments.dataset.open()?;
    let text = arguments.points.as_deref().map(disk::read_text).transpose()?;
    let crs = arguments.dataset.crs(&dataset);
    let printer = arguments.positions.printer(&crs)?;
    let points = match (&arguments.points, &text) {
        (Some(path), Some(text)) => {
            let points = parse_positions(&disk::display_name(path), text, &crs)?;
            note(&points, &crs);
            points
        }
        _ => placed("--at", &arguments.at, &crs)?,
    };
    let at: Vec<DVec2> = points.iter().map(|point| point.at).collect();
    let surface = arguments.query.surface.unwrap_or_else(|| dataset.default_surface());
    if surface != Surface::Source {
        arguments.dataset.note_ground(&dataset)?;
    }
    let mut answers = dataset.heights(surface, arguments.query.interpolation, &crs, &at)?;
    let outside = outside_note(&answers, &at, &crs, &dataset.header());
    outside.iter().for_each(|note| warn(&format!("note: {note}")));
    let mut datum = dataset.header().vertical_datum.clone();
    if let Some(above) = arguments.query.above {
        let brought = bring_heights(&mut answers, (datum.as_deref(), above), (&crs, &at), &Geoid::default());
        brought.map_err(FileError::at(&arguments.dataset.file))?;
        datum = Some(above.name().to_owned());
    }
    stream(|out| match arguments.dataset.json {
        true => write_json(out, (&points, printer), &answers, datum.as_deref()),
        false => write_csv(out, (&points, printer), &answers),
    })
}

fn write_csv(
    out: &mut dyn Write,
    (points, printer): (&[WrittenPosition<'_>], PositionPrinter<'_>),
    answers: &[Answer],
) -> io::Result<()> {
    writeln!(out, "{},height,status", printer.columns())?;
    points.iter().zip(answers).try_for_each(|(point, &answer)| match printer.text(point.at) {
        None => write_row(out, point, answer),
        Some(position) => {
            let height = answer.height_m().map(|height_m| height_m.to_string()).unwrap_or_default();
            writeln!(out, "{position},{height},{}", answer.status())
        }
    })
}

/// Writes one object a line; a missing height is null. What heights are counted from is there where it is known.
fn write_json(
    out: &mut dyn Write,
    (points, printer): (&[WrittenPosition<'_>], PositionPrinter<'_>),
    answers: &[Answer],
    datum: Option<&str>,
) -> io::Result<()> {
    write!(out, "[")?;
    for (index, (point, answer)) in points.iter().zip(answers).enumerate() {
        let mut object = json!({
            "x": point.at.x, "y": point.at.y, "height": answer.height_m(), "status": answer.status()
        });
        printer.add_to(&mut object, point.at);
        if let Some(datum) = datum {
            object["vertical_datum"] = datum.into();
        }
        write!(out, "{}\n  {object}", if index == 0 { "" } else { "," })?;
    }
    writeln!(out, "\n]")
}
