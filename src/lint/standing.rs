//! The solids and models of a scene, indexed for rays and placed on the finest ground, as in a walk.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};

use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, FeatureId, MaterialId, MeshId};
use sandtable_geom::rect::Rect;
use sandtable_model::Model;
use sandtable_scene::footprint::ModelFootprint;
use sandtable_scene::placement::stand;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::support_surface::SupportSurface;
use sandtable_walk::pick::StandingIndex;

/// The solids and models for which `is_wanted` returns true, given their feature and a rectangle around them in world
/// coordinates.
pub fn standing_index(scene: &SceneModel, is_wanted: &dyn Fn(FeatureId, &Rect) -> bool) -> StandingIndex {
    let mut list = DrawList::default();
    for solid in &scene.solids {
        let plan = solid.mesh.vertices.iter().map(|at| Vec3::from(at.position).truncate().as_dvec2());
        if is_wanted(solid.feature, &Rect::around(plan)) {
            let mesh = list.add_mesh(solid.mesh.clone());
            add_item(&mut list, mesh, Mat4::IDENTITY, solid.feature);
        }
    }
    let finest = scene.scale.ground(&scene.lattice);
    let ground = SupportSurface { displayed: &finest, ground: &finest };
    let footprints: Vec<ModelFootprint> = scene.models.iter().map(ModelFootprint::of).collect();
    let reaches: Vec<f32> = scene.models.iter().map(reach).collect();
    let mut meshes: BTreeMap<usize, Vec<MeshId>> = BTreeMap::new();
    for placement in &scene.placements {
        let around = Vec2::splat(reaches[placement.model] * placement.scale);
        let [min, max] = [placement.at - around, placement.at + around].map(|at| at.as_dvec2());
        if !is_wanted(placement.feature, &Rect { min, max }) {
            continue;
        }
        let Some(pose) = stand(placement, &footprints[placement.model], ground) else { continue };
        let parts = meshes.entry(placement.model).or_insert_with(|| {
            scene.models[placement.model].parts.iter().map(|part| list.add_mesh(part.mesh.clone())).collect()
        });
        for &mesh in parts.iter() {
            add_item(&mut list, mesh, pose.world_from_model, placement.feature);
        }
    }
    StandingIndex::new(Arc::new(list))
}

/// The greatest distance of a model from its origin, in its own units.
pub fn reach(model: &Model) -> f32 {
    model.bounds().map_or(0.0, |bounds| bounds.farthest_from(Vec3::ZERO).length())
}

fn add_item(list: &mut DrawList, mesh: MeshId, world_from_mesh: Mat4, feature: FeatureId) {
    let triangles = 0..list.meshes[mesh.0 as usize].triangles.len() as u32;
    let (material, layer) = (MaterialId(0), DepthLayer::Solid);
    list.items.push(DrawItem { mesh, triangles, material, world_from_mesh, layer, feature });
}
