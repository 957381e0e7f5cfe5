//! The draw list: everything a picture shows, in drawing order.
//!
//! # Instances
//! One item is one object at one place: a hundred thousand trees are a hundred thousand items of some hundred bytes.
//! Consecutive items that differ only in placement and feature form a *run* ([`DrawList::runs`]). The GPU renderer
//! draws a run with one call, and an exporter can write it as one mesh with many nodes. Drawing item by item gives the
//! same picture.

use std::ops::Range;
use std::sync::Arc;

use glam::{Mat4, Vec2};
use rayon::prelude::*;

use crate::color::Srgba;
use crate::ground::{GroundMap, GroundMapError};
use crate::ground_inset::GroundInset;
use crate::lighting::Lighting;
use crate::material::{Material, TextureId};
use crate::pixels::Pixels;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// The index of a mesh in a [`DrawList`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshId(pub u32);

/// The index of a material in a [`DrawList`] or a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// The feature of the scene that something belongs to; the value in a picture's feature buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct FeatureId(pub u32);

impl FeatureId {
    /// Nothing: the sky.
    pub const NONE: Self = Self(0);
    /// The bare ground.
    pub const GROUND: Self = Self(1);
    /// The walls and the base of the block that the ground is the top of.
    pub const PLINTH: Self = Self(u32::MAX);

    /// The feature of an index, counted from 0; the inverse of [`FeatureId::index`].
    ///
    /// ```
    /// use sandtable_draw::list::FeatureId;
    /// assert_eq!(FeatureId::of_index(7).index(), Some(7));
    /// ```
    pub fn of_index(index: usize) -> Self {
        Self(Self::GROUND.0 + 1 + index as u32)
    }

    /// Which feature it is, counted from 0; `None` for nothing, for the ground and for the plinth.
    pub fn index(self) -> Option<usize> {
        match self {
            Self::PLINTH => None,
            feature => Some(feature.0.checked_sub(Self::GROUND.0 + 1)? as usize),
        }
    }
}

/// A corner of a triangle to draw.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct DrawVertex {
    /// Position in meters, in mesh space.
    pub position: [f32; 3],
    /// Unit normal in mesh space; not read where the material takes the ground's.
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

/// The share of a depth by which a draped surface may lie behind the surface it is draped on.
pub const DRAPE_TOLERANCE: f64 = 1.0 / 50_000.0;

/// The order of surfaces that lie in the same plane.
///
/// Items come in rising layers in [`DrawList::items`]. A draped item lies exactly in the ground's triangles. It is
/// drawn over the ground and lower drapes where its depth exceeds theirs by no more than [`DRAPE_TOLERANCE`]. A solid
/// is drawn where it is nearer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DepthLayer {
    /// The terrain.
    Ground,
    /// Cut to the ground's triangles; a higher number lies over a lower.
    Draped(u8),
    /// Has a shape of its own.
    Solid,
}

/// A range of a mesh's triangles with a material, placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawItem {
    /// The mesh.
    pub mesh: MeshId,
    /// The range of its triangles.
    pub triangles: Range<u32>,
    /// The material.
    pub material: MaterialId,
    /// Mesh space to world space: a rotation, a uniform scale and a translation.
    pub world_from_mesh: Mat4,
    /// The order in the same plane.
    pub layer: DepthLayer,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

impl DrawItem {
    /// Whether `other` differs in placement and feature only.
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
    /// The items, layers rising.
    pub items: Vec<DrawItem>,
    /// The map that ground materials read.
    pub ground: Option<Arc<GroundMap>>,
    /// Finer maps of parts of the ground, each within the one before; only the processor draws them.
    pub insets: Vec<GroundInset>,
    /// Light, haze and sky.
    pub lighting: Lighting,
}

/// Why a draw list cannot be rendered; numbers are indices into the list.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum DrawListError {
    #[error("a triangle of mesh {0} names a vertex that the mesh does not hold")]
    MissingVertex(usize),
    #[error("material {0} names a texture that the list does not hold")]
    MissingTexture(usize),
    #[error("item {0} names a mesh that the list does not hold")]
    MissingMesh(usize),
    #[error("item {0} draws triangles that its mesh does not hold")]
    MissingTriangles(usize),
    #[error("item {0} names a material that the list does not hold")]
    MissingMaterial(usize),
    #[error("item {0} takes its color or normals from the ground map, but the draw list has none; add one")]
    MissingGroundMap(usize),
    #[error("item {0} lies in a lower layer than the item before it")]
    LayerOrder(usize),
    #[error(transparent)]
    GroundMap(#[from] GroundMapError),
}

impl DrawList {
    /// The elevation of the ground map at a world position, meters, of the finest one there; `None` without ground.
    pub fn ground_height_m(&self, at: Vec2) -> Option<f32> {
        let holds = |inset: &&GroundInset| {
            let [min, max] = inset.corners();
            min.cmple(at).all() && at.cmple(max).all()
        };
        let height_m = |inset: &GroundInset| inset.map.sample(at - inset.origin).height_m;
        let finest = self.insets.iter().rev().find(holds).map(height_m);
        finest.or_else(|| Some(self.ground.as_ref()?.sample(at).height_m))
    }

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

    /// The runs of items, in order: each as long as possible, together all items.
    pub fn runs(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let mut start = 0;
        self.items.chunk_by(DrawItem::batches_with).map(move |run| {
            let range = start..start + run.len();
            start = range.end;
            range
        })
    }

    /// The number of triangles that all items draw together.
    pub fn triangle_count(&self) -> usize {
        self.items.iter().map(|item| item.triangles.len()).sum()
    }

    /// Checks the invariants that renderers rely on: every index is in range, layers rise, and the ground map is
    /// present where it is read, and sound.
    ///
    /// # Errors
    /// The first [`DrawListError`] found.
    pub fn check(&self) -> Result<(), DrawListError> {
        let lacks_vertex = |mesh: &DrawMesh| {
            let count = mesh.vertices.len();
            mesh.triangles.iter().flatten().any(|id| id.index() >= count)
        };
        let lacks_texture =
            |material: &Material| material.texture.is_some_and(|id| id.0 as usize >= self.textures.len());
        if let Some(mesh) = self.meshes.par_iter().position_first(lacks_vertex) {
            return Err(DrawListError::MissingVertex(mesh));
        }
        if let Some(material) = self.materials.iter().position(lacks_texture) {
            return Err(DrawListError::MissingTexture(material));
        }
        for (index, item) in self.items.iter().enumerate() {
            self.check_item(index, item)?;
        }
        if let Some(index) = self.items.windows(2).position(|pair| pair[0].layer > pair[1].layer) {
            return Err(DrawListError::LayerOrder(index + 1));
        }
        let insets = self.insets.iter().map(|inset| &*inset.map);
        Ok(self.ground.as_deref().into_iter().chain(insets).try_for_each(GroundMap::check)?)
    }

    fn check_item(&self, index: usize, item: &DrawItem) -> Result<(), DrawListError> {
        let mesh = self.meshes.get(item.mesh.0 as usize).ok_or(DrawListError::MissingMesh(index))?;
        let Range { start, end } = item.triangles;
        if start > end || end as usize > mesh.triangles.len() {
            return Err(DrawListError::MissingTriangles(index));
        }
        let material = self.materials.get(item.material.0 as usize);
        let material = material.ok_or(DrawListError::MissingMaterial(index))?;
        if material.reads_ground_map() && self.ground.is_none() {
            return Err(DrawListError::MissingGroundMap(index));
        }
        Ok(())
    }
}
