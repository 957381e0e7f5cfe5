//! Rebuilds the ground in the background, for a picture of another size or another tolerance.
//!
//! Where the picture has fewer pixels while it moves, so has its ground fewer triangles: as many as those pixels tell apart. The
//! ground of the whole picture is kept aside meanwhile, and that of the moving one while it rests, so that neither is made twice.

use egui::Context;

use crate::opened::OpenedScene;
use crate::worker::{WorkerFailure, WorkerJob, drop_apart};
use sandtable_view::camera::Camera;
use sandtable_walk::reach::ReachedGround;

impl OpenedScene {
    /// Whether the ground of the whole picture is being rebuilt.
    pub fn is_reaching(&self) -> bool {
        self.reaching.is_some() && self.drawn == self.size
    }

    /// Takes over a ground that has become ready, and begins to make another where the picture needs it.
    ///
    /// # Errors
    /// A fault of the program; the ground before stays.
    pub fn follow_reach(&mut self, context: &Context) -> Result<(), WorkerFailure> {
        let Ok(camera) = self.camera(self.size) else { return Ok(()) };
        let drawn = camera.resized(self.drawn);
        if let Some(done) = WorkerJob::take(&mut self.reaching) {
            let made = done?;
            let is_late = self.walk.suits(&drawn);
            let other = if is_late { made } else { self.walk.take_reach(made) };
            self.lay_aside(other, &camera);
        }
        let task = if self.wants_ground(&drawn) { self.walk.reach_task(&drawn) } else { None };
        if let Some(task) = task {
            self.reaching = Some(WorkerJob::start(context, move || task.ground()));
        }
        Ok(())
    }

    /// Whether the ground for a camera's picture is neither there nor being made.
    pub(super) fn wants_ground(&self, camera: &Camera) -> bool {
        // Terrain on disk has spheres of its own.
        let is_shown = self.paged.as_ref().is_none_or(|paged| !paged.is_shown());
        let is_aside = || self.aside.as_ref().is_some_and(|aside| self.walk.would_suit(aside, camera));
        is_shown && self.reaching.is_none() && !self.walk.suits(camera) && !is_aside()
    }

    /// Shows the ground that lies aside where that suits a camera's picture, and the one shown does not.
    pub(super) fn exchange_ground(&mut self, camera: &Camera) {
        if self.walk.suits(camera) {
            return;
        }
        let walk = &self.walk;
        if let Some(aside) = self.aside.take_if(|aside| walk.would_suit(aside, camera)) {
            self.aside = Some(self.walk.take_reach(aside));
        }
    }

    /// Shows the ground of the whole picture, if it is there, and keeps none aside: an edit would copy what both share.
    pub fn leave_one_ground(&mut self) {
        if let Ok(camera) = self.camera(self.size) {
            self.exchange_ground(&camera);
        }
        self.aside.take().into_iter().for_each(drop_apart);
    }

    /// Keeps a ground aside, where pictures have fewer pixels at times; that of the whole picture, which `camera` sees, before any
    /// other.
    fn lay_aside(&mut self, ground: ReachedGround, camera: &Camera) {
        let is_whole = |aside: &ReachedGround| self.walk.would_suit(aside, camera);
        let is_needed = self.is_lowered_at_times
            && (self.walk.suits(camera) || is_whole(&ground) || !self.aside.as_ref().is_some_and(is_whole));
        let left = if is_needed { self.aside.replace(ground) } else { Some(ground) };
        left.into_iter().for_each(drop_apart);
    }
}
