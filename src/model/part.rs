//! Builds parts with shared vertices, one per material, from triangles with separate corners.
//!
//! Some formats index positions, normals and texture coordinates separately. Their readers pass whole corners; corners
//! that are equal in every bit become one vertex.

use glam::{Vec2, Vec3};

use crate::ModelPart;
use crate::error::ModelError;
use sandtable_base::limits::MODEL_TRIANGLES;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex, MaterialId};
use sandtable_mesh::numbering::Numbering;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// Counts the triangles of a model against [`MODEL_TRIANGLES`].
#[derive(Debug, Default)]
pub(super) struct TriangleBudget {
    used: usize,
}

impl TriangleBudget {
    pub(super) fn take(&mut self, triangles: usize) -> Result<(), ModelError> {
        self.used = self.used.saturating_add(triangles);
        if self.used > MODEL_TRIANGLES.count() {
            return Err(ModelError::TooLarge { what: "triangles", limit: &MODEL_TRIANGLES });
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ModelCorner {
    pub position: Vec3,
    pub normal: Vec3,
    pub uv: Vec2,
    pub color: Srgba,
}

/// The parts of one object, one a material, in the order in which materials first appear.
#[derive(Debug, Default)]
pub(super) struct PartBuilder {
    name: String,
    numbers: Numbering<MaterialId>,
    parts: Vec<WeldedPart>,
}

#[derive(Debug)]
struct WeldedPart {
    part: ModelPart,
    vertices: Numbering<[u32; 9]>,
}

impl PartBuilder {
    pub(super) fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a triangle, counter-clockwise seen from its outside.
    pub(super) fn triangle(&mut self, material: MaterialId, corners: [ModelCorner; 3]) {
        let number = self.numbers.number(material);
        if number.is_new {
            let part = ModelPart { name: self.name.clone(), mesh: DrawMesh::default(), material };
            self.parts.push(WeldedPart { part, vertices: Numbering::default() });
        }
        let WeldedPart { part, vertices } = &mut self.parts[number.index as usize];
        let ids = corners.map(|corner| {
            let vertex = DrawVertex {
                position: corner.position.into(),
                normal: corner.normal.into(),
                uv: corner.uv.into(),
                color: corner.color,
            };
            let number = vertices.number(bytemuck::cast(vertex));
            if number.is_new { part.mesh.vertex(vertex) } else { VertexId(number.index) }
        });
        part.mesh.triangle(ids);
    }

    /// The parts, each with at least one triangle.
    pub(super) fn finish(self) -> impl Iterator<Item = ModelPart> {
        self.parts.into_iter().map(|welded| welded.part)
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
        let mut budget = TriangleBudget::default();
        assert!(budget.take(MODEL_TRIANGLES.count()).is_ok());
        assert!(budget.take(1).is_err());
    }
}
