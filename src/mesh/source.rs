//! A mesh as writers of files read it: counts first, then vertices, then triangles, each in a pass of its own.
//!
//! A mesh in memory is read as it is; one that is larger is made anew for each pass.

use std::io;

use glam::Vec3;

use crate::sink::VertexId;
use crate::trimesh::TriMesh;
use sandtable_geom::aabb::Aabb;

/// The size of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshSize {
    /// The number of vertices.
    pub vertices: usize,
    /// The number of triangles.
    pub triangles: usize,
    /// The box around the vertices, meters; at the origin without any.
    pub bounds: Aabb,
}

/// A mesh that is read in passes.
pub trait MeshSource {
    /// Its size.
    fn size(&self) -> MeshSize;

    /// Calls `each` with the positions of all vertices in their order, meters.
    ///
    /// # Errors
    /// Those of `each`, and where the mesh cannot be made.
    fn each_vertex(&mut self, each: &mut dyn FnMut(Vec3) -> io::Result<()>) -> io::Result<()>;

    /// Calls `each` with the vertices of all triangles in their order, counter-clockwise seen from above.
    ///
    /// # Errors
    /// As [`MeshSource::each_vertex`].
    fn each_triangle(&mut self, each: &mut dyn FnMut([VertexId; 3]) -> io::Result<()>) -> io::Result<()>;

    /// Calls `each` with the positions of the corners of all triangles in their order.
    ///
    /// # Errors
    /// As [`MeshSource::each_vertex`].
    fn each_facet(&mut self, each: &mut dyn FnMut([Vec3; 3]) -> io::Result<()>) -> io::Result<()>;
}

impl MeshSource for &TriMesh {
    fn size(&self) -> MeshSize {
        MeshSize {
            vertices: self.positions.len(),
            triangles: self.triangles.len(),
            bounds: Aabb::around(self.positions.iter().copied()).unwrap_or_default(),
        }
    }

    fn each_vertex(&mut self, each: &mut dyn FnMut(Vec3) -> io::Result<()>) -> io::Result<()> {
        self.positions.iter().copied().try_for_each(each)
    }

    fn each_triangle(&mut self, each: &mut dyn FnMut([VertexId; 3]) -> io::Result<()>) -> io::Result<()> {
        self.triangles.iter().copied().try_for_each(each)
    }

    fn each_facet(&mut self, each: &mut dyn FnMut([Vec3; 3]) -> io::Result<()>) -> io::Result<()> {
        (0..self.triangles.len()).map(|index| self.corners(index)).try_for_each(each)
    }
}
