//! `sandtable viewshed`: the posts that can be seen from a point, as a map, a raster or a few figures.

use std::fmt::Write;
use std::ops::Bound;
use std::path::{Path, PathBuf};
use std::slice;

use clap::Args;
use glam::DVec2;
use serde_json::json;

use crate::error::CliError;
use crate::los::curvature;
use crate::options::DatasetArguments;
use crate::output::{print, print_lines, row};
use crate::output_format::raster_format;
use crate::positions::{PositionsArguments, placed_one};
use crate::progress::StepTimer;
use crate::values::{number, number_pair, position};
use sandtable_dem::dem_format::DemFormat;
use sandtable_files::{disk, raster_file};
use sandtable_query::dataset::{QueryError, transform};
use sandtable_query::ground::QueriedGround;
use sandtable_query::positions::PositionArgument;
use sandtable_query::viewshed::{ViewshedSummary, raster, windows};
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_sheet::viewshed_map::{SheetText, viewshed_map};
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{Sector, Viewshed, ViewshedCounts, ViewshedOptions, viewshed};

const HEIGHT_ADVICE: &str = "write meters as a number from 0 to 100000";

#[derive(Debug, Args)]
#[command(
    after_help = "A raster holds 1 where a target can be seen, 0 where it is hidden, and 255, its no-data value, beyond the \
                  range, out of the sector and where there is no elevation."
)]
pub struct ViewshedArguments {
    #[command(flatten)]
    pub dataset: DatasetArguments,
    /// The position of the observer: X,Y, a grid reference, UTM, or latitude and longitude with letters
    #[arg(long, value_name = "POSITION", allow_hyphen_values = true, value_parser = position)]
    pub at: PositionArgument,
    #[command(flatten)]
    pub positions: PositionsArguments,
    #[command(flatten)]
    pub conditions: SightConditions,
    /// Look only between two azimuths, in degrees clockwise from north
    #[arg(long, value_name = "FROM,TO", allow_hyphen_values = true, value_parser = number_pair)]
    pub sector: Option<[f64; 2]>,
    /// Write the answer to this file: a map as .png, or a raster as .tif, .asc, .flt, .bil, .bt or .xyz
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
}

/// How an observer looks.
#[derive(Debug, Args)]
pub struct SightConditions {
    /// Meters of the eye above the ground
    #[arg(long, value_name = "METERS", default_value = "2", value_parser = number::<f64>(0.0..=1e5, HEIGHT_ADVICE))]
    pub observer_height: f64,
    /// Meters of the target above the ground
    #[arg(long, value_name = "METERS", default_value = "0", value_parser = number::<f64>(0.0..=1e5, HEIGHT_ADVICE))]
    pub target_height: f64,
    /// How far to look, in meters [default: without limit]
    #[arg(long, value_name = "METERS", value_parser = number::<f64>((Bound::Excluded(0.0), Bound::Unbounded), "write meters as a number above 0"))]
    pub range: Option<f64>,
    /// The share of the Earth's curvature that refraction cancels
    #[arg(long, value_name = "K", default_value_t = 1.0 / 7.0, value_parser = number::<f64>(-1.0..1.0, "write a number from -1 to below 1; 0.13 to 0.17 is usual"))]
    pub refraction: f64,
    /// Assume a flat Earth without air
    #[arg(long, conflicts_with = "refraction")]
    pub flat: bool,
}

/// A file to write.
enum ViewshedOutput<'a> {
    Map(&'a Path),
    Raster(&'a Path, &'static DemFormat),
}

pub fn run(arguments: &ViewshedArguments) -> Result<(), CliError> {
    let output = arguments.output.as_deref().map(|path| output(path, &arguments.dataset.file)).transpose()?;
    let steps = StepTimer::default();
    steps.begin("reading the ground");
    let dataset = arguments.dataset.open()?;
    let crs = arguments.dataset.crs(&dataset);
    let printer = arguments.positions.printer(&crs)?;
    let at = placed_one("--at", &arguments.at, &crs)?;
    let around_m = arguments.conditions.range.unwrap_or(f64::INFINITY);
    let reach = GroundReach { crs: &crs, at: &[at], around_m };
    let ground = arguments.dataset.ground(&dataset, &reach)?;
    let options = options(arguments, transform("the observer at", &crs, &ground.crs, at)?);
    steps.begin("looking around");
    let viewshed = viewshed(&ground.lattice, &options).map_err(|answer| QueryError::NoGround {
        what: "the observer at".into(),
        at,
        answer,
    })?;
    let summary = ViewshedSummary::new(&ground.lattice, &viewshed);
    if let Some(output) = output {
        steps.begin("writing");
        write(arguments, &output, &ground, &options, &viewshed)?;
    }
    steps.finish();
    if arguments.dataset.json {
        let mut answer = json(arguments, &options, &summary);
        printer.add_to(&mut answer["observer"], at);
        print(&format!("{answer:#}\n"))
    } else {
        let observer = printer.text(at).map(|position| row(9, "observer", position));
        print_lines(&text(arguments, &summary, observer))
    }
}

