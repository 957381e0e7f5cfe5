//! The sink that mesh generators write to; it hides the storage of the mesh.

/// The index of a vertex in one mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct VertexId(pub u32);

impl VertexId {
    /// The id of the vertex at `index`. Panics past `u32::MAX` vertices.
    pub fn new(index: usize) -> Self {
        Self(u32::try_from(index).expect("meshes hold fewer than 2^32 vertices"))
    }

    /// The position of this vertex in its mesh's vertex list.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Receives the vertices and triangles of a mesh.
pub trait MeshSink<V> {
    /// Adds a vertex and returns its id.
    fn vertex(&mut self, vertex: V) -> VertexId;

    /// Adds a triangle of vertices added before, counter-clockwise seen from its outside.
    fn triangle(&mut self, corners: [VertexId; 3]);
}
