//! Shadows of solids and models, computed in the background when the camera has come to rest.
//!
//! A shadow map is right wherever it reaches, whatever the eye does; only how fine it is depends on where the eye was. So it
//! stays while the camera moves, and is made anew when that rests elsewhere.

use std::time::Duration;

use egui::Context;
use glam::Vec3;

use crate::opened::OpenedScene;
use crate::relisting::RelistingError;
use crate::scene_load::LoaderSlot;
use crate::shadow_state::ShadowedView;
use crate::worker::WorkerJob;
use sandtable_view::camera::Camera;

/// How long the camera rests before shadows are made for it: shorter makes them during a flight with pauses.
const REST: Duration = Duration::from_millis(200);
/// The share of its height above the ground by which the eye may have moved: texels are then a tenth too large or too small.
const STALE_SHARE: f32 = 0.1;
/// The cosine of the angle by which the view may have turned, 4 degrees: shadows may be missing so far inside its border.
const STALE_COSINE: f32 = 0.9976;
/// The least height above the ground that is counted with, in meters.
const LEAST_HEIGHT_M: f32 = 20.0;

impl OpenedScene {
    /// Takes over shadows that have become ready, and begins to make others where the camera rests elsewhere.
    ///
    /// # Errors
    /// See [`RelistingError`]; the shadows before stay.
    pub fn follow_shadows(&mut self, context: &Context, slot: &LoaderSlot) -> Result<(), RelistingError> {
        if let Some(done) = WorkerJob::take(&mut self.shadows.job) {
            self.shadows.ready = done??;
        }
        let Ok(camera) = self.camera(self.size) else { return Ok(()) };
        if !slot.is_filled() || self.is_relisting() || self.shadows.job.is_some() || !self.is_stale(&camera) {
            return Ok(());
        }
        let rest = self.shadows.rest(&camera);
        if rest < REST {
            context.request_repaint_after(REST - rest);
            return Ok(());
        }
        let view = ShadowedView { camera, ground: self.walk.shown_ground() };
        let (list, slot) = (std::sync::Arc::clone(&self.list), slot.clone());
        let work = move || {
            let Some(loader) = slot.loader() else { return Ok(None) };
            loader.cast_shadows(&view.ground.with_list(&list), &view.camera).map(Some)
        };
        self.shadows.made_for = Some(camera);
        self.shadows.job = Some(WorkerJob::start(context, work));
        Ok(())
    }

    /// Whether the shadows were made for another view than `camera` has.
    fn is_stale(&self, camera: &Camera) -> bool {
        let Some(before) = &self.shadows.made_for else { return true };
        let eye = camera.eye();
        let below = self.ground_z(eye.truncate().as_dvec2());
        let height_m = below.map_or(eye.z - self.bounds().min.z, |z| eye.z - z as f32).max(LEAST_HEIGHT_M);
        let is_turned = |of: fn(&Camera) -> Vec3| of(before).dot(of(camera)) < STALE_COSINE;
        before.eye().distance(eye) > STALE_SHARE * height_m
            || is_turned(Camera::forward)
            || is_turned(Camera::right)
            || before.tan_half_fov() != camera.tan_half_fov()
    }
}
