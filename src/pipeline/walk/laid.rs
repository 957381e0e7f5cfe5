//! What lies on the ground of a walk, cut again where the ground or the view of it changed.

use glam::Vec3;

use crate::draw::list::DrawList;
use crate::draw::patches::{PatchDrapes, PatchId};
use crate::geom::aabb::Aabb;
use crate::pipeline::walk::shown::ShownPatches;
use crate::roam::dynamic::DynamicTerrain;
use crate::roam::graph::Vertex;
use crate::roam::patched_ground::PatchedGround;
use crate::roam::refine::deferred::Deferred;
use crate::roam::refine::deferred::surface::DeferredSurface;
use crate::scene::SceneModel;
use crate::scene::picture::recut::GroundSheets;
use crate::view::camera::Camera;

/// The share of its distance that an eye moves until what depends on it is made anew: a line is then at most so much too
/// wide or too narrow. Smaller shares cost more frames.
const STALE_SHARE: f32 = 0.2;

/// The least distance that is counted with, in meters: near the eye nothing is too narrow.
const LEAST_DISTANCE_M: f32 = 25.0;

/// What lies on a patch as the renderer has it.
#[derive(Clone, Copy, Debug, Default)]
struct LaidPatch {
    /// Whether it was cut to what the patch displays now.
    is_cut: bool,
    /// From where it was seen when it was handed over.
    eye: Option<Vec3>,
}

/// What lies on the ground, by patch.
pub(super) struct LaidGround {
    sheets: GroundSheets,
    patches: Vec<LaidPatch>,
}

impl LaidGround {
    pub fn new(scene: &SceneModel, ground: PatchedGround<'_>) -> Self {
        let patches = vec![LaidPatch::default(); ground.layout.patch_count()];
        Self { sheets: GroundSheets::new(scene, ground), patches }
    }

    /// The materials.
    pub fn head(&self) -> &DrawList {
        self.sheets.head()
    }

    /// Hands everything over again that comes into view.
    pub fn forget_handed(&mut self) {
        self.patches.iter_mut().for_each(|patch| patch.eye = None);
    }

    /// What lies on the patches that changed or came into view, and what looks otherwise from where the camera is now.
    pub fn update(
        &mut self,
        _scene: &SceneModel,
        mesh: &Deferred<DynamicTerrain>,
        shown: &ShownPatches,
        camera: &Camera,
    ) -> Vec<PatchDrapes> {
        mesh.changes().dirty.iter().for_each(|&patch| self.patches[patch].is_cut = false);
        for &patch in shown.changed() {
            self.patches[patch].eye = None;
        }
        let terrain = mesh.source();
        let layout = *terrain.ground().layout;
        let (east, _) = layout.patch_grid();
        let corner = |patch: usize| {
            Vertex::new((patch % east) as i32 * layout.patch(), (patch / east) as i32 * layout.patch())
        };
        let is_due = |&patch: &usize| {
            let laid = &self.patches[patch];
            self.sheets.is_occupied(patch)
                && match laid.eye {
                    Some(eye) if laid.is_cut => {
                        let bounds = terrain.heights().bounds(terrain.ground(), corner(patch));
                        self.sheets.fades(patch) && has_moved(camera.eye(), eye, bounds)
                    }
                    _ => true,
                }
        };
        let due: Vec<usize> = shown.visible().iter().copied().filter(is_due).collect();
        let uncut: Vec<usize> = due.iter().copied().filter(|&patch| !self.patches[patch].is_cut).collect();
        if !uncut.is_empty() {
            self.sheets.recut(&uncut, &DeferredSurface::new(mesh, terrain.lattice().cell()));
        }
        let handed = due.into_iter().map(|patch| {
            self.patches[patch] = LaidPatch { is_cut: true, eye: Some(camera.eye()) };
            PatchDrapes { patch: PatchId(patch as u32), pieces: self.sheets.pieces(patch, camera) }
        });
        handed.collect()
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
