//! The ground: one lattice of heights, the earthworks on it, the light that reaches it, and the height query
//! service.

pub mod earthwork;
pub mod facets;
pub mod lattice;
pub mod light;
pub mod query;
