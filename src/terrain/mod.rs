//! The ground: one lattice of heights, the roads aligned to it, the earthworks and brushes that change it, the light that
//! reaches it, and the height query service.

pub mod densify;
pub mod full_resolution;
pub mod hillshade;
pub mod lattice;
pub mod light;
pub mod post_rect;
pub mod profile;
pub mod query;
pub mod sight;
pub mod support_surface;
pub mod triangle_surface;
pub mod volumes;
