//! The draw list: everything a picture shows, in drawing order.
//!
//! # Instances
//! One item stands for one thing in one place, however many there are alike: a hundred thousand trees are a hundred
//! thousand items of some hundred bytes. What is alike is told by what items say, not by a table beside them: items
//! that follow each other and differ in nothing but place and feature make a *run* ([`DrawList::runs`]). Whoever gains
//! by it takes a run at once, as the GPU renderer draws it with one call and an exporter can write one mesh with many
//! nodes; whoever does not takes item by item and gets the same.

use std::ops::Range;
use std::sync::Arc;

use glam::Mat4;

use crate::draw::color::Srgba;
use crate::draw::ground::GroundMap;
use crate::draw::lighting::Lighting;
use crate::draw::material::{Material, TextureId};
use crate::draw::pixels::Pixels;
use crate::mesh::sink::{MeshSink, VertexId};

/// The index of a mesh in a [`DrawList`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshId(pub u32);

/// The index of a material in a [`DrawList`] or a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// Which feature of the scene something belongs to; what the feature buffer of a picture holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct FeatureId(pub u32);

impl FeatureId {
    /// Nothing: the sky.
    pub const NONE: Self = Self(0);
    /// The bare ground.
    pub const GROUND: Self = Self(1);
}

/// A corner of a triangle to draw.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct DrawVertex {
    /// Position in meters, in the mesh's own space.
    pub position: [f32; 3],
    /// Unit normal in the mesh's own space; not read where the material takes the ground's.
    pub normal: [f32; 3],
    /// Texture coordinates; V runs downward, (0, 0) is the texture's upper left corner.
    pub uv: [f32; 2],
    /// Multiplied with the material's color.
    pub color: Srgba,
}

/// Vertices and counter-clockwise triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawMesh {
    /// The vertices.
    pub vertices: Vec<DrawVertex>,
    /// Triples of indices into `vertices`.
    pub triangles: Vec<[VertexId; 3]>,
}

impl MeshSink<DrawVertex> for DrawMesh {
    fn vertex(&mut self, vertex: DrawVertex) -> VertexId {
        let id = VertexId::new(self.vertices.len());
        self.vertices.push(vertex);
        id
    }

    fn triangle(&mut self, corners: [VertexId; 3]) {
        self.triangles.push(corners);
    }
}

/// Who wins where two surfaces lie in the same plane.
///
/// Items come in rising layers in [`DrawList::items`]. A draped item lies exactly in the ground's triangles,
/// so it is drawn where its depth exceeds what is there by no more than one part in 50,000, over ground and
/// lower drapes; a solid is drawn where it is nearer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DepthLayer {
    /// The terrain itself.
    Ground,
    /// Something cut to the ground's triangles; a higher number lies over a lower.
    Draped(u8),
    /// Something with a shape of its own.
    Solid,
}

/// One range of a mesh's triangles, with a material, at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawItem {
    /// The mesh.
    pub mesh: MeshId,
    /// Which of its triangles.
    pub triangles: Range<u32>,
    /// The material.
    pub material: MaterialId,
    /// Mesh space to world space: a rotation, a uniform scale and a translation.
    pub world_from_mesh: Mat4,
    /// Who wins in the same plane.
    pub layer: DepthLayer,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

impl DrawItem {
    /// Whether another item differs in nothing but its place and its feature.
    pub fn batches_with(&self, other: &Self) -> bool {
        self.mesh == other.mesh
            && self.triangles == other.triangles
            && self.material == other.material
            && self.layer == other.layer
    }
}

/// Everything a picture shows.
#[derive(Clone, Debug, Default)]
pub struct DrawList {
    /// Textures, by [`TextureId`].
    pub textures: Vec<Pixels>,
    /// Materials, by [`MaterialId`].
    pub materials: Vec<Material>,
    /// Meshes, by [`MeshId`].
    pub meshes: Vec<DrawMesh>,
    /// What to draw, layers rising.
    pub items: Vec<DrawItem>,
    /// The map that ground materials read.
    pub ground: Option<Arc<GroundMap>>,
    /// Light, haze and sky.
    pub lighting: Lighting,
}

impl DrawList {
    /// Adds a texture.
    pub fn add_texture(&mut self, pixels: Pixels) -> TextureId {
        self.textures.push(pixels);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds a material.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a mesh.
    pub fn add_mesh(&mut self, mesh: DrawMesh) -> MeshId {
        self.meshes.push(mesh);
        MeshId(self.meshes.len() as u32 - 1)
    }

    /// The runs of items: each as long as it can be, in order, all items covered.
    pub fn runs(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let mut start = 0;
        self.items.chunk_by(DrawItem::batches_with).map(move |run| {
            let range = start..start + run.len();
            start = range.end;
            range
        })
    }

    /// How many triangles all items draw together.
    pub fn triangle_count(&self) -> usize {
        self.items.iter().map(|item| item.triangles.len()).sum()
    }

    /// Whether every index points at something, layers rise and the ground map is sound: what a renderer
    /// relies on.
    ///
    /// # Errors
    /// A sentence that names the first thing out of place.
    pub fn check(&self) -> Result<(), String> {
        for (index, mesh) in self.meshes.iter().enumerate() {
            let count = mesh.vertices.len();
            if let Some(corners) =
                mesh.triangles.iter().find(|corners| corners.iter().any(|id| id.index() >= count))
            {
                return Err(format!("mesh {index} has {count} vertices but a triangle {corners:?}"));
            }
        }
        for (index, material) in self.materials.iter().enumerate() {
            if material.texture.is_some_and(|id| id.0 as usize >= self.textures.len()) {
                return Err(format!("material {index} names a texture that is not there"));
            }
        }
        for (index, item) in self.items.iter().enumerate() {
            let mesh = self.meshes.get(item.mesh.0 as usize).ok_or(format!("item {index} names no mesh"))?;
            if item.triangles.end as usize > mesh.triangles.len() || item.triangles.start > item.triangles.end
            {
                return Err(format!(
                    "item {index} draws triangles {:?} of {}",
                    item.triangles,
                    mesh.triangles.len()
                ));
            }
            if item.material.0 as usize >= self.materials.len() {
                return Err(format!("item {index} names no material"));
            }
        }
        self.ground.as_deref().map_or(Ok(()), GroundMap::check)?;
        match self.items.windows(2).position(|pair| pair[0].layer > pair[1].layer) {
            Some(index) => Err(format!("item {} lies in a lower layer than the one before it", index + 1)),
            None => Ok(()),
        }
    }
}
