//! `sandtable plan`: work in shards.

use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::json;

use crate::error::CliError;
use crate::height::PointQueryArguments;
use crate::options::{AccessArguments, DatasetArguments, HeightArguments, SceneArguments};
use crate::output::print;
use crate::plan_analysis::{self, PlanAnalysisCommand};
use crate::values::{choice, number};
use crate::viewshed::SightConditions;
use sandtable_description::document::PAPER_DPI;
use sandtable_description::words::PaperName;
use sandtable_files::disk;
use sandtable_geom::crs::Crs;
use sandtable_render::backend_name::BackendName;
use sandtable_shards::atlas::arguments::{AtlasArguments, atlas_scene, pixel_m};
use sandtable_shards::atlas::plan::plan as plan_atlas;
use sandtable_shards::heights::arguments::HeightsArguments;
use sandtable_shards::heights::plan::plan as plan_heights;
use sandtable_shards::plan_path::written;
use sandtable_shards::planned_dataset::{PlannedDataset, PlannedWord, QueriedDataset};
use sandtable_shards::tiles::encoding::TileEncoding;
use sandtable_shards::tiles::plan::{TilesRequest, plan as plan_tiles};
use sandtable_shards::viewsheds::arguments::ViewshedsArguments;
use sandtable_shards::viewsheds::plan::plan as plan_viewsheds;
use sandtable_terrain::query::Surface;

/// What is planned.
#[derive(Debug, Subcommand)]
pub enum PlanCommand {
    /// Heights of many points, as `height` prints them
    Heights(PlanHeightsArguments),
    /// How many of many observers see each post of the ground
    Viewsheds(PlanViewshedsArguments),
    /// Annotated sheets of a scene side by side, at a true scale
    Atlas(PlanAtlasArguments),
    /// Terrain tiles for globes and maps in browsers: quantized-mesh, terrain-RGB
    Tiles(PlanTilesArguments),
    /// A terrain analysis whose values depend on the land around them, as `analyze` writes its raster
    #[command(subcommand)]
    Analysis(PlanAnalysisCommand),
}

#[derive(Debug, Args)]
pub struct PlanHeightsArguments {
    #[command(flatten)]
    dataset: DatasetArguments,
    /// A CSV file of x,y, with or without a header
    #[arg(long, value_name = "CSV")]
    points: PathBuf,
    #[command(flatten)]
    query: PointQueryArguments,
    #[command(flatten)]
    plan: PlanOptions,
}

#[derive(Debug, Args)]
#[command(
    after_help = "A raster holds how many observers see each post, and no data where none looks or there is no elevation."
)]
pub struct PlanViewshedsArguments {
    #[command(flatten)]
    dataset: DatasetArguments,
    /// A CSV file of the observers' x,y, with or without a header
    #[arg(long, value_name = "CSV")]
    points: PathBuf,
    #[command(flatten)]
    conditions: SightConditions,
    #[command(flatten)]
    plan: PlanOptions,
}

#[derive(Debug, Args)]
#[command(
    after_help = "A sheet is a plan of the scene, with the scene's furniture; `layout = \"margin\"` of it names the neighbors."
)]
pub struct PlanAtlasArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The n of the map scale 1:n of the sheets
    #[arg(long, value_name = "N", value_parser = number::<f64>(1.0..=1e9, "write the n of a scale 1:n, as in 25000"))]
    scale: f64,
    /// The paper of a sheet
    #[arg(long, default_value = "A4", value_parser = choice::<PaperName>())]
    paper: PaperName,
    /// Turn the paper upright
    #[arg(long)]
    portrait: bool,
    /// Pixels per inch
    #[arg(long, value_name = "DPI", default_value_t = PAPER_DPI, value_parser = number::<f64>(10.0..=1e4, "write a number from 10 to 10000"))]
    dpi: f64,
    /// The renderer of all sheets: the processor, the same on every machine, or a graphics adapter
    #[arg(long, default_value = "cpu", value_parser = choice::<BackendName>())]
    backend: BackendName,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// The folder of the plan
    #[arg(short, long, value_name = "PLAN")]
    output: PathBuf,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Of quantized-mesh, heights above EGM96 are brought to the ellipsoid; others are taken as they are.\n\
                  Colors have the heights of the file. Without elevation, tiles lie at 0; pictures of nothing else are left out."
)]
pub struct PlanTilesArguments {
    /// The elevation file or scene
    file: PathBuf,
    /// How tiles state heights
    #[arg(long, default_value = "quantized-mesh", value_parser = choice::<TileEncoding>())]
    encoding: TileEncoding,
    /// The finest level [default: as fine as the elevation]
    #[arg(long, value_name = "Z", value_parser = clap::value_parser!(u32).range(0..=22))]
    max_zoom: Option<u32>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    heights: HeightArguments,
    #[command(flatten)]
    access: AccessArguments,
    /// The folder of the plan
    #[arg(short, long, value_name = "PLAN")]
    output: PathBuf,
}

/// The shards and the folder of a plan.
#[derive(Debug, Args)]
pub struct PlanOptions {
    /// About how many shards there are to be [default: as many as take some seconds each]
    #[arg(long, value_name = "N")]
    pub shards: Option<NonZeroU64>,
    /// The folder of the plan
    #[arg(short, long, value_name = "PLAN")]
    pub output: PathBuf,
}

