//! Reads model files (3DS, OBJ with MTL, glTF and GLB) to a [`Model`], Z up, without a file system.
//!
//! ```text
//! bytes ── read ──┬─ three_ds ─┐
//!                 ├─ obj ──────┼─ normals, triangulate, part, material, texture ──► Model
//!                 └─ gltf ─────┘
//! ```
//!
//! `detail` chooses how a small model is drawn: as it is, as a coarser level (`simplify` collapses edges of a `soup` of
//! all parts) or as a picture (`impostor`).
//!
//! Trees, a shrub and a rock are [`built_in`]. The files that a model names (buffers, textures, material libraries)
//! come through [`Companions`]. A broken model file is an error; a texture that cannot be loaded is a note.

mod appearance;
pub mod built_in;
pub mod detail;
pub mod error;
pub mod gltf;
pub mod impostor;
mod impostor_raster;
mod material;
mod normals;
pub mod obj;
mod part;
mod quadric;
pub mod read;
pub mod simplify;
mod soup;
mod texture;
pub mod texture_files;
pub mod three_ds;
mod triangulate;
mod webp;

use glam::Vec3;

use crate::error::CompanionError;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, MaterialId};
use sandtable_draw::material::Material;
use sandtable_draw::pixels::Pixels;
use sandtable_geom::aabb::Aabb;

/// A model: X right, Y to its back, Z up, front toward −Y; in the file's units.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Meshes with one material each, node transforms applied.
    pub parts: Vec<ModelPart>,
    /// Materials, by [`MaterialId`]; textures index `textures`.
    pub materials: Vec<Material>,
    /// Textures, by [`sandtable_draw::material::TextureId`].
    pub textures: Vec<Pixels>,
    /// The numbers of elements in the file, counted as its format counts.
    pub census: Census,
    /// Notes on parts of the file that are not drawn: missing textures, unsupported features.
    pub notes: Vec<String>,
    /// What its colors are multiplied with, one by where it stands, so that plants are not all alike; none for files.
    pub tints: Vec<Srgba>,
}

/// Triangles of one material.
#[derive(Clone, Debug)]
pub struct ModelPart {
    /// The object's or mesh's name in the file; may be empty.
    pub name: String,
    /// The triangles.
    pub mesh: DrawMesh,
    /// The material.
    pub material: MaterialId,
}

/// The numbers of elements in a model file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Meshes: 3DS triangle meshes, OBJ objects and groups with faces, glTF primitives as placed by nodes.
    pub meshes: usize,
    /// Vertices as stored in the file; of glTF, those of drawn meshes, each mesh once.
    pub vertices: usize,
    /// Faces as stored in the file: a polygon counts once, and so does a mesh that is placed several times.
    pub faces: usize,
    /// Materials defined.
    pub materials: usize,
}

/// Loads the files that a model names: buffers, textures, material libraries.
pub trait Companions {
    /// The bytes of the file that the model calls `name`.
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError>;
}

impl Model {
    /// The smallest box around all vertices; `None` where there are none.
    pub fn bounds(&self) -> Option<Aabb> {
        let vertices = self.parts.iter().flat_map(|part| &part.mesh.vertices);
        Aabb::around(vertices.map(|vertex| Vec3::from(vertex.position)))
    }

    /// The number of triangles of all parts.
    pub fn triangle_count(&self) -> usize {
        self.parts.iter().map(|part| part.mesh.triangles.len()).sum()
    }
}
