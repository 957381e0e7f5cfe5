//! Answers to what the user asked that take reading a file, while they are awaited.

use crate::measuring::Measuring;
use crate::worker::WorkerJob;
use sandtable_walk::disk_ground::DiskGroundError;
use sandtable_walk::pick::WalkPick;

/// The result of a click, while it is awaited; `None` where there is no ground after all.
pub type PickJob = WorkerJob<Result<Option<WalkPick>, DiskGroundError>>;

/// Answers that are awaited; a newer question takes the place of the one before.
#[derive(Default)]
pub struct DiskAnswers {
    /// What was clicked at.
    pub pick: Option<PickJob>,
    /// What was measured last.
    pub measuring: Option<WorkerJob<Measuring>>,
}

impl DiskAnswers {
    /// Whether an answer is awaited.
    pub fn is_busy(&self) -> bool {
        self.pick.is_some() || self.measuring.is_some()
    }
}
