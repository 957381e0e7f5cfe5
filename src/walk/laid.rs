//! The draped features of a walk, cut again where the ground or the view of it changed.

use std::sync::Arc;

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use crate::shown::ShownPatches;
use sandtable_draw::list::{DrawList, FeatureId};
use sandtable_draw::patches::{PatchDrapes, PatchId};
use sandtable_geom::aabb::Aabb;
use sandtable_picture::placed_text::PlacedText;
use sandtable_picture::recut::{GroundSheets, SeenTint};
use sandtable_picture::sheet_cuts::{SheetCuts, SheetParts};
use sandtable_picture::tried_analysis::TriedAnalysis;
use sandtable_ribbon::patches::StalePatch;
use sandtable_roam::dynamic::DynamicTerrain;
use sandtable_roam::graph::Vertex;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::refine::deferred::surface::DeferredSurface;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// The share of its distance that an eye moves until what depends on it is made anew: a line is then at most so much too
/// wide or too narrow. Smaller shares cost more frames.
const STALE_SHARE: f32 = 0.2;

/// The least distance that is counted with, in meters: near the eye nothing is too narrow.
const LEAST_DISTANCE_M: f32 = 25.0;

/// The least height above the ground that is counted with where symbols are planned, in meters.
const LEAST_HEIGHT_M: f32 = 150.0;

/// The most patches on which what lies is made anew in one update though it still lies on the ground: lines that the eye has
/// come nearer to can wait for a few frames, and a frame that waits for all of them is a late one.
const MOST_RENEWED: usize = 12;

/// The most areas of a patch whose triangles have changed that are told apart: every triangle that lies is compared with each,
/// which costs as much as cutting it where there are several times as many.
const MOST_AREAS: usize = 24;

/// What lies on a patch as the renderer has it.
#[derive(Clone, Copy, Debug, Default)]
struct LaidPatch {
    /// Whether it was cut to what the patch displayed before the last update.
    is_cut: bool,
    /// Whether other symbols are planned in it than it was cut of.
    is_replanned: bool,
    /// Whether it is to be handed over again as it is.
    is_wanted: bool,
    /// From where it was seen when it was handed over; `None` where the renderer does not have it.
    eye: Option<Vec3>,
}

/// What lies on the ground, by patch.
pub(super) struct LaidGround {
    sheets: GroundSheets,
    /// The materials.
    head: Arc<DrawList>,
    patches: Vec<LaidPatch>,
    /// How many patches in view wait to be handed over again.
    waiting: usize,
    /// From where symbols were planned.
    planned: Option<Vec3>,
    /// A tint that is laid when a list has its texture.
    tint: Option<SeenTint>,
    /// An analysis that is laid when a list has its materials.
    tried: Option<TriedAnalysis>,
    /// How many tints and analyses that are tried there were.
    additions: u32,
}

impl LaidGround {
    pub fn new(scene: &SceneModel, ground: PatchedGround<'_>) -> Self {
        let patches = vec![LaidPatch::default(); ground.layout.patch_count()];
        let sheets = GroundSheets::new(scene, ground);
        Self {
            head: Arc::new(sheets.head().clone()),
            sheets,
            patches,
            waiting: 0,
            planned: None,
            tint: None,
            tried: None,
            additions: 0,
        }
    }

    /// The materials.
    pub fn head(&self) -> &Arc<DrawList> {
        &self.head
    }

    /// Adds the texture of a tint to the materials; the tint before goes.
    pub fn add_tint(&mut self, mut tint: SeenTint) {
        self.clear_tint();
        self.sheets.add_texture(&mut tint);
        self.head = Arc::new(self.sheets.head().clone());
        self.tint = Some(tint);
        self.additions += 1;
    }

    /// Adds the materials of an analysis that is tried; the one before goes.
    pub fn add_tried(&mut self, mut tried: TriedAnalysis) {
        self.clear_tried();
        self.sheets.add_tried(&mut tried);
        self.head = Arc::new(self.sheets.head().clone());
        self.tried = Some(tried);
        self.additions += 1;
    }

    /// The number of times that materials were added so far.
    pub fn additions(&self) -> u32 {
        self.additions
    }

