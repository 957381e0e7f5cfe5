//! The state of a mesh: one bit per vertex.

use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;

/// Which vertices are active. Patch corners always are.
///
/// Every operation keeps the bits closed under parents, so that whatever is emitted from them is conforming.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActiveSet {
    layout: PatchLayout,
    bits: Vec<u64>,
}

impl ActiveSet {
    /// No vertex but the patch corners.
    pub fn new(layout: PatchLayout) -> Self {
        Self { layout, bits: vec![0; layout.vertex_count().div_ceil(64)] }
    }

    /// The layout whose vertices it holds.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Whether a vertex of the layout is active.
    #[inline]
    pub fn is_active(&self, vertex: Vertex) -> bool {
        self.layout.is_corner(vertex) || self.bit(self.layout.index(vertex))
    }

    /// Activates a vertex and first its inactive parents, up to the roots: the forced split.
    #[inline]
    pub fn activate(&mut self, vertex: Vertex) {
        self.activate_each(vertex, &mut |_| ());
    }

    /// The forced split as [`ActiveSet::activate`] does it; `each` is told every vertex that becomes active,
    /// parents before their children. Recursion is as deep as the graph has levels, 25 at most.
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

    /// Deactivates a vertex and first its active children, down to the finest: the forced merge. Patch corners
    /// stay.
    pub fn deactivate(&mut self, vertex: Vertex) {
        self.deactivate_each(vertex, &mut |_| ());
    }

    /// The forced merge as [`ActiveSet::deactivate`] does it; `each` is told every vertex that becomes inactive,
    /// children before their parents.
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

    /// Deactivates a vertex that can go without any other going; says whether it did. It did not where the
    /// vertex is a patch corner, not active, or has an active child.
    pub fn merge(&mut self, vertex: Vertex) -> bool {
        let goes = self.is_mergeable(vertex);
        if goes {
            self.clear(vertex);
        }
        goes
    }

    /// Whether the vertex is in the layout, active, no patch corner, and has no active child.
    pub fn is_mergeable(&self, vertex: Vertex) -> bool {
        self.layout.contains(vertex)
            && self.bit(self.layout.index(vertex))
            && !vertex.children().any(|child| self.layout.contains(child) && self.is_active(child))
    }

    /// How many vertices are active, not counting patch corners.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether every active vertex has its parents active.
    ///
    /// # Errors
    /// A sentence naming the first vertex whose parent is missing.
    pub fn check(&self) -> Result<(), String> {
        let columns = self.layout.columns();
        for index in (0..self.layout.vertex_count()).filter(|&index| self.bit(index)) {
            let vertex = Vertex::new((index % columns) as i32, (index / columns) as i32);
            let missing = vertex
                .parents()
                .into_iter()
                .find(|&parent| self.layout.contains(parent) && !self.is_active(parent));
            if let Some(parent) = missing {
                return Err(format!("{vertex:?} is active, its parent {parent:?} is not"));
            }
        }
        Ok(())
    }

    fn clear(&mut self, vertex: Vertex) {
        let index = self.layout.index(vertex);
        self.bits[index / 64] &= !(1 << (index % 64));
    }

    /// Whether the vertex stored at `index` is active; patch corners have no bit.
    #[inline]
    pub fn bit(&self, index: usize) -> bool {
        self.bits[index / 64] >> (index % 64) & 1 == 1
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
            prop_assert_eq!(active.check(), Ok(()));
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
                prop_assert_eq!(active.check(), Ok(()));
                let inside = active.layout().contains(Vertex::new(x, y));
                let corner = active.layout().is_corner(Vertex::new(x, y));
                prop_assert!(!inside || corner || !active.is_active(Vertex::new(x, y)));
            }
        }
    }
}
