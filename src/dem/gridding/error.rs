//! Errors of gridding points.

use glam::DVec3;

use sandtable_raster::cell_grid::CellGridError;

/// Why no grid was made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum GridError {
    #[error(transparent)]
    Cells(#[from] CellGridError),
    #[error("{what} is {value}; it must be {wanted}")]
    Parameter { what: &'static str, value: f64, wanted: &'static str },
    #[error("a point at {}, {} has the height {}: all three must be finite and below 1e60", .0.x, .0.y, .0.z)]
    Unplaceable(DVec3),
    #[error(
        "all {0} positions lie on one line and no cell between them; give more points, or grid by distance (idw, quadrant or nearest) with the nearest point's height beyond the hull"
    )]
    Collinear(usize),
}
