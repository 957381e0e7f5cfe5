//! Triangles with corners of their own to parts with shared vertices, one part a material.
//!
//! Readers of formats that index positions, normals and texture coordinates apart hand in whole corners;
//! corners equal in every bit become one vertex.

use std::collections::{BTreeMap, HashMap};

use glam::{Vec2, Vec3};

use crate::draw::color::Srgba;
use crate::draw::list::{DrawMesh, DrawVertex, MaterialId};
use crate::mesh::sink::{MeshSink, VertexId};
use crate::model::ModelPart;
use crate::model::error::ModelError;

/// The most triangles a model may have once all its instances are placed; bounds the memory that a small
/// file with many instances can ask for to some hundred megabytes. Arbitrary, but above what a scene can use.
pub(super) const MAX_TRIANGLES: usize = 1 << 22;

/// Counts the triangles of a model against [`MAX_TRIANGLES`].
#[derive(Debug, Default)]
pub(super) struct Budget {
    used: usize,
}

impl Budget {
    /// Takes `triangles` from the budget.
    ///
    /// # Errors
    /// [`ModelError::TooLarge`].
    pub(super) fn take(&mut self, triangles: usize) -> Result<(), ModelError> {
        self.used = self.used.saturating_add(triangles);
        if self.used > MAX_TRIANGLES {
            return Err(ModelError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
        }
        Ok(())
    }
}

/// One corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelCorner {
    pub position: Vec3,
    pub normal: Vec3,
    pub uv: Vec2,
    pub color: Srgba,
}

/// The parts of one object, a material each, in the order in which materials first appear.
#[derive(Debug, Default)]
pub(super) struct PartBuilder {
    name: String,
    parts: Vec<Growing>,
    of_material: BTreeMap<MaterialId, usize>,
}

#[derive(Debug)]
struct Growing {
    material: MaterialId,
    mesh: DrawMesh,
    known: HashMap<DrawVertexBits, VertexId>,
}

type DrawVertexBits = [u32; 9];

impl PartBuilder {
    /// Parts of an object called `name`.
    pub(super) fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a triangle, counter-clockwise seen from its outside.
    pub(super) fn triangle(&mut self, material: MaterialId, corners: [ModelCorner; 3]) {
        let parts = &mut self.parts;
        let index = *self.of_material.entry(material).or_insert_with(|| {
            parts.push(Growing { material, mesh: DrawMesh::default(), known: HashMap::new() });
            parts.len() - 1
        });
        let part = &mut parts[index];
        let ids = corners.map(|corner| part.vertex(corner));
        part.mesh.triangle(ids);
    }

    /// The parts that got triangles.
    pub(super) fn finish(self) -> impl Iterator<Item = ModelPart> {
        let name = self.name;
        self.parts.into_iter().map(move |part| ModelPart {
            name: name.clone(),
            mesh: part.mesh,
            material: part.material,
        })
    }
}

impl Growing {
    fn vertex(&mut self, corner: ModelCorner) -> VertexId {
        let vertex = DrawVertex {
            position: corner.position.into(),
            normal: corner.normal.into(),
            uv: corner.uv.into(),
            color: corner.color,
        };
        let bits: DrawVertexBits = bytemuck::cast(vertex);
        let mesh = &mut self.mesh;
        *self.known.entry(bits).or_insert_with(|| mesh.vertex(vertex))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f32, y: f32) -> ModelCorner {
        ModelCorner { position: Vec3::new(x, y, 0.0), normal: Vec3::Z, uv: Vec2::ZERO, color: Srgba::WHITE }
    }

    #[test]
    fn two_triangles_of_a_square_share_two_vertices() {
        let mut builder = PartBuilder::new("square");
        let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        builder.triangle(MaterialId(0), [corners[0], corners[1], corners[2]]);
        builder.triangle(MaterialId(0), [corners[0], corners[2], corners[3]]);
        let parts: Vec<ModelPart> = builder.finish().collect();
        assert_eq!((parts[0].mesh.vertices.len(), parts[0].mesh.triangles.len()), (4, 2));
    }

    #[test]
    fn every_material_gets_a_part() {
        let mut builder = PartBuilder::new("two");
        let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0)];
        for material in [1, 0, 1] {
            builder.triangle(MaterialId(material), corners);
        }
        let counts: Vec<_> =
            builder.finish().map(|part| (part.material.0, part.mesh.triangles.len())).collect();
        assert_eq!(counts, [(1, 2), (0, 1)]);
    }

    #[test]
    fn more_triangles_than_the_budget_are_refused() {
        let mut budget = Budget::default();
        assert!(budget.take(MAX_TRIANGLES).is_ok());
        assert!(budget.take(1).is_err());
    }
}
