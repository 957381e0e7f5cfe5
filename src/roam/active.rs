//! The state of a mesh: one bit per vertex.

use crate::graph::Vertex;
use crate::layout::PatchLayout;

/// The active vertices. Patch corners are always active and have no bit.
///
/// Every operation keeps the bits closed under parents, so that all triangles made from them are conforming.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActiveSet {
    layout: PatchLayout,
    bits: Vec<u64>,
}

impl ActiveSet {
    /// The patch corners alone.
    pub fn new(layout: PatchLayout) -> Self {
        Self { layout, bits: vec![0; layout.vertex_count().div_ceil(64)] }
    }

    /// The layout of the vertices.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Whether a vertex of the layout is active.
    #[inline]
    pub fn is_active(&self, vertex: Vertex) -> bool {
        self.layout.is_corner(vertex) || self.bit(self.layout.index(vertex))
    }

    /// Whether the vertex at `index` is active; `false` for patch corners.
    #[inline]
    pub fn bit(&self, index: usize) -> bool {
        self.bits[index / 64] >> (index % 64) & 1 == 1
    }

    /// The vertices that are active in one of two sets of a layout, or in both.
    pub fn joined(mut self, other: Self) -> Self {
        assert_eq!(self.layout, other.layout, "sets of one layout");
        self.bits.iter_mut().zip(other.bits).for_each(|(own, other)| *own |= other);
        self
    }

    /// Activates a vertex and first its inactive parents, up to the roots: the forced split.
    #[inline]
    pub fn activate(&mut self, vertex: Vertex) {
        self.activate_each(vertex, &mut |_| ());
    }

    /// [`ActiveSet::activate`] with a call of `each` for every vertex that becomes active, parents before children. The
    /// recursion is at most 25 deep, the number of levels.
    #[inline]
    pub fn activate_each(&mut self, vertex: Vertex, each: &mut impl FnMut(Vertex)) {
        if self.layout.contains(vertex) && !self.is_active(vertex) {
            self.force(vertex, each);
        }
    }

    fn force(&mut self, vertex: Vertex, each: &mut impl FnMut(Vertex)) {
        for parent in vertex.parents() {
            self.activate_each(parent, each);
        }
        let index = self.layout.index(vertex);
        self.bits[index / 64] |= 1 << (index % 64);
        each(vertex);
    }

    /// Deactivates a vertex and first its active children, down to the finest: the forced merge. Patch corners stay.
    pub fn deactivate(&mut self, vertex: Vertex) {
        self.deactivate_each(vertex, &mut |_| ());
    }

    /// [`ActiveSet::deactivate`] with a call of `each` for every vertex that becomes inactive, children before parents.
    pub fn deactivate_each(&mut self, vertex: Vertex, each: &mut impl FnMut(Vertex)) {
        if !self.layout.contains(vertex) || self.layout.is_corner(vertex) || !self.is_active(vertex) {
            return;
        }
        for child in vertex.children() {
            self.deactivate_each(child, each);
        }
        self.clear(vertex);
        each(vertex);
    }

    /// Deactivates a vertex if it is mergeable; returns whether it was.
    pub fn merge(&mut self, vertex: Vertex) -> bool {
        let is_mergeable = self.is_mergeable(vertex);
        if is_mergeable {
            self.clear(vertex);
        }
        is_mergeable
    }

    /// Whether the vertex is in the layout, active, no patch corner, and has no active child.
    pub fn is_mergeable(&self, vertex: Vertex) -> bool {
        self.layout.contains(vertex)
            && self.bit(self.layout.index(vertex))
            && !self.layout.children(vertex).any(|child| self.is_active(child))
    }

    /// The number of active vertices, without patch corners.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Checks that every active vertex has its parents active.
    ///
    /// # Panics
    /// Where one has not.
    pub fn check(&self) {
        for vertex in self.layout.vertices().filter(|&vertex| self.is_active(vertex)) {
            let missing = self.layout.parents(vertex).find(|&parent| !self.is_active(parent));
            assert!(
                self.layout.is_corner(vertex) || missing.is_none(),
                "{vertex:?} is active, its parent {missing:?} is not"
            );
        }
    }

    fn clear(&mut self, vertex: Vertex) {
        let index = self.layout.index(vertex);
        self.bits[index / 64] &= !(1 << (index % 64));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_activations_leave_parents_active(
            vertices in proptest::collection::vec((0..65i32, 0..49i32), 0..40),
        ) {
            let mut active = ActiveSet::new(PatchLayout::new(60, 40, 16).expect("sound"));
            for (x, y) in vertices {
                active.activate(Vertex::new(x, y));
                prop_assert!(!active.layout().contains(Vertex::new(x, y)) || active.is_active(Vertex::new(x, y)));
            }
            active.check();
        }

        #[test]
        fn a_forced_merge_takes_back_a_forced_split_and_nothing_else(
            vertices in proptest::collection::vec((0..65i32, 0..49i32), 0..40),
            x in 0..65i32, y in 0..49i32,
        ) {
            let mut before = ActiveSet::new(PatchLayout::new(60, 40, 16).expect("sound"));
            for (x, y) in vertices {
                before.activate(Vertex::new(x, y));
            }
            let mut active = before.clone();
            let mut split = Vec::new();
            active.activate_each(Vertex::new(x, y), &mut |vertex| split.push(vertex));
            if let Some(&first) = split.first() {
                prop_assert_eq!(active.count(), before.count() + split.len());
                let mut merged = Vec::new();
                for &vertex in split.iter().rev() {
                    active.deactivate_each(vertex, &mut |vertex| merged.push(vertex));
                }
                merged.reverse();
                prop_assert_eq!(merged, split);
                prop_assert!(!active.is_active(first));
            }
            prop_assert_eq!(&active, &before);
        }

        #[test]
        fn any_forced_merge_leaves_parents_active(
            vertices in proptest::collection::vec((0..65i32, 0..49i32), 0..40),
            gone in proptest::collection::vec((-2..67i32, -2..51i32), 0..10),
        ) {
            let mut active = ActiveSet::new(PatchLayout::new(60, 40, 16).expect("sound"));
            vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
            for (x, y) in gone {
                active.deactivate(Vertex::new(x, y));
                active.check();
                let inside = active.layout().contains(Vertex::new(x, y));
                let corner = active.layout().is_corner(Vertex::new(x, y));
                prop_assert!(!inside || corner || !active.is_active(Vertex::new(x, y)));
            }
        }
    }
}
