//! The result of [`to_metric`](crate::warp::to_metric) for a raster that stays on disk, computed where it is read.
//!
//! ```text
//! window of the result ─► its cells' positions in the source's grid ─► the window of the source around them ─► heights
//! ```
//!
//! The cells of a resampled raster lie around its valid samples, so that these must be found first. Where each side of the
//! raster holds data, a few samples tell; else all of it is read once, some rows at a time.

use crate::cell_grid::CellGrid;
use crate::error::DemErrorKind;
use crate::raster::{Raster, Samples};
use crate::warp::crs_transform::CrsTransform;
use crate::warp::error::WarpError;
use crate::warp::metric_crs::{OffScale, metric_crs_around, off_scale_around};
use crate::warp::resample::Resampler;
use crate::warp::valid_search::{ValidSearch, WarpWindowsError, searched};
use crate::warp::windowed_resample::bilinear_window;
use crate::warp::with_crs;
use crate::windows::{RasterWindow, Windows};
use sandtable_geom::crs::Crs;

/// The result of warping a raster, without its samples.
#[derive(Clone, Debug)]
pub struct MetricPlan {
    /// The result without its samples.
    header: Raster,
    making: MetricMaking,
    off_scale: Option<OffScale>,
}

/// The system that a raster's ground is made in, and why that is another than the stated one.
#[derive(Clone, Debug)]
pub struct MetricSystem {
    /// As [`metric_crs`](crate::warp::metric_crs::metric_crs).
    pub crs: Option<Crs>,
    /// As [`off_scale`](crate::warp::metric_crs::off_scale).
    pub off_scale: Option<OffScale>,
}

impl MetricSystem {
    /// The metric system for a raster on disk, of which few samples are read in most cases.
    ///
    /// # Errors
    /// [`WarpWindowsError`].
    pub fn of(source: &mut (impl Windows + ?Sized), target: Option<&Crs>) -> Result<Self, WarpWindowsError> {
        searched(source, |raster, search| Self::found(raster, target, search))
    }

    fn found<W: Windows + ?Sized>(
        raster: &Raster,
        target: Option<&Crs>,
        search: &ValidSearch<'_, W>,
    ) -> Result<Self, WarpError> {
        let valid = || search.valid();
        let crs = metric_crs_around(raster, target, &valid)?;
        Ok(Self { crs, off_scale: off_scale_around(raster, target, &valid)? })
    }
}

/// A raster on disk in a metric system, north up, with heights in meters.
pub struct MetricWindows<'a, W: ?Sized> {
    source: &'a mut W,
    plan: &'a MetricPlan,
}

/// How the samples of the result are made.
#[derive(Clone, Debug)]
enum MetricMaking {
    /// They are the source's, mirrored where its columns run west or its rows north.
    Kept { mirrors_x: bool, mirrors_y: bool },
    /// They lie between the source's, whose system is `own`.
    Resampled { own: Option<Crs>, cells: CellGrid },
}

impl MetricPlan {
    /// The result of [`to_metric`](crate::warp::to_metric) for `source`.
    ///
    /// # Errors
    /// [`WarpWindowsError`].
    pub fn new(source: &mut (impl Windows + ?Sized), target: Option<&Crs>) -> Result<Self, WarpWindowsError> {
        searched(source, |raster, search| plan(raster, target, search))
    }

    /// The result without its samples.
    pub fn header(&self) -> &Raster {
        &self.header
    }

    /// Why the result lies in another metric system than the raster, where it does.
    pub fn off_scale(&self) -> Option<&OffScale> {
        self.off_scale.as_ref()
    }
}

impl<'a, W: Windows + ?Sized> MetricWindows<'a, W> {
    /// The result of `plan`, which was made of `source`.
    pub fn new(source: &'a mut W, plan: &'a MetricPlan) -> Self {
        Self { source, plan }
    }

    /// The source's window that becomes `window`, mirrored.
    fn kept(&mut self, window: RasterWindow, mirrors: (bool, bool)) -> Result<Samples, DemErrorKind> {
        let (width, height) = self.size();
        let RasterWindow { column, row, .. } = window;
        let column = if mirrors.0 { width - column - window.width } else { column };
        let row = if mirrors.1 { height - row - window.height } else { row };
        let samples = self.source.samples(RasterWindow { column, row, ..window })?;
        Ok(samples.mirrored(window.width as usize, mirrors))
    }

    /// The samples of cells, in the source's vertical unit.
    fn resampled(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        let MetricMaking::Resampled { own, cells } = &self.plan.making else {
            return Ok(Samples::absent(0, false));
        };
        let whole = self.source.metadata().without_samples();
        let transform = CrsTransform::new(&whole, own.as_ref(), self.plan.header.crs.as_ref());
        bilinear_window(self.source, &Resampler::to_cells(&whole, &transform, *cells), window)
    }
}

impl<W: Windows + ?Sized> Windows for MetricWindows<'_, W> {
    fn metadata(&self) -> &Raster {
        &self.plan.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let meters_per_z = self.source.metadata().meters_per_z;
        let samples = match self.plan.making {
            MetricMaking::Kept { mirrors_x, mirrors_y } => self.kept(window, (mirrors_x, mirrors_y))?,
            MetricMaking::Resampled { .. } => self.resampled(window)?,
        };
        Ok(samples.scaled(meters_per_z, 0.0))
    }

    fn announce(&mut self, windows: &[RasterWindow]) {
        if let MetricMaking::Kept { mirrors_x: false, mirrors_y: false } = self.plan.making {
            self.source.announce(windows);
        }
    }
}

/// The steps of [`to_metric`](crate::warp::to_metric) but for the samples.
fn plan<W: Windows + ?Sized>(
    raster: &Raster,
    target: Option<&Crs>,
    search: &ValidSearch<'_, W>,
) -> Result<MetricPlan, WarpError> {
    let MetricSystem { crs: system, off_scale } = MetricSystem::found(raster, target, search)?;
    let own = raster.crs.as_ref().or(target).or(system.as_ref());
    let (north_up, making) = if own == system.as_ref() && raster.is_axis_aligned() {
        let (mirrors_x, mirrors_y) = raster.mirrors();
        (raster.placed_north_up(), MetricMaking::Kept { mirrors_x, mirrors_y })
    } else {
        let transform = CrsTransform::new(raster, own, system.as_ref());
        let valid = search.valid().ok_or(WarpError::Empty)?;
        let resampler = Resampler::around_valid(raster, &transform, None, valid)?;
        let making = MetricMaking::Resampled { own: own.cloned(), cells: resampler.cells() };
        (resampler.header(), making)
    };
    let is_wide = raster.samples.is_wide() || raster.meters_per_z != 1.0;
    let metric = Raster { meters_per_z: 1.0, samples: Samples::absent(0, is_wide), ..north_up };
    let header = with_crs(std::borrow::Cow::Owned(metric), system.as_ref()).into_owned();
    Ok(MetricPlan { header, making, off_scale })
}
