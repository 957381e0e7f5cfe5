//! Refiners: policies that decide which vertices are active, one file each.
//!
//! For one view all of them make the same mesh, the closure under parents of the wanted vertices that have a wanted parent
//! (see [`rebuild`]), unless a budget of drawn triangles ends refinement earlier.
//!
//! - `rebuild`: splits from the roots, for any criterion; keeps nothing between frames.
//! - `coherent`: forced splits and merges of the last mesh, for any criterion; equal to `rebuild`.
//! - `queues`: the split and merge queues of Duchaineau et al. 1997 with a budget. They also split leaves that only a
//!   forced split made, so that without a budget they equal `rebuild` only for a monotone criterion; else they are finer,
//!   by an amount that depends on the views before.
//! - `deferred`: nested spheres alone, each vertex examined when the eye may have reached its sphere; equal to `rebuild`.

pub mod changes;
pub mod coherent;
pub mod deferred;
mod drawn;
mod listed;
mod members;
pub mod queues;
pub mod rebuild;
