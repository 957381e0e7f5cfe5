//! The shadows of an open scene: their inputs and their progress.

use std::time::{Duration, Instant};

use crate::worker::WorkerJob;
use sandtable_draw::list::DrawList;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::live::LiveShadows;
use sandtable_gpu::live::prepared::PreparedShadows;
use sandtable_view::camera::Camera;
use sandtable_walk::shown_ground::ShownGround;

/// The inputs of shadows.
pub struct ShadowedView {
    /// How it is seen.
    pub camera: Camera,
    /// The ground as it is shown.
    pub ground: ShownGround,
}

/// The shadows of an open scene.
#[derive(Default)]
pub struct ShadowState {
    /// The camera that they were made for last; `None` where they are to be made anew.
    pub(super) made_for: Option<Camera>,
    /// The camera of the frame before, and since when it is the same.
    pub(super) rests: Option<(Camera, Instant)>,
    pub(super) job: Option<WorkerJob<Result<Option<PreparedShadows>, GpuError>>>,
    /// What the renderer is to take over.
    pub(super) ready: Option<PreparedShadows>,
}

impl ShadowedView {
    /// The shadows of a list.
    ///
    /// # Errors
    /// [`GpuError::List`] where the list is unsound, [`GpuError::Memory`] where there is not the memory for them.
    pub fn shadows(&self, list: &DrawList) -> Result<LiveShadows, GpuError> {
        LiveShadows::new(&self.ground.with_list(list), &self.camera)
    }
}

impl ShadowState {
    /// The renderer gets shadows for `camera` with a list.
    pub fn made_for(&mut self, camera: Camera) {
        (self.made_for, self.job, self.ready) = (Some(camera), None, None);
    }

    /// Marks the shadows as outdated: the ground, or an object on it, has changed.
    pub fn forget(&mut self) {
        self.made_for = None;
    }

    /// Shadows that the renderer has not taken over.
    pub fn take_ready(&mut self) -> Option<PreparedShadows> {
        self.ready.take()
    }

    /// The time since `camera` last changed.
    pub fn rest(&mut self, camera: &Camera) -> Duration {
        match &self.rests {
            Some((before, since)) if before == camera => since.elapsed(),
            _ => {
                self.rests = Some((*camera, Instant::now()));
                Duration::ZERO
            }
        }
    }
}
