//! Square patches laid over a lattice of any size.
//!
//! Patches of 2ⁿ cells a side start at the south-west post and reach past the lattice's east and north borders where its
//! size is no multiple of theirs. A vertex beyond a border is mapped to the nearest post on it. Each axis is mapped
//! monotonically, so triangles across the border shrink to its near side, those beyond it have no area and are not drawn,
//! and the mesh stays conforming without additional vertices.

use crate::graph::Vertex;
use sandtable_terrain::lattice::Post;

/// The layout of patches over a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchLayout {
    patch: i32,
    patches_east: i32,
    patches_north: i32,
    columns: i32,
    rows: i32,
    last_column: i32,
    last_row: i32,
}

/// Neighboring patches, and the vertices that belong to just these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchSpan {
    /// The south-western one, counted in patches east and north.
    pub first: (i32, i32),
    /// The north-eastern one.
    pub last: (i32, i32),
    /// The south-western of the vertices.
    min: Vertex,
    /// The north-eastern of them.
    max: Vertex,
}

impl PatchSpan {
    /// Whether a vertex belongs to just these patches.
    #[inline]
    pub fn holds(&self, vertex: Vertex) -> bool {
        // Without jumps: among the vertices of a patch those on its border come as a surprise.
        (vertex.x >= self.min.x)
            & (vertex.x <= self.max.x)
            & (vertex.y >= self.min.y)
            & (vertex.y <= self.max.y)
    }
}

/// The default number of cells along a patch's side: 65² vertices keep an index list within 16 bits, and culling a patch
/// saves up to 8,192 triangles.
pub const DEFAULT_PATCH: u32 = 64;

/// The most vertices of a layout. Posts are limited where rasters are read, but patches over a lattice of two rows have up
/// to 2048 vertices per post: indices would exceed a u32, and errors the memory.
pub const MOST_VERTICES: u64 = 1 << 29;

/// The most patches of a layout whose vertices are never in memory together: 65,536 posts a side in patches of 64. The
/// summaries of a million patches take tens of megabytes.
pub const MOST_PATCHES: u64 = 1 << 20;

impl PatchLayout {
    /// Patches of `patch` cells a side, a power of two from 2 to 4096, over a lattice of `columns` × `rows` posts, at least
    /// 2 × 2 and at most 2²⁸ either way, with at most [`MOST_VERTICES`] vertices. `None` otherwise.
    pub fn new(columns: u32, rows: u32, patch: u32) -> Option<Self> {
        let layout = Self::over(columns, rows, patch)?;
        (layout.columns() as u64 * layout.rows() as u64 <= MOST_VERTICES).then_some(layout)
    }

    /// As [`PatchLayout::new`], for patches that are read one at a time: at most [`MOST_PATCHES`] of them, with any number
    /// of vertices.
    pub fn paged(columns: u32, rows: u32, patch: u32) -> Option<Self> {
        let layout = Self::over(columns, rows, patch)?;
        (layout.patches_east as u64 * layout.patches_north as u64 <= MOST_PATCHES).then_some(layout)
    }

    fn over(columns: u32, rows: u32, patch: u32) -> Option<Self> {
        let sizes = 2..=1 << 28;
        if !patch.is_power_of_two()
            || !(2..=4096).contains(&patch)
            || !sizes.contains(&columns)
            || !sizes.contains(&rows)
        {
            return None;
        }
        let vertices = |posts: u32| (posts - 1).div_ceil(patch) * patch + 1;
        Some(Self {
            columns: vertices(columns) as i32,
            rows: vertices(rows) as i32,
            patch: patch as i32,
            patches_east: (columns - 1).div_ceil(patch) as i32,
            patches_north: (rows - 1).div_ceil(patch) as i32,
            last_column: columns as i32 - 1,
            last_row: rows as i32 - 1,
        })
    }

    /// Cells along a patch's side.
    #[inline]
    pub fn patch(&self) -> i32 {
        self.patch
    }

    /// The south-west corners of all patches, row by row.
    pub fn patches(&self) -> impl Iterator<Item = Vertex> + use<> {
        self.patches_within((0, 0), (i32::MAX, i32::MAX))
    }

