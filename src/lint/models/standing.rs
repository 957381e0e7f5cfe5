//! A model as it stands on the ground.

use glam::{DVec2, Vec3};

use crate::ground_line;
use sandtable_geom::aabb::Aabb;
use sandtable_model::{Model, built_in};
use sandtable_scene::footprint::ModelFootprint;
use sandtable_scene::placed_model::Placement;
use sandtable_scene::scene_model::SceneModel;

/// What a model file holds, apart from where it stands.
pub(super) struct ModelShape {
    pub(super) bounds: Aabb,
    pub(super) footprint: ModelFootprint,
    /// Plants and rocks that need no file stand as they should: among each other, beside roads, on slopes.
    pub(super) is_built_in: bool,
}

/// A model on the ground.
pub(super) struct StandingModel<'a> {
    pub(super) placement: &'a Placement,
    pub(super) shape: &'a ModelShape,
    /// The corners of its foot in world space: front left, front right, back right, back left.
    pub(super) base: [Vec3; 4],
}

impl ModelShape {
    pub(super) fn of(model: &Model) -> Self {
        let is_built_in = matches!(&model.parts[..], [part] if built_in::NAMES.contains(&part.name.as_str()));
        Self { bounds: model.bounds().unwrap_or_default(), footprint: ModelFootprint::of(model), is_built_in }
    }
}

impl StandingModel<'_> {
    /// Its sides in meters, along its own axes.
    pub(super) fn size_m(&self) -> Vec3 {
        self.shape.bounds.size() * self.placement.scale
    }

    /// Its foot in plan, counter-clockwise, world coordinates.
    pub(super) fn outline(&self) -> [DVec2; 4] {
        self.base.map(|corner| corner.truncate().as_dvec2())
    }

    /// World Z of the lowest corner of its foot.
    pub(super) fn foot_z(&self) -> f32 {
        self.base.iter().map(|corner| corner.z).fold(f32::INFINITY, f32::min)
    }

    /// Its place as a message states it.
    pub(super) fn place(&self, scene: &SceneModel) -> String {
        ground_line::place(scene, self.placement.at.as_dvec2())
    }
}
