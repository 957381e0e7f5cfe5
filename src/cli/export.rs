//! `sandtable export`: a scene as a file that modeling programs open, or as a model to print.

use std::path::{Path, PathBuf};
use std::slice::from_ref;

use clap::Args;

use crate::error::CliError;
use crate::options::SceneArguments;
use crate::output::{print_summary, row};
use crate::output_format::output_format;
use crate::progress::StepTimer;
use crate::values::number;
use sandtable_export::features::{ExportedFeatures, FeatureFormat, export_features};
use sandtable_export::print_model::{self, PrintFormat, PrintModel, PrintSize, print_model};
use sandtable_export::scene_export::{DEFAULT_MAX_ERROR_M, ExportFormat, export};
use sandtable_export::scene_page::export_page;
use sandtable_files::disk;
use sandtable_geom::crs::Crs;
use sandtable_scene::scene_file::{open_scene, open_scene_true_to_scale};

/// The longer side of a printed model, and the bed it is printed on, in millimeters, where none is stated: most printers
/// have a bed of 220 mm or more.
const SIDE_MM: f64 = 180.0;
const BED_MM: f64 = 200.0;

#[derive(Debug, Args)]
#[command(
    after_help = "Lengths and heights are meters from the south-west post, heights without exaggeration; the file says where that\n\
                  is. In a .glb north is -Z and up is Y; in an .obj north is Y and up is Z. The materials (.mtl) and textures of\n\
                  an .obj are written beside it. Light, labels and furniture are not exported.\n\n\
                  A .html is a page that any browser opens without a server or a network: the scene as in its pictures, to turn, to\n\
                  fly through and to ask for heights. Its light is that of the first camera.\n\n\
                  A .3mf or .stl is a solid to print in millimeters, with the scene's exaggeration: what is seen from above, on a\n\
                  base. A model larger than the bed is cut into pieces with pegs and sockets; as .stl each is a file of its own.\n\n\
                  A .gpkg, .geojson or .kmz holds what the scene shows, layer by layer: roads and water as laid, cut and fill,\n\
                  contours, spot heights, buildings, viewsheds, lines of sight, graphics and symbols. A .gpkg opens in QGIS with\n\
                  its styles, a .kmz in Google Earth. A .msdl or .nvg holds units and graphics."
)]
pub struct ExportArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Write the scene to this file; the extension names the format: .glb, .obj, .html for browsers, .3mf or .stl to print;
    /// its features as .gpkg, .geojson, .kmz, .msdl or .nvg
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The largest error of the ground at any post, in meters [default: 1; for a page 0.5 or more, by its size]
    #[arg(long, value_name = "METERS", value_parser = number::<f64>(0.0.., "write meters as a number from 0 on"))]
    pub max_error: Option<f64>,
    /// The coordinate system of a .gpkg, such as EPSG:32616 [default: the scene's]
    #[arg(long, value_name = "CRS", value_parser = Crs::parse)]
    pub crs: Option<Crs>,
    /// The longer side of a printed model, in millimeters [default: 180]
    #[arg(long, value_name = "MM", value_parser = number::<f64>(20.0..=4000.0, "write millimeters as a number from 20 to 4000"))]
    pub side: Option<f64>,
    /// The side of the printer's bed, in millimeters [default: 200]
    #[arg(long, value_name = "MM", value_parser = number::<f64>(50.0..=2000.0, "write millimeters as a number from 50 to 2000"))]
    pub bed: Option<f64>,
}

impl ExportArguments {
    /// Whether the scene is written as a page for browsers.
    pub fn is_page(&self) -> bool {
        self.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html"))
    }
}

/// What a file is exported as.
#[derive(Clone, Copy, Debug)]
enum ExportTarget {
    Scene(ExportFormat),
    Page,
    Print(PrintFormat),
    Features(FeatureFormat),
}

impl ExportTarget {
    fn from_extension(extension: &str) -> Option<Self> {
        let page = ["html", "htm"].iter().any(|page| extension.eq_ignore_ascii_case(page));
        let scene = ExportFormat::from_extension(extension).map(Self::Scene).or(page.then_some(Self::Page));
        let print = || PrintFormat::from_extension(extension).map(Self::Print);
        scene.or_else(print).or_else(|| FeatureFormat::from_extension(extension).map(Self::Features))
    }
}

