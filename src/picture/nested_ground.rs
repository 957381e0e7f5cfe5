//! Ground near the eye with more samples than the scene has: parts of the elevation, each built as a scene.
//!
//! A nested ground has all that lies and stands on it, made of its own heights: roads that the ground follows, pads, models.
//! What a picture has once, such as its light, colors, labels, tactical graphics and cameras, is the outer scene's; see
//! [`crate::nested`].

use std::sync::Arc;

use glam::{DVec2, Vec3};

use crate::nested_plan::{NestedPlan, nested_plans};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::words::TableTop;
use sandtable_geom::rect::Rect;
use sandtable_scene::build::build_with;
use sandtable_scene::build_errors::BuildErrors;
use sandtable_scene::finer_elevation::{FinerElevation, part_document};
use sandtable_scene::planned_pictures::ElevationNeed;
use sandtable_scene::scene_label::SceneLabel;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_scene::world_frame::WorldFrame;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// A part of a scene, built of more samples.
pub struct NestedGround {
    /// The part, in a world space of its own.
    pub scene: SceneModel,
    /// The origin of that in the world space of the outer scene.
    pub origin: DVec2,
    /// The side, in samples, of the squares of which its heights are means.
    pub step: u32,
}

impl NestedGround {
    /// Its rectangle in the world space of the outer scene.
    pub fn rect(&self) -> Rect {
        let Rect { min, max } = self.scene.lattice.extent();
        Rect { min: min + self.origin, max: max + self.origin }
    }

    /// This ground without a sea where the outer scene has none: a hollow below the sea may reach the border of a part, but
    /// not that of the model.
    fn with_sea_of(mut self, outer: &SceneModel) -> Self {
        if self.scene.water().sea_posts == 0 {
            return self;
        }
        let (lattice, cover) = (Arc::clone(&self.scene.lattice), outer.water());
        let mut water = self.scene.water().clone();
        let highest_m = self.scene.water_rules.highest_sea_m();
        let heights = lattice.heights().iter().enumerate();
        for (index, _) in heights.filter(|(_, height)| **height <= highest_m) {
            let world = (lattice.post_at(index).grid() * lattice.cell()) + self.origin;
            if water.is_water[index] && !cover.is_beside(&outer.lattice, world) {
                water.is_water[index] = false;
                water.sea_posts = water.sea_posts.saturating_sub(1);
            }
        }
        self.scene.water = water.into();
        self
    }
}

/// The nested grounds of a picture, the coarsest first, each within the one before; none where the scene holds all samples
/// that it shows.
///
/// # Errors
/// The elevation or a source cannot be read.
pub fn nested_grounds(
    scene: &SceneModel,
    camera: &Camera,
    progress: &dyn Fn(&'static str),
) -> Result<Vec<NestedGround>, Diagnostic> {
    let Some(finer) = &scene.finer else { return Ok(Vec::new()) };
    progress("reading near ground");
    let plans = nested_plans(scene, camera, finer.step);
    plans.iter().map(|plan| nested_ground(scene, finer, plan)).collect()
}

fn nested_ground(
    outer: &SceneModel,
    finer: &FinerElevation,
    plan: &NestedPlan,
) -> Result<NestedGround, Diagnostic> {
    let frame = WorldFrame::new(&finer.document, &outer.crs, &outer.stated_crs, outer.lattice.map_extent());
    let document = part_document(&frame, &plan.rect)?;
    let need = ElevationNeed::Nested { step: plan.step };
    let scene = build_with(&document, &finer.assets, need, &|_| ());
    let mut scene = scene.map_err(BuildErrors::into_first)?;
    scene.table = TableTop::None;
    scene.scale = outer.scale;
    scene.contours = outer.contours;
    scene.climate = outer.climate;
    let origin = scene.lattice.origin() - outer.lattice.origin();
    let moved = origin.as_vec2().extend(0.0);
    scene.bounds = (outer.bounds.0 - moved, outer.bounds.1 - moved);
    let ground = NestedGround { scene, origin, step: plan.step };
    Ok(ground.with_sea_of(outer))
}

/// The heights of the nested grounds of a picture.
#[derive(Clone, Debug, Default)]
pub struct NestedHeights {
    /// Their lattices, the coarsest first.
    lattices: Vec<Arc<Lattice>>,
}

impl NestedHeights {
    /// The heights of `grounds`.
    pub fn new(grounds: &[NestedGround]) -> Self {
        Self { lattices: grounds.iter().map(|ground| Arc::clone(&ground.scene.lattice)).collect() }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.lattices.is_empty()
    }

    /// The elevation of the finest ground at map coordinates, meters, on the posts of `outer` where no nested ground is; `None`
    /// without data.
    pub fn height_m(&self, outer: &Lattice, at: DVec2) -> Option<f64> {
        let height_m = |lattice: &Lattice| ground_height(lattice, Interpolation::Planar, at).height_m();
        let nested = self.lattices.iter().rev().find_map(|lattice| height_m(lattice));
        nested.or_else(|| height_m(outer))
    }

    /// World Z of the finest ground at a world position of `scene`; `None` without data.
    pub fn drawn_z(&self, scene: &SceneModel, at: DVec2) -> Option<f64> {
        if self.is_empty() {
            return FullResolution { lattice: scene.ground().lattice() }.displayed_z(at);
        }
        let height_m = self.height_m(&scene.lattice, scene.lattice.origin() + at)?;
        Some(scene.scale.world_z(height_m))
    }

    /// The lattice with the closest posts; `outer` where no nested ground is.
    pub fn finest<'a>(&'a self, outer: &'a Lattice) -> &'a Lattice {
        self.lattices.last().map_or(outer, |lattice| lattice)
    }

    /// A place that is as high above the finest ground as `at` is above the lattice of `scene`, in world space.
    pub fn lifted(&self, scene: &SceneModel, at: Vec3) -> Vec3 {
        if self.is_empty() {
            return at;
        }
        let (map, none) = (scene.lattice.map_point(at), Self::default());
        let rise = self.height_m(&scene.lattice, map).zip(none.height_m(&scene.lattice, map));
        let rise_m = rise.map_or(0.0, |(finest, outer)| finest - outer);
        at + Vec3::Z * scene.scale.world_z(rise_m) as f32
    }

    /// A view with its eye as high above the finest ground as it is stated above the ground, and its target likewise.
    pub fn lifted_view(&self, scene: &SceneModel, view: &SceneView) -> SceneView {
        let ViewAim::At { eye, target } = view.aim else { return view.clone() };
        let tables = scene.finer.iter().flat_map(|finer| &finer.document.cameras);
        let table = tables.into_iter().find(|table| *table.name == view.name);
        let has_elevation = table.is_some_and(|table| table.eye_elevation.is_some());
        let eye = if has_elevation { eye } else { self.lifted(scene, eye) };
        SceneView { aim: ViewAim::At { eye, target: self.lifted(scene, target) }, ..view.clone() }
    }

    /// A label on the finest ground of a picture of `scene`.
    pub fn lifted_label(&self, scene: &SceneModel, label: &SceneLabel) -> SceneLabel {
        let ground = self.lifted(scene, label.ground);
        let course = label.course.map(|at| self.lifted(scene, at));
        SceneLabel { ground, anchor: label.anchor + (ground - label.ground), course, ..label.clone() }
    }
}