    /// Lays the last tint, and the last analysis that is tried, over the ground.
    pub fn lay_added(&mut self) {
        if let Some(tint) = self.tint.take() {
            self.replan(|sheets| sheets.lay_tint(Some(&tint)));
        }
        if let Some(tried) = self.tried.take() {
            self.replan(|sheets| sheets.lay_tried(Some(&tried)));
            // Its lines are planned in the next update.
            self.planned = None;
        }
    }

    /// Takes the analysis away that is tried.
    pub fn clear_tried(&mut self) {
        self.tried = None;
        self.replan(|sheets| sheets.lay_tried(None));
        self.planned = None;
    }

    /// Takes the tint away.
    pub fn clear_tint(&mut self) {
        self.tint = None;
        self.replan(|sheets| sheets.lay_tint(None));
    }

    fn replan(&mut self, plan: impl FnOnce(&mut GroundSheets) -> Vec<usize>) {
        let replanned = plan(&mut self.sheets);
        replanned.into_iter().for_each(|patch| self.patches[patch].is_replanned = true);
    }

    /// Hands over all draped features again, a few patches per update.
    pub fn renew(&mut self) {
        self.patches.iter_mut().for_each(|patch| patch.is_wanted = patch.eye.is_some());
    }

    /// The number of patches in view that wait to be handed over in later updates.
    pub fn waiting(&self) -> usize {
        self.waiting
    }

    /// Marks the draped features of a patch as outdated, because its ground has moved.
    pub fn moved(&mut self, patch: usize) {
        self.patches[patch].is_cut = false;
    }

    /// Marks the draped features of some patches as cut to other triangles than those to be displayed.
    pub fn forget_cuts(&mut self, is_meant: impl Fn(usize) -> bool) {
        let patches = self.patches.iter_mut().enumerate();
        patches.filter(|(patch, _)| is_meant(*patch)).for_each(|(_, laid)| laid.is_cut = false);
    }

    /// The draped features, to be cut on another thread.
    pub fn parts(&self) -> SheetParts {
        self.sheets.parts()
    }

    /// Exchanges what was cut: the ground is to display what `cuts` were cut to.
    pub fn exchange_cuts(&mut self, cuts: &mut SheetCuts) {
        let before: Vec<bool> = self.patches.iter().map(|laid| laid.is_cut).collect();
        self.forget_cuts(|_| true);
        cuts.patches().iter().for_each(|&patch| self.patches[patch].is_cut = true);
        let planned = self.sheets.exchange_cuts(cuts);
        planned.iter().for_each(|&patch| self.patches[patch].is_cut = false);
        cuts.retain(|patch| before[patch] && !planned.contains(&patch));
    }

    /// The uppermost draped feature of a patch at a world position; `None` for bare ground.
    pub fn feature_at(&self, patch: usize, at: DVec2) -> Option<FeatureId> {
        self.sheets.feature_at(patch, at)
    }

    /// Hands everything over again that comes into view.
    pub fn forget_handed(&mut self) {
        self.patches.iter_mut().for_each(|patch| patch.eye = None);
    }

