//! Gathering: which shards are missing or stale, and the product of all.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::{PlannedProduct, ShardPlan};
use crate::record::{self, ShardState};
use crate::{analysis, atlas, heights, tiles, viewsheds};
use sandtable_analysis::outcome::Outcome;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::formats::WRITTEN_EXTENSIONS;
use sandtable_export::features::FeatureFormat;
use sandtable_files::disk;
use sandtable_query::analysis::WrittenArgument;
use sandtable_terrain::stop_flag::StopFlag;

/// The states of the shards of a plan, by their numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanProgress(Vec<ShardState>);

impl PlanProgress {
    /// Reads the records and results of all shards of a plan; one whose results are not those of its record is stale. `watch` says
    /// how many are read.
    pub fn read(plan: &ShardPlan, watch: &StopFlag) -> Self {
        watch.stretch(0.0..1.0, plan.count());
        let state = |id: usize| {
            let state = record::verified_state(plan, id);
            watch.did(1);
            state
        };
        Self((0..plan.count()).into_par_iter().map(state).collect())
    }

    /// The numbers of the shards in a state.
    pub fn with(&self, state: ShardState) -> Vec<usize> {
        (0..self.0.len()).filter(|&id| self.0[id] == state).collect()
    }

    /// Whether all shards are done.
    pub fn is_complete(&self) -> bool {
        self.0.iter().all(|&state| state == ShardState::Done)
    }
}

/// What was gathered.
#[derive(Default)]
pub struct GatheredProduct {
    /// The files that were written.
    pub files: Vec<PathBuf>,
    /// Of an analysis its figures, tables and notes.
    pub outcome: Option<GatheredOutcome>,
}

/// What an analysis gives besides its raster.
pub struct GatheredOutcome {
    /// The kind.
    pub kind: &'static AnalysisKind,
    /// The arguments of the plan.
    pub arguments: Vec<WrittenArgument>,
    /// The outcome, without its raster.
    pub outcome: Outcome,
}

impl From<Vec<PathBuf>> for GatheredProduct {
    fn from(files: Vec<PathBuf>) -> Self {
        Self { files, outcome: None }
    }
}

/// Writes the product of a plan, to `out` or into the plan's folder, and returns its files: where all shards are done, or an
/// index of those that are. `watch` says which share of heights, viewsheds and rasters is joined.
///
/// # Errors
/// An input has changed, a file cannot be read or written, or `out` has no extension of the product.
pub fn gather(
    plan: &ShardPlan,
    progress: &PlanProgress,
    out: Option<&Path>,
    watch: &StopFlag,
) -> Result<GatheredProduct, ShardError> {
    let own = |name: &str| out.map_or_else(|| plan.folder.join(name), Path::to_owned);
    match &plan.product {
        PlannedProduct::Atlas(arguments) => {
            let page = checked(plan, own("index.html"))?;
            let items = checked(plan, page.with_file_name("items.json"))?;
            plan.verify_inputs()?;
            atlas::gather::gather(plan, arguments, &progress.0, (&page, &items))?;
            Ok(vec![page, items].into())
        }
        _ if !progress.is_complete() => Ok(GatheredProduct::default()),
        PlannedProduct::Heights(arguments) => {
            let out = checked(plan, own("heights.csv"))?;
            plan.verify_inputs()?;
            heights::gather::gather(plan, arguments, &out, watch)?;
            Ok(vec![out].into())
        }
        PlannedProduct::Tiles(arguments) => Ok(vec![tiles::gather::gather(plan, arguments, out)?].into()),
        PlannedProduct::Viewsheds(arguments) => {
            let out = checked(plan, own("viewsheds.tif"))?;
            let format = raster_format(&out)?;
            plan.verify_inputs()?;
            viewsheds::gather::gather(plan, arguments, (&out, format), watch)?;
            Ok(vec![out].into())
        }
        PlannedProduct::Analysis(arguments) => {
            let out = checked(plan, own("analysis.tif"))?;
            let format = analysis_format(&out)?;
            plan.verify_inputs()?;
            let outcome = match format {
                GatheredFormat::Raster(format) => {
                    analysis::gather::gather(plan, arguments, (&out, format), watch)?
                }
                GatheredFormat::Features(format) => {
                    analysis::gather::gather_features(plan, arguments, (&out, format), watch)?
                }
            };
            let (kind, arguments) = (arguments.kind(&plan.folder)?, arguments.written());
            Ok(GatheredProduct {
                files: vec![out],
                outcome: Some(GatheredOutcome { kind, arguments, outcome }),
            })
        }
    }
}

/// A file of an analysis.
enum GatheredFormat {
    Raster(&'static DemFormat),
    Features(FeatureFormat),
}

/// The format of a file of an analysis.
fn analysis_format(out: &Path) -> Result<GatheredFormat, ShardError> {
    let extension = out.extension().unwrap_or_default().to_string_lossy().into_owned();
    match FeatureFormat::from_extension(&extension) {
        Some(format @ (FeatureFormat::GeoPackage | FeatureFormat::GeoJson)) => {
            Ok(GatheredFormat::Features(format))
        }
        _ => DemFormat::to_write(&extension).map(GatheredFormat::Raster).ok_or_else(|| {
            let message = format!(
                "analyses are gathered as .gpkg or .geojson, and their rasters as {WRITTEN_EXTENSIONS}; name a file that \
                 ends so"
            );
            PlanError::new(out, PlanFault::Output(message)).into()
        }),
    }
}

/// The format of a raster's file.
fn raster_format(out: &Path) -> Result<&'static DemFormat, ShardError> {
    let extension = out.extension().unwrap_or_default().to_string_lossy().into_owned();
    DemFormat::to_write(&extension).ok_or_else(|| {
        let message = format!("rasters are written as {WRITTEN_EXTENSIONS}; name a file that ends so");
        PlanError::new(out, PlanFault::Output(message)).into()
    })
}

/// A path to which a product can be written: none of an input.
fn checked(plan: &ShardPlan, out: PathBuf) -> Result<PathBuf, ShardError> {
    let inputs: Vec<PathBuf> = plan.inputs.iter().map(|input| plan.folder.join(&input.path)).collect();
    disk::check_output(&out, &inputs)?;
    Ok(out)
}
