//! `sandtable profile`: the ground along a line, as a table or JSON, and as a chart.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::options::{ChartArguments, DatasetArguments};
use crate::output::{print, stream, warn};
use crate::positions::{PositionPrinter, PositionsArguments, placed};
use crate::values::{PositionList, choice, positions};
use sandtable_annotate::chart_profile::paint;
use sandtable_files::disk;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, QueryError, transform};
use sandtable_query::positions::{InputLine, read_line};
use sandtable_query::profile::{GroundProfile, ProfileError};
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_terrain::profile::{Extreme, ProfileStation, Sampling};
use sandtable_terrain::query::Interpolation;

#[derive(Debug, Args)]
#[command(
    after_help = "The table has station,x,y,height,status a line: meters from the start, the position in the coordinate\n\
                  system of the line, meters. There is a station wherever the ground bends, and on the model's border."
)]
pub struct ProfileArguments {
    #[command(flatten)]
    pub dataset: DatasetArguments,
    /// The line: --line X,Y X,Y and so on, or other positions; in quotes where one has spaces or begins with a minus sign
    #[arg(long, value_name = "POSITION", allow_hyphen_values = true, required_unless_present = "points", value_parser = positions)]
    pub line: Vec<PositionList>,
    /// The line's other vertices
    #[arg(value_name = "POSITION", requires = "line", hide = true, value_parser = positions)]
    pub rest: Vec<PositionList>,
    /// A file with the line: x,y or a position a line of CSV, or the first line of a vector file; - reads CSV from standard input
    #[arg(long, value_name = "FILE", conflicts_with = "line")]
    pub points: Option<PathBuf>,
    /// The interpolation of heights between posts
    #[arg(long, default_value = "planar", value_parser = choice::<Interpolation>())]
    pub interpolation: Interpolation,
    /// Also a station every so many meters
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub step: Option<f64>,
    #[command(flatten)]
    pub positions: PositionsArguments,
    #[command(flatten)]
    pub chart: ChartArguments,
}

pub fn run(arguments: &ProfileArguments) -> Result<(), CliError> {
    arguments.chart.check(&arguments.dataset.file)?;
    let dataset = arguments.dataset.open()?;
    let line = line(arguments, &dataset)?;
    let line_crs = line.crs.clone();
    let printer = arguments.positions.printer(&line_crs)?;
    let reach = GroundReach { crs: &line.crs, at: &line.vertices, around_m: 0.0 };
    let ground = arguments.dataset.ground(&dataset, &reach)?;
    let sampling = Sampling { interpolation: arguments.interpolation, step_m: arguments.step };
    let profile = GroundProfile::new(&ground, line, sampling).map_err(|error| match error {
        ProfileError::Query(error) => error.into(),
        step => CliError::usage(format!("--step: {step}")),
    })?;
    if let Some(path) = &arguments.chart.output {
        let size = arguments.chart.size;
        let chart = profile.chart(arguments.dataset.chart_title("Profile"));
        disk::write_picture(path, &paint((size.width, size.height), &chart))?;
    }
    if arguments.dataset.json {
        return print(&format!("{}\n", json(&profile, printer)?));
    }
    stream(|out| write_csv(out, &profile, printer))
}

fn line(arguments: &ProfileArguments, dataset: &Dataset) -> Result<InputLine, CliError> {
    if let Some(path) = &arguments.points {
        let line = read_line(path, arguments.dataset.crs.clone(), &dataset.crs())?;
        line.notes.iter().for_each(|note| warn(&format!("note: {}: {note}", disk::display_name(path))));
        return Ok(line);
    }
    let positions: PositionList = arguments.line.iter().chain(&arguments.rest).flatten().cloned().collect();
    if positions.len() < 2 {
        return Err(CliError::usage("--line needs at least two positions: --line X,Y X,Y"));
    }
    let crs = arguments.dataset.crs(dataset);
    let vertices = placed("--line", &positions, &crs)?.iter().map(|position| position.at).collect();
    Ok(InputLine { vertices, crs, notes: Vec::new() })
}

fn write_csv(out: &mut dyn Write, profile: &GroundProfile, printer: PositionPrinter<'_>) -> io::Result<()> {
    writeln!(out, "station,{},height,status", printer.columns())?;
    for (station, at) in profile.stations.iter().zip(&profile.positions) {
        let height = station.ground.height_m().map(|height_m| height_m.to_string()).unwrap_or_default();
        let position = printer.row(*at, || format!("{},{}", at.x, at.y));
        writeln!(out, "{},{position},{height},{}", station.station_m, station.ground.status())?;
    }
    Ok(())
}

fn json(profile: &GroundProfile, printer: PositionPrinter<'_>) -> Result<Value, QueryError> {
    let station = |(station, at): (&ProfileStation, &DVec2)| {
        let mut object = json!({
            "station": station.station_m,
            "x": at.x,
            "y": at.y,
            "height": station.ground.height_m(),
            "status": station.ground.status(),
        });
        printer.add_to(&mut object, *at);
        object
    };
    let (summary, crs, ground_crs) = (&profile.summary, &profile.line.crs, &profile.ground_crs);
    Ok(json!({
        "crs": crs.name(),
        "straight_in": ground_crs.name(),
        "length_m": summary.length_m,
        "covered_m": summary.covered_m,
        "ground_length_m": summary.ground_length_m,
        "ascent_m": summary.ascent_m,
        "descent_m": summary.descent_m,
        "lowest": extreme(summary.lowest, ground_crs, (crs, printer))?,
        "highest": extreme(summary.highest, ground_crs, (crs, printer))?,
        "stations": profile.stations.iter().zip(&profile.positions).map(station).collect::<Vec<_>>(),
    }))
}

fn extreme(
    place: Option<Extreme>,
    from: &Crs,
    (to, printer): (&Crs, PositionPrinter<'_>),
) -> Result<Value, QueryError> {
    let Some(Extreme { station_m, at, height_m }) = place else { return Ok(Value::Null) };
    let at = transform("the station at", from, to, at)?;
    let mut object = json!({"station": station_m, "x": at.x, "y": at.y, "height": height_m});
    printer.add_to(&mut object, at);
    Ok(object)
}