pub fn run(arguments: &ExportArguments) -> Result<(), CliError> {
    let (scene, out) = (&arguments.scene, &arguments.output);
    let written = "scenes are exported as .glb, .obj or .html, as .3mf or .stl to print, or as .gpkg, .geojson, .kmz, .msdl or .nvg";
    let unused = |option: &str, kind: &str| {
        Err(CliError::Usage(format!("--{option} has no effect on {kind}; remove it")))
    };
    let kind = output_format(out, from_ref(&scene.scene), ExportTarget::from_extension, written)?;
    let has_system = matches!(kind, ExportTarget::Features(format) if !format.is_geographic());
    if arguments.crs.is_some() && !has_system {
        return unused("crs", "this format, whose system is fixed");
    }
    match kind {
        ExportTarget::Scene(_) if arguments.side.is_some() => unused("side", "a .glb or .obj"),
        ExportTarget::Scene(_) if arguments.bed.is_some() => unused("bed", "a .glb or .obj"),
        ExportTarget::Page if arguments.side.is_some() => unused("side", "a page"),
        ExportTarget::Page if arguments.bed.is_some() => unused("bed", "a page"),
        ExportTarget::Features(_) if arguments.max_error.is_some() => {
            unused("max-error", "a file of features")
        }
        ExportTarget::Features(_) if arguments.side.is_some() => unused("side", "a file of features"),
        ExportTarget::Features(_) if arguments.bed.is_some() => unused("bed", "a file of features"),
        ExportTarget::Features(format) => run_features(arguments, format),
        ExportTarget::Print(_) if arguments.max_error.is_some() => unused("max-error", "a model to print"),
        ExportTarget::Scene(format) => run_scene(arguments, format),
        ExportTarget::Page => run_page(arguments),
        ExportTarget::Print(format) => run_print(arguments, format),
    }
}

fn run_scene(arguments: &ExportArguments, format: ExportFormat) -> Result<(), CliError> {
    let (scene, out) = (&arguments.scene, &arguments.output);
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let scene = open_scene_true_to_scale(&scene.scene, &scene.access.allow, &progress)?;
    let max_error_m = arguments.max_error.unwrap_or(DEFAULT_MAX_ERROR_M);
    let exported = export(&scene, out, format, max_error_m, &progress, steps.step_watch().counted())?;
    steps.finish();
    let facts = [
        row(10, "objects", exported.list.items.len()),
        row(10, "triangles", exported.triangles),
        row(10, "materials", exported.list.materials.len()),
    ];
    let notes: Vec<&str> =
        scene.notes().into_iter().chain(exported.notes.iter().map(String::as_str)).collect();
    print_summary(&summary(&exported.files, &facts, &notes))
}

fn run_features(arguments: &ExportArguments, format: FeatureFormat) -> Result<(), CliError> {
    let (scene, out) = (&arguments.scene, &arguments.output);
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let scene = open_scene_true_to_scale(&scene.scene, &scene.access.allow, &progress)?;
    let exported = export_features(&scene, out, format, arguments.crs.as_ref(), &progress)?;
    steps.finish();
    let ExportedFeatures { layers, notes } = exported;
    let facts: Vec<String> = layers.iter().map(|(name, count)| row(15, name, count)).collect();
    let notes: Vec<&str> = scene.notes().into_iter().chain(notes.iter().map(String::as_str)).collect();
    print_summary(&summary(&[out], &facts, &notes))
}

fn run_page(arguments: &ExportArguments) -> Result<(), CliError> {
    let (scene, out) = (&arguments.scene, &arguments.output);
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let scene = open_scene(&scene.scene, &scene.access.allow, &progress)?;
    let page = export_page(&scene, out, arguments.max_error, &progress, steps.step_watch().counted())?;
    steps.finish();
    let facts = [
        row(10, "size", format!("{:.1} MB", page.bytes as f64 / 1e6)),
        row(
            10,
            "ground",
            format!("{} triangles, off by at most {} m", page.ground_triangles, page.max_error_m),
        ),
    ];
    print_summary(&summary(&[out], &facts, &scene.notes()))
}

fn run_print(arguments: &ExportArguments, format: PrintFormat) -> Result<(), CliError> {
    let (scene, out) = (&arguments.scene, &arguments.output);
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let scene = open_scene(&scene.scene, &scene.access.allow, &progress)?;
    disk::check_output(out, &scene.files)?;
    let size =
        PrintSize { side_mm: arguments.side.unwrap_or(SIDE_MM), bed_mm: arguments.bed.unwrap_or(BED_MM) };
    let model = print_model(&scene, size, &progress)
        .map_err(|error| CliError::input(format!("{}: {error}", arguments.scene.scene.display())))?;
    progress("writing");
    let files = print_model::write(&model, &scene, out, format)?;
    steps.finish();
    let PrintModel { pieces, counts: [across, deep], size_mm, scale, notes } = &model;
    let triangles: usize = pieces.iter().map(|piece| piece.mesh.triangles.len()).sum();
    let facts = [
        row(10, "size", format!("{:.1} x {:.1} x {:.1} mm, 1:{scale:.0}", size_mm.x, size_mm.y, size_mm.z)),
        row(
            10,
            "pieces",
            format!("{} ({across} from west to east, {deep} from south to north)", pieces.len()),
        ),
        row(10, "triangles", triangles),
    ];
    print_summary(&summary(
        &files,
        &facts,
        &scene.notes().into_iter().chain(notes.iter().map(String::as_str)).collect::<Vec<_>>(),
    ))
}

/// The files, what they hold, and notes.
fn summary(files: &[impl AsRef<Path>], facts: &[String], notes: &[&str]) -> Vec<String> {
    let files = files.iter().map(|path| path.as_ref().display().to_string());
    files.chain(facts.iter().cloned()).chain(notes.iter().map(|note| row(10, "note", note))).collect()
}
