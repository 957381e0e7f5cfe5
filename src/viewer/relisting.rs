//! Rebuilds the list of solids and models while the old one is shown: for another sun, features that are hidden, ground that
//! moved under models, an eye that is far from where it was.

use std::sync::Arc;

use egui::Context;

use crate::opened::{FIRST_SIZE, OpenedScene};
use crate::scene_jobs::{RelistedScene, Relisting};
use crate::scene_load::{LoaderSlot, SceneLoad};
use crate::shadow_state::ShadowedView;
use crate::worker::{WorkerFailure, WorkerJob, drop_apart};
use sandtable_draw::patches::GroundChanges;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::live::KeptPatches;
use sandtable_walk::pick::StandingIndex;

/// Why a list cannot be shown; the one before stays.
#[derive(Debug, thiserror::Error)]
pub enum RelistingError {
    /// The device cannot hold it.
    #[error(transparent)]
    Graphics(#[from] GpuError),
    /// A fault of the program.
    #[error(transparent)]
    Worker(#[from] WorkerFailure),
}

impl OpenedScene {
    /// Requests a new list of solids and models; it is shown when it is ready.
    pub fn relist(&mut self) {
        self.wants_list = true;
    }

    /// Whether a new list of solids and models is being made.
    pub fn is_relisting(&self) -> bool {
        self.wants_list || self.relisting.is_some()
    }

    /// Takes over a list that has become ready, and begins the next one that was requested.
    ///
    /// # Errors
    /// See [`RelistingError`].
    pub fn follow_relisting(&mut self, context: &Context, slot: &LoaderSlot) -> Result<(), RelistingError> {
        let done = self.relisting.as_ref().and_then(|relisting| relisting.job.poll());
        let taken = done.map_or(Ok(()), |done| self.take_relisted(done));
        if self.relisting.is_none() && std::mem::take(&mut self.wants_list) {
            self.start_relisting(context, slot);
        }
        taken
    }

    fn take_relisted(
        &mut self,
        done: Result<Result<RelistedScene, GpuError>, WorkerFailure>,
    ) -> Result<(), RelistingError> {
        let Some(relisting) = self.relisting.take() else { return Ok(()) };
        let RelistedScene { list, standing, prepared, eye, seen } = done??;
        self.walk.take_standing(&relisting.task, &list);
        drop_apart((
            std::mem::replace(&mut self.list, list),
            std::mem::replace(&mut self.standing, standing),
        ));
        self.list_eye = eye;
        // A list that was not shown yet took the ground with it.
        let load = match (&self.load, prepared) {
            (None, Some(prepared)) => {
                self.shadows.made_for(seen);
                SceneLoad { list: Arc::clone(&self.list), prepared: Some(prepared), kept: KeptPatches::All }
            }
            _ => {
                self.shadows.forget();
                SceneLoad::unprepared(&self.list)
            }
        };
        self.load = Some(load);
        Ok(())
    }

    fn start_relisting(&mut self, context: &Context, slot: &LoaderSlot) {
        let (Ok(camera), Ok(seen)) = (self.camera(FIRST_SIZE), self.camera(self.size)) else { return };
        let shadowed = ShadowedView { camera: seen, ground: self.walk.shown_ground() };
        let task = self.walk.standing_task(self.wanted_sun);
        let (made, hidden, slot) = (task.clone(), self.hidden.clone(), slot.clone());
        let has_windows = self.finer.is_some();
        let work = move || {
            let mut list = made.list(&camera, &|_| ());
            list.items.retain(|item| !hidden.contains(&item.feature));
            let mut prepared = slot.prepare(&list, &shadowed, &GroundChanges::default())?;
            if has_windows {
                slot.expect_windows(&mut prepared)?;
            }
            let list = Arc::new(list);
            let standing = StandingIndex::new(Arc::clone(&list));
            Ok(RelistedScene { list, standing, prepared, eye: camera.eye(), seen })
        };
        let job = WorkerJob::start(context, work);
        self.relisting = Some(Relisting { task, job });
    }
}
