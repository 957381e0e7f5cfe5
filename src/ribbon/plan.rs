//! Triangles in plan, before they meet the ground.

use glam::{DVec2, Vec2};

use crate::mesh::sink::{MeshSink, VertexId};

/// A corner in plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanVertex {
    /// World X and Y in metres.
    pub at: DVec2,
    /// Texture coordinates.
    pub uv: Vec2,
}

/// Counter-clockwise triangles in plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanMesh {
    /// The corners.
    pub vertices: Vec<PlanVertex>,
    /// Triples of indices into `vertices`.
    pub triangles: Vec<[VertexId; 3]>,
}

impl PlanMesh {
    /// The corners of every triangle.
    pub fn corners(&self) -> impl Iterator<Item = [PlanVertex; 3]> + '_ {
        self.triangles.iter().map(|triangle| triangle.map(|id| self.vertices[id.index()]))
    }

    /// The sum of all triangles' areas in square metres.
    pub fn area_m2(&self) -> f64 {
        self.corners().map(|[a, b, c]| (b.at - a.at).perp_dot(c.at - a.at) / 2.0).sum()
    }
}

impl MeshSink<PlanVertex> for PlanMesh {
    fn vertex(&mut self, vertex: PlanVertex) -> VertexId {
        let id = VertexId::new(self.vertices.len());
        self.vertices.push(vertex);
        id
    }

    fn triangle(&mut self, corners: [VertexId; 3]) {
        self.triangles.push(corners);
    }
}
