//! Background jobs that rebuild parts of an open scene, while the old parts are shown.

use std::sync::Arc;

use glam::Vec3;

use crate::worker::WorkerJob;
use sandtable_draw::list::DrawList;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::live::prepared::PreparedScene;
use sandtable_view::camera::Camera;
use sandtable_walk::pick::StandingIndex;
use sandtable_walk::reach::ReachedGround;
use sandtable_walk::standing_task::StandingTask;

/// The ground that is being made.
pub type Reaching = WorkerJob<ReachedGround>;

/// A list that is being made.
pub struct Relisting {
    pub task: StandingTask,
    pub job: WorkerJob<Result<RelistedScene, GpuError>>,
}

/// A list that was made.
pub struct RelistedScene {
    pub list: Arc<DrawList>,
    pub standing: StandingIndex,
    pub prepared: Option<PreparedScene>,
    pub eye: Vec3,
    /// The camera that its shadows are for.
    pub seen: Camera,
}
