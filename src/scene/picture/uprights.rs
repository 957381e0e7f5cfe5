//! What stands on the ground, set on it as it is displayed: the walls, fences and lines, and what buildings lack to it.

use rayon::prelude::*;

use crate::draw::list::{DrawList, DrawMesh, Layer};
use crate::draw::material::Material;
use crate::scene::kind::Scene;
use crate::scene::picture::add_mesh;
use crate::terrain::facets::Facets;
use crate::terrain::finest::Finest;
use crate::terrain::underfoot::Underfoot;

/// Adds all uprights that have ground under them.
pub(super) fn add(list: &mut DrawList, scene: &Scene, displayed: &dyn Facets) {
    let terrain = &scene.terrain;
    let ground = Finest { lattice: &terrain.lattice, exaggeration: terrain.exaggeration };
    let under = Underfoot { displayed, ground };
    let meshes: Vec<DrawMesh> =
        scene.uprights.par_iter().map(|standing| standing.upright.mesh(under)).collect();
    let mut material = None;
    for (standing, mesh) in scene.uprights.iter().zip(meshes) {
        if !mesh.triangles.is_empty() {
            let material = *material.get_or_insert_with(|| {
                list.add_material(Material { name: "upright".into(), ..Material::default() })
            });
            add_mesh(list, mesh, material, Layer::Solid, standing.feature);
        }
    }
}
