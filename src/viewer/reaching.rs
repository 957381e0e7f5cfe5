//! Rebuilds the ground in the background, for a picture of another size or another tolerance.

use egui::Context;

use crate::opened::OpenedScene;
use crate::worker::{WorkerFailure, WorkerJob, drop_apart};

impl OpenedScene {
    /// Whether the ground is being rebuilt.
    pub fn is_reaching(&self) -> bool {
        self.reaching.is_some()
    }

    /// Takes over a ground that has become ready, and begins to make another where the picture needs it.
    ///
    /// # Errors
    /// A fault of the program; the ground before stays.
    pub fn follow_reach(&mut self, context: &Context) -> Result<(), WorkerFailure> {
        if let Some(done) = WorkerJob::take(&mut self.reaching) {
            drop_apart(self.walk.take_reach(done?));
        }
        let Ok(camera) = self.camera(self.size) else { return Ok(()) };
        // Terrain on disk has spheres of its own.
        let is_shown = self.paged.as_ref().is_none_or(|paged| !paged.is_shown());
        let task = if self.reaching.is_none() && is_shown { self.walk.reach_task(&camera) } else { None };
        if let Some(task) = task {
            self.reaching = Some(WorkerJob::start(context, move || task.ground()));
        }
        Ok(())
    }
}
