//! The ground that refinement reads: every vertex with its position in world space.

use glam::{Vec2, Vec3};

use crate::graph::Vertex;
use crate::layout::PatchLayout;
use sandtable_terrain::lattice::{Lattice, Post};

/// A displayed lattice and the patches over it.
#[derive(Clone, Copy, Debug)]
pub struct PatchedGround<'a> {
    /// The heights, as they are displayed.
    pub lattice: &'a Lattice,
    /// The patches over them.
    pub layout: &'a PatchLayout,
}

impl PatchedGround<'_> {
    /// World X and Y of a vertex of the layout, meters.
    #[inline]
    pub fn plan(&self, vertex: Vertex) -> Vec2 {
        self.lattice.position(self.layout.post(vertex))
    }

    /// The world position of a vertex of the layout, meters; Z 0 where it has no data.
    #[inline]
    pub fn position(&self, vertex: Vertex) -> Vec3 {
        let height = self.lattice.height(self.layout.post(vertex));
        self.plan(vertex).extend(if height.is_nan() { 0.0 } else { height })
    }

    /// Whether the patch with south-west corner `corner` lies within the borders and has data at every post, so that all
    /// its triangles are drawn.
    pub fn is_whole(&self, corner: Vertex) -> bool {
        let (lattice, side) = (self.lattice, self.layout.patch());
        let far = corner.moved(side, side);
        let within = far.x < lattice.columns() as i32 && far.y < lattice.rows() as i32;
        let row = |y: i32| {
            let start = lattice.index(Post { column: corner.x as u32, row: y as u32 });
            &lattice.heights()[start..=start + side as usize]
        };
        within && (corner.y..=far.y).all(|y| row(y).iter().all(|height| !height.is_nan()))
    }

    /// The corners in the layout of the two triangles that `vertex` splits; of one of them on the border of the terrain.
    pub fn diamond_corners(&self, vertex: Vertex) -> impl Iterator<Item = Vertex> {
        vertex.hypotenuse().into_iter().chain(self.layout.parents(vertex))
    }

    /// The south-west and north-east corner, in meters, of the rectangle around [`PatchedGround::diamond_corners`].
    pub fn diamond(&self, vertex: Vertex) -> (Vec2, Vec2) {
        self.diamond_corners(vertex)
            .map(|corner| self.plan(corner))
            .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(min, max), at| (min.min(at), max.max(at)))
    }
}