pub fn run(command: &PlanCommand) -> Result<(), CliError> {
    match command {
        PlanCommand::Heights(arguments) => run_heights(arguments),
        PlanCommand::Viewsheds(arguments) => run_viewsheds(arguments),
        PlanCommand::Atlas(arguments) => run_atlas(arguments),
        PlanCommand::Tiles(arguments) => run_tiles(arguments),
        PlanCommand::Analysis(command) => plan_analysis::run(command),
    }
}

fn run_heights(arguments: &PlanHeightsArguments) -> Result<(), CliError> {
    let PlanHeightsArguments { dataset, points, query, plan } = arguments;
    let (queried, folder) = open(dataset, points, plan)?;
    let surface = query.surface.unwrap_or_else(|| queried.dataset.default_surface());
    if surface != Surface::Source {
        dataset.note_ground(&queried.dataset)?;
    }
    // What is gathered has positions in the system in which they were planned.
    let crs = Some(&queried.crs).filter(|crs| **crs != Crs::local());
    let planned = HeightsArguments {
        dataset: PlannedDataset::new(&dataset.file, &dataset.options(), crs, folder),
        points: written(points, folder),
        surface: PlannedWord(surface),
        interpolation: PlannedWord(query.interpolation),
        above: query.above.map(PlannedWord),
    };
    let shards = plan_heights(planned, &queried, plan.shards.map(NonZeroU64::get), folder)?;
    report(folder, "heights", shards, dataset.json)
}

fn run_viewsheds(arguments: &PlanViewshedsArguments) -> Result<(), CliError> {
    let PlanViewshedsArguments { dataset, points, conditions, plan } = arguments;
    let (queried, folder) = open(dataset, points, plan)?;
    dataset.note_ground(&queried.dataset)?;
    let planned = ViewshedsArguments {
        dataset: planned(dataset, folder),
        points: written(points, folder),
        observer_height: conditions.observer_height,
        target_height: conditions.target_height,
        range: conditions.range,
        refraction: (!conditions.flat).then_some(conditions.refraction),
    };
    let shards = plan_viewsheds(planned, &queried, plan.shards.map(NonZeroU64::get), folder)?;
    report(folder, "viewsheds", shards, dataset.json)
}

fn run_atlas(arguments: &PlanAtlasArguments) -> Result<(), CliError> {
    let SceneArguments { scene, access } = &arguments.scene;
    let opened =
        atlas_scene(scene, &access.allow, (pixel_m(arguments.scale, arguments.dpi), arguments.backend))?;
    let folder = &arguments.output;
    disk::make_folder(folder)?;
    let planned = AtlasArguments {
        scene: written(scene, folder),
        allow: access.allow.iter().map(|allowed| written(allowed, folder)).collect(),
        scale: arguments.scale,
        paper: PlannedWord(arguments.paper),
        portrait: arguments.portrait,
        dpi: arguments.dpi,
        backend: PlannedWord(arguments.backend),
    };
    let sheets = plan_atlas(planned, &opened, folder)?;
    report(folder, "atlas", sheets, arguments.json)
}

fn run_tiles(arguments: &PlanTilesArguments) -> Result<(), CliError> {
    let PlanTilesArguments { file, encoding, max_zoom, heights, access, output, .. } = arguments;
    let (heights, access) = (heights.clone(), access.clone());
    let crs = Some(Crs::wgs84());
    let dataset = DatasetArguments { file: file.clone(), crs, json: arguments.json, heights, access };
    let opened = dataset.open()?;
    disk::make_folder(output)?;
    let queried = QueriedDataset { path: file.clone(), crs: dataset.crs(&opened), dataset: opened };
    let request = TilesRequest { encoding: *encoding, max_zoom: *max_zoom };
    let shards = plan_tiles(planned(&dataset, output), &queried, request, output)?;
    report(output, "tiles", shards, arguments.json)
}

/// Opens the dataset, and makes the folder of the plan.
fn open<'a>(
    dataset: &DatasetArguments,
    points: &Path,
    plan: &'a PlanOptions,
) -> Result<(QueriedDataset, &'a Path), CliError> {
    if points == Path::new("-") {
        return Err(CliError::usage(
            "standard input is read once, and a plan reads its points twice; name a file",
        ));
    }
    let opened = dataset.open()?;
    let crs = dataset.crs(&opened);
    disk::make_folder(&plan.output)?;
    Ok((QueriedDataset { path: dataset.file.clone(), dataset: opened, crs }, &plan.output))
}

/// The dataset of a plan in `folder`.
pub fn planned(dataset: &DatasetArguments, folder: &Path) -> PlannedDataset {
    PlannedDataset::new(&dataset.file, &dataset.options(), dataset.crs.as_ref(), folder)
}

/// Says what was planned.
pub fn report(folder: &Path, product: &str, shards: usize, is_json: bool) -> Result<(), CliError> {
    let plan = folder.display().to_string();
    if is_json {
        return print(&format!("{:#}\n", json!({ "plan": plan, "product": product, "shards": shards })));
    }
    let noun = if shards == 1 { "shard" } else { "shards" };
    print(&format!("{plan}: {shards} {noun} of {product}, 0 to {}\n", shards - 1))
}
