//! `sandtable dem convert`: an elevation file in another format, another system or with other cells.
//!
//! Without `--crs` and `--cell` the samples stay as they are, to the last bit where the format can hold them. What was
//! done to them is told: the system, the shift between datums, how they were resampled, what was rounded.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::app::arguments::StatedHeights;
use crate::app::dem::{self, StatedPlace};
use crate::app::failure::CliError;
use crate::app::progress::StepTimer;
use crate::app::{output, rasters};
use crate::dem::formats::DemFormat;
use crate::dem::raster::Raster;
use crate::dem::voids;
use crate::dem::warp::WarpError;
use crate::dem::warp::reproject::{Resampling, Warped, reproject};
use crate::dem::write::WrittenDem;
use crate::geom::crs::Crs;

/// A cell of more degrees than this was meant in meters.
const LARGEST_CELL_DEG: f64 = 1.0;

/// `dem convert`.
#[derive(Debug, Args)]
#[command(
    after_help = "Cells as large as the file's or finer lie bilinearly between its samples; from twice as large on they hold the mean\n\
                  of the samples in them. A shift between datums goes by the numbers of the systems' definitions (towgs84),\n\
                  good to some meters; one that needs a grid file is refused."
)]
pub struct ConvertOptions {
    /// The elevation files, tiles of one raster where there are several, and the file to write: .tif, .asc, .bt, .hgt or
    /// .png
    #[arg(required = true, num_args = 2.., value_names = ["IN", "OUT"])]
    pub files: Vec<PathBuf>,
    /// Fill voids that samples enclose, with a membrane from their rims; the filled samples are counted
    #[arg(long)]
    pub fill_voids: bool,
    /// The system to bring it to, for example EPSG:32616 [default: its own]
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// The system that it is in, where it names none or the wrong one
    #[arg(long, value_name = "CRS")]
    pub source_crs: Option<String>,
    /// Side of a cell in units of the system that it is brought to [default: its own]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = above_zero)]
    pub cell: Option<f64>,
    /// What gray values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
}

fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(side) if side.is_finite() && side > 0.0 => Ok(side),
        _ => Err("write a number above 0".into()),
    }
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had, read or brought to the system; the output cannot be written or cannot hold it.
pub fn run(options: &ConvertOptions) -> Result<(), CliError> {
    let (inputs, out) = places(options)?;
    let format = rasters::format_of(out, inputs)?;
    let input = inputs[0].as_path();
    let target = parsed("--crs", options.crs.as_deref())?;
    let steps = StepTimer::default();
    steps.begin("reading");
    let (source, notes) = load(inputs, options)?;
    steps.begin("resampling");
    let Warped { raster, method } = brought(input, &source, target.as_ref(), options.cell)?;
    steps.begin("writing");
    let written = rasters::write(&raster, format, out, inputs)?;
    steps.finish();
    let shift = shift(&source, &raster).map_err(|reason| about(input, &reason))?;
    let mut lines = summary(out, format, &raster, (method, shift), &written);
    lines.extend(notes.iter().map(|note| format!("  note         {note}")));
    output::print(&output::text_of(&lines))
}

fn about(file: &Path, reason: &str) -> CliError {
    CliError::input(format!("{}: {reason}", file.display()))
}

/// What is read, and what is written.
fn places(options: &ConvertOptions) -> Result<(&[PathBuf], &Path), CliError> {
    match options.files.split_last() {
        Some((out, inputs @ [_, ..])) => Ok((inputs, out)),
        _ => Err(CliError::Usage("name an elevation file and the file to write".into())),
    }
}

fn parsed(option: &str, text: Option<&str>) -> Result<Option<Crs>, CliError> {
    let crs = text.map(Crs::parse).transpose();
    crs.map_err(|error| CliError::Usage(format!("{option}: {error}")))
}

/// The raster, and what was done to make it one without voids.
fn load(inputs: &[PathBuf], options: &ConvertOptions) -> Result<(Raster, Vec<String>), CliError> {
    let crs = parsed("--source-crs", options.source_crs.as_deref())?;
    let place = StatedPlace { cell: options.cell, crs };
    let mut notes = Vec::new();
    let mut raster = match inputs {
        [input] => dem::read_raster_placed(input, options.heights, &place)?,
        tiles => {
            let mosaic = dem::read_mosaic(tiles, options.heights, &place)?;
            notes.push(mosaic.note());
            mosaic.raster
        }
    };
    if options.fill_voids {
        notes.push(voids::fill(&mut raster).note());
    }
    Ok((raster, notes))
}

