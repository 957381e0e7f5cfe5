//! A set of vertices as a list.

use crate::graph::Vertex;
use crate::layout::PatchLayout;

/// A list of vertices, each once, with a membership bit for every vertex of the layout.
#[derive(Clone, Debug)]
pub(super) struct VertexSet {
    list: Vec<Vertex>,
    bits: Vec<u64>,
}

impl VertexSet {
    pub(super) fn new(layout: &PatchLayout) -> Self {
        Self { list: Vec::new(), bits: vec![0; layout.vertex_count().div_ceil(64)] }
    }

    /// Whether the vertex with this index is a member.
    pub(super) fn contains(&self, index: usize) -> bool {
        self.bits[index / 64] >> (index % 64) & 1 == 1
    }

    pub(super) fn insert(&mut self, layout: &PatchLayout, vertex: Vertex) {
        let index = layout.index(vertex);
        if !self.contains(index) {
            self.bits[index / 64] |= 1 << (index % 64);
            self.list.push(vertex);
        }
    }

    /// Keeps the vertices for which `keep`, called with the vertex and its index, returns true.
    pub(super) fn retain(&mut self, layout: &PatchLayout, mut keep: impl FnMut(Vertex, usize) -> bool) {
        let bits = &mut self.bits;
        self.list.retain(|&vertex| {
            let index = layout.index(vertex);
            let kept = keep(vertex, index);
            if !kept {
                bits[index / 64] &= !(1 << (index % 64));
            }
            kept
        });
    }
}
