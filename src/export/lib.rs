//! Draw lists as files for modeling programs, binary glTF and OBJ, and as a page for browsers ([`page`]).
//!
//! A draw list cannot be written as it is: the ground's color comes from a map that is read at every pixel, and what
//! is draped on the ground shares its planes, so that other programs would show both flickering. So a list is prepared
//! first:
//!
//! ```text
//!  DrawList ─► bake     the ground map as a texture
//!           ─► inlay    the ground without what the drapes cover
//!           ─► prepare  normals at every vertex          ─► glb | obj
//! ```

mod bake;
pub mod features;
pub mod glb;
mod inlay;
pub mod obj;
pub mod page;
mod page_symbols;
pub mod prepare;
pub mod print_model;
pub mod scene_export;
pub mod scene_page;

use std::collections::BTreeMap;
use std::ops::Range;

use glam::Vec3;

use sandtable_draw::list::{DrawItem, DrawList, DrawMesh, FeatureId};
use sandtable_draw::material::Material;
use sandtable_mesh::sink::VertexId;
use sandtable_mesh::write::remarks::Remarks;

/// A prepared draw list ([`prepare::prepare`]) with names and remarks for its file.
#[derive(Clone, Copy)]
pub struct SceneExport<'a> {
    /// The list.
    pub list: &'a DrawList,
    /// Names features; an empty name is allowed.
    pub name_of: &'a dyn Fn(FeatureId) -> String,
    /// Remarks for the file.
    pub remarks: &'a Remarks,
}

impl SceneExport<'_> {
    fn mesh(&self, item: &DrawItem) -> &DrawMesh {
        &self.list.meshes[item.mesh.0 as usize]
    }

    fn material(&self, item: &DrawItem) -> &Material {
        &self.list.materials[item.material.0 as usize]
    }

    /// The triangles of an item that have an area; the others are not written.
    fn triangles(&self, item: &DrawItem) -> impl Iterator<Item = [VertexId; 3]> {
        let (mesh, Range { start, end }) = (self.mesh(item), item.triangles.clone());
        let position = |id: VertexId| Vec3::from(mesh.vertices[id.index()].position);
        let has_area = move |corners: &&[VertexId; 3]| {
            let [a, b, c] = corners.map(position);
            (b - a).cross(c - a) != Vec3::ZERO
        };
        mesh.triangles[start as usize..end as usize].iter().filter(has_area).copied()
    }

    /// The triangles that the file shows; those of a mesh in several places count in each.
    pub fn triangle_count(&self) -> usize {
        let mut counts = BTreeMap::new();
        let count = |item: &DrawItem| {
            let key = (item.mesh, item.triangles.start, item.triangles.end);
            *counts.entry(key).or_insert_with(|| self.triangles(item).count())
        };
        self.list.items.iter().map(count).sum()
    }
}
