//! Bringing elevation to another coordinate system or to other cells.
//!
//! Without options the samples stay as they are, to the last bit.

use sandtable_geom::crs::{Crs, CrsError};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::mosaic::Mosaic;
use sandtable_raster::raster::Raster;
use sandtable_raster::voids;
use sandtable_raster::warp::error::WarpError;
use sandtable_raster::warp::reproject::{Resampling, Warped, reproject, reproject_windows};
use sandtable_raster::warp::valid_search::WarpWindowsError;
use sandtable_raster::windows::Windows;

/// A larger cell, in degrees, is taken for one in meters.
const LARGEST_CELL_DEG: f64 = 1.0;

/// The options for converting elevation.
#[derive(Clone, Debug, Default)]
pub struct ConvertOptions {
    /// The coordinate system to bring it to; its own where `None`.
    pub crs: Option<Crs>,
    /// The side of a cell in units of that system; its own where `None`.
    pub cell: Option<f64>,
    /// Whether voids that samples enclose are filled or kept.
    pub voids: VoidHandling,
}

impl ConvertOptions {
    /// Whether all samples stay as they are.
    pub fn keeps_samples(&self) -> bool {
        self.crs.is_none() && self.cell.is_none() && self.voids == VoidHandling::Keep
    }
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
        /// The UTM zone, or UPS, of the elevation, where it is known.
        zone: Option<String>,
    },
    #[error(transparent)]
    Warp(#[from] WarpError),
    #[error(transparent)]
    Crs(#[from] CrsError),
    #[error(transparent)]
    Read(#[from] DemErrorKind),
}

impl From<WarpWindowsError> for ConvertError {
    fn from(error: WarpWindowsError) -> Self {
        match error {
            WarpWindowsError::Warp(error) => Self::Warp(error),
            WarpWindowsError::Read(error) => Self::Read(error),
        }
    }
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
    let of_other_cells = source.of_other_cells;
    let mut source = source.raster;
    notes.append(&mut source.notes);
    if options.voids == VoidHandling::Fill {
        notes.push(voids::fill(&mut source).note());
    }
    let own = source.crs.clone();
    let (raster, resampling) = match resample(source, options)? {
        (raster, Resampling::Kept) if of_other_cells > 0 => (raster, Resampling::OfTiles),
        resampled => resampled,
    };
    let datum_shift = datum_shift(own.as_ref(), raster.crs.as_ref())?;
    Ok(Converted { raster, resampling, datum_shift, notes })
}

/// The result of [`convert`] for elevation on disk, computed window by window; `None` where that would not save memory:
/// where no samples are computed, or voids are filled.
///
/// # Errors
/// See [`ConvertError`].
pub fn convert_windows(
    source: &mut (impl Windows + ?Sized),
    options: &ConvertOptions,
) -> Result<Option<Converted>, ConvertError> {
    let header = source.metadata().without_samples();
    let is_kept = options.crs.is_none() && options.cell.is_none();
    if is_kept || options.voids == VoidHandling::Fill {
        return Ok(None);
    }
    check(&header, options)?;
    let warped = reproject_windows(source, options.crs.as_ref(), options.cell)?;
    let Some(Warped { raster, method }) = warped else { return Ok(None) };
    let (raster, notes) = (raster.into_owned(), header.notes);
    let datum_shift = datum_shift(header.crs.as_ref(), raster.crs.as_ref())?;
    Ok(Some(Converted { raster, resampling: method, datum_shift, notes }))
}

/// How positions are moved from a system to another; `None` where it stays.
fn datum_shift(from: Option<&Crs>, to: Option<&Crs>) -> Result<Option<String>, CrsError> {
    match (from, to) {
        (Some(from), Some(to)) if from != to => Ok(Some(from.datum_shift_to(to)?.to_string())),
        _ => Ok(None),
    }
}

fn resample(source: Raster, options: &ConvertOptions) -> Result<(Raster, Resampling), ConvertError> {
    let (target, cell) = (options.crs.as_ref(), options.cell);
    if target.is_none() && cell.is_none() {
        return Ok((source, Resampling::Kept));
    }
    check(&source, options)?;
    let warped = reproject(&source, target, cell)?;
    Ok((warped.raster.into_owned(), warped.method))
}

/// Checks that the options suit a raster; its samples are ignored.
fn check(source: &Raster, options: &ConvertOptions) -> Result<(), ConvertError> {
    let target = options.crs.as_ref();
    if let (Some(target), None, true) = (target, &source.crs, source.georeferenced) {
        return Err(ConvertError::NoCrs(target.name().to_owned()));
    }
    let is_in_degrees = target.or(source.crs.as_ref()).is_some_and(Crs::is_geographic);
    match options.cell.filter(|&cell| is_in_degrees && cell > LARGEST_CELL_DEG) {
        Some(cell) => Err(ConvertError::CellInDegrees { cell, zone: zone(source) }),
        None => Ok(()),
    }
}

/// The name of the UTM zone, or of UPS, at the raster's center.
fn zone(source: &Raster) -> Option<String> {
    let center = source.crs.as_ref()?.transform(&Crs::wgs84(), source.center()).ok()?;
    Some(Crs::utm_or_ups_at(center.x, center.y).name().to_owned())
}
