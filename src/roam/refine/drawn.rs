//! The bintree triangles that a ground draws, for budgets of drawn triangles.
//!
//! A triangle beyond the border has no area, and one with a corner without data is left out, so a split can add −1 to 2
//! drawn triangles in place of each that it halves. Whole patches, within the borders and with data everywhere, are known
//! in advance: all their triangles are drawn, and nothing is looked up.

use std::ops::{Add, Sub};

use crate::bintree::Triangle;
use crate::emit::world::drawn_posts;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;
use crate::refine::listed::ListedPatches;

/// Numbers of triangles: drawn ones, and all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Count {
    pub(super) drawn: i64,
    pub(super) leaves: i64,
}

impl Add for Count {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { drawn: self.drawn + other.drawn, leaves: self.leaves + other.leaves }
    }
}

impl Sub for Count {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { drawn: self.drawn - other.drawn, leaves: self.leaves - other.leaves }
    }
}

/// What a ground draws.
#[derive(Clone, Debug)]
pub(super) struct Drawn<'a> {
    ground: PatchedGround<'a>,
    whole: Vec<bool>,
    /// Per vertex the bits of those of its triangles, [`Vertex::side_bit`], in which anything can be drawn.
    shows: Vec<u8>,
}

impl<'a> Drawn<'a> {
    /// Reads every post once, and every triangle of patches with holes or across the border.
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

    fn layout(&self) -> &'a PatchLayout {
        self.ground.layout
    }

    /// Whether anything can be drawn in a triangle of a listed patch that `vertex` splits; `vertex` splits at least one.
    #[inline]
    pub(super) fn shows(&self, listed: &ListedPatches, vertex: Vertex) -> bool {
        let (layout, sides) = (self.layout(), self.shows[self.layout().index(vertex)]);
        sides == BOTH || listed.apexes(layout, vertex).any(|apex| sides & vertex.side_bit(apex) != 0)
    }

    /// Counts a leaf of the patch with south-west corner `corner`.
    pub(super) fn leaf(&self, corner: Vertex, leaf: &Triangle) -> Count {
        let is_drawn = self.whole[self.layout().patch_index(corner)] || self.is_drawn(leaf.corners());
        Count { drawn: i64::from(is_drawn), leaves: 1 }
    }

    /// The triangles that activating `vertex` adds in listed patches.
    pub(super) fn added(&self, listed: &ListedPatches, vertex: Vertex) -> Count {
        let layout = self.layout();
        let added = |apex: Vertex| {
            let is_whole = self.whole[layout.patch_holding(vertex, apex)];
            Count { drawn: if is_whole { 1 } else { self.added_at(vertex, apex) }, leaves: 1 }
        };
        listed.apexes(layout, vertex).map(added).fold(Count::default(), Count::add)
    }

    /// The drawn triangles that halving the one with right-angled corner `apex` adds.
    fn added_at(&self, vertex: Vertex, apex: Vertex) -> i64 {
        let [from, to] = vertex.hypotenuse();
        let drawn = |corners| i64::from(self.is_drawn(corners));
        drawn([vertex, apex, from]) + drawn([vertex, to, apex]) - drawn([apex, from, to])
    }

    fn is_drawn(&self, corners: [Vertex; 3]) -> bool {
        drawn_posts(self.ground, corners).is_some()
    }

    /// Marks the vertices below a triangle; returns whether anything can be drawn in it.
    fn mark(&mut self, triangle: &Triangle) -> bool {
        let mut shows = self.is_drawn(triangle.corners());
        if !triangle.is_finest() {
            for half in triangle.split() {
                shows |= self.mark(&half);
            }
            if shows {
                self.set(triangle.split_vertex(), triangle.apex);
            }
        }
        shows
    }

    /// Marks every triangle of a whole patch.
    fn mark_all(&mut self, corner: Vertex) {
        let far = corner.moved(self.layout().patch(), self.layout().patch());
        let within = |at: &Vertex| (corner.x..=far.x).contains(&at.x) && (corner.y..=far.y).contains(&at.y);
        for vertex in (corner.y..=far.y).flat_map(|y| (corner.x..=far.x).map(move |x| Vertex::new(x, y))) {
            for apex in vertex.parents().into_iter().filter(within) {
                self.set(vertex, apex);
            }
        }
    }

    fn set(&mut self, vertex: Vertex, apex: Vertex) {
        self.shows[self.ground.layout.index(vertex)] |= vertex.side_bit(apex);
    }
}

const BOTH: u8 = 0b11;
