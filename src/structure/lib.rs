//! Structures on the ground: outlines and centerlines with elevations become solids.
//!
//! Positions are world space; heights are handed in as they are drawn, so that a solid meets the ground it stands on.

pub mod bands;
pub mod bridge;
pub mod building;
pub mod building_footing;
pub mod building_footprint;
pub mod deck;
pub mod deck_check;
pub mod deck_profile;
pub mod draped_solid;
pub mod eaves;
pub mod faces;
pub mod fence;
pub mod fence_band;
pub mod fence_track;
pub mod obstacle;
pub mod pier;
pub mod plinth;
pub mod power;
pub mod power_beam;
pub mod roof;
mod roof_domed;
pub mod roof_hipped;
mod roof_mansard;
pub mod roof_rectangle;
mod roof_ridged;
mod roof_skillion;
pub mod space_polygon;
pub mod straight_skeleton;
pub mod tunnel;
pub mod unit_roof;
