//! The triangle bintree's leaves (Duchaineau et al. 1997).
//!
//! Either as triples of grid vertices, for any patch, or per patch as triples of indices into the block of its (patch + 1)²
//! vertices: the block never changes, and a frame renews the short list alone.

use crate::active::ActiveSet;
use crate::bintree::Triangle;
use crate::emit::walk::{self, WalkKey};
use crate::graph::Vertex;
use crate::layout::PatchLayout;

/// Calls `emit` with the leaves of the patches whose south-west corners are listed, counter-clockwise from the apex. Within
/// a patch every leaf shares an edge with the one before.
pub fn triangles(
    active: &ActiveSet,
    patches: impl IntoIterator<Item = Vertex>,
    mut emit: impl FnMut([Vertex; 3]),
) {
    for corner in patches {
        triangles_where(active, corner, |_| true, &mut emit);
    }
}

/// The leaves of one patch, without the triangles for which `enter` returns false and those below them. `enter` is called
/// with the corners of inner triangles too.
pub fn triangles_where(
    active: &ActiveSet,
    corner: Vertex,
    mut enter: impl FnMut([Vertex; 3]) -> bool,
    mut emit: impl FnMut([Vertex; 3]),
) {
    let layout = active.layout();
    let columns = layout.columns() as i32;
    let at = |key: WalkKey| vertex(columns, key);
    let vertices = |[apex, entry, exit]: [WalkKey; 3]| [at(apex), at(entry), at(exit)];
    let roots = Triangle::roots(corner, layout.patch()).map(|root| root.corners().map(|at| key(layout, at)));
    walk::leaves(active, roots, |keys| enter(vertices(keys)), |keys| emit(vertices(keys)));
}

/// The key of a vertex of the layout, tagged with its row.
#[inline]
pub fn key(layout: &PatchLayout, vertex: Vertex) -> WalkKey {
    WalkKey::new(layout.index(vertex) as u32, vertex.y as u32)
}

/// The vertex of a key that is tagged with its row; `columns` vertices make a row.
#[inline]
pub fn vertex(columns: i32, key: WalkKey) -> Vertex {
    let y = key.tag() as i32;
    Vertex::new(key.index() as i32 - y * columns, y)
}

/// The (patch + 1)² vertices of one patch, row by row from the south-west, which index lists refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexBlock {
    patch: i32,
}

/// Cells along the side of the largest patch whose 129² vertices have 16-bit indices.
pub const LARGEST_BLOCK: i32 = 128;

impl VertexBlock {
    /// The block of every patch of a layout; `None` where its patches are larger than [`LARGEST_BLOCK`].
    pub fn new(layout: &PatchLayout) -> Option<Self> {
        (layout.patch() <= LARGEST_BLOCK).then_some(Self { patch: layout.patch() })
    }

    /// The number of vertices.
    pub fn vertex_count(self) -> usize {
        ((self.patch + 1) * (self.patch + 1)) as usize
    }

    /// The vertex at `index` in the block of the patch with south-west corner `corner`.
    #[inline]
    pub fn vertex(self, corner: Vertex, index: u16) -> Vertex {
        let side = self.patch + 1;
        corner.moved(i32::from(index) % side, i32::from(index) / side)
    }

    /// The index of a vertex of the patch with south-west corner `corner`.
    #[inline]
    pub fn index(self, corner: Vertex, vertex: Vertex) -> u16 {
        ((vertex.y - corner.y) * (self.patch + 1) + vertex.x - corner.x) as u16
    }

