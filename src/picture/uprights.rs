//! Walls, fences, lines and footings, set on the displayed ground.

use rayon::prelude::*;

use crate::add_mesh;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh};
use sandtable_draw::material::Material;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::support_surface::SupportSurface;
use sandtable_terrain::triangle_surface::TriangleSurface;

/// Adds all uprights that have ground under them.
pub(super) fn add(list: &mut DrawList, scene: &SceneModel, displayed: &dyn TriangleSurface) {
    let ground = FullResolution { lattice: scene.ground().lattice() };
    let under = SupportSurface { displayed, ground: &ground };
    let meshes: Vec<DrawMesh> =
        scene.uprights.par_iter().map(|standing| standing.upright.mesh(under)).collect();
    let mut material = None;
    for (standing, mesh) in scene.uprights.iter().zip(meshes) {
        if !mesh.triangles.is_empty() {
            let material = *material.get_or_insert_with(|| {
                list.add_material(Material { name: "upright".into(), ..Material::default() })
            });
            add_mesh(list, mesh, material, DepthLayer::Solid, standing.feature);
        }
    }
}
