//! Refinement: refiners, error maps and edits, and what the papers state about them.

mod common;
mod deferred;
mod edits;
mod papers;
mod refiners;
mod rtin;
mod spheres;
