//! Ribbons, cut to the displayed triangles.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::draw::color::Srgba;
use crate::draw::list::{DepthLayer, DrawList, DrawMesh, MaterialId};
use crate::draw::material::{AlphaMode, Material, NormalSource};
use crate::ribbon::drape::drape;
use crate::ribbon::texture::{RibbonSurface, texture};
use crate::scene::SceneModel;
use crate::scene::picture::add_mesh;
use crate::terrain::triangle_surface::TriangleSurface;

/// Adds all ribbons, lower layers first.
pub(super) fn add(list: &mut DrawList, scene: &SceneModel, displayed: &dyn TriangleSurface) {
    let meshes: Vec<DrawMesh> = scene
        .ribbons
        .par_iter()
        .map(|ribbon| {
            let mut mesh = DrawMesh::default();
            drape(&ribbon.plan, displayed, &mut mesh);
            mesh
        })
        .collect();
    let mut materials: BTreeMap<(RibbonSurface, [u8; 4]), MaterialId> = BTreeMap::new();
    let mut order: Vec<_> =
        scene.ribbons.iter().zip(meshes).filter(|(_, mesh)| !mesh.triangles.is_empty()).collect();
    order.sort_by_key(|(ribbon, _)| ribbon.layer);
    for (ribbon, mesh) in order {
        let material = *materials
            .entry((ribbon.surface, ribbon.tint.0))
            .or_insert_with(|| draped_material(list, ribbon.surface, ribbon.tint));
        add_mesh(list, mesh, material, DepthLayer::Draped(ribbon.layer), ribbon.feature);
    }
}

fn draped_material(list: &mut DrawList, surface: RibbonSurface, tint: Srgba) -> MaterialId {
    let texture = list.add_texture(texture(surface));
    list.add_material(Material {
        name: format!("{surface:?}").to_lowercase(),
        base_color: tint,
        texture: Some(texture),
        alpha: if surface.lets_through() { AlphaMode::Blend } else { AlphaMode::Opaque },
        normals: NormalSource::Ground,
        ..Material::default()
    })
}