    /// The south-west corners of the patches from `first` to `last`, counted in patches east and north, ends included;
    /// those beyond the borders are left out.
    pub fn patches_within(
        &self,
        first: (i32, i32),
        last: (i32, i32),
    ) -> impl Iterator<Item = Vertex> + use<> {
        let east = first.0.max(0)..=last.0.min(self.patches_east - 1);
        let (patch, north) = (self.patch, first.1.max(0)..=last.1.min(self.patches_north - 1));
        north.flat_map(move |y| east.clone().map(move |x| Vertex::new(x * patch, y * patch)))
    }

    /// The south-west corners of the patches that share a vertex with the rectangle `min`..=`max` of vertices.
    pub fn patches_meeting(&self, min: Vertex, max: Vertex) -> impl Iterator<Item = Vertex> + use<> {
        let before = |at: i32| (at - 1).max(0) / self.patch;
        self.patches_within((before(min.x), before(min.y)), (max.x / self.patch, max.y / self.patch))
    }

    /// The patches that a vertex of the layout belongs to: one, unless it lies on a border between patches.
    pub fn patches_at(&self, vertex: Vertex) -> PatchSpan {
        let [x, y] = [(vertex.x, self.patches_east), (vertex.y, self.patches_north)].map(|(at, count)| {
            let (first, last) = ((at - 1).max(0) / self.patch, (at / self.patch).min(count - 1));
            if first < last {
                return [(first, at), (last, at)];
            }
            let west = first * self.patch + i32::from(first > 0);
            [(first, west), (last, (last + 1) * self.patch - i32::from(last < count - 1))]
        });
        let [[(west, min_x), (east, max_x)], [(south, min_y), (north, max_y)]] = [x, y];
        PatchSpan {
            first: (west, south),
            last: (east, north),
            min: Vertex::new(min_x, min_y),
            max: Vertex::new(max_x, max_y),
        }
    }

