//! `sandtable mesh`: an elevation file to a mesh with a promise, that it is nowhere off by more than it was asked.
//!
//! The promise is not taken on trust from the arithmetic that chose the triangles: what is about to be written is
//! measured in f64 at every post, and refined further should rounding have spoilt it. With every post a vertex
//! there is nothing left to be off by, so this ends.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;

use crate::app::arguments::MeshOptions;
use crate::app::dem::{StatedPlace, read_raster_placed};
use crate::app::failure::CliError;
use crate::app::progress::StepTimer;
use crate::app::{files, output};
use crate::dem::raster::Raster;
use crate::dem::warp::{self, WarpError};
use crate::geom::crs::Crs;
use crate::mesh::trimesh::TriMesh;
use crate::mesh::write::{self, MeshFormat, Remarks};
use crate::roam::bound::{self, Deviation};
use crate::roam::closure::least_closure;
use crate::roam::displayed::DisplayedTerrain;
use crate::roam::layout::PatchLayout;
use crate::terrain::lattice::Lattice;

/// The largest patch there is: the larger, the fewer triangles flat ground needs.
const LARGEST_PATCH: u32 = 4096;

/// How far f32 arithmetic may mistake a distance, as a part of the relief.
const ROUNDING: f64 = 1e-6;

/// A tolerance that no triangle keeps.
const KEEP_EVERYTHING: f64 = -1.0;

/// Writes the mesh and prints what it holds and how far it is off.
///
/// # Errors
/// The elevation file cannot be had, read or brought to meters; the mesh cannot be written; its name is that of no
/// format.
pub fn run(options: &MeshOptions) -> Result<(), CliError> {
    let format = format_of(&options.output)?;
    files::check_file_place(
        &options.output,
        &options.file,
        "this is the elevation file itself; name another with -o",
    )?;
    let steps = StepTimer::default();
    steps.begin("reading");
    let ground = load(options)?;
    steps.begin("building the mesh");
    let built = build(&ground.lattice, options.max_error).map_err(|reason| about(&options.file, &reason))?;
    steps.begin("writing");
    let remarks = remarks(options, &ground, &built);
    files::write_whole_with(&options.output, |out| write::write(format, &built.mesh, &remarks, out))?;
    steps.finish();
    for note in &ground.notes {
        output::warn(&format!("note: {note}"));
    }
    output::print(&output::text_of(&summary(options, &ground, &built)))
}

fn about(file: &Path, reason: &str) -> CliError {
    CliError::input(format!("{}: {reason}", file.display()))
}

fn format_of(path: &Path) -> Result<MeshFormat, CliError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    MeshFormat::from_extension(&extension).ok_or_else(|| {
        let place = path.display();
        CliError::Usage(format!(
            "{place}: meshes are written as .obj, .ply, .stl or .glb; name a file that ends so"
        ))
    })
}

/// What the mesh is made of.
struct MeshGround {
    lattice: Arc<Lattice>,
    crs: Crs,
    /// What was done to the elevation file, for the user to know.
    notes: Vec<String>,
}

fn load(options: &MeshOptions) -> Result<MeshGround, CliError> {
    let wrong = |reason: String| about(&options.file, &reason);
    let stated = options.crs.as_deref().map(Crs::parse).transpose();
    let stated = stated.map_err(|error| CliError::Usage(format!("--crs: {error}")))?;
    let place = StatedPlace { cell: options.cell, crs: stated };
    let raster = read_raster_placed(&options.file, options.heights, &place)?;
    let metric = warp::to_metric(&raster, None).map_err(|error| wrong(remedy(&error)))?;
    let lattice = Lattice::from_raster(&metric).map_err(|error| wrong(error.to_string()))?;
    let notes =
        brought(&raster, &metric).into_iter().map(|note| format!("{}: {note}", options.file.display()));
    Ok(MeshGround {
        lattice: Arc::new(lattice),
        crs: metric.crs.clone().unwrap_or_else(Crs::local),
        notes: notes.collect(),
    })
}

/// Warping speaks to those who write scene files; here its remedies are arguments.
fn remedy(error: &WarpError) -> String {
    match error {
        WarpError::LooksLikeDegrees { min_x, max_x, min_y, max_y } => format!(
            "no coordinate system is named, and the coordinates, {min_x} to {max_x} and {min_y} to {max_y}, look like degrees; name it, for example --crs EPSG:4326"
        ),
        WarpError::NoPlace => {
            "it does not say where it lies or how far apart its posts are; give --cell METERS".into()
        }
        WarpError::NoZone { west, east, south, north } => format!(
            "it reaches from longitude {west} to {east} and from latitude {south} to {north}, which no UTM zone covers well; cut it, or warp it to a projected system in meters first"
        ),
        other => other.to_string(),
    }
}

