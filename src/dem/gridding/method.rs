//! The ways from points to the heights of cells.

use crate::gridding::error::GridError;

/// A gridding method: how the height at a cell's center follows from the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GriddingMethod {
    /// On the plane through the corners of the Delaunay triangle around it, breaklines kept as edges of triangles.
    /// Continuous, with creases at the edges; reproduces planes.
    Tin,
    /// Sibson's natural neighbors (Sibson 1981): each neighbor weighs as the share of the cell's Voronoi region that
    /// it would lose to a site there. Continuous, and smooth except at the points; reproduces planes.
    Natural,
    /// The mean of the nearest points, each weighing as its distance to the power of −`power` (Shepard 1968).
    /// Discontinuous where the set of nearest points changes.
    InverseDistance {
        /// The number of points; at least 1.
        k: u32,
        /// The power; above 0.
        power: f64,
    },
    /// The mean of the four points around, weighted by distance: the nearest point of each quadrant, weighing as its
    /// distance to the power of −`power`. It draws on all sides even where points lie along lines, such as contours and
    /// cross-sections. Quadrants without points are left out.
    Quadrant {
        /// The power; above 0.
        power: f64,
    },
    /// The nearest point's.
    Nearest,
}

impl GriddingMethod {
    /// Checks the parameters.
    pub(super) fn check(self) -> Result<(), GridError> {
        let power = match self {
            Self::InverseDistance { k: 0, .. } => {
                return Err(GridError::Parameter { what: "k", value: 0.0, wanted: "at least 1" });
            }
            Self::InverseDistance { power, .. } | Self::Quadrant { power } => power,
            Self::Tin | Self::Natural | Self::Nearest => return Ok(()),
        };
        if power > 0.0 && power.is_finite() {
            return Ok(());
        }
        Err(GridError::Parameter { what: "power", value: power, wanted: "a number above 0" })
    }
}
