//! Bringing elevation to another coordinate system or to other cells.
//!
//! Without options the samples stay as they are, to the last bit.

use crate::dem::mosaic::Mosaic;
use crate::dem::raster::Raster;
use crate::dem::voids;
use crate::dem::warp::WarpError;
use crate::dem::warp::reproject::{Resampling, reproject};
use crate::geom::crs::{Crs, CrsError};

/// A larger cell, in degrees, is taken for one in meters.
const LARGEST_CELL_DEG: f64 = 1.0;

/// How elevation is converted.
#[derive(Clone, Debug, Default)]
pub struct ConvertOptions {
    /// The coordinate system to bring it to; its own where `None`.
    pub crs: Option<Crs>,
    /// The side of a cell in units of that system; its own where `None`.
    pub cell: Option<f64>,
    /// Whether voids that samples enclose are filled or kept.
    pub voids: VoidHandling,
}

/// The treatment of voids that samples enclose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VoidHandling {
    /// They stay.
    #[default]
    Keep,
    /// A membrane from their rims fills them.
    Fill,
}

/// Converted elevation and its provenance.
#[derive(Debug)]
pub struct Converted {
    /// The elevation.
    pub raster: Raster,
    /// How its samples were made.
    pub resampling: Resampling,
    /// How positions were moved between datums; `None` where the system stayed.
    pub datum_shift: Option<String>,
    /// Notes for the user on joining and filling.
    pub notes: Vec<String>,
}

/// Elevation that cannot be converted.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ConvertError {
    #[error("it names no coordinate system, so it cannot be brought to {0}")]
    NoCrs(String),
    #[error(
        "cells of {cell} degrees are too large: cells count in the units of the system, and this one is in degrees"
    )]
    CellInDegrees {
        cell: f64,
        /// The UTM zone of the elevation, where it is known.
        zone: Option<String>,
    },
    #[error(transparent)]
    Warp(#[from] WarpError),
    #[error(transparent)]
    Crs(#[from] CrsError),
}

/// Converts opened elevation.
///
/// # Errors
/// See [`ConvertError`].
pub fn convert(source: Mosaic, options: &ConvertOptions) -> Result<Converted, ConvertError> {
    let mut notes = Vec::new();
    if source.tiles > 1 {
        notes.push(source.note());
    }
    let mut source = source.raster;
    if options.voids == VoidHandling::Fill {
        notes.push(voids::fill(&mut source).note());
    }
    let own = source.crs.clone();
    let (raster, resampling) = resample(source, options)?;
    let datum_shift = match (&own, &raster.crs) {
        (Some(from), Some(to)) if from != to => Some(from.datum_shift_to(to)?.to_string()),
        _ => None,
    };
    Ok(Converted { raster, resampling, datum_shift, notes })
}

fn resample(source: Raster, options: &ConvertOptions) -> Result<(Raster, Resampling), ConvertError> {
    let (target, cell) = (options.crs.as_ref(), options.cell);
    if target.is_none() && cell.is_none() {
        return Ok((source, Resampling::Kept));
    }
    if let (Some(target), None, true) = (target, &source.crs, source.georeferenced) {
        return Err(ConvertError::NoCrs(target.name().to_owned()));
    }
    let is_in_degrees = target.or(source.crs.as_ref()).is_some_and(Crs::is_geographic);
    if let Some(cell) = cell.filter(|&cell| is_in_degrees && cell > LARGEST_CELL_DEG) {
        return Err(ConvertError::CellInDegrees { cell, zone: zone(&source) });
    }
    let warped = reproject(&source, target, cell)?;
    Ok((warped.raster.into_owned(), warped.method))
}

/// The name of the UTM zone of the raster's center.
fn zone(source: &Raster) -> Option<String> {
    let center = source.crs.as_ref()?.transform(&Crs::wgs84(), source.center()).ok()?;
    Some(Crs::utm_at(center.x, center.y).name().to_owned())
}
