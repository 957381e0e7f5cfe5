//! Queries of the ground of a dataset: heights, profiles, lines of sight and viewsheds.
//!
//! ```text
//! files ─► dem ─► ground ─► dataset ──► profile, sight, viewshed     answers about the ground
//!                  ▲
//! scene file ──────┘
//! ```
//!
//! No step reads arguments or the clock, and none prints: a step returns values, notes for the user and typed errors.

pub mod analysis;
pub mod analysis_bands;
pub mod analysis_extent;
pub mod bounded_mesh;
pub mod convert;
pub mod dataset;
pub mod dem;
pub mod gridding;
pub mod ground;
pub mod heights_above;
pub mod outside_note;
pub mod overviews;
pub mod parted_analysis;
pub mod parted_elevation;
pub mod positions;
pub mod post_raster;
pub mod profile;
pub mod service;
pub mod sight;
pub mod viewshed;
mod water_bands;
pub mod windowed_elevation;
