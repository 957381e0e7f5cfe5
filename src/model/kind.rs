//! What every model file becomes.

use glam::Vec3;

use crate::draw::list::{DrawMesh, MaterialId};
use crate::draw::material::Material;
use crate::draw::pixels::Pixels;

/// A model: X right, Y to its back, Z up, front towards −Y; in the file's units.
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
