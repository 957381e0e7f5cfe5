//! A piece of the terrain, read and measured by itself, whose inner patches are those of the whole.

use glam::DVec2;

use crate::block::BlockFault;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;
use sandtable_raster::windows::Windows;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::windowed::post_heights;

/// The whole terrain, without its heights.
#[derive(Clone, Copy, Debug)]
pub struct PagedFrame {
    /// Its patches.
    pub layout: PatchLayout,
    /// Map coordinates of its south-west post.
    pub origin: DVec2,
    /// Meters between posts, eastward and northward.
    pub cell: DVec2,
}

/// Patches of the terrain, from `first` to `last`, counted in patches east and north, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patches {
    /// South-west.
    pub first: (i32, i32),
    /// North-east.
    pub last: (i32, i32),
}

impl Patches {
    /// One patch, by its south-west corner.
    pub fn one(layout: &PatchLayout, corner: Vertex) -> Self {
        let at = (corner.x / layout.patch(), corner.y / layout.patch());
        Self { first: at, last: at }
    }

    /// These with all that their errors and spheres depend on.
    ///
    /// The first one's diagonal runs as that of the terrain's first patch, so that the region's vertices have the parents
    /// and children that they have in the terrain.
    fn with_surroundings(self, layout: &PatchLayout) -> Self {
        let (east, north) = layout.patch_grid();
        let mut first = ((self.first.0 - 1).max(0), (self.first.1 - 1).max(0));
        if (first.0 + first.1) % 2 != 0 {
            // An odd sum has an odd and therefore positive part.
            if first.0 > 0 { first.0 -= 1 } else { first.1 -= 1 }
        }
        let last = ((self.last.0 + 1).min(east as i32 - 1), (self.last.1 + 1).min(north as i32 - 1));
        Self { first, last }
    }
}

/// A piece of the terrain in memory.
#[derive(Clone, Debug)]
pub struct PagedRegion {
    lattice: Lattice,
    layout: PatchLayout,
    first: Vertex,
}

impl PagedRegion {
    /// Reads `patches` with all that their errors and spheres depend on.
    ///
    /// # Errors
    /// See [`BlockFault`].
    pub fn read(
        windows: &mut impl Windows,
        frame: &PagedFrame,
        patches: Patches,
    ) -> Result<Self, BlockFault> {
        let side = frame.layout.patch();
        let Patches { first, last } = patches.with_surroundings(&frame.layout);
        let first = Vertex::new(first.0 * side, first.1 * side);
        let end = frame.layout.post(Vertex::new((last.0 + 1) * side, (last.1 + 1) * side));
        let (columns, rows) = (end.column - first.x as u32 + 1, end.row - first.y as u32 + 1);
        let rect = PostRect { first: Post { column: first.x as u32, row: first.y as u32 }, last: end };
        let lattice = read_part(windows, (frame.origin, frame.cell), rect)?;
        let layout = PatchLayout::new(columns, rows, side as u32);
        Ok(Self { lattice, layout: layout.ok_or(BlockFault::TooMany { columns, rows })?, first })
    }

    /// The piece as a ground: vertices are counted from its own south-west, their positions are those of the whole terrain.
    pub fn ground(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    /// A vertex of the terrain as this region counts it.
    pub fn own(&self, vertex: Vertex) -> Vertex {
        vertex.moved(-self.first.x, -self.first.y)
    }
}

/// Reads the posts of a rectangle as a part of the lattice with this origin and cell.
///
/// # Errors
/// See [`BlockFault`].
pub fn read_part(
    windows: &mut impl Windows,
    frame: (DVec2, DVec2),
    posts: PostRect,
) -> Result<Lattice, BlockFault> {
    let heights = post_heights(windows, posts)?;
    Ok(Lattice::part(frame, posts.first, posts.width() as u32, heights)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_begins_at_an_even_patch_and_reaches_one_patch_round() {
        let layout = PatchLayout::new(10 * 16 + 1, 7 * 16 + 1, 16).expect("sound");
        for corner in layout.patches() {
            let patches = Patches::one(&layout, corner);
            let around = patches.with_surroundings(&layout);
            let (x, y) = patches.first;
            assert_eq!((around.first.0 + around.first.1) % 2, 0);
            assert!((around.first.0 == 0 || (x - 2..x).contains(&around.first.0)), "{corner:?} {around:?}");
            assert!((around.first.1 == 0 || (y - 2..y).contains(&around.first.1)), "{corner:?} {around:?}");
            assert!(around.first.0 >= 0 && around.first.1 >= 0);
            assert_eq!(around.last, ((x + 1).min(9), (y + 1).min(6)));
        }
    }
}
