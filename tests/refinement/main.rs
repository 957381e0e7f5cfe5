//! Refinement: refiners, error maps and edits, and what the papers state about them.

#[path = "../common/mod.rs"]
mod common;

mod deferred;
mod edits;
mod papers;
mod refiners;
mod rtin;
mod spheres;
