//! An indexed triangle mesh in world space.

use glam::Vec3;

use crate::sink::{MeshSink, VertexId};

/// Positions in meters (X east, Y north, Z up) and triangles, counter-clockwise seen from above.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Triples of indices into `positions`.
    pub triangles: Vec<[VertexId; 3]>,
}

impl TriMesh {
    /// The three corners of triangle `index`. Panics where an index is out of range.
    pub fn corners(&self, index: usize) -> [Vec3; 3] {
        self.triangles[index].map(|id| self.positions[id.index()])
    }
}

impl MeshSink<Vec3> for TriMesh {
    fn vertex(&mut self, vertex: Vec3) -> VertexId {
        let id = VertexId::new(self.positions.len());
        self.positions.push(vertex);
        id
    }

    fn triangle(&mut self, corners: [VertexId; 3]) {
        self.triangles.push(corners);
    }
}
