//! Policies for setting the bits: one file per refiner.
//!
//! Whatever the policy, the mesh for one view is the same: the closure under parents of the vertices that are
//! wanted and have a parent that is (see [`rebuild`]), unless a budget of triangles stops it earlier.

pub mod deferred;
pub mod rebuild;

/// What one update of a mesh changed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Vertices activated.
    pub splits: usize,
    /// Vertices deactivated.
    pub merges: usize,
    /// The patches in which something changed, by [`crate::roam::layout::Layout::patch_index`], ascending.
    pub dirty: Vec<usize>,
}
