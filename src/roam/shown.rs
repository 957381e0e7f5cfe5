//! The triangles of one frame: for each patch an index list of 16 bits into its own block of vertices.
//!
//! Index lists are what a graphics adapter receives, so methods of refining and emitting are compared by them: their
//! triangles, what changed since the frame before, and what was sent.

use std::sync::Arc;

use crate::active::ActiveSet;
use crate::emit::bintree::VertexBlock;
use crate::emit::world::drawn_posts;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;

/// Three vertices of a patch, counter-clockwise seen from above; vertices count row by row from the south-west.
pub type LocalTriangle = [u16; 3];

/// The triangles shown in one patch.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchList {
    /// The patch's south-west corner.
    pub corner: Vertex,
    /// Its triangles; shared with the frame before where nothing changed.
    pub triangles: Arc<Vec<LocalTriangle>>,
    /// The number of indices that encode them: three a triangle in a list, fewer in strips.
    pub indices: usize,
}

impl PatchList {
    /// The list with three indices a triangle.
    pub fn of_triangles(corner: Vertex, triangles: Arc<Vec<LocalTriangle>>) -> Self {
        let indices = 3 * triangles.len();
        Self { corner, triangles, indices }
    }

    /// The list of triangles of vertices of the patch with south-west corner `corner`.
    ///
    /// # Panics
    /// Where patches are larger than 128 cells, since their vertices have no 16-bit index.
    pub fn of_vertices(
        layout: &PatchLayout,
        corner: Vertex,
        triangles: impl IntoIterator<Item = [Vertex; 3]>,
    ) -> Self {
        let local = |corners: [Vertex; 3]| corners.map(|vertex| local(layout, corner, vertex));
        Self::of_triangles(corner, Arc::new(triangles.into_iter().map(local).collect()))
    }

    /// The bintree's leaves in the patch with south-west corner `corner`, without those beyond the border or over no data.
    ///
    /// # Panics
    /// Where patches are larger than 128 cells, since their vertices have no 16-bit index.
    pub fn bintree(ground: PatchedGround<'_>, active: &ActiveSet, corner: Vertex) -> Self {
        let block = block(ground.layout);
        let is_drawn = |triangle: LocalTriangle| {
            drawn_posts(ground, triangle.map(|index| block.vertex(corner, index))).is_some()
        };
        let mut triangles = Vec::new();
        block.append(active, corner, is_drawn, &mut triangles);
        Self::of_triangles(corner, Arc::new(triangles))
    }

    /// The vertex with index `index` in this patch.
    pub fn vertex(&self, layout: &PatchLayout, index: u16) -> Vertex {
        block(layout).vertex(self.corner, index)
    }

    /// Bytes of the index list.
    pub fn bytes(&self) -> usize {
        2 * self.indices
    }
}

/// The index of `vertex` in the patch with south-west corner `corner`, which holds it.
///
/// # Panics
/// Where patches are larger than 128 cells.
pub fn local(layout: &PatchLayout, corner: Vertex, vertex: Vertex) -> u16 {
    block(layout).index(corner, vertex)
}

fn block(layout: &PatchLayout) -> VertexBlock {
    VertexBlock::new(layout).expect("patches of at most 128 cells have 16-bit indices")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::displayed::DisplayedTerrain;
    use glam::{DVec2, Vec2, Vec3};
    use sandtable_terrain::lattice::Lattice;
    use sandtable_terrain::triangle_surface::TriangleSurface;
    use std::collections::BTreeSet;

    fn plan_key(corners: [Vec2; 3]) -> [[i64; 2]; 3] {
        let mut key = corners.map(|corner| [corner.x as i64, corner.y as i64]);
        key.sort();
        key
    }

    #[test]
    fn the_lists_of_all_patches_are_the_triangles_that_are_displayed() {
        let (columns, rows) = (45u32, 37u32);
        let mut heights: Vec<f32> =
            (0..columns * rows).map(|at| libm::sinf(at as f32 * 0.31) * 9.0).collect();
        heights[20 * 45 + 20] = f32::NAN;
        let lattice =
            Arc::new(Lattice::new(DVec2::ZERO, DVec2::splat(4.0), columns, heights).expect("sound"));
        let layout = PatchLayout::new(columns, rows, 16).expect("sound");
        let mut active = ActiveSet::new(layout);
        for (x, y) in [(3, 5), (20, 19), (33, 30), (16, 9), (41, 36)] {
            active.activate(Vertex::new(x, y));
        }
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let mut listed = BTreeSet::new();
        for corner in layout.patches() {
            let list = PatchList::bintree(ground, &active, corner);
            assert_eq!(list.bytes(), 6 * list.triangles.len());
            for triangle in list.triangles.iter() {
                let corners = triangle.map(|index| ground.plan(list.vertex(&layout, index)));
                assert!(listed.insert(plan_key(corners)), "{corners:?} twice");
            }
        }
        let mut displayed = BTreeSet::new();
        let extent = lattice.extent();
        DisplayedTerrain::new(Arc::clone(&lattice), active, layout.patches().collect()).visit_facets(
            &extent,
            &mut |facet| {
                displayed.insert(plan_key(facet.map(Vec3::truncate)));
            },
        );
        assert_eq!(listed, displayed);
    }
}
