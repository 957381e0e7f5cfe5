//! Makes ground in meters from a raster, for programs without a scene file.

use std::sync::Arc;

use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::warp;
use sandtable_raster::warp::error::WarpError;
use sandtable_raster::warp::valid_search::WarpWindowsError;
use sandtable_terrain::lattice::{Lattice, LatticeError};
use sandtable_terrain::query::service::{HeightService, Snapshot};
use sandtable_terrain::query::source_raster::SourceRaster;
use sandtable_terrain::query::windowed::LatticePartError;

/// Ground in meters.
pub struct MetricGround {
    /// The posts.
    pub lattice: Lattice,
    /// Their coordinate system.
    pub crs: Crs,
}

/// The ground that a query is about: all of it, or as far as the query reaches ([`Lattice::held_part`]).
#[derive(Clone)]
pub struct QueriedGround {
    /// The posts.
    pub lattice: Arc<Lattice>,
    /// Their coordinate system.
    pub crs: Crs,
    /// The vertical datum of the elevation, in the file's words.
    pub vertical_datum: Option<String>,
}

impl From<&Snapshot> for QueriedGround {
    fn from(snapshot: &Snapshot) -> Self {
        Self {
            lattice: Arc::clone(snapshot.lattice()),
            crs: snapshot.crs().clone(),
            vertical_datum: snapshot.source_header().vertical_datum.clone(),
        }
    }
}

impl QueriedGround {
    /// The posts that are held as a lattice of their own, which holds all of its posts.
    ///
    /// # Errors
    /// Fewer than two columns or rows are held.
    pub fn held_lattice(&self) -> Result<Arc<Lattice>, GroundError> {
        match self.lattice.holds_all() {
            true => Ok(Arc::clone(&self.lattice)),
            false => Ok(Arc::new(self.lattice.cut_to_held()?)),
        }
    }
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
    /// Its samples cannot be read.
    #[error(transparent)]
    Read(#[from] DemErrorKind),
    /// A query reaches too far over elevation that is not kept in memory.
    #[error(
        "the query needs {columns} x {rows} posts, more than the {RASTER_SAMPLES} that are read at once; query less ground, with a range or a shorter line, or {RASTER_SAMPLES:#}"
    )]
    Reach {
        /// Posts per row.
        columns: usize,
        /// Rows.
        rows: usize,
    },
}

impl From<WarpWindowsError> for GroundError {
    fn from(error: WarpWindowsError) -> Self {
        match error {
            WarpWindowsError::Warp(error) => Self::Warp(error),
            WarpWindowsError::Read(error) => Self::Read(error),
        }
    }
}

impl From<LatticePartError> for GroundError {
    fn from(error: LatticePartError) -> Self {
        match error {
            LatticePartError::Lattice(error) => Self::Lattice(error),
            LatticePartError::Read(error) => Self::Read(error),
        }
    }
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
    let source = Arc::new(SourceRaster::from(Arc::clone(raster)));
    Ok(HeightService::new(source, ground.crs, Arc::new(ground.lattice)))
}