/// That the posts are not those of the file, where they are not.
fn brought(raster: &Raster, metric: &Raster) -> Option<String> {
    let name = |raster: &Raster| raster.crs.as_ref().map_or("no system", |crs| crs.name()).to_owned();
    let axes = raster.map_from_grid.matrix2;
    let turned = axes.x_axis.y != 0.0 || axes.y_axis.x != 0.0;
    if raster.crs == metric.crs && !turned {
        return None;
    }
    let (cell, columns, rows) = (metric.spacing().x, metric.width, metric.height);
    Some(format!(
        "brought from {} to {}, {columns} x {rows} posts {cell:.3} m apart; the error is measured at these",
        name(raster),
        name(metric)
    ))
}

/// A mesh and how far it is off.
struct BuiltMesh {
    mesh: TriMesh,
    deviation: Deviation,
}

/// The least mesh that keeps `max_error_m` at every post.
fn build(lattice: &Arc<Lattice>, max_error_m: f64) -> Result<BuiltMesh, String> {
    let layout = layout_over(lattice).ok_or_else(|| {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        format!("{columns} x {rows} posts are more than one mesh can be made of; cut it into parts")
    })?;
    let (low, high) = lattice.height_range();
    let slack = (f64::from(high) - f64::from(low)) * ROUNDING;
    let mut built = None;
    let less = |slack: f64| (max_error_m - slack).max(0.0);
    for tolerance_m in [less(slack), less(16.0 * slack), KEEP_EVERYTHING] {
        let active = least_closure(lattice, &layout, tolerance_m.min(f64::from(f32::MAX)) as f32);
        let mut mesh = TriMesh::default();
        DisplayedTerrain::new(Arc::clone(lattice), active, layout.patches().collect()).emit(&mut mesh);
        let deviation = bound::measure(lattice, &mesh).map_err(|error| error.to_string())?;
        let kept = deviation.max_m <= max_error_m;
        built = Some(BuiltMesh { mesh, deviation });
        if kept {
            break;
        }
    }
    let built = built.expect("at least one tolerance was tried");
    if built.mesh.triangles.is_empty() {
        return Err("nowhere do three posts of one cell have data, so there is no triangle to write".into());
    }
    Ok(built)
}

/// One patch over everything, or as few as there can be.
fn layout_over(lattice: &Lattice) -> Option<PatchLayout> {
    let (columns, rows) = (lattice.columns(), lattice.rows());
    let whole = (columns.max(rows) - 1).next_power_of_two().clamp(2, LARGEST_PATCH);
    // A long and narrow terrain would have most of the vertices of its patches beyond its border.
    let narrow = 2 * (columns.min(rows) - 1).next_power_of_two().max(2);
    let largest = whole.min(narrow).ilog2();
    (1..=largest).rev().find_map(|log| PatchLayout::new(columns, rows, 1 << log))
}

/// Where the mesh stands and what it promises.
fn remarks(options: &MeshOptions, ground: &MeshGround, built: &BuiltMesh) -> Remarks {
    let origin = ground.lattice.origin();
    let (name, crs) = (file_name(&options.file), ground.crs.name());
    let lines = [
        format!("terrain mesh of {name}, written by sandtable"),
        "meters from the south-west post: X east, Y north, Z up".to_owned(),
        format!(
            "origin: X 0, Y 0 is easting {} northing {} in {crs}; Z is the elevation",
            origin.x, origin.y
        ),
        format!(
            "vertical error: at most {} m at every post, asked for {} m",
            told(built.deviation.max_m),
            options.max_error
        ),
    ];
    Remarks::new(&lines, &format!("meters; origin E {} N {}; {crs}", origin.x, origin.y))
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A maximum in tenths of a millimeter, rounded up: what is told is still a bound.
fn told(max_m: f64) -> f64 {
    (max_m * 1e4).ceil() / 1e4
}

fn summary(options: &MeshOptions, ground: &MeshGround, built: &BuiltMesh) -> Vec<String> {
    let Deviation { max_m, mean_m, rms_m, worst, measured, left_out } = built.deviation;
    let origin = ground.lattice.origin();
    let place = worst.map_or_else(String::new, |post| {
        let at = origin + DVec2::new(f64::from(post.column), f64::from(post.row)) * ground.lattice.cell();
        let column = post.column;
        format!(" at column {column}, row {} from the south-west ({:.2}, {:.2})", post.row, at.x, at.y)
    });
    let mut lines = vec![
        format!("{}", options.output.display()),
        format!("  vertices   {}", built.mesh.positions.len()),
        format!("  triangles  {}", built.mesh.triangles.len()),
        format!("  error      maximum {} m, asked for {} m{place}", told(max_m), options.max_error),
        format!("             mean {mean_m:.4} m, RMS {rms_m:.4} m, over {measured} posts"),
        format!("  origin     ({:.3}, {:.3}) in {}", origin.x, origin.y, ground.crs.name()),
    ];
    if left_out > 0 {
        lines.push(format!("  left out   {left_out} posts with data that only cells with a hole touch"));
    }
    lines
}
