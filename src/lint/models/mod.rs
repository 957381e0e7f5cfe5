//! Models that have a wrong size or lie on their sides, float, are buried, stand in one another, or have stretched textures.

mod footings;
mod overlaps;
mod sizes;
mod textures;

use glam::{DVec2, Vec3};

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_geom::aabb::Aabb;
use sandtable_model::{Model, built_in};
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::footprint::ModelFootprint;
use sandtable_scene::placed_model::Placement;
use sandtable_scene::placement::stand;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::support_surface::SupportSurface;

/// The most models that are looked at: of more, the first. Bounds the time of a check to some seconds.
const MOST_MODELS: usize = 100_000;

/// What a model file holds, apart from where it stands.
struct ModelShape {
    bounds: Aabb,
    footprint: ModelFootprint,
    /// Plants and rocks that need no file stand as they should: among each other, beside roads, on slopes.
    is_built_in: bool,
}

/// A model on the ground.
struct StandingModel<'a> {
    placement: &'a Placement,
    shape: &'a ModelShape,
    /// The corners of its foot in world space: front left, front right, back right, back left.
    base: [Vec3; 4],
}

/// Runs all checks of models.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    let shapes: Vec<ModelShape> = scene.models.iter().map(ModelShape::of).collect();
    let finest = scene.scale.ground(&scene.lattice);
    let ground = SupportSurface { displayed: &finest, ground: &finest };
    let own = scene
        .placements
        .iter()
        .filter(|placement| context.kind(placement.feature) == Some(FeatureKind::Model));
    let standing = own.take(MOST_MODELS).filter_map(|placement| {
        let shape = &shapes[placement.model];
        let base = stand(placement, &shape.footprint, ground)?.base(&shape.footprint);
        (!shape.is_built_in).then_some(StandingModel { placement, shape, base })
    });
    let standing: Vec<StandingModel<'_>> = standing.collect();
    sizes::check(context, &standing, sink);
    footings::check(context, &standing, sink);
    overlaps::check(context, &standing, sink);
    textures::check(context, &standing, sink);
}

impl ModelShape {
    fn of(model: &Model) -> Self {
        let is_built_in = matches!(&model.parts[..], [part] if built_in::NAMES.contains(&part.name.as_str()));
        Self { bounds: model.bounds().unwrap_or_default(), footprint: ModelFootprint::of(model), is_built_in }
    }
}

impl StandingModel<'_> {
    /// Its sides in meters, along its own axes.
    fn size_m(&self) -> Vec3 {
        self.shape.bounds.size() * self.placement.scale
    }

    /// Its foot in plan, counter-clockwise, world coordinates.
    fn outline(&self) -> [DVec2; 4] {
        self.base.map(|corner| corner.truncate().as_dvec2())
    }

    /// World Z of the lowest corner of its foot.
    fn foot_z(&self) -> f32 {
        self.base.iter().map(|corner| corner.z).fold(f32::INFINITY, f32::min)
    }

    /// Its place as a message states it.
    fn place(&self, scene: &SceneModel) -> String {
        super::ground_line::place(scene, self.placement.at.as_dvec2())
    }
}
