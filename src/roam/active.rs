//! The state of a mesh: one bit per vertex.

use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;

/// Which vertices are active. Patch corners always are.
///
/// Every operation keeps the bits closed under parents, so that whatever is emitted from them is conforming.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActiveSet {
    layout: Layout,
    bits: Vec<u64>,
}

impl ActiveSet {
    /// No vertex but the patch corners.
    pub fn new(layout: Layout) -> Self {
        Self { layout, bits: vec![0; layout.vertex_count().div_ceil(64)] }
    }

    /// The layout whose vertices it holds.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Whether a vertex of the layout is active.
    pub fn is_active(&self, vertex: Vertex) -> bool {
        self.layout.is_corner(vertex) || self.bit(self.layout.index(vertex))
    }

    /// Activates a vertex and first its inactive parents, up to the roots: the forced split.
    pub fn activate(&mut self, vertex: Vertex) {
        let mut waiting = vec![vertex];
        while let Some(vertex) = waiting.pop() {
            if self.layout.contains(vertex) && !self.is_active(vertex) {
                let index = self.layout.index(vertex);
                self.bits[index / 64] |= 1 << (index % 64);
                waiting.extend(vertex.parents());
            }
        }
    }

    /// Deactivates a vertex and first its active children, down to the finest: the forced merge. Patch corners stay.
    pub fn deactivate(&mut self, vertex: Vertex) {
        let mut waiting = vec![vertex];
        while let Some(vertex) = waiting.pop() {
            if self.layout.contains(vertex) && !self.layout.is_corner(vertex) && self.is_active(vertex) {
                let index = self.layout.index(vertex);
                self.bits[index / 64] &= !(1 << (index % 64));
                waiting.extend(vertex.children());
            }
        }
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

    fn bit(&self, index: usize) -> bool {
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
            let mut active = ActiveSet::new(Layout::new(60, 40, 16).expect("sound"));
            for (x, y) in vertices {
                active.activate(Vertex::new(x, y));
                prop_assert!(!active.layout().contains(Vertex::new(x, y)) || active.is_active(Vertex::new(x, y)));
            }
            prop_assert_eq!(active.check(), Ok(()));
        }

        #[test]
        fn any_deactivations_leave_no_vertex_without_its_parents(
            vertices in proptest::collection::vec((0..65i32, 0..49i32), 0..40),
            dropped in proptest::collection::vec((0..65i32, 0..49i32), 0..40),
        ) {
            let mut active = ActiveSet::new(Layout::new(60, 40, 16).expect("sound"));
            vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
            for vertex in dropped.into_iter().map(|(x, y)| Vertex::new(x, y)) {
                active.deactivate(vertex);
                let layout = *active.layout();
                let stays = layout.contains(vertex) && layout.is_corner(vertex);
                prop_assert!(stays || !layout.contains(vertex) || !active.is_active(vertex));
            }
            prop_assert_eq!(active.check(), Ok(()));
        }
    }
}