/// The raster in the system and with the cells that are wanted; as it is where none are.
fn brought<'a>(
    input: &Path,
    source: &'a Raster,
    target: Option<&Crs>,
    cell: Option<f64>,
) -> Result<Warped<'a>, CliError> {
    if target.is_none() && cell.is_none() {
        return Ok(Warped { raster: Cow::Borrowed(source), method: Resampling::Kept });
    }
    if let (Some(target), None, true) = (target, &source.crs, source.georeferenced) {
        let reason = format!(
            "it names no coordinate system, so it cannot be brought to {}; name its own, for example --source-crs EPSG:4326",
            target.name()
        );
        return Err(about(input, &reason));
    }
    let is_in_degrees = target.or(source.crs.as_ref()).is_some_and(Crs::is_geographic);
    if let Some(cell) = cell.filter(|&cell| is_in_degrees && cell > LARGEST_CELL_DEG) {
        return Err(about(input, &degrees(source, cell)));
    }
    reproject(source, target, cell).map_err(|error| about(input, &remedy(&error)))
}

/// A cell in meters for a raster in degrees, and what would take it.
fn degrees(source: &Raster, cell: f64) -> String {
    let center = source.crs.as_ref().and_then(|crs| crs.transform(&Crs::wgs84(), source.center()).ok());
    let zone = center.map_or_else(
        || "a projected system".to_owned(),
        |center| format!("its UTM zone, --crs {}", Crs::utm_at(center.x, center.y).name()),
    );
    format!(
        "cells of {cell} degrees are too large: cells count in the units of the system, and this one is in degrees; for cells of {cell} m bring it to {zone}"
    )
}

/// Warping speaks to those who write scene files; here its remedies are arguments.
fn remedy(error: &WarpError) -> String {
    match error {
        WarpError::LooksLikeDegrees { min_x, max_x, min_y, max_y } => format!(
            "no coordinate system is named, and the coordinates, {min_x} to {max_x} and {min_y} to {max_y}, look like degrees; name it, for example --source-crs EPSG:4326"
        ),
        WarpError::NoPlace => {
            "it does not say where it lies or how far apart its samples are; give --cell METERS".into()
        }
        other => other.to_string(),
    }
}

/// What was done to move positions between datums; `None` where the system stayed.
fn shift(source: &Raster, raster: &Raster) -> Result<Option<String>, String> {
    match (&source.crs, &raster.crs) {
        (Some(from), Some(to)) if from != to => {
            from.datum_shift_to(to).map(|shift| Some(shift.to_string())).map_err(|error| error.to_string())
        }
        _ => Ok(None),
    }
}

fn summary(
    out: &Path,
    format: &DemFormat,
    raster: &Raster,
    (method, shift): (Resampling, Option<String>),
    written: &WrittenDem,
) -> Vec<String> {
    let cell = raster.spacing();
    let valid = raster.samples.iter().filter(|value| !value.is_nan()).count();
    let how = match method {
        Resampling::Kept => "no, the samples are the file's",
        Resampling::Bilinear => "bilinear, between the four samples around each cell's center",
        Resampling::Average => "average of the samples in each cell",
    };
    let mut lines = vec![
        format!("{}", out.display()),
        format!("  format       {}, {}", format.name, written.stored),
        format!("  size         {} columns, {} rows", raster.width, raster.height),
        format!("  crs          {}", raster.crs.as_ref().map_or("none stated", |crs| crs.name())),
        format!("  cell         {} x {}", cell.x, cell.y),
        format!("  resampled    {how}"),
    ];
    lines.extend(shift.map(|shift| format!("  datum shift  {shift}")));
    lines.extend(raster.vertical_datum.as_ref().map(|datum| format!("  heights      from {datum}")));
    lines.push(format!("  valid        {valid} of {} samples", raster.samples.len()));
    lines.extend(written.notes.iter().map(|note| format!("  note         {note}")));
    for companion in &written.companions {
        lines.push(format!("  beside it    {}", out.with_extension(companion.extension).display()));
    }
    lines
}
