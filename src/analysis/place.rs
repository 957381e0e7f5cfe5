//! Positions of parameters, on the ground.

use glam::DVec2;

use crate::error::AnalysisError;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::query::{Interpolation, ground_height};

/// The height of the ground at a position of a parameter, meters.
///
/// # Errors
/// [`AnalysisError::Place`] where there is none.
pub(crate) fn height_under(ground: &Lattice, key: &'static str, at: DVec2) -> Result<f64, AnalysisError> {
    let height_m = ground_height(ground, Interpolation::Planar, at).height_m();
    height_m.ok_or_else(|| AnalysisError::Place { key, at, problem: missing_ground(ground, at) })
}

/// The post nearest to a position; `None` off the land.
pub(crate) fn nearest_post(ground: &Lattice, at: DVec2) -> Option<usize> {
    let grid = ground.grid_from_map(at).round();
    let is_there = grid.cmpge(DVec2::ZERO).all() && grid.cmple(ground.last_grid()).all();
    is_there.then(|| ground.index(Post::at_grid(grid)))
}

/// The post nearest to a position of a parameter.
///
/// # Errors
/// [`AnalysisError::Place`] where there is none, or it has no elevation.
pub(crate) fn post_under(ground: &Lattice, key: &'static str, at: DVec2) -> Result<usize, AnalysisError> {
    let post = nearest_post(ground, at).filter(|&index| !ground.heights()[index].is_nan());
    post.ok_or_else(|| AnalysisError::Place { key, at, problem: missing_ground(ground, at) })
}

/// Why a position has no ground.
pub(crate) fn missing_ground(ground: &Lattice, at: DVec2) -> &'static str {
    if ground.map_extent().contains(at) { "there is no elevation there" } else { "lies off the land" }
}
