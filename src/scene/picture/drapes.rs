//! What lies on the ground, cut to the displayed triangles.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::draw::color::Srgba;
use crate::draw::list::{DrawList, DrawMesh, Layer, MaterialId};
use crate::draw::material::{Alpha, Material, Normals};
use crate::ribbon::drape::drape;
use crate::ribbon::texture::{Surface, texture};
use crate::scene::kind::Scene;
use crate::scene::picture::add_mesh;
use crate::terrain::facets::Facets;

/// Adds all ribbons, lower layers first.
pub(super) fn add(list: &mut DrawList, scene: &Scene, displayed: &dyn Facets) {
    let meshes: Vec<DrawMesh> = scene
        .ribbons
        .par_iter()
        .map(|ribbon| {
            let mut mesh = DrawMesh::default();
            drape(&ribbon.plan, displayed, &mut mesh);
            mesh
        })
        .collect();
    let mut materials: BTreeMap<(Surface, [u8; 4]), MaterialId> = BTreeMap::new();
    let mut order: Vec<_> =
        scene.ribbons.iter().zip(meshes).filter(|(_, mesh)| !mesh.triangles.is_empty()).collect();
    order.sort_by_key(|(ribbon, _)| ribbon.layer);
    for (ribbon, mesh) in order {
        let material = *materials
            .entry((ribbon.surface, ribbon.tint.0))
            .or_insert_with(|| draped_material(list, ribbon.surface, ribbon.tint));
        add_mesh(list, mesh, material, Layer::Draped(ribbon.layer), ribbon.feature);
    }
}

fn draped_material(list: &mut DrawList, surface: Surface, tint: Srgba) -> MaterialId {
    let texture = list.add_texture(texture(surface));
    list.add_material(Material {
        name: format!("{surface:?}").to_lowercase(),
        base_color: tint,
        texture: Some(texture),
        alpha: if surface.lets_through() { Alpha::Blend } else { Alpha::Opaque },
        normals: Normals::Ground,
        ..Material::default()
    })
}
