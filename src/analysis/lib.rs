//! Terrain analysis: functions from the land to rasters, features and tables, with units and sources.
//!
//! ```text
//! land, arguments ──► run ──► surface, movement, observation, landing, water, earth ──► outcome
//! ```
//!
//! A kind is a row of `sandtable-catalog` and a function here. It knows the land as layers on a lattice; no scene, no file
//! and no pixel. The same land and arguments give the same bits, whatever the number of threads.

mod apart;
pub mod arguments;
mod center_columns;
pub mod earth;
pub mod error;
pub mod extent;
pub mod land;
pub mod landing;
pub mod line_posts;
mod measures;
pub mod movement;
pub mod observation;
pub mod outcome;
mod place;
mod ring;
mod round_classes;
pub mod run;
pub mod sight_parts;
pub mod surface;
pub mod tally;
#[cfg(test)]
mod test_land;
#[cfg(test)]
mod test_places;
pub mod water;
