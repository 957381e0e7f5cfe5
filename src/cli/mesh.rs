//! `sandtable mesh`: an elevation file as a mesh with an error bound.

use std::path::PathBuf;
use std::slice::from_ref;
use std::sync::Arc;

use clap::Args;

use crate::convert::place_error;
use crate::error::CliError;
use crate::options::HeightArguments;
use crate::output::{print_summary, row, warn};
use crate::output_format::output_format;
use crate::progress::StepTimer;
use crate::values::number;
use sandtable_base::message::numbers::{counted, fixed};
use sandtable_dem::hints::DemOptions;
use sandtable_files::disk;
use sandtable_files::error::FileError;
use sandtable_geom::crs::Crs;
use sandtable_mesh::source::{MeshSize, MeshSource};
use sandtable_mesh::write::remarks::Remarks;
use sandtable_mesh::write::{self, MeshFormat};
use sandtable_query::bounded_mesh::{BoundedMesh, MeshError};
use sandtable_query::dem::{self, OpenedDem};
use sandtable_query::ground::{GroundError, MetricGround};
use sandtable_query::parted_elevation::PartedElevation;
use sandtable_query::windowed_elevation::WindowedElevation;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::MOST_KEPT_SAMPLES;
use sandtable_roam::bound::Deviation;
use sandtable_roam::parts::PartedGround;
use sandtable_terrain::lattice::Lattice;

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
    let written = "meshes are written as .obj, .ply, .stl or .glb";
    let format =
        output_format(&arguments.output, from_ref(&arguments.file), MeshFormat::from_extension, written)?;
    let steps = StepTimer::default();
    steps.begin("reading");
    let options =
        DemOptions { cell: arguments.cell, crs: arguments.crs.clone(), ..arguments.heights.dem_options() };
    match dem::open_either(&arguments.file, &options, MOST_KEPT_SAMPLES)? {
        OpenedDem::Windows(windows) => {
            let elevation = WindowedElevation::new(windows);
            let ground = PartedElevation::new(elevation).map_err(|error| failed(arguments, error))?;
            let (lattice, crs) = (ground.frame().clone(), ground.crs().clone());
            let header = ground.header().without_samples();
            let warning = dem::header_warning(&arguments.file, &header);
            let place = MeshPlace { header, lattice: &lattice, crs, warning };
            steps.begin("building the mesh");
            let range = ground.height_range();
            let bounded = BoundedMesh::of_parts(ground, range, arguments.max_error);
            let bounded = bounded.map_err(|error| failed(arguments, error))?;
            write_mesh(arguments, format, &place, bounded, &steps)
        }
        OpenedDem::Kept(mosaic) => {
            let warning = dem::warning(&arguments.file, &mosaic);
            let ground = MetricGround::from_raster(&mosaic.raster)
                .map_err(|error| failed(arguments, Arc::new(error).into()))?;
            let (lattice, header) = (Arc::new(ground.lattice), mosaic.raster.without_samples());
            drop(mosaic);
            let place = MeshPlace { header, lattice: &lattice, crs: ground.crs, warning };
            steps.begin("building the mesh");
            let bounded = BoundedMesh::new(&lattice, arguments.max_error);
            let bounded = bounded.map_err(|error| failed(arguments, error))?;
            write_mesh(arguments, format, &place, bounded, &steps)
        }
    }
}

/// Where a mesh lies.
struct MeshPlace<'a> {
    /// The raster without its samples, which are not held.
    header: Raster,
    /// The ground; not all of its heights need be held.
    lattice: &'a Lattice,
    crs: Crs,
    /// A warning for the user about the files, where there is one.
    warning: Option<String>,
}

fn write_mesh<G: PartedGround>(
    arguments: &MeshArguments,
    format: MeshFormat,
    place: &MeshPlace<'_>,
    mut bounded: BoundedMesh<G>,
    steps: &StepTimer,
) -> Result<(), CliError>
where
    MeshError: From<G::Error>,
{
    steps.begin("writing");
    let MeshPlace { header, lattice, crs, warning } = place;
    let deviation = *bounded.deviation();
    let remarks = remarks(arguments, lattice, crs, deviation);
    let written =
        disk::write_with(&arguments.output, |out| write::write(format, &mut bounded, &remarks, out));
    if let Some(error) = bounded.take_fault() {
        return Err(failed(arguments, error));
    }
    written?;
    steps.finish();
    warning.iter().for_each(|warning| warn(&format!("warning: {warning}")));
    let notes = dem::reading_notes(&arguments.file, header);
    notes.iter().for_each(|note| warn(&format!("note: {note}")));
    if let Some(note) = resampled(header, lattice, crs) {
        warn(&format!("note: {}: {note}", arguments.file.display()));
    }
    print_summary(&summary(arguments, place, bounded.size(), deviation))
}

/// The error of an elevation file of which no mesh can be made.
fn failed(arguments: &MeshArguments, error: MeshError) -> CliError {
    let file = &arguments.file;
    match &error {
        MeshError::Ground(ground) => match &**ground {
            GroundError::Warp(error) => place_error(file, error, "--crs"),
            _ => FileError::at(file)(error).into(),
        },
        _ => FileError::at(file)(error).into(),
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
        format!("terrain mesh of {}, written by sandtable", disk::file_name(&arguments.file)),
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

fn summary(
    arguments: &MeshArguments,
    MeshPlace { lattice, crs, .. }: &MeshPlace<'_>,
    size: MeshSize,
    deviation: Deviation,
) -> Vec<String> {
    let Deviation { max_m, mean_m, rms_m, worst, measured, left_out } = deviation;
    let origin = lattice.origin();
    let place = worst.map_or_else(String::new, |post| {
        let at = lattice.map_position(post);
        let at = format!("({}, {})", fixed(at.x, 2), fixed(at.y, 2));
        format!(" at column {}, row {} from the south-west {at}", post.column, post.row)
    });
    let row = |name: &str, value: String| row(10, name, value);
    let mut lines = vec![
        arguments.output.display().to_string(),
        row("vertices", size.vertices.to_string()),
        row("triangles", size.triangles.to_string()),
        row("error", format!("maximum {} m, asked for {} m{place}", rounded_up(max_m), arguments.max_error)),
        row("", format!("mean {mean_m:.4} m, RMS {rms_m:.4} m, over {measured} posts")),
        row("origin", format!("({}, {}) in {}", fixed(origin.x, 3), fixed(origin.y, 3), crs.name())),
    ];
    if left_out > 0 {
        lines.push(row(
            "left out",
            format!("{} with data that only cells with a hole touch", counted(left_out, "post", "posts")),
        ));
    }
    lines
}
