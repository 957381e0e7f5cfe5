//! Makes ground in meters from a raster, for programs without a scene file.

use std::sync::Arc;

use crate::dem::raster::Raster;
use crate::dem::warp::{self, WarpError};
use crate::geom::crs::Crs;
use crate::terrain::lattice::{Lattice, LatticeError};
use crate::terrain::query::service::HeightService;

/// Ground in meters.
pub struct MetricGround {
    /// The posts.
    pub lattice: Lattice,
    /// Their coordinate system.
    pub crs: Crs,
}

/// Elevation that has no ground in meters.
#[derive(Debug, thiserror::Error)]
pub enum GroundError {
    /// The raster cannot be brought to meters.
    #[error("{}", warp_reason(.0))]
    Warp(WarpError),
    /// The raster has no surface.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
}

/// The reason, with a remedy that needs no scene file.
fn warp_reason(error: &WarpError) -> String {
    match error {
        WarpError::NoPlace => {
            "the elevation file does not say where it lies or how far apart its samples are; put a \
                               world file beside it (.pgw for a PNG: six lines)"
                .into()
        }
        WarpError::LooksLikeDegrees { min_x, max_x, min_y, max_y } => format!(
            "the elevation file names no coordinate system, and its coordinates, {min_x} to {max_x} and {min_y} to {max_y}, look like degrees; put a .prj file beside it that says EPSG:4326"
        ),
        other => other.to_string(),
    }
}

impl MetricGround {
    /// The ground of a raster; one in degrees, or in a system whose lengths are not true, is brought to the UTM zone of its
    /// center.
    ///
    /// # Errors
    /// See [`GroundError`].
    pub fn from_raster(raster: &Raster) -> Result<Self, GroundError> {
        let metric = warp::to_metric(raster, None).map_err(GroundError::Warp)?;
        Ok(Self {
            lattice: Lattice::from_raster(&metric)?,
            crs: metric.crs.clone().unwrap_or_else(Crs::local),
        })
    }
}

/// The height service of a raster and its ground in meters.
///
/// # Errors
/// See [`GroundError`].
pub fn height_service(raster: &Arc<Raster>) -> Result<HeightService, GroundError> {
    let ground = MetricGround::from_raster(raster)?;
    Ok(HeightService::new(Arc::clone(raster), ground.crs, Arc::new(ground.lattice)))
}
