//! A walk through a scene: the ground refined from frame to frame, and draped features cut again where it changed.
//!
//! ```text
//!  camera ─► patches in view ─► deferred refiner ─► patches that changed ─► their triangles, 16 bits an index ─┐
//!               (culling)          ▲  spheres                        └────► what lies on them, cut anew ───────┴─► changes
//!  edits ─► heights, errors, spheres, mended ──► vertices of the patches they touched ─────────────────────────┘
//! ```
//!
//! A walk has no window and no clock: an update takes a camera and returns what changed since the update before, as a
//! renderer is to receive it, and what it cost. What stands on the ground is a draw list that is made once
//! ([`Walk::static_list`]).

pub mod analysis_task;
mod check;
pub mod disk_ground;
pub mod edit;
mod far_block;
pub mod flown_scene;
pub mod fly;
pub mod frame;
pub mod ground_windows;
mod laid;
pub mod lod;
pub mod measure;
pub mod page_heights;
pub mod paged;
pub mod paged_elevation;
pub mod pick;
pub mod reach;
mod relief_map;
mod shown;
pub mod shown_ground;
pub mod standing_task;

use std::sync::{Arc, OnceLock};

use glam::Vec3;

use crate::frame::{ReachRenewal, WalkError, WalkFrame, WalkOptions, WalkStatistics};
use crate::laid::LaidGround;
use crate::relief_map::ReliefMap;
use crate::shown::{ShownPatches, positions};
use sandtable_draw::lighting::Lighting;
use sandtable_draw::list::DrawList;
use sandtable_geom::aabb::Aabb;
use sandtable_picture::models::{PlacementMove, PlacementMoves, moved_box};
use sandtable_picture::placed_text::PlacedText;
use sandtable_picture::recut::SeenTint;
use sandtable_picture::standing;
use sandtable_picture::tried_analysis::TriedAnalysis;
use sandtable_roam::culling::{Culling, InView};
use sandtable_roam::dynamic::{DynamicOptions, DynamicTerrain, ErrorMeasure, Radius};
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::spheres;
use sandtable_scene::placed_model::Placement;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_view::camera::Camera;

/// The picture that the first spheres are made for, before there is a camera: pixels from top to bottom, over the tangent of
/// half the field of view. Spheres are made anew for another picture.
const FIRST_PICTURE: f32 = 1080.0 / 0.5;

/// Meshes of patches that are kept out of view before they are made anew: 140 KB each in patches of 64.
const MOST_MESHES: usize = 1024;

/// The distance of the eye whose spheres stand for parallel rays, in diagonals of the scene: all of the ground is equally far
/// from it but for a thousandth.
const PARALLEL_DISTANCE: f32 = 1000.0;

/// A walk through a scene.
pub struct Walk {
    scene: Arc<SceneModel>,
    options: WalkOptions,
    mesh: Deferred<DynamicTerrain>,
    view: InView,
    shown: ShownPatches,
    laid: LaidGround,
    /// The elevations, true to scale, where they are drawn by another scale than the terrain has.
    elevations: Option<Arc<Lattice>>,
    /// The ground for rays and lines of sight, true to scale; `None` until somebody looks.
    sight: OnceLock<SightGround>,
    map: ReliefMap,
    moves: PlacementMoves,
}

/// From where the ground is refined, and how far its spheres reach.
#[derive(Clone, Copy, Debug)]
struct Vantage {
    eye: Vec3,
    reach: f32,
}

