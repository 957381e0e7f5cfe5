//! A mesh for one view from the roots down, by splits alone.
//!
//! A triangle whose split vertex is wanted is split, with the splits that this forces, and its halves are examined in turn.
//! Halves that only a forced split made are not examined, so the result does not depend on the order: it is the closure
//! under parents of the wanted vertices that have a wanted parent.
//!
//! Costs one evaluation of the criterion per triangle of the resulting tree, whatever the size of the terrain.

use rayon::prelude::*;

use crate::active::ActiveSet;
use crate::bintree::Triangle;
use crate::criterion::Criterion;
use crate::graph::Vertex;
use crate::layout::PatchLayout;

/// The active vertices for one view, from the roots of the patches whose south-west corners are listed. Other patches stay
/// as coarse as their neighbors allow.
pub fn rebuild(
    layout: &PatchLayout,
    criterion: &impl Criterion,
    patches: impl IntoIterator<Item = Vertex>,
) -> ActiveSet {
    let mut active = ActiveSet::new(*layout);
    for corner in patches {
        for root in Triangle::roots(corner, layout.patch()) {
            split(&mut active, criterion, root);
        }
    }
    active
}

/// [`rebuild`] on all threads, each of which has patches of its own; the same for any number of them.
pub fn rebuild_by_parts(layout: &PatchLayout, criterion: &impl Criterion, patches: &[Vertex]) -> ActiveSet {
    /// Parts for each thread: near patches have many times the triangles of far ones.
    const PARTS: usize = 4;
    let part = patches.len().div_ceil(PARTS * rayon::current_num_threads()).max(1);
    let parts = patches.par_chunks(part).map(|part| rebuild(layout, criterion, part.iter().copied()));
    parts.reduce_with(ActiveSet::joined).unwrap_or_else(|| ActiveSet::new(*layout))
}

/// Splits a triangle and its halves while they are wanted; the recursion is as deep as the patch has levels.
fn split(active: &mut ActiveSet, criterion: &impl Criterion, triangle: Triangle) {
    let vertex = triangle.split_vertex();
    if criterion.wants(vertex) {
        active.activate(vertex);
        if vertex.has_children() {
            for half in triangle.split() {
                split(active, criterion, half);
            }
        }
    }
}