    /// The draped features of the patches that changed or came into view, and those that look different from where the
    /// camera is now.
    pub fn update(
        &mut self,
        scene: &SceneModel,
        mesh: &Deferred<DynamicTerrain>,
        shown: &ShownPatches,
        camera: &Camera,
    ) -> Vec<PatchDrapes> {
        let terrain = mesh.source();
        self.plan_lines(scene, terrain.lattice(), camera);
        shown.changed().iter().for_each(|&patch| self.patches[patch].eye = None);
        let has_changed = |patch: usize| mesh.changes().dirty.binary_search(&patch).is_ok();
        let (mut due, mut renewed) = (Vec::new(), 0);
        for &patch in shown
            .visible()
            .iter()
            .filter(|&&patch| self.patches[patch].is_replanned || self.sheets.is_occupied(patch))
        {
            let laid = self.patches[patch];
            let is_due = match laid.eye {
                Some(eye) if laid.is_cut && !has_changed(patch) => {
                    let looks_otherwise = laid.is_replanned
                        || laid.is_wanted
                        || self.looks_otherwise(terrain, patch, eye, camera.eye());
                    renewed += usize::from(looks_otherwise);
                    looks_otherwise && renewed <= MOST_RENEWED
                }
                _ => true,
            };
            if is_due {
                due.push(patch);
            }
        }
        self.waiting = usize::saturating_sub(renewed, MOST_RENEWED);
        if due.is_empty() {
            // Threads would be woken for nothing.
            return Vec::new();
        }
        let stale: Vec<StalePatch> = due
            .iter()
            .filter(|&&patch| {
                let laid = self.patches[patch];
                !laid.is_cut || laid.is_replanned || has_changed(patch)
            })
            .map(|&patch| self.stale(patch, mesh))
            .collect();
        if !stale.is_empty() {
            self.sheets.recut(&stale, &DeferredSurface::new(mesh, terrain.lattice().cell()));
        }
        for &patch in &due {
            self.patches[patch] = LaidPatch { is_cut: true, eye: Some(camera.eye()), ..LaidPatch::default() };
        }
        let pieces = |patch: usize| self.sheets.pieces(patch, camera);
        due.into_par_iter()
            .map(|patch| PatchDrapes { patch: PatchId(patch as u32), pieces: pieces(patch) })
            .collect()
    }

    /// Where a patch is to be cut again: what was cut of it lies on all triangles that the last update left.
    fn stale(&self, patch: usize, mesh: &Deferred<DynamicTerrain>) -> StalePatch {
        let areas = mesh.changed_areas(patch);
        let is_partial = self.patches[patch].is_cut && areas.len() <= MOST_AREAS;
        StalePatch { patch, areas: is_partial.then(|| areas.collect()) }
    }

    /// The texts of tactical graphics, as they were planned last.
    pub fn texts(&self) -> &[PlacedText] {
        self.sheets.texts()
    }

    /// Plans symbols and graphics for the camera where it has moved by a share of its height above the ground.
    fn plan_lines(&mut self, scene: &SceneModel, lattice: &Lattice, camera: &Camera) {
        let has_graphics = self.sheets.has_graphics() || scene.has_overlay();
        if scene.symbols.is_empty() && !has_graphics {
            return;
        }
        let eye = camera.eye();
        let ground = FullResolution { lattice };
        let below = ground.displayed_z(eye.truncate().as_dvec2());
        let height_m = below.map_or(eye.z - scene.bounds.0.z, |z| eye.z - z as f32);
        let stale_m = STALE_SHARE * height_m.max(LEAST_HEIGHT_M);
        if self.planned.is_none_or(|planned| planned.distance(eye) > stale_m) {
            self.planned = Some(eye);
            let mut replanned = self.sheets.plan_symbols(scene, camera);
            if has_graphics {
                replanned.extend(self.sheets.plan_graphics(scene, camera));
            }
            replanned.into_iter().for_each(|patch| self.patches[patch].is_replanned = true);
        }
    }

    /// Whether what shows of a patch differs from what was handed over when the eye was at `then`.
    fn looks_otherwise(&self, terrain: &DynamicTerrain, patch: usize, then: Vec3, now: Vec3) -> bool {
        if now == then || !self.sheets.fades(patch) {
            return false;
        }
        let layout = *terrain.ground().layout;
        let (east, _) = layout.patch_grid();
        let corner =
            Vertex::new((patch % east) as i32 * layout.patch(), (patch / east) as i32 * layout.patch());
        has_moved(now, then, terrain.heights().bounds(terrain.ground(), corner))
    }

    /// The largest clearance in meters between what was cut in the patches in view and what they display.
    pub fn check(&self, mesh: &Deferred<DynamicTerrain>, shown: &ShownPatches) -> f64 {
        let surface = DeferredSurface::new(mesh, mesh.source().lattice().cell());
        self.sheets.check(shown.visible(), &surface)
    }
}

/// Whether an eye has moved by more than a share of its distance from a box.
fn has_moved(now: Vec3, then: Vec3, bounds: Option<(Vec3, Vec3)>) -> bool {
    let Some((min, max)) = bounds else { return false };
    let distance_m = now.distance(Aabb { min, max }.nearest_to(now)).max(LEAST_DISTANCE_M);
    now.distance(then) > STALE_SHARE * distance_m
}
