//! Making the nested spheres anew beside the window, for a picture of another size or another tolerance.

use egui::Context;

use crate::roam::dynamic::SphereTask;
use crate::roam::spheres::SphereMap;
use crate::viewer::opened::OpenedScene;
use crate::viewer::worker::{WorkerFailure, WorkerJob};

/// Spheres that are being made.
pub struct Reaching {
    task: SphereTask,
    job: WorkerJob<SphereMap>,
}

impl OpenedScene {
    /// Whether spheres are being made.
    pub fn is_reaching(&self) -> bool {
        self.reaching.is_some()
    }

    /// Takes over the spheres that were made meanwhile, and begins to make others where the picture needs them.
    ///
    /// # Errors
    /// A fault of the program; the spheres before stay.
    pub fn follow_reach(&mut self, context: &Context) -> Result<(), WorkerFailure> {
        if let Some(done) = self.reaching.as_ref().and_then(|reaching| reaching.job.poll()) {
            let made = self.reaching.take().zip(Some(done?));
            if let Some((Reaching { task, .. }, spheres)) = made {
                self.walk.take_reach(&task, spheres);
            }
        }
        let Ok(camera) = self.camera(self.size) else { return Ok(()) };
        // Terrain on disk has spheres of its own.
        let is_shown = self.paged.as_ref().is_none_or(|paged| !paged.is_shown());
        let task = if self.reaching.is_none() && is_shown { self.walk.reach_task(&camera) } else { None };
        if let Some(task) = task {
            let (made, context) = (task.clone(), context.clone());
            let job = WorkerJob::start(move || made.spheres(), move || context.request_repaint());
            self.reaching = Some(Reaching { task, job });
        }
        Ok(())
    }
}
