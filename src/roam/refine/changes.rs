//! What an update did, and how that is kept while it goes on.

use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;

/// What one update changed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RefinementChanges {
    /// Vertices that became active.
    pub splits: usize,
    /// Vertices that became inactive.
    pub merges: usize,
    /// The patches that hold a triangle of such a vertex, as places in [`PatchLayout::patches`], rising: what else
    /// was drawn from the bits is still right.
    pub dirty: Vec<usize>,
}

/// Changes as they come.
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
        self.touch(layout, vertex);
    }

    pub(super) fn merge(&mut self, layout: &PatchLayout, vertex: Vertex) {
        self.changes.merges += 1;
        self.touch(layout, vertex);
    }

    /// Forgets that a vertex was merged, once it is active again. Its patches stay marked.
    pub(super) fn take_back_merge(&mut self) {
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

    fn touch(&mut self, layout: &PatchLayout, vertex: Vertex) {
        for apex in vertex.parents().into_iter().filter(|&apex| layout.contains(apex)) {
            let patch = layout.patch_holding(vertex, apex);
            if !self.marked[patch] {
                self.marked[patch] = true;
                self.changes.dirty.push(patch);
            }
        }
    }
}
