//! Policies for setting the bits: one file per refiner.
//!
//! Whatever the policy, the mesh for one view is the same: the closure under parents of the vertices that are
//! wanted and have a parent that is (see [`rebuild`]), unless a budget of triangles stops it earlier.

pub mod changes;
pub mod coherent;
pub mod deferred;
mod listed;
mod members;
pub mod queues;
pub mod rebuild;
