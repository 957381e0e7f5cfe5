//! Model files — 3DS, OBJ with MTL, glTF and GLB — to one [`Model`], Z up, no file system.
//!
//! ```text
//! bytes ── read ──┬─ three_ds ─┐
//!                 ├─ obj ──────┼─ normals, triangulate, part, texture ──► Model
//!                 └─ gltf ─────┘
//! ```
//!
//! How a model is drawn where it is small is its own matter too: `detail` chooses between the model, its coarser levels
//! (`simplify`, by collapsing edges of a `soup` of all parts) and pictures of it (`impostor`).
//!
//! Trees, a shrub and a rock are [`built_in`]. What a model file names — buffers, textures, material libraries — comes
//! through [`Companions`]. A file that cannot be trusted is an error; a picture that cannot be had is a note on a
//! model without it.

pub mod built_in;
pub mod detail;
pub mod error;
pub mod gltf;
pub mod impostor;
mod impostor_raster;
mod nearest;
mod normals;
pub mod obj;
mod part;
mod quadric;
pub mod read;
pub mod simplify;
mod soup;
mod texture;
pub mod three_ds;
mod triangulate;

use glam::Vec3;

use crate::draw::list::{DrawMesh, MaterialId};
use crate::draw::material::Material;
use crate::draw::pixels::Pixels;

/// A model: X right, Y to its back, Z up, front toward −Y; in the file's units.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Meshes with one material each, node transforms applied.
    pub parts: Vec<ModelPart>,
    /// Materials, by [`MaterialId`]; textures index `textures`.
    pub materials: Vec<Material>,
    /// Textures, by [`crate::draw::material::TextureId`].
    pub textures: Vec<Pixels>,
    /// What the file holds, counted as its format counts.
    pub census: Census,
    /// What the file asked for and did not get: a missing texture, a feature that is not drawn.
    pub notes: Vec<String>,
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

/// What a model file holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Meshes: 3DS triangle meshes, OBJ objects or groups with faces, glTF primitives as placed by nodes.
    pub meshes: usize,
    /// Vertices as stored in the file; of glTF, those of drawn meshes, each mesh once.
    pub vertices: usize,
    /// Faces as stored in the file: a polygon counts once, and so does a mesh that stands in several places.
    pub faces: usize,
    /// Materials defined.
    pub materials: usize,
}

/// Gives a loader the files its model names: buffers, textures, material libraries.
pub trait Companions {
    /// The bytes of the file that the model calls `name`, looked up beside the model.
    ///
    /// # Errors
    /// A sentence that says why it cannot be had.
    fn load(&self, name: &str) -> Result<Vec<u8>, String>;
}

impl Model {
    /// The smallest box around all vertices as `(min, max)`; `None` where there are none.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut positions =
            self.parts.iter().flat_map(|part| &part.mesh.vertices).map(|vertex| Vec3::from(vertex.position));
        let first = positions.next()?;
        Some(positions.fold((first, first), |(min, max), at| (min.min(at), max.max(at))))
    }

    /// How many triangles are drawn, all places of a mesh counted.
    pub fn triangle_count(&self) -> usize {
        self.parts.iter().map(|part| part.mesh.triangles.len()).sum()
    }
}
