//! `sandtable mesh`: an elevation file as a mesh with an error bound.

use std::path::PathBuf;
use std::slice::from_ref;
use std::sync::Arc;

use clap::Args;

use crate::cli::convert::place_error;
use crate::cli::error::CliError;
use crate::cli::options::HeightArguments;
use crate::cli::output::{print_lines, row, warn};
use crate::cli::output_format::output_format;
use crate::cli::progress::StepTimer;
use crate::cli::values::number;
use crate::dem::raster::Raster;
use crate::dem::read::DemOptions;
use crate::dem::windows::MOST_KEPT_SAMPLES;
use crate::geom::crs::Crs;
use crate::mesh::write::{self, MeshFormat, Remarks};
use crate::pipeline::bounded_mesh::BoundedMesh;
use crate::pipeline::dem;
use crate::pipeline::error::FileError;
use crate::pipeline::files;
use crate::pipeline::ground::{GroundError, MetricGround};
use crate::pipeline::windowed_elevation::WindowedElevation;
use crate::roam::bound::Deviation;
use crate::terrain::lattice::Lattice;

#[derive(Debug, Args)]
#[command(
    after_help = "Coordinates are meters from the south-west post, X east, Y north, Z up; the file says where that is.\n\
                  An elevation file in degrees is brought to its UTM zone first. Ground without data is left out."
)]
pub struct MeshArguments {
    /// The elevation file
    pub file: PathBuf,
    /// The largest vertical error of the mesh at any post of the elevation file
    #[arg(long, value_name = "METERS", allow_negative_numbers = true, value_parser = number::<f64>(0.0.., "write meters as a number from 0 on"))]
    pub max_error: f64,
    /// Write the mesh to this file: .obj, .ply, .stl or .glb
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The coordinate system of an elevation file that names none, for example EPSG:4326
    #[arg(long, value_name = "CRS", value_parser = Crs::parse)]
    pub crs: Option<Crs>,
    /// Meters between the posts of an elevation file that does not state it
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub cell: Option<f64>,
    #[command(flatten)]
    pub heights: HeightArguments,
}

pub fn run(arguments: &MeshArguments) -> Result<(), CliError> {
    let out = &arguments.output;
    let written = "meshes are written as .obj, .ply, .stl or .glb";
    let format = output_format(out, from_ref(&arguments.file), MeshFormat::from_extension, written)?;
    let steps = StepTimer::default();
    steps.begin("reading");
    let options =
        DemOptions { cell: arguments.cell, crs: arguments.crs.clone(), ..arguments.heights.dem_options() };
    let MeshedGround { ground, header, warning } = MeshedGround::open(arguments, &options)?;
    let MetricGround { lattice, crs } = ground;
    let lattice = Arc::new(lattice);
    steps.begin("building the mesh");
    let bounded = BoundedMesh::new(&lattice, arguments.max_error).map_err(FileError::at(&arguments.file))?;
    steps.begin("writing");
    let remarks = remarks(arguments, &lattice, &crs, bounded.deviation);
    files::write_with(out, |out| write::write(format, &bounded.mesh, &remarks, out))?;
    steps.finish();
    warning.iter().for_each(|warning| warn(&format!("warning: {warning}")));
    if let Some(note) = resampled(&header, &lattice, &crs) {
        warn(&format!("note: {}: {note}", arguments.file.display()));
    }
    print_lines(&summary(arguments, &lattice, &crs, &bounded))
}

/// The ground that a mesh is made of.
struct MeshedGround {
    ground: MetricGround,
    /// The raster without its samples, which are not held.
    header: Raster,
    /// A warning for the user about the files, where there is one.
    warning: Option<String>,
}

