//! Finer posts of the ground around the eye, for the tint and light of terrain on disk, made in the background.
//!
//! A job makes one window and sends it with the others, the coarsest first; until then the one before is shown, wherever it
//! lies.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use egui::Context;
use glam::Vec3;

use crate::opened::OpenedScene;
use crate::scene_load::LoaderSlot;
use crate::worker::{WorkerJob, drop_apart};
use sandtable_base::message::chain::error_text;
use sandtable_draw::ground::GroundMap;
use sandtable_draw::ground_window::GroundWindow;
use sandtable_gpu::live::prepared::{LiveLoader, PreparedWindows};
use sandtable_terrain::lattice::LatticeError;
use sandtable_view::camera::Camera;
use sandtable_walk::ground_windows::{
    GroundWindowLight, GroundWindowMaker, GroundWindowPlan, GroundWindowView,
};
use sandtable_walk::paged_elevation::{ElevationWindows, ReadingWatch};

/// The eye is seen as no nearer to the ground than this, in meters.
const LEAST_DISTANCE_M: f32 = 1.0;

/// The windows around the eye.
pub struct FinerGround {
    maker: Arc<Mutex<GroundWindowMaker<ElevationWindows>>>,
    watch: Arc<ReadingWatch>,
    /// By the distance between their posts, the coarsest first.
    made: Vec<MadeWindow>,
    job: Option<WorkerJob<Result<SentWindows, String>>>,
    /// What the renderer is to take over.
    ready: Option<PreparedWindows>,
    /// Whether the renderer has none of them any more.
    is_lost: bool,
    has_failed: bool,
}

#[derive(Clone)]
struct MadeWindow {
    plan: GroundWindowPlan,
    map: Arc<GroundMap>,
    to_sun: Vec3,
    window: Arc<GroundWindow>,
}

/// What a job has made.
struct SentWindows {
    made: Vec<MadeWindow>,
    prepared: PreparedWindows,
}

impl FinerGround {
    /// No windows yet of a terrain.
    ///
    /// # Errors
    /// It is no lattice.
    pub fn new(samples: ElevationWindows) -> Result<Self, LatticeError> {
        let watch = Arc::clone(samples.watch());
        let maker = Arc::new(Mutex::new(GroundWindowMaker::new(samples)?));
        let (made, job, ready) = (Vec::new(), None, None);
        Ok(Self { maker, watch, made, job, ready, is_lost: false, has_failed: false })
    }

    /// Whether a window is being made.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// Hands all windows over again, to a renderer that starts again.
    pub fn forget_handed(&mut self) {
        self.is_lost = self.ready.is_none();
    }

    /// Windows that the renderer has not taken over.
    pub fn take_ready(&mut self) -> Option<PreparedWindows> {
        self.ready.take()
    }

    /// Takes over what was made.
    fn follow(&mut self) -> Result<(), String> {
        let Some(done) = WorkerJob::take(&mut self.job) else { return Ok(()) };
        let sent = done.map_err(|failure| error_text(&failure)).and_then(|sent| sent);
        let SentWindows { made, prepared } = sent.inspect_err(|_| self.has_failed = true)?;
        drop_apart(std::mem::replace(&mut self.made, made));
        self.ready = Some(prepared);
        Ok(())
    }

    /// Begins to make the coarsest window that `view` lacks.
    fn start(
        &mut self,
        view: &GroundWindowView,
        light: GroundWindowLight,
        loader: LiveLoader,
        context: &Context,
    ) {
        let plans = self.maker.lock().unwrap_or_else(PoisonError::into_inner).plans(&light.map, view);
        let is_lit = |made: &MadeWindow| Arc::ptr_eq(&made.map, &light.map) && made.to_sun == light.to_sun;
        let known: Vec<Option<&MadeWindow>> = plans
            .iter()
            .map(|plan| self.made.iter().find(|made| made.plan.every() == plan.every()))
            .collect();
        let is_missing = |at: &usize| known[*at].is_none_or(|made| made.plan != plans[*at] || !is_lit(made));
        let missing = (0..plans.len()).find(is_missing);
        if missing.is_none() && !self.is_lost {
            return;
        }
        self.is_lost = false;
        let plan = missing.map(|at| plans[at].clone());
        let (held, maker) = (self.made.clone(), Arc::clone(&self.maker));
        let work = move || {
            let mut made: BTreeMap<_, MadeWindow> =
                held.into_iter().map(|made| (std::cmp::Reverse(made.plan.every()), made)).collect();
            if let Some(plan) = plan {
                let window = maker.lock().unwrap_or_else(PoisonError::into_inner).window(&plan, &light);
                let window = Arc::new(window.map_err(|error| error_text(&error))?);
                let GroundWindowLight { map, to_sun, .. } = light;
                made.insert(std::cmp::Reverse(plan.every()), MadeWindow { plan, map, to_sun, window });
            }
            let made: Vec<MadeWindow> = made.into_values().collect();
            let windows: Vec<Arc<GroundWindow>> = made.iter().map(|made| Arc::clone(&made.window)).collect();
            let prepared = loader.prepare_windows(&windows).map_err(|error| error_text(&error))?;
            Ok(SentWindows { made, prepared })
        };
        self.job = Some(WorkerJob::start(context, work));
    }
}

impl Drop for FinerGround {
    fn drop(&mut self) {
        self.watch.stop();
    }
}

impl OpenedScene {
    /// Takes over a window that has become ready, and begins to make the next one that the camera lacks.
    ///
    /// # Errors
    /// Why there are no windows from now on; those before stay.
    pub fn follow_finer_ground(&mut self, context: &Context, slot: &LoaderSlot) -> Result<(), String> {
        let Some(finer) = &mut self.finer else { return Ok(()) };
        finer.follow()?;
        let is_shown = self.paged.as_ref().is_some_and(|paged| paged.is_shown());
        if finer.is_busy() || finer.has_failed || !is_shown {
            return Ok(());
        }
        let (Some(loader), Ok(camera)) = (slot.loader(), self.camera(self.size)) else { return Ok(()) };
        let Some(map) = self.list.ground.clone() else { return Ok(()) };
        let view = self.window_view(&camera);
        let light = GroundWindowLight { scene: Arc::clone(&self.scene), map, to_sun: self.walk.to_sun() };
        if let Some(finer) = &mut self.finer {
            finer.start(&view, light, loader, context);
        }
        Ok(())
    }

    fn window_view(&self, camera: &Camera) -> GroundWindowView {
        let eye = camera.eye();
        let above_m = self.ground_z(eye.truncate().as_dvec2()).map_or(0.0, |z| eye.z - z as f32);
        let beside_m = eye.distance(self.bounds().nearest_to(eye));
        GroundWindowView {
            eye: eye.truncate().as_dvec2(),
            distance_m: f64::from(above_m.max(beside_m).max(LEAST_DISTANCE_M)),
            focus: self.focus(camera).truncate(),
            pixel: f64::from(camera.pixels_per_meter(1.0)).recip(),
        }
    }
}