fn output<'a>(path: &'a Path, input: &PathBuf) -> Result<ViewshedOutput<'a>, CliError> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        disk::check_output(path, &[input])?;
        return Ok(ViewshedOutput::Map(path));
    }
    Ok(ViewshedOutput::Raster(path, raster_format(path, slice::from_ref(input))?))
}

/// The options for an observer at `at` in the ground's system.
fn options(arguments: &ViewshedArguments, at: DVec2) -> ViewshedOptions {
    ViewshedOptions {
        observer: SightEnd { at, above_m: arguments.conditions.observer_height },
        target_above_m: arguments.conditions.target_height,
        range_m: arguments.conditions.range.unwrap_or(f64::INFINITY),
        sector: arguments.sector.map_or(Sector::ALL, |[from, to]| Sector::between(from, to)),
        curvature: curvature(arguments.conditions.flat, Some(arguments.conditions.refraction)),
    }
}

fn write(
    arguments: &ViewshedArguments,
    output: &ViewshedOutput<'_>,
    ground: &QueriedGround,
    options: &ViewshedOptions,
    viewshed: &Viewshed,
) -> Result<(), CliError> {
    // What is held is the square around the range, where that is not all.
    let lattice = &*ground.held_lattice()?;
    match output {
        ViewshedOutput::Raster(path, format) => {
            let file = &arguments.dataset.file;
            let mut windows = windows(lattice, viewshed, &ground.crs);
            if raster_file::write_windows(&mut windows, format, path, file)?.is_none() {
                let raster = raster(lattice, viewshed, &ground.crs);
                raster_file::write(&raster, format, path, slice::from_ref(file))?;
            }
        }
        ViewshedOutput::Map(path) => {
            let text = SheetText {
                title: format!("Viewshed · {}", disk::file_stem(&arguments.dataset.file)),
                subtitle: subtitle(arguments, &ViewshedSummary::new(&ground.lattice, viewshed)),
                vertical_datum: ground.vertical_datum.clone(),
            };
            disk::write_picture(path, &viewshed_map((lattice, &ground.crs), viewshed, options, text))?;
        }
    }
    Ok(())
}

fn subtitle(arguments: &ViewshedArguments, summary: &ViewshedSummary) -> String {
    let mut subtitle = format!("Eye {} m above ground", arguments.conditions.observer_height);
    if arguments.conditions.target_height > 0.0 {
        let _ = write!(subtitle, ", target {} m", arguments.conditions.target_height);
    }
    if let Some(range) = arguments.conditions.range {
        let _ = write!(subtitle, ", within {range} m");
    }
    if let Some([from, to]) = arguments.sector {
        let _ = write!(subtitle, ", azimuth {from}° to {to}°");
    }
    let _ = write!(subtitle, "; {:.1} % in sight", summary.visible_share * 100.0);
    subtitle + if arguments.conditions.flat { "; flat Earth" } else { "; curvature and refraction applied" }
}

fn json(
    arguments: &ViewshedArguments,
    options: &ViewshedOptions,
    summary: &ViewshedSummary,
) -> serde_json::Value {
    let ViewshedCounts { visible, hidden, no_data, beyond } = summary.counts;
    let observer = options.observer;
    json!({
        "observer": { "x": observer.at.x, "y": observer.at.y, "above_m": observer.above_m },
        "target_above_m": options.target_above_m,
        "range_m": arguments.conditions.range,
        "sector_deg": arguments.sector,
        "refraction": (!arguments.conditions.flat).then_some(arguments.conditions.refraction),
        "posts": { "visible": visible, "hidden": hidden, "no_data": no_data, "beyond": beyond },
        "visible_m2": summary.visible_m2,
        "visible_share": summary.visible_share,
        "output": arguments.output.as_ref().map(|path| path.display().to_string()),
    })
}

fn text(arguments: &ViewshedArguments, summary: &ViewshedSummary, observer: Option<String>) -> Vec<String> {
    let ViewshedCounts { visible, hidden, no_data, beyond } = summary.counts;
    let mut lines: Vec<String> = arguments.output.iter().map(|path| path.display().to_string()).collect();
    lines.extend(observer);
    let (km2, percent) = (summary.visible_m2 / 1e6, summary.visible_share * 100.0);
    lines.push(row(9, "in sight", format!("{km2:.3} km², {percent:.2} % of what was looked at")));
    let posts = format!("{visible} visible, {hidden} hidden, {no_data} without data, {beyond} beyond");
    lines.push(row(9, "posts", posts));
    lines
}
