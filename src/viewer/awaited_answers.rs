//! Awaited answers to requests of the user that need reading a file.

use crate::measuring::Measuring;
use crate::worker::WorkerJob;
use sandtable_walk::disk_ground::DiskGroundError;
use sandtable_walk::pick::WalkPick;

/// The result of a click, while it is awaited; `None` where there is no ground after all.
pub type PickJob = WorkerJob<Result<Option<WalkPick>, DiskGroundError>>;

/// Answers that are awaited; a newer question takes the place of the one before.
#[derive(Default)]
pub struct DiskAnswers {
    /// The last click.
    pub pick: Option<PickJob>,
    /// The last measurement.
    pub measuring: Option<WorkerJob<Measuring>>,
}

impl DiskAnswers {
    /// Whether an answer is awaited.
    pub fn is_busy(&self) -> bool {
        self.pick.is_some() || self.measuring.is_some()
    }
}
