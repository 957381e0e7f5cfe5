//! From the roots down: a mesh for one view, built anew by splits alone.
//!
//! A triangle whose split vertex is wanted is split, with whatever that forces, and its halves are looked at in
//! turn. Halves that only a neighbour forced are not looked at, so the result does not depend on the order: it
//! is the closure under parents of the vertices that are wanted and have a parent that is.
//!
//! Cost: one question a triangle of the resulting tree, whatever the size of the terrain.

use crate::roam::active::ActiveSet;
use crate::roam::bintree::Triangle;
use crate::roam::criterion::Criterion;
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;

/// Sets the bits for one view, from the roots of the patches whose south-west corners are listed.
///
/// The other patches are left as coarse as their neighbours allow.
pub fn rebuild(
    layout: &Layout,
    criterion: &impl Criterion,
    patches: impl IntoIterator<Item = Vertex>,
) -> ActiveSet {
    let mut active = ActiveSet::new(*layout);
    let mut stack = Vec::new();
    for corner in patches {
        stack.extend(Triangle::roots(corner, layout.patch()));
        while let Some(triangle) = stack.pop() {
            let vertex = triangle.split_vertex();
            if criterion.wants(vertex) {
                active.activate(vertex);
                if vertex.has_children() {
                    stack.extend(triangle.split());
                }
            }
        }
    }
    active
}
