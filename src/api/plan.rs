//! Work that exceeds one machine, cut into shards.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::api::error::Error;
use crate::api::gpu_renderer::GPU;
use sandtable_shards::gather::{PlanProgress, gather};
use sandtable_shards::plan::ShardPlan;
use sandtable_shards::record::ShardState;
use sandtable_shards::work::{ShardWorker, is_done};
use sandtable_terrain::stop_flag::StopFlag;

/// A plan that the command `plan` wrote, in the format of `src/shards/SHARDS.md`. Its shards may be done from many threads,
/// programs and machines, in any order.
pub struct WorkPlan {
    plan: Arc<ShardPlan>,
    /// What shards share, opened, for each thread that did one; taken out while one does.
    idle: Mutex<Vec<ShardWorker>>,
}

/// The progress of a plan, and the files that `gather` wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GatheredPlan {
    /// The number of shards whose results exist and match their records.
    pub done: usize,
    /// The numbers of the shards without a record.
    pub missing: Vec<usize>,
    /// The numbers of the shards whose record is of another plan, or whose results do not match their record.
    pub stale: Vec<usize>,
    /// The files that were written: the product if all shards are done, else at most an index.
    pub output: Vec<PathBuf>,
}

impl WorkPlan {
    /// The plan in a folder.
    ///
    /// # Errors
    /// [`Error::Plan`].
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self { plan: Arc::new(ShardPlan::open(folder.as_ref())?), idle: Mutex::default() })
    }

    /// What is made: `heights`, `viewsheds`, `atlas`, `tiles` or `analysis`.
    pub fn product(&self) -> &'static str {
        self.plan.product.word()
    }

    /// The number of shards.
    pub fn count(&self) -> usize {
        self.plan.count()
    }

    /// Whether a shard is done, by its record and the sizes of its files.
    pub fn is_done(&self, shard: usize) -> bool {
        is_done(&self.plan, shard)
    }

    /// Checks that the inputs have not changed since the plan was made.
    ///
    /// # Errors
    /// [`Error::Plan`] names the first that is not.
    pub fn verify_inputs(&self) -> Result<(), Error> {
        Ok(self.plan.verify_inputs()?)
    }

    /// Processes a shard, even one that is done: writes its results, then its record. The first one of a thread checks and
    /// opens the inputs, which later ones share.
    ///
    /// # Errors
    /// [`Error::Plan`]; other shards may still be done.
    pub fn work(&self, shard: usize) -> Result<(), Error> {
        let idle = self.idle().pop();
        let mut worker = match idle {
            Some(worker) => worker,
            None => ShardWorker::open(&self.plan, GPU)?,
        };
        worker.work(shard)?;
        self.idle().push(worker);
        Ok(())
    }

    /// Returns the progress of the plan; if all shards are done, also writes the product, to `out` or into the plan's
    /// folder.
    ///
    /// # Errors
    /// [`Error::Plan`].
    pub fn gather(&self, out: Option<&Path>) -> Result<GatheredPlan, Error> {
        let watch = StopFlag::default();
        let progress = PlanProgress::read(&self.plan, &watch);
        let output = gather(&self.plan, &progress, out, &watch)?.files;
        let (missing, stale) = (progress.with(ShardState::Missing), progress.with(ShardState::Stale));
        Ok(GatheredPlan { done: progress.with(ShardState::Done).len(), missing, stale, output })
    }

    fn idle(&self) -> MutexGuard<'_, Vec<ShardWorker>> {
        // Workers are put in whole.
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