impl MeshedGround {
    /// The ground of the elevation file. Of a large one only the heights of posts are held, not the file.
    fn open(arguments: &MeshArguments, options: &DemOptions) -> Result<Self, CliError> {
        let file = &arguments.file;
        if let Some(windows) = dem::open_large(file, options, MOST_KEPT_SAMPLES) {
            let elevation = WindowedElevation::new(windows);
            let ground = elevation.whole_ground().map_err(|error| match &*error {
                GroundError::Warp(error) => place_error(file, error, "--crs"),
                _ => FileError::at(file)(error).into(),
            })?;
            return Ok(Self { ground, header: elevation.header().without_samples(), warning: None });
        }
        let mosaic = dem::open(file, options)?;
        let warning = dem::warning(file, &mosaic);
        let ground = MetricGround::from_raster(&mosaic.raster).map_err(|error| match error {
            GroundError::Warp(error) => place_error(file, &error, "--crs"),
            other => FileError::at(file)(other).into(),
        })?;
        Ok(Self { ground, header: mosaic.raster.without_samples(), warning })
    }
}

/// A note that the elevations were resampled; `None` if the posts are the file's.
fn resampled(raster: &Raster, lattice: &Lattice, crs: &Crs) -> Option<String> {
    let from = raster.crs.as_ref().map_or("no system", |crs| crs.name());
    let axes = raster.map_from_grid.matrix2;
    let is_rotated = axes.x_axis.y != 0.0 || axes.y_axis.x != 0.0;
    if raster.crs.as_ref().is_none_or(|own| own == crs) && !is_rotated {
        return None;
    }
    let to = if *crs == Crs::local() { "no system" } else { crs.name() };
    let (columns, rows, cell_m) = (lattice.columns(), lattice.rows(), lattice.cell().x);
    let grid = format!("{columns} x {rows} posts {cell_m:.3} m apart");
    Some(format!("brought from {from} to {to}, {grid}; the error is measured at these"))
}

/// Where the mesh lies and its error bound.
fn remarks(arguments: &MeshArguments, lattice: &Lattice, crs: &Crs, deviation: Deviation) -> Remarks {
    let (origin, crs) = (lattice.origin(), crs.name());
    let lines = [
        format!("terrain mesh of {}, written by sandtable", files::file_name(&arguments.file)),
        "meters from the south-west post: X east, Y north, Z up".to_owned(),
        format!(
            "origin: X 0, Y 0 is easting {} northing {} in {crs}; Z is the elevation",
            origin.x, origin.y
        ),
        format!(
            "vertical error: at most {} m at every post, asked for {} m",
            rounded_up(deviation.max_m),
            arguments.max_error
        ),
    ];
    Remarks::new(&lines, &format!("meters; origin E {} N {}; {crs}", origin.x, origin.y))
}

/// A maximum in tenths of a millimeter, rounded up, so that it stays a bound.
fn rounded_up(max_m: f64) -> f64 {
    (max_m * 1e4).ceil() / 1e4
}

fn summary(arguments: &MeshArguments, lattice: &Lattice, crs: &Crs, bounded: &BoundedMesh) -> Vec<String> {
    let Deviation { max_m, mean_m, rms_m, worst, measured, left_out } = bounded.deviation;
    let origin = lattice.origin();
    let place = worst.map_or_else(String::new, |post| {
        let at = lattice.map_position(post);
        format!(" at column {}, row {} from the south-west ({:.2}, {:.2})", post.column, post.row, at.x, at.y)
    });
    let row = |name: &str, value: String| row(10, name, value);
    let mut lines = vec![
        arguments.output.display().to_string(),
        row("vertices", bounded.mesh.positions.len().to_string()),
        row("triangles", bounded.mesh.triangles.len().to_string()),
        row("error", format!("maximum {} m, asked for {} m{place}", rounded_up(max_m), arguments.max_error)),
        row("", format!("mean {mean_m:.4} m, RMS {rms_m:.4} m, over {measured} posts")),
        row("origin", format!("({:.3}, {:.3}) in {}", origin.x, origin.y, crs.name())),
    ];
    if left_out > 0 {
        lines.push(row("left out", format!("{left_out} posts with data that only cells with a hole touch")));
    }
    lines
}
