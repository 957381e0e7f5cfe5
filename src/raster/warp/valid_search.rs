//! The samples with data of a raster on disk, searched for where that matters, and once.

use std::cell::{Cell, RefCell};

use glam::DVec2;

use crate::error::DemErrorKind;
use crate::raster::Raster;
use crate::warp::data_extent::with_valid;
use crate::warp::error::WarpError;
use crate::windows::{RasterWindow, Windows};
use sandtable_geom::rect::Rect;

/// Samples along a side of the raster that are read at a time in search of one with data.
const PROBE: u32 = 256;

/// Samples that are read at a time where all are.
pub(super) const SAMPLES_AT_ONCE: u32 = 1 << 22;

/// A raster on disk that cannot be brought to another system.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum WarpWindowsError {
    #[error(transparent)]
    Warp(#[from] WarpError),
    #[error(transparent)]
    Read(#[from] DemErrorKind),
}

/// What `find` makes of a raster's header and of a search for its valid samples.
pub(super) fn searched<W: Windows + ?Sized, T>(
    source: &mut W,
    find: impl FnOnce(&Raster, &ValidSearch<'_, W>) -> Result<T, WarpError>,
) -> Result<T, WarpWindowsError> {
    let raster = source.metadata().without_samples();
    let search = ValidSearch { source: RefCell::new(source), found: Cell::new(None), fault: Cell::new(None) };
    let found = find(&raster, &search);
    // A fault of reading comes before what follows from it.
    match search.fault.into_inner() {
        Some(fault) => Err(fault.into()),
        None => Ok(found?),
    }
}

/// The search for the valid samples of a raster on disk, done once.
pub(super) struct ValidSearch<'a, W: ?Sized> {
    source: RefCell<&'a mut W>,
    /// The outer `None` before the search.
    found: Cell<Option<Option<Rect>>>,
    fault: Cell<Option<DemErrorKind>>,
}

impl<W: Windows + ?Sized> ValidSearch<'_, W> {
    /// The rectangle of the grid around the valid samples; `None` where there is none, or they cannot be read.
    pub fn valid(&self) -> Option<Rect> {
        if let Some(found) = self.found.get() {
            return found;
        }
        let found = data_extent(&mut **self.source.borrow_mut()).unwrap_or_else(|fault| {
            self.fault.set(Some(fault));
            None
        });
        self.found.set(Some(found));
        found
    }
}

/// The smallest grid rectangle around the valid samples, out to their edges; `None` where there is none.
fn data_extent(source: &mut (impl Windows + ?Sized)) -> Result<Option<Rect>, DemErrorKind> {
    let (width, height) = source.size();
    let row = |row: u32| RasterWindow { column: 0, row, width, height: 1 };
    let column = |column: u32| RasterWindow { column, row: 0, width: 1, height };
    let mut reaches_all_sides = true;
    for side in [row(0), row(height - 1), column(0), column(width - 1)] {
        reaches_all_sides = reaches_all_sides && has_data(source, side)?;
    }
    if reaches_all_sides {
        return Ok(Some(Rect { min: DVec2::ZERO, max: DVec2::new(width.into(), height.into()) }));
    }
    let mut around = Rect::EMPTY;
    for band in RasterWindow::all((width, height)).bands(SAMPLES_AT_ONCE) {
        around = with_valid(around, &source.samples(band)?, band);
    }
    Ok((!around.is_empty()).then_some(around))
}

/// Whether a row or a column holds a sample with data.
fn has_data(source: &mut (impl Windows + ?Sized), line: RasterWindow) -> Result<bool, DemErrorKind> {
    for column in (0..line.width).step_by(PROBE as usize) {
        for row in (0..line.height).step_by(PROBE as usize) {
            let part = RasterWindow {
                column: line.column + column,
                row: line.row + row,
                width: PROBE.min(line.width - column),
                height: PROBE.min(line.height - row),
            };
            if source.samples(part)?.valid().next().is_some() {
                return Ok(true);
            }
        }
    }
    Ok(false)
}
