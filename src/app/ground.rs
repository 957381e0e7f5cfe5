//! From an elevation file to ground in meters, for commands that take no scene.

use std::path::Path;
use std::sync::Arc;

use crate::app::arguments::StatedHeights;
use crate::app::dem::read_raster;
use crate::app::failure::CliError;
use crate::dem::raster::Raster;
use crate::dem::warp::{self, WarpError};
use crate::geom::crs::Crs;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::service::HeightService;

/// The lattice of the elevation file at `path`; one in degrees is brought to the UTM zone of its middle.
///
/// # Errors
/// The file cannot be had or read, or has no place in meters; the message names it.
pub fn metric_lattice(path: &Path, heights: StatedHeights) -> Result<Lattice, CliError> {
    let raster = read_raster(path, heights)?;
    let wrong = |reason: String| CliError::input(format!("{}: {reason}", path.display()));
    let metric = warp::to_metric(&raster, None).map_err(|error| wrong(explain(&error)))?;
    Lattice::from_raster(&metric).map_err(|error| wrong(error.to_string()))
}

/// A height service on the ground of an elevation file; one in degrees is brought to the UTM zone of its middle.
///
/// # Errors
/// Why it has no place in meters.
pub fn service(raster: &Arc<Raster>) -> Result<HeightService, String> {
    let metric = warp::to_metric(raster, None).map_err(|error| explain(&error))?;
    let lattice = Lattice::from_raster(&metric).map_err(|error| error.to_string())?;
    let crs = metric.crs.clone().unwrap_or_else(Crs::local);
    Ok(HeightService::new(Arc::clone(raster), crs, Arc::new(lattice)))
}

/// What is wrong; where a scene file could state the place, a file beside it must.
fn explain(error: &WarpError) -> String {
    match error {
        WarpError::NoPlace => {
            "the elevation file does not say where it lies or how far apart its samples are; \
                               put a world file beside it (.pgw for a PNG: six lines)"
                .into()
        }
        other => other.to_string(),
    }
}
