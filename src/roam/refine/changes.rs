//! The changes of an update.

use crate::graph::Vertex;
use crate::layout::PatchLayout;

/// The changes of one update.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RefinementChanges {
    /// Vertices that became active.
    pub splits: usize,
    /// Vertices that became inactive.
    pub merges: usize,
    /// The patches that hold a triangle of such a vertex, as places in [`PatchLayout::patches`], in ascending order. What
    /// was drawn of the other patches is still valid.
    pub dirty: Vec<usize>,
}

/// The changes of an update so far.
#[derive(Clone, Debug)]
pub(super) struct ChangeTally {
    changes: RefinementChanges,
    marked: Vec<bool>,
}

impl ChangeTally {
    pub(super) fn new(layout: &PatchLayout) -> Self {
        Self { changes: RefinementChanges::default(), marked: vec![false; layout.patch_count()] }
    }

    pub(super) fn split(&mut self, layout: &PatchLayout, vertex: Vertex) {
        self.changes.splits += 1;
        self.mark(layout, vertex);
    }

    pub(super) fn merge(&mut self, layout: &PatchLayout, vertex: Vertex) {
        self.changes.merges += 1;
        self.mark(layout, vertex);
    }

    /// Uncounts a merge that was undone; its patches stay marked.
    pub(super) fn undo_merge(&mut self) {
        self.changes.merges -= 1;
    }

    /// All changes since the last call.
    pub(super) fn take(&mut self) -> RefinementChanges {
        let mut changes = std::mem::take(&mut self.changes);
        changes.dirty.sort_unstable();
        for &patch in &changes.dirty {
            self.marked[patch] = false;
        }
        changes
    }

    fn mark(&mut self, layout: &PatchLayout, vertex: Vertex) {
        for apex in layout.parents(vertex) {
            let patch = layout.patch_holding(vertex, apex);
            if !std::mem::replace(&mut self.marked[patch], true) {
                self.changes.dirty.push(patch);
            }
        }
    }
}
