//! `sandtable dem convert`: elevation in another format, another coordinate system or with other cells.

use std::ops::Bound;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::error::CliError;
use crate::options::HeightArguments;
use crate::output::{print_summary, row};
use crate::output_format::raster_format;
use crate::progress::StepTimer;
use crate::values::number;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::message::chain::error_text;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemOptions;
use sandtable_dem::written::{WrittenDem, WrittenWindows};
use sandtable_files::raster_file;
use sandtable_geom::crs::Crs;
use sandtable_query::convert::{
    ConvertError, ConvertOptions, Converted, VoidHandling, convert, convert_windows,
};
use sandtable_query::dem::{self, OpenedDem};
use sandtable_raster::warp::error::WarpError;
use sandtable_raster::warp::reproject::Resampling;
use sandtable_raster::windows::MOST_KEPT_SAMPLES;

#[derive(Debug, Args)]
#[command(
    after_help = "Cells as large as the file's or finer are bilinear between its samples; from twice as large on they hold the mean\n\
                  of the samples in them. A shift between datums uses the numbers of the systems' definitions (towgs84), good\n\
                  to some meters; one that needs a grid file is refused."
)]
pub struct ConvertArguments {
    /// The elevation files, tiles of one raster where there are several, and without -o the file to write
    #[arg(required = true, num_args = 1.., value_names = ["IN", "OUT"])]
    pub files: Vec<PathBuf>,
    /// The file to write: .tif, .asc, .flt, .bil, .bt, .xyz, .hgt, .dt0, .dt1, .dt2 or .png [default: the last of the files, where it is no elevation yet]
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Write over the last of the files although it is elevation
    #[arg(long, conflicts_with = "output")]
    pub force: bool,
    /// Fill voids that samples enclose, with a membrane from their rims; the filled samples are counted
    #[arg(long)]
    pub fill_voids: bool,
    /// The coordinate system to bring it to, for example EPSG:32616 [default: its own]
    #[arg(long, value_name = "CRS", value_parser = Crs::parse)]
    pub crs: Option<Crs>,
    /// The coordinate system that it is in, where it names none or the wrong one
    #[arg(long, value_name = "CRS", value_parser = Crs::parse)]
    pub source_crs: Option<Crs>,
    /// Side of a cell in units of the system that it is brought to [default: its own]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = number::<f64>((Bound::Excluded(0.0), Bound::Unbounded), "write a number above 0"))]
    pub cell: Option<f64>,
    #[command(flatten)]
    pub heights: HeightArguments,
}

pub fn run(arguments: &ConvertArguments) -> Result<(), CliError> {
    let (out, inputs) = match (&arguments.output, arguments.files.split_last()) {
        (Some(out), _) => (out.as_path(), &arguments.files[..]),
        (None, Some((out, inputs @ [_, ..]))) => (out.as_path(), inputs),
        _ => return Err(CliError::usage("name an elevation file and the file to write")),
    };
    let format = raster_format(out, inputs)?;
    if arguments.output.is_none() && !arguments.force && out.exists() {
        refuse_elevation(out, &arguments.heights.dem_options())?;
    }
    let steps = StepTimer::default();
    let dem_options = DemOptions {
        cell: arguments.cell,
        crs: arguments.source_crs.clone(),
        ..arguments.heights.dem_options()
    };
    let options = ConvertOptions {
        crs: arguments.crs.clone(),
        cell: arguments.cell,
        voids: if arguments.fill_voids { VoidHandling::Fill } else { VoidHandling::Keep },
    };
    let (converted, written, valid) = match copied(inputs, &dem_options, &options, (format, out), &steps)? {
        Some(copied) => copied,
        None => {
            let converted = converted(inputs, &dem_options, &options, &steps)?;
            steps.begin("writing");
            let written = raster_file::write(&converted.raster, format, out, inputs)?;
            let valid = converted.raster.samples.valid().count() as u64;
            (converted, written, valid)
        }
    };
    steps.finish();
    print_summary(&summary(out, format, &converted, &written, valid))
}

/// Writes a large file of which all samples stay while it is read, where the format allows it: the elevation without its
/// samples, what was written, and how many samples hold data. `None` where it is to be read whole.
fn copied(
    inputs: &[PathBuf],
    dem_options: &DemOptions,
    options: &ConvertOptions,
    (format, out): (&DemFormat, &Path),
    steps: &StepTimer,
) -> Result<Option<(Converted, WrittenDem, u64)>, CliError> {
    // What tiles share is known where all of them are joined.
    let [input] = inputs else { return Ok(None) };
    if !options.keeps_samples() {
        return Ok(None);
    }
    let Some(mut windows) = dem::open_large(input, dem_options, MOST_KEPT_SAMPLES) else { return Ok(None) };
    let samples = windows.size();
    if u64::from(samples.0) * u64::from(samples.1) > RASTER_SAMPLES.get() {
        return Ok(None);
    }
    steps.begin("copying");
    let written = raster_file::write_windows(&mut *windows, format, out, input)?;
    let raster = windows.metadata().without_samples();
    Ok(written.map(|WrittenWindows { stored, valid, notes }| {
        let own = raster.notes.clone();
        let converted = Converted { raster, resampling: Resampling::Kept, datum_shift: None, notes: own };
        (converted, WrittenDem { bytes: Vec::new(), companions: Vec::new(), stored, notes }, valid)
    }))
}

