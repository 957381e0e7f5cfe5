//! Policies for setting the bits: one file per refiner.
//!
//! Whatever the policy, the mesh for one view is the same: the closure under parents of the vertices that are
//! wanted and have a parent that is (see [`rebuild`]), unless a budget of drawn triangles stops it earlier.
//!
//! - `rebuild`: splits alone, from the roots, for any criterion; nothing is remembered.
//! - `coherent`: forced splits and merges from the last mesh, for any criterion, equal to `rebuild`.
//! - `queues`: the split and merge queues of 1997 with a budget. They take leaves as they find them, forced ones
//!   too, so that without a budget they equal `rebuild` only where the criterion is monotone; else they are
//!   finer by what depends on the way taken.

pub mod changes;
pub mod coherent;
pub mod deferred;
mod drawn;
mod listed;
mod members;
pub mod queues;
pub mod rebuild;
