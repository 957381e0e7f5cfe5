//! Models, each set where it stands.

use std::collections::BTreeMap;

use crate::draw::list::{DrawItem, DrawList, Layer, MaterialId, MeshId};
use crate::draw::material::{Material, TextureId};
use crate::model::kind::Model;
use crate::scene::footprint::Footprint;
use crate::scene::kind::Scene;
use crate::scene::picture::add_mesh;
use crate::scene::stand::{Grounds, stand};
use crate::terrain::facets::Facets;
use crate::terrain::finest::Finest;

/// A model's meshes and materials in a draw list.
struct Listed {
    parts: Vec<(MeshId, u32, MaterialId)>,
    footprint: Footprint,
}

/// Adds every placement that has ground under it, and the plinths.
pub(super) fn add(list: &mut DrawList, scene: &Scene, displayed: &dyn Facets) {
    let finest = Finest { lattice: &scene.terrain.lattice, exaggeration: scene.terrain.exaggeration };
    let grounds = Grounds { displayed, finest };
    let mut listed: BTreeMap<usize, Listed> = BTreeMap::new();
    let mut concrete = None;
    for placement in &scene.placements {
        let model =
            listed.entry(placement.model).or_insert_with(|| list_model(list, &scene.models[placement.model]));
        let Some(stand) = stand(placement, &model.footprint, &grounds) else {
            continue;
        };
        for &(mesh, count, material) in &model.parts {
            list.items.push(DrawItem {
                mesh,
                triangles: 0..count,
                material,
                world_from_mesh: stand.world_from_model,
                layer: Layer::Solid,
                feature: placement.feature,
            });
        }
        if let Some(block) = stand.plinth(placement, &model.footprint, &grounds) {
            let material = *concrete.get_or_insert_with(|| {
                list.add_material(Material { name: "concrete".into(), ..Material::default() })
            });
            add_mesh(list, block, material, Layer::Solid, placement.feature);
        }
    }
}

fn list_model(list: &mut DrawList, model: &Model) -> Listed {
    let first_texture = list.textures.len() as u32;
    list.textures.extend(model.textures.iter().cloned());
    let first_material = list.materials.len() as u32;
    list.materials.extend(model.materials.iter().map(|material| Material {
        texture: material.texture.map(|TextureId(id)| TextureId(id + first_texture)),
        ..material.clone()
    }));
    let parts = model
        .parts
        .iter()
        .map(|part| {
            let count = part.mesh.triangles.len() as u32;
            (list.add_mesh(part.mesh.clone()), count, MaterialId(part.material.0 + first_material))
        })
        .collect();
    Listed { parts, footprint: Footprint::of(model) }
}