fn converted(
    inputs: &[PathBuf],
    dem_options: &DemOptions,
    options: &ConvertOptions,
    steps: &StepTimer,
) -> Result<Converted, CliError> {
    let failed = |error| with_remedy(&inputs[0], &error);
    steps.begin("reading");
    let source = match inputs {
        [input] => match dem::open_either(input, dem_options, MOST_KEPT_SAMPLES)? {
            OpenedDem::Kept(mosaic) => *mosaic,
            OpenedDem::Windows(mut windows) => {
                steps.begin("resampling");
                if let Some(converted) = convert_windows(&mut windows, options).map_err(failed)? {
                    return Ok(converted);
                }
                steps.begin("reading");
                dem::open(input, dem_options)?
            }
        },
        tiles => dem::open_tiles(tiles, dem_options)?,
    };
    steps.begin("resampling");
    convert(source, options).map_err(failed)
}

/// Refuses a file that may have been meant as one of those to read.
fn refuse_elevation(out: &Path, options: &DemOptions) -> Result<(), CliError> {
    match dem::format_by_head(out, options) {
        Some(format) => Err(CliError::input(format!(
            "{}: it is elevation ({format}), and would be written over; name the file to write with -o, or add --force",
            out.display()
        ))),
        None => Ok(()),
    }
}

/// The error with the arguments that would mend it.
fn with_remedy(file: &Path, error: &ConvertError) -> CliError {
    let remedy = match error {
        ConvertError::NoCrs(_) => "; name its own, for example --source-crs EPSG:4326".to_owned(),
        ConvertError::CellInDegrees { cell, zone: Some(zone) } => {
            format!("; for cells of {cell} m bring it to meters, --crs {zone}")
        }
        ConvertError::CellInDegrees { cell, zone: None } => {
            format!("; for cells of {cell} m bring it to a projected system")
        }
        ConvertError::Warp(error) => return place_error(file, error, "--source-crs"),
        ConvertError::Crs(_) | ConvertError::Read(_) => String::new(),
    };
    CliError::input(format!("{}: {}{remedy}", file.display(), error_text(error)))
}

/// The error for elevation without a georeference, with the options that state one. `crs_option` is the option of the
/// coordinate system.
pub fn place_error(file: &Path, error: &WarpError, crs_option: &str) -> CliError {
    let reason = match error {
        WarpError::LooksLikeDegrees { min_x, max_x, min_y, max_y } => format!(
            "no coordinate system is named, and the coordinates, {min_x} to {max_x} and {min_y} to {max_y}, look like degrees; name it, for example {crs_option} EPSG:4326"
        ),
        WarpError::NoPlace => {
            "it does not say where it lies or how far apart its samples are; give --cell METERS".into()
        }
        WarpError::NoZone { west, east, south, north } => format!(
            "it reaches from longitude {west} to {east} and from latitude {south} to {north}, which no UTM zone covers well; cut it, or warp it to a projected system in meters first"
        ),
        other => error_text(other),
    };
    CliError::input(format!("{}: {reason}", file.display()))
}

fn summary(
    out: &Path,
    format: &DemFormat,
    converted: &Converted,
    written: &WrittenDem,
    valid: u64,
) -> Vec<String> {
    let Converted { raster, resampling, datum_shift, notes } = converted;
    let cell = raster.spacing();
    let samples = u64::from(raster.width) * u64::from(raster.height);
    let resampled = match resampling {
        Resampling::Kept => "no, the samples are the file's",
        Resampling::Bilinear => "bilinear, between the four samples around each cell's center",
        Resampling::Average => "average of the samples in each cell",
        Resampling::OfTiles => "tiles of other cells, as the notes say",
    };
    let row = |name: &str, value: &str| row(12, name, value);
    let mut lines = vec![
        out.display().to_string(),
        row("format", &format!("{}, {}", format.name, written.stored)),
        row("size", &format!("{} columns, {} rows", raster.width, raster.height)),
        row("crs", raster.crs.as_ref().map_or("none stated", |crs| crs.name())),
        row("cell", &format!("{} x {}", cell.x, cell.y)),
        row("resampled", resampled),
    ];
    lines.extend(datum_shift.iter().map(|shift| row("datum shift", shift)));
    lines.extend(raster.vertical_datum.iter().map(|datum| row("heights", &format!("from {datum}"))));
    lines.push(row("valid", &format!("{valid} of {samples} samples")));
    lines.extend(written.notes.iter().map(|note| row("note", note)));
    let companions = written.companions.iter().map(|companion| out.with_extension(companion.extension));
    lines.extend(companions.map(|path| row("beside it", &path.display().to_string())));
    lines.extend(notes.iter().map(|note| row("note", note)));
    lines
}