impl Walk {
    /// A walk that starts anywhere in `scene`. Measures the errors of all of the ground.
    pub fn new(scene: Arc<SceneModel>, options: WalkOptions) -> Self {
        let tolerance_px = options.tolerance_px.unwrap_or(scene.tolerance_px);
        let lattice = Arc::clone(scene.ground().lattice());
        let cell_m = lattice.cell().min_element();
        let terrain = DynamicTerrain::new(
            lattice,
            DynamicOptions {
                patch: scene.ground().layout().patch() as u32,
                measure: ErrorMeasure::Exact,
                radius: Radius::Bounding,
                reach: FIRST_PICTURE / tolerance_px,
            },
        );
        let terrain = terrain.expect("the scene's own patches lie over its ground");
        let laid = LaidGround::new(&scene, terrain.ground());
        let shown = ShownPatches::new(scene.ground().layout().patch_count(), options.kept_patches);
        let mesh = Deferred::new(terrain, cell_m).expect("a scene's patches have 16-bit indices");
        let elevations = (scene.scale.0 != 1.0).then(|| Arc::clone(&scene.lattice));
        let (view, sight, map) = (InView::default(), OnceLock::new(), ReliefMap::default());
        let moves = PlacementMoves::new();
        Self { scene, options, mesh, view, shown, laid, elevations, sight, map, moves }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<SceneModel> {
        &self.scene
    }

    /// The heights as they are drawn, with all edits; a snapshot while it is held.
    pub fn lattice(&self) -> &Arc<Lattice> {
        self.mesh.source().lattice()
    }

    /// The greatest error of the displayed ground, in pixels.
    pub fn tolerance_px(&self) -> f32 {
        self.options.tolerance_px.unwrap_or(self.scene.tolerance_px)
    }

    /// The elevations with all edits, true to scale; a snapshot while it is held.
    pub fn elevations(&self) -> &Arc<Lattice> {
        self.elevations.as_ref().unwrap_or_else(|| self.lattice())
    }

    /// Sets the greatest error of the displayed ground, in pixels, at least a hundredth; the next update shows it.
    pub fn set_tolerance_px(&mut self, tolerance_px: f32) {
        self.options.tolerance_px = Some(tolerance_px.max(0.01));
    }

    /// Unit vector toward the sun; as on a map with north above where the options name none.
    pub fn to_sun(&self) -> Vec3 {
        self.options.to_sun.unwrap_or_else(|| self.scene.sunlight.to_sun(None))
    }

    /// Moves the sun; the next [`Walk::static_list`] is lit by it.
    pub fn set_sun(&mut self, to_sun: Vec3) {
        self.options.to_sun = Some(to_sun);
    }

    /// Everything except the ground and the draped features: the ground map, the light, solids, and models in the form
    /// that suits their distance from `camera`, whichever way that turns.
    ///
    /// Its first material is that of the ground; those of [`DrapedPiece`](sandtable_draw::patches::DrapedPiece)s are among those
    /// that follow, with the same numbers in every list of this walk.
    pub fn static_list(&self, camera: &Camera, progress: &dyn Fn(&'static str)) -> DrawList {
        let list = self.standing_task(self.to_sun()).list(camera, progress);
        if let Some(map) = &list.ground {
            self.map.keep(map);
        }
        list
    }

    /// Lets a model, by its number among the scene's placements, stand elsewhere in the next [`Walk::static_list`].
    pub fn move_model(&mut self, placement: usize, to: PlacementMove) {
        self.moves.insert(placement, to);
    }

    /// The current pose of a model, by its number among the scene's placements.
    pub fn model_pose(&self, placement: usize) -> PlacementMove {
        self.moves.get(&placement).copied().unwrap_or_else(|| {
            let Placement { at, heading_rad, .. } = self.scene.placements[placement];
            PlacementMove { at, heading_rad }
        })
    }

    /// The corners of a model's box in world space if it stood so; `None` where it has no ground under it. Each differs in one
    /// axis of the model from those whose numbers differ in one bit.
    pub fn model_box(&self, placement: usize, pose: PlacementMove) -> Option<[Vec3; 8]> {
        moved_box(&self.scene, self.lattice(), placement, pose)
    }

    /// Whether lists of [`Walk::static_list`] differ with the eye: whether the models are too many to be drawn in full from
    /// everywhere.
    pub fn list_depends_on_eye(&self) -> bool {
        standing::depends_on_distance(&self.scene)
    }

    /// The light, the haze and the backdrop for a camera.
    pub fn lighting(&self, camera: &Camera) -> Lighting {
        sandtable_picture::lighting(&self.scene, camera, self.to_sun())
    }

    /// Brings the ground up to date with a camera and returns what changed since the update before.
    ///
    /// # Errors
    /// A patch cannot be read; the update can be repeated.
    pub fn update(&mut self, camera: &Camera) -> Result<WalkFrame, WalkError> {
        let vantage = self.vantage(camera);
        if let (ReachRenewal::InUpdate, Some(task)) = (self.options.renewal, self.reach_task(camera)) {
            self.take_reach(task.ground());
        }
        let terrain = self.mesh.source();
        let visible = self.view.update(terrain.ground(), terrain.heights(), Culling::frustum(camera));
        let refined = self.mesh.update(vantage.eye, visible)?;
        let mut statistics =
            WalkStatistics { splits: refined.splits, merges: refined.merges, ..WalkStatistics::default() };
        let mut changes =
            self.shown.update(&self.mesh, |corner| positions(self.mesh.source().ground(), corner));
        self.forget_meshes();
        changes.drapes = self.laid.update(&self.scene, &self.mesh, &self.shown, camera);
        changes.map = self.map.take_new();
        statistics.waiting_patches = self.laid.waiting();
        statistics.examined = self.mesh.examined();
        statistics.count(&self.mesh, &changes);
        Ok(WalkFrame { changes, statistics })
    }

    /// The texts of tactical graphics, as they were planned in the last update.
    pub fn graphic_texts(&self) -> &[PlacedText] {
        self.laid.texts()
    }

    /// Hands everything over again in the next update: for a renderer that starts anew.
    pub fn forget_handed(&mut self) {
        self.shown.forget();
        self.laid.forget_handed();
    }

    /// Hands over what lies on the ground again, a few patches an update: for a viewer that shows other features of it.
    pub fn renew_laid(&mut self) {
        self.laid.renew();
    }

    /// Lays a tint over the ground, instead of the one before; the list that a task made from now on has its texture, and the
    /// tint is seen from [`Walk::take_standing`] on.
    pub fn lay_tint(&mut self, tint: SeenTint) {
        self.laid.add_tint(tint);
    }

    /// Takes the tint away.
    pub fn clear_tint(&mut self) {
        self.laid.clear_tint();
    }

    /// Lays an analysis that is tried over the ground, instead of the one before; it is seen from [`Walk::take_standing`] of a
    /// list on that a task makes from now on.
    pub fn lay_analysis(&mut self, tried: TriedAnalysis) {
        self.laid.add_tried(tried);
    }

    /// Takes the analysis away that is tried.
    pub fn clear_analysis(&mut self) {
        self.laid.clear_tried();
    }

    /// Where the camera's spheres are seen from. Parallel rays come from very far away.
    fn vantage(&self, camera: &Camera) -> Vantage {
        let (min, max) = self.scene.bounds;
        if camera.parallel_frame().is_none() {
            return Vantage { eye: camera.eye(), reach: spheres::reach(camera, self.tolerance_px()) };
        }
        let ground = Aabb { min, max };
        let distance_m = PARALLEL_DISTANCE * ground.size().length().max(1.0);
        let reach = distance_m * camera.pixels_per_meter(1.0) / self.tolerance_px();
        Vantage { eye: ground.center() + Vec3::Z * distance_m, reach }
    }

    /// Forgets the meshes of patches that have been out of view for the longest time where there are too many.
    fn forget_meshes(&mut self) {
        let kept = MOST_MESHES.max(self.mesh.visible().len());
        if self.mesh.meshes() > kept + kept / 4 {
            self.mesh.forget(kept);
            // A patch without a mesh begins with two triangles, whatever it was cut to.
            let mut is_hidden = vec![true; self.mesh.source().ground().layout.patch_count()];
            self.shown.visible().iter().for_each(|&patch| is_hidden[patch] = false);
            self.laid.forget_cuts(|patch| is_hidden[patch]);
        }
    }
}
