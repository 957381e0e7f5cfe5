//! Gathering: which shards are missing or stale, and the product of all.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::dem::formats::{DemFormat, WRITTEN_EXTENSIONS};
use crate::pipeline::files;
use crate::pipeline::shards::error::{PlanError, PlanFault, ShardError};
use crate::pipeline::shards::plan::{PlannedProduct, ShardPlan};
use crate::pipeline::shards::record::{self, ShardState};
use crate::pipeline::shards::work::extension;
use crate::pipeline::shards::{heights, viewsheds};

/// How far the shards of a plan are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlanProgress {
    /// The number of those whose results are there, and are those of their records.
    pub done: usize,
    /// The numbers of those without a record.
    pub missing: Vec<usize>,
    /// The numbers of those whose record is of another plan, or whose results are not those of it.
    pub stale: Vec<usize>,
}

impl PlanProgress {
    /// Reads the records and results of all shards of a plan.
    pub fn read(plan: &ShardPlan) -> Self {
        let extension = extension(plan);
        let state = |id: usize| match record::state(plan, id, extension) {
            ShardState::Done if record::verify_result(plan, id, extension).is_err() => ShardState::Stale,
            state => state,
        };
        let states: Vec<ShardState> = (0..plan.count()).into_par_iter().map(state).collect();
        let with =
            |wanted: ShardState| (0..states.len()).filter(|&id| states[id] == wanted).collect::<Vec<usize>>();
        let (missing, stale) = (with(ShardState::Missing), with(ShardState::Stale));
        Self { done: with(ShardState::Done).len(), missing, stale }
    }

    /// Whether all shards are done.
    pub fn is_complete(&self) -> bool {
        self.missing.is_empty() && self.stale.is_empty()
    }
}

/// Writes the product of a plan whose shards are all done, to `out` or into the plan's folder; returns the files.
///
/// # Errors
/// An input has changed, a file cannot be read or written, or `out` has no extension of the product.
pub fn gather(plan: &ShardPlan, out: Option<&Path>) -> Result<Vec<PathBuf>, ShardError> {
    let own = |name: &str| out.map_or_else(|| plan.folder.join(name), Path::to_owned);
    match &plan.product {
        PlannedProduct::Heights(arguments) => {
            let out = checked(plan, own("heights.csv"))?;
            plan.verify_inputs()?;
            heights::gather::gather(plan, arguments, &out)?;
            Ok(vec![out])
        }
        PlannedProduct::Viewsheds(arguments) => {
            let out = checked(plan, own("viewsheds.tif"))?;
            let extension = out.extension().unwrap_or_default().to_string_lossy().into_owned();
            let format = DemFormat::to_write(&extension).ok_or_else(|| {
                let message =
                    format!("rasters are written as {WRITTEN_EXTENSIONS}; name a file that ends so");
                PlanError::new(&out, PlanFault::Output(message))
            })?;
            plan.verify_inputs()?;
            viewsheds::gather::gather(plan, arguments, &out, format)?;
            Ok(vec![out])
        }
    }
}

/// A path to which a product can be written: none of an input.
fn checked(plan: &ShardPlan, out: PathBuf) -> Result<PathBuf, ShardError> {
    let inputs: Vec<PathBuf> = plan.inputs.iter().map(|input| plan.folder.join(&input.path)).collect();
    files::check_output(&out, &inputs)?;
    Ok(out)
}