    /// Appends the leaves of one patch for which `keep` returns true to `list`, counter-clockwise from the apex.
    ///
    /// In a patch that a border cuts or that lacks data `keep` must test
    /// [`drawn_posts`](crate::emit::world::drawn_posts).
    pub fn append(
        self,
        active: &ActiveSet,
        corner: Vertex,
        mut keep: impl FnMut([u16; 3]) -> bool,
        list: &mut Vec<[u16; 3]>,
    ) {
        let layout = active.layout();
        let key = |at: Vertex| WalkKey::new(layout.index(at) as u32, u32::from(self.index(corner, at)));
        let roots = Triangle::roots(corner, layout.patch()).map(|root| root.corners().map(key));
        walk::leaves(
            active,
            roots,
            |_| true,
            |keys| {
                let indices = keys.map(|key| key.tag() as u16);
                if keep(indices) {
                    list.push(indices);
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::flat::Flat;
    use crate::emit::examples::{activations, active_set, full_area_m2, lattice, mesh_of, shares_edge};
    use crate::emit::quadtree;
    use crate::emit::strips::{self, Strips};
    use crate::errors::ErrorMap;
    use crate::refine::rebuild::rebuild;
    use proptest::prelude::*;
    use sandtable_mesh::check;

    /// The leaves by splitting triangles, the plain way.
    fn plain(active: &ActiveSet, corner: Vertex) -> Vec<[Vertex; 3]> {
        let mut stack = Triangle::roots(corner, active.layout().patch()).to_vec();
        let mut found = Vec::new();
        while let Some(triangle) = stack.pop() {
            if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
                found.push(triangle.corners());
            } else {
                stack.extend(triangle.split());
            }
        }
        found.sort();
        found
    }

    proptest! {
        #[test]
        fn the_walk_on_linear_indices_finds_the_leaves_of_the_bintree(
            (columns, rows, vertices) in activations(),
        ) {
            let active = active_set(columns, rows, 16, &vertices);
            for corner in active.layout().patches() {
                let mut walked = Vec::new();
                triangles(&active, [corner], |corners| walked.push(corners));
                for pair in walked.windows(2) {
                    prop_assert!(shares_edge(pair[0], pair[1]), "{:?}", pair);
                }
                walked.sort();
                prop_assert_eq!(walked, plain(&active, corner));
            }
        }

        #[test]
        fn a_patch_s_short_indices_name_its_leaves((columns, rows, vertices) in activations()) {
            let active = active_set(columns, rows, 16, &vertices);
            let block = VertexBlock::new(active.layout()).expect("small patches");
            for corner in active.layout().patches() {
                let (mut walked, mut list) = (Vec::new(), Vec::new());
                triangles(&active, [corner], |corners| walked.push(corners));
                block.append(&active, corner, |_| true, &mut list);
                let named: Vec<_> =
                    list.iter().map(|indices| indices.map(|index| block.vertex(corner, index))).collect();
                prop_assert_eq!(named, walked);
            }
        }
    }

    proptest! {
        #[test]
        fn holes_of_infinite_error_are_those_of_the_full_mesh_in_every_emitter(
            columns in 2u32..49, rows in 2u32..49, holes in proptest::collection::vec(0usize..2400, 0..5),
            tolerance_m in 0.0..10.0f32,
        ) {
            let layout = PatchLayout::new(columns, rows, 16).expect("sound");
            let lattice = lattice(columns, rows, &holes);
            let errors = ErrorMap::exact(&lattice, &layout);
            let active = rebuild(&layout, &Flat::new(&layout, &errors, tolerance_m), layout.patches());
            let expected = full_area_m2(&lattice, &layout);
            let mut strips = Strips::default();
            strips.add_patches(&active, layout.patches(), |_| true);
            let meshes = [
                mesh_of(&lattice, &layout, |place| triangles(&active, layout.patches(), place)),
                mesh_of(&lattice, &layout, |place| quadtree::triangles(&active, layout.patches(), place)),
                mesh_of(&lattice, &layout, |place| {
                    strips.iter().for_each(|strip| strips::unstrip(strip, &mut *place));
                }),
            ];
            for mesh in meshes {
                prop_assert_eq!(check::check_with_area(&mesh, expected).err(), None);
            }
        }
    }

    #[test]
    fn the_largest_block_is_the_last_that_sixteen_bits_hold() {
        let block = |patch| VertexBlock::new(&PatchLayout::new(300, 300, patch).expect("sound"));
        assert_eq!(block(128).map(VertexBlock::vertex_count), Some(129 * 129));
        assert_eq!(block(256), None);
    }

    #[test]
    fn the_deepest_patch_is_walked_to_its_posts() {
        let layout = PatchLayout::new(4097, 4097, 4096).expect("sound");
        let mut active = ActiveSet::new(layout);
        active.activate(Vertex::new(1, 0));
        active.activate(Vertex::new(4095, 4096));
        let mut finest = 0;
        triangles(&active, layout.patches(), |[a, b, c]| {
            finest += i32::from((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) == 1);
        });
        assert!(finest >= 4, "{finest} finest triangles");
    }
}
