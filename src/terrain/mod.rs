//! The ground: one lattice of heights, the roads aligned to it, the earthworks and brushes that change it, the light that
//! reaches it, and the height query service.

pub mod alignment;
pub mod brush;
pub mod densify;
pub mod earthwork;
pub mod facets;
pub mod grading;
pub mod hillshade;
pub mod lattice;
pub mod light;
pub mod profile;
pub mod query;
pub mod sight;
