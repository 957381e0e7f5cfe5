//! The ground: one lattice of heights, the roads aligned to it, the earthworks and brushes that change it, the light that
//! reaches it, and the height query service.

pub mod alignment;
pub mod brush;
pub mod channel;
pub mod densify;
pub mod earthwork;
pub mod facets;
pub mod fall;
pub mod finest;
pub mod grading;
pub mod hillshade;
pub mod lattice;
pub mod light;
pub mod pad;
pub mod profile;
pub mod query;
pub mod shore;
pub mod sight;
pub mod underfoot;