    /// Vertices of the layout in runs that belong to the same patches.
    pub fn runs<'a>(&self, mut vertices: &'a [Vertex]) -> impl Iterator<Item = (PatchSpan, &'a [Vertex])> {
        std::iter::from_fn(move || {
            let span = self.patches_at(*vertices.first()?);
            let count = vertices.iter().position(|&vertex| !span.holds(vertex)).unwrap_or(vertices.len());
            let (run, rest) = vertices.split_at(count);
            vertices = rest;
            Some((span, run))
        })
    }

    /// The place of the patch with south-west corner `corner` in [`PatchLayout::patches`].
    #[inline]
    pub fn patch_index(&self, corner: Vertex) -> usize {
        let shift = self.patch.trailing_zeros();
        ((corner.y >> shift) * self.patches_east + (corner.x >> shift)) as usize
    }

    /// The place in [`PatchLayout::patches`] of the patch of the triangle that `vertex` splits and whose right-angled
    /// corner is `apex`, one of its parents; both are vertices of the layout.
    #[inline]
    pub fn patch_holding(&self, vertex: Vertex, apex: Vertex) -> usize {
        // The point halfway between them lies inside that patch, whatever borders the two are on.
        self.patch_index(Vertex::new((vertex.x + apex.x) >> 1, (vertex.y + apex.y) >> 1))
    }

    /// Patches eastward and northward.
    pub fn patch_grid(&self) -> (usize, usize) {
        (self.patches_east as usize, self.patches_north as usize)
    }

    /// The number of patches.
    pub fn patch_count(&self) -> usize {
        self.patches_east as usize * self.patches_north as usize
    }

    /// Vertices per row.
    #[inline]
    pub fn columns(&self) -> usize {
        self.columns as usize
    }

    /// Rows of vertices.
    #[inline]
    pub fn rows(&self) -> usize {
        self.rows as usize
    }

    /// The number of vertices.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.columns() * self.rows()
    }

    /// Whether the vertex belongs to a patch.
    #[inline]
    pub fn contains(&self, vertex: Vertex) -> bool {
        (vertex.x as usize) < self.columns() && (vertex.y as usize) < self.rows()
    }

    /// The index of a vertex of the layout, row by row.
    #[inline]
    pub fn index(&self, vertex: Vertex) -> usize {
        debug_assert!(self.contains(vertex), "{vertex:?} is outside {self:?}");
        vertex.y as usize * self.columns() + vertex.x as usize
    }

    /// The vertex with an index.
    #[inline]
    pub fn vertex(&self, index: usize) -> Vertex {
        Vertex::new((index % self.columns()) as i32, (index / self.columns()) as i32)
    }

    /// All vertices by their indices.
    pub fn vertices(&self) -> impl Iterator<Item = Vertex> {
        (0..self.vertex_count()).map(|index| self.vertex(index))
    }

    /// The parents of a vertex that belong to the layout: the right-angled corners of the triangles that it splits.
    #[inline]
    pub fn parents(&self, vertex: Vertex) -> impl Iterator<Item = Vertex> {
        vertex.parents().into_iter().filter(|&parent| self.contains(parent))
    }

    /// The children of a vertex that belong to the layout.
    #[inline]
    pub fn children(&self, vertex: Vertex) -> impl Iterator<Item = Vertex> {
        vertex.children().filter(|&child| self.contains(child))
    }

    /// Every vertex that is no patch corner, with each of its children.
    pub fn descents(&self) -> impl Iterator<Item = (Vertex, Vertex)> {
        let inner = self.vertices().filter(|&vertex| !self.is_corner(vertex));
        inner.flat_map(|vertex| self.children(vertex).map(move |child| (vertex, child)))
    }

    /// Whether the vertex is a corner of patches, which is always active.
    #[inline]
    pub fn is_corner(&self, vertex: Vertex) -> bool {
        (vertex.x | vertex.y) & (self.patch - 1) == 0
    }

    /// The number of posts of the lattice.
    pub fn posts(&self) -> u64 {
        (self.last_column as u64 + 1) * (self.last_row as u64 + 1)
    }

    /// The post of a vertex: its own, or the nearest on the border.
    #[inline]
    pub fn post(&self, vertex: Vertex) -> Post {
        Post { column: vertex.x.min(self.last_column) as u32, row: vertex.y.min(self.last_row) as u32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_cover_the_lattice_and_no_row_more() {
        let layout = PatchLayout::new(65, 66, 64).expect("sound");
        assert_eq!((layout.columns(), layout.rows(), layout.patch_count()), (65, 129, 2));
        assert_eq!(layout.post(Vertex::new(10, 100)), Post { column: 10, row: 65 });
    }

    #[test]
    fn the_patches_at_a_vertex_are_those_that_meet_it() {
        let layout = PatchLayout::new(40, 21, 8).expect("sound");
        for vertex in layout.vertices() {
            let span = layout.patches_at(vertex);
            let meeting = layout.patches_meeting(vertex, vertex);
            assert!(meeting.eq(layout.patches_within(span.first, span.last)), "{vertex:?}: {span:?}");
            let same = layout.vertices().filter(|&other| layout.patches_at(other) == span);
            assert!(same.eq(layout.vertices().filter(|&other| span.holds(other))), "{vertex:?}: {span:?}");
        }
    }

    #[test]
    fn runs_are_as_long_as_the_patches_are_the_same() {
        let layout = PatchLayout::new(40, 21, 8).expect("sound");
        let vertices: Vec<Vertex> = layout.vertices().collect();
        let runs: Vec<_> = layout.runs(&vertices).collect();
        assert!(runs.iter().flat_map(|(_, run)| run.iter()).eq(&vertices));
        assert!(runs.iter().all(|(span, run)| run.iter().all(|&vertex| layout.patches_at(vertex) == *span)));
        assert!(runs.windows(2).all(|pair| pair[0].0 != pair[1].0));
    }

    #[test]
    fn sizes_that_make_no_patches_are_refused() {
        assert_eq!(PatchLayout::new(65, 65, 48), None);
        assert_eq!(PatchLayout::new(1, 65, 64), None);
        assert_eq!(PatchLayout::new(2, 1 << 28, 64), None);
        assert!(PatchLayout::new(16_384, 16_384, 64).is_some());
        assert!(
            PatchLayout::new(65_537, 65_537, 64).is_none()
                && PatchLayout::paged(65_537, 65_537, 64).is_some()
        );
        assert_eq!(PatchLayout::paged(65_538, 65_537, 64), None);
    }
}
