//! Positions of parameters, on the ground.

use glam::DVec2;

use crate::error::AnalysisError;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};

/// The height of the ground at a position of a parameter, meters.
///
/// # Errors
/// [`AnalysisError::Place`] where there is none.
pub(crate) fn height_under(ground: &Lattice, key: &'static str, at: DVec2) -> Result<f64, AnalysisError> {
    let height_m = ground_height(ground, Interpolation::Planar, at).height_m();
    height_m.ok_or_else(|| AnalysisError::Place { key, at, problem: missing_ground(ground, at) })
}

/// Why a position has no ground.
pub(crate) fn missing_ground(ground: &Lattice, at: DVec2) -> &'static str {
    if ground.map_extent().contains(at) { "there is no elevation there" } else { "lies off the land" }
}
