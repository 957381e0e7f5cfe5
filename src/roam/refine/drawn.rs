//! Which bintree triangles a ground draws, for counting what shows instead of what is there.
//!
//! A triangle beyond the border has no area, and one with a corner over no data is left out, so that a split can add
//! any number of drawn triangles from −1 to 2 in place of each that it halves. Patches that lie within the borders
//! and have data everywhere are known beforehand: there every triangle is drawn and nothing is looked up.

use crate::roam::bintree::Triangle;
use crate::roam::emit::world::drawn_posts;
use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::patched_ground::PatchedGround;
use crate::roam::refine::listed::ListedPatches;

/// Triangles: those that are drawn, and all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Count {
    pub(super) drawn: i64,
    pub(super) leaves: i64,
}

impl Count {
    pub(super) fn plus(self, other: Self) -> Self {
        Self { drawn: self.drawn + other.drawn, leaves: self.leaves + other.leaves }
    }

    pub(super) fn minus(self, other: Self) -> Self {
        Self { drawn: self.drawn - other.drawn, leaves: self.leaves - other.leaves }
    }
}

/// What a ground draws.
#[derive(Clone, Debug)]
pub(super) struct Drawn<'a> {
    ground: PatchedGround<'a>,
    whole: Vec<bool>,
    /// Per vertex a bit for each of the triangles that it splits: whether there is anything to draw in it.
    shows: Vec<u8>,
}

impl<'a> Drawn<'a> {
    /// Looks at every post once, and at every triangle of patches with holes or across the border.
    pub(super) fn new(ground: PatchedGround<'a>) -> Self {
        let layout = ground.layout;
        let whole = layout.patches().map(|corner| ground.is_whole(corner)).collect();
        let mut drawn = Self { ground, whole, shows: vec![0; layout.vertex_count()] };
        for corner in layout.patches() {
            if drawn.whole[layout.patch_index(corner)] {
                drawn.mark_all(corner);
            } else {
                for root in Triangle::roots(corner, layout.patch()) {
                    drawn.mark(&root);
                }
            }
        }
        drawn
    }

    pub(super) fn layout(&self) -> &'a PatchLayout {
        self.ground.layout
    }

    /// Whether a triangle of a listed patch that `vertex` splits is drawn, or anything that it can be split into;
    /// `vertex` splits one at least.
    #[inline]
    pub(super) fn shows(&self, listed: &ListedPatches, vertex: Vertex) -> bool {
        let (layout, sides) = (self.layout(), self.shows[self.layout().index(vertex)]);
        let is_listed = |apex| layout.contains(apex) && listed.holds(layout.patch_holding(vertex, apex));
        let shows = |apex| sides & side(vertex, apex) != 0 && is_listed(apex);
        sides == BOTH || vertex.parents().into_iter().any(shows)
    }

    /// A leaf of the patch with south-west corner `corner`.
    pub(super) fn leaf(&self, corner: Vertex, leaf: &Triangle) -> Count {
        let is_drawn = self.whole[self.layout().patch_index(corner)] || self.is_drawn(leaf.corners());
        Count { drawn: i64::from(is_drawn), leaves: 1 }
    }

    /// How many triangles more the listed patches have once `vertex` is active.
    pub(super) fn added(&self, listed: &ListedPatches, vertex: Vertex) -> Count {
        let layout = self.layout();
        let mut added = Count::default();
        for apex in vertex.parents().into_iter().filter(|&apex| layout.contains(apex)) {
            let patch = layout.patch_holding(vertex, apex);
            if listed.holds(patch) {
                let drawn = if self.whole[patch] { 1 } else { self.added_at(vertex, apex) };
                added = added.plus(Count { drawn, leaves: 1 });
            }
        }
        added
    }

    /// How many more triangles are drawn once the one with right-angled corner `apex` is halved.
    fn added_at(&self, vertex: Vertex, apex: Vertex) -> i64 {
        let [from, to] = vertex.hypotenuse();
        let drawn = |corners| i64::from(self.is_drawn(corners));
        drawn([vertex, apex, from]) + drawn([vertex, to, apex]) - drawn([apex, from, to])
    }

    fn is_drawn(&self, corners: [Vertex; 3]) -> bool {
        drawn_posts(self.ground, corners).is_some()
    }

    /// Marks what shows in a triangle; says whether anything does. Recursion is as deep as the graph has levels.
    fn mark(&mut self, triangle: &Triangle) -> bool {
        let mut shows = self.is_drawn(triangle.corners());
        if !triangle.is_finest() {
            for half in triangle.split() {
                shows |= self.mark(&half);
            }
            if shows {
                let vertex = triangle.split_vertex();
                self.set(vertex, side(vertex, triangle.apex));
            }
        }
        shows
    }

    /// Marks every triangle of a patch where all are drawn.
    fn mark_all(&mut self, corner: Vertex) {
        let far = corner.moved(self.layout().patch(), self.layout().patch());
        let within = |at: &Vertex| (corner.x..=far.x).contains(&at.x) && (corner.y..=far.y).contains(&at.y);
        for vertex in (corner.y..=far.y).flat_map(|y| (corner.x..=far.x).map(move |x| Vertex::new(x, y))) {
            for apex in vertex.parents().into_iter().filter(within) {
                self.set(vertex, side(vertex, apex));
            }
        }
    }

    fn set(&mut self, vertex: Vertex, side: u8) {
        let index = self.layout().index(vertex);
        self.shows[index] |= side;
    }
}

const BOTH: u8 = 0b11;

/// The bit of the triangle that `vertex` splits and whose right-angled corner is `apex`.
#[inline]
fn side(vertex: Vertex, apex: Vertex) -> u8 {
    if (apex.y, apex.x) < (vertex.y, vertex.x) { 1 } else { 2 }
}
