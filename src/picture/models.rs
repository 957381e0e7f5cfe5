//! Models, each in its pose.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::detail::{self, ListedForm, PlacedModel, Viewer};
use crate::{add_mesh, canopy};
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh};
use sandtable_draw::material::Material;
use sandtable_scene::footprint::ModelFootprint;
use sandtable_scene::placed_model::Placement;
use sandtable_scene::placement::stand;
use sandtable_scene::scatter::chance::Chance;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::support_surface::SupportSurface;
use sandtable_terrain::triangle_surface::TriangleSurface;

/// The seed of tints: any other gives others.
const TINT_SEED: u64 = 0x7ea5;

/// The place of a model while a user moves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacementMove {
    /// World X and Y of its origin.
    pub at: Vec2,
    /// The heading of its front, radians clockwise from north.
    pub heading_rad: f32,
}

/// Models that stand elsewhere, by their number among the scene's placements.
pub type PlacementMoves = BTreeMap<usize, PlacementMove>;

/// Adds every placement that has ground under it and may be seen, and the plinths.
pub(super) fn add(
    list: &mut DrawList,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
    viewer: Viewer<'_>,
) {
    add_moved(list, scene, displayed, viewer, &PlacementMoves::new());
}

/// [`add`] with some models elsewhere.
pub(super) fn add_moved(
    list: &mut DrawList,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
    viewer: Viewer<'_>,
    moves: &PlacementMoves,
) {
    let placed = place(list, scene, displayed, moves);
    let plants = detail::add(list, scene, &placed, viewer);
    let ground = scene.scale.ground(&scene.lattice);
    canopy::add(list, SupportSurface { displayed, ground: &ground }, &plants);
}

/// [`add`] of all models in all their forms.
pub(super) fn add_forms(
    list: &mut DrawList,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
) -> Vec<ListedForm> {
    let placed = place(list, scene, displayed, &PlacementMoves::new());
    detail::add_forms(list, scene, &placed)
}

/// The corners of a model's box in world space where it would stand, by its number among the scene's placements; each
/// differs in one axis of the model from those whose numbers differ in one bit. `None` where it has no ground under it.
pub fn moved_box(
    scene: &SceneModel,
    lattice: &Lattice,
    number: usize,
    PlacementMove { at, heading_rad }: PlacementMove,
) -> Option<[Vec3; 8]> {
    let placement = Placement { at, heading_rad, ..*scene.placements.get(number)? };
    let (model, finest) = (&scene.models[placement.model], scene.scale.ground(&scene.lattice));
    let ground = SupportSurface { displayed: &FullResolution { lattice }, ground: &finest };
    let stand = stand(&placement, &ModelFootprint::of(model), ground)?;
    let mut corners = model.bounds()?.corners();
    Some([0; 8].map(|_| stand.world_from_model.transform_point3(corners.next().unwrap_or_default())))
}

/// Adds the plinths of all placements that have ground under them, and returns these.
fn place(
    list: &mut DrawList,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
    moves: &PlacementMoves,
) -> Vec<PlacedModel> {
    let finest = scene.scale.ground(&scene.lattice);
    let ground = SupportSurface { displayed, ground: &finest };
    let footprints: Vec<ModelFootprint> = scene.models.iter().map(ModelFootprint::of).collect();
    let set = |(number, placement): (usize, &Placement)| -> Option<(PlacedModel, Option<DrawMesh>)> {
        let placement = &match moves.get(&number) {
            Some(&PlacementMove { at, heading_rad }) => Placement { at, heading_rad, ..*placement },
            None => *placement,
        };
        let footprint = &footprints[placement.model];
        let stand = stand(placement, footprint, ground)?;
        let Placement { model, feature, .. } = *placement;
        let plinth = stand.plinth(placement, footprint, ground);
        let tint = tint(placement.at, scene.models[model].tints.len());
        Some((PlacedModel { model, world_from_model: stand.world_from_model, tint, feature }, plinth))
    };
    let (placed, plinths): (Vec<PlacedModel>, Vec<Option<DrawMesh>>) =
        scene.placements.par_iter().enumerate().filter_map(set).unzip();
    let mut concrete = None;
    for (block, placed) in
        plinths.into_iter().zip(&placed).filter_map(|(block, placed)| Some((block?, placed)))
    {
        let material = *concrete.get_or_insert_with(|| {
            list.add_material(Material { name: "concrete".into(), ..Material::default() })
        });
        add_mesh(list, block, material, DepthLayer::Solid, placed.feature);
    }
    placed
}

/// Which of so many tints the model at a place has: the same in every picture.
fn tint(at: Vec2, count: usize) -> u8 {
    let place = (i64::from(at.x.to_bits()), i64::from(at.y.to_bits()));
    if count > 1 { Chance::of(TINT_SEED, place).below(count) as u8 } else { 0 }
}
