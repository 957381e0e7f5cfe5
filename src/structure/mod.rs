//! What is built on the ground with a shape of its own: outlines and centrelines with elevations become solids.
//!
//! Positions are world space; heights are handed in as they are drawn, times the scene's exaggeration, so that a solid
//! meets the ground it stands on.

pub mod faces;
pub mod plinth;
