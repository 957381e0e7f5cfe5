//! Errors of warping rasters.

use glam::U64Vec2;

use crate::raster::Raster;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_geom::crs::CrsError;
use sandtable_geom::rect::Rect;

/// Why a raster cannot be warped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum WarpError {
    #[error(
        "the elevation file names no coordinate system and its coordinates, {min_x} to {max_x} and {min_y} to {max_y}, look like degrees; state its system, for example EPSG:4326, as crs under [terrain] or by --crs on the command line"
    )]
    LooksLikeDegrees { min_x: f64, max_x: f64, min_y: f64, max_y: f64 },
    #[error(
        "the elevation file does not state where it lies or how far apart its samples are; state cell (meters between samples) under [terrain]"
    )]
    NoPlace,
    #[error("the elevation file holds no valid sample: all of them are no data; check its no-data value")]
    Empty,
    #[error(
        "a scene needs a projected system in meters, and {0} is not one; choose a UTM zone, for example EPSG:32616"
    )]
    TargetNotMetric(String),
    #[error(
        "the elevation file reaches from longitude {west} to {east} and from latitude {south} to {north}, which no UTM zone covers well; cut it, or state a projected system in meters as crs of the scene"
    )]
    NoZone {
        /// In degrees.
        west: f64,
        /// In degrees.
        east: f64,
        /// In degrees.
        south: f64,
        /// In degrees.
        north: f64,
    },
    #[error(
        "in {system} the elevation file would need {} x {} samples; choose a system that suits its place, or larger cells; where that is more than {RASTER_SAMPLES}, {RASTER_SAMPLES:#}",
        .size.x, .size.y
    )]
    TooLarge {
        system: String,
        /// Samples per row and rows.
        size: U64Vec2,
    },
    /// The raster covers a pole, where one in the wanted system, in degrees, has no border.
    #[error(
        "the elevation file covers a pole, which a raster in degrees ({0}) cannot; cut it, or choose a polar system, for example EPSG:3413 or EPSG:3031"
    )]
    Pole(String),
    #[error(transparent)]
    Crs(#[from] CrsError),
}

/// Checks that a raster has a georeference and, where it looks like degrees, a coordinate system.
pub(super) fn check_source(raster: &Raster) -> Result<(), WarpError> {
    if !raster.georeferenced {
        return Err(WarpError::NoPlace);
    }
    let (Rect { min, max }, cell) = (raster.extent(), raster.spacing());
    let may_be_degrees = min.x >= -360.0 && max.x <= 360.0 && min.y >= -90.5 && max.y <= 90.5;
    if raster.crs.is_none() && may_be_degrees && cell.max_element() < 0.1 {
        return Err(WarpError::LooksLikeDegrees { min_x: min.x, max_x: max.x, min_y: min.y, max_y: max.y });
    }
    Ok(())
}
