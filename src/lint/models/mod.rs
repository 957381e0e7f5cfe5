//! Models that have a wrong size or lie on their sides, float, are buried, stand in one another, or have stretched textures.

mod footings;
mod overlaps;
mod sizes;
mod standing;
mod textures;

use crate::context::LintContext;
use crate::models::standing::{ModelShape, StandingModel};
use crate::sink::FindingSink;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::placement::stand;
use sandtable_terrain::support_surface::SupportSurface;

/// The most models that are looked at: of more, the first. Bounds the time of a check to some seconds.
const MOST_MODELS: usize = 100_000;

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
