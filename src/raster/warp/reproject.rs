//! Reprojects rasters to a given coordinate system and cell size.
//!
//! ```text
//! cells of the source   │  1×          2×                  cells that are wanted
//! ──────────────────────┼───┼───────────┼─────────────────────────────────────►
//!                        bilinear        average of the samples in each cell
//! ```

use std::borrow::Cow;

use glam::DVec2;

use crate::raster::Raster;
use crate::warp::crs_transform::CrsTransform;
use crate::warp::data_extent::data_extent;
use crate::warp::error::{WarpError, check_source};
use crate::warp::resample::{CellSize, Resampler};
use crate::warp::valid_search::{WarpWindowsError, searched};
use crate::warp::windowed_resample::{average, bilinear_window};
use crate::warp::with_crs;
use crate::windows::{RasterWindow, Windows};
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;

/// From this many times the source's cells on, cells hold the average: only that keeps the mean height.
const COARSER: f64 = 2.0;

/// The method by which samples were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resampling {
    /// They are the source's, in its order or mirrored.
    Kept,
    /// Between the four samples of the source around each cell's center.
    Bilinear,
    /// As the mean of the source's samples in each cell.
    Average,
    /// Those of some tiles bilinearly or as means, when the tiles were joined.
    OfTiles,
}

/// A raster in another system or with other cells.
#[derive(Clone, Debug)]
pub struct Warped<'a> {
    /// The raster, heights in the source's vertical unit; borrowed where it is the source.
    pub raster: Cow<'a, Raster>,
    /// How its samples were made.
    pub method: Resampling,
}

/// `raster` in `target`, or in its own system, with square cells of `cell` units of that system, or of the size of its
/// own. North is up.
///
/// In its own system, a raster along the axes keeps its north-west corner, and without a `cell` its samples. All else is
/// resampled: cells lie on multiples of their size and cover the valid samples. Longitudes of a raster across the date
/// line continue beyond 180°.
///
/// A raster without a system is taken to be in `target`. The same bits for every number of threads.
///
/// # Errors
/// [`WarpError`]: a raster without a place, one that looks like degrees and names no system, one without valid
/// samples, too many cells, a pole in degrees, and points that one of the systems does not cover or datums whose shift
/// is not known.
pub fn reproject<'a>(
    raster: &'a Raster,
    target: Option<&Crs>,
    cell: Option<f64>,
) -> Result<Warped<'a>, WarpError> {
    check_source(raster)?;
    let own = raster.crs.as_ref().or(target);
    let system = target.or(own);
    let stays = own == system && raster.is_axis_aligned();
    let source = if stays { raster.turned_north_up() } else { Cow::Borrowed(raster) };
    let cell = cell.filter(|&cell| !stays || DVec2::splat(cell) != source.spacing());
    if stays && cell.is_none() {
        return Ok(Warped { raster: with_crs(source, own), method: Resampling::Kept });
    }
    let transform = CrsTransform::new(&source, own, system);
    let (resampler, method) = coarser_or_finer(&source, &transform, stays, cell, &|| data_extent(&source))?;
    let raster = if method == Resampling::Average { resampler.average() } else { resampler.bilinear() };
    Ok(Warped { raster: Cow::Owned(raster), method })
}

/// `raster` in its own system with square cells of `cell` units of it, on multiples of their size, so that rasters that lie
/// beside each other fit: means of its samples from twice its cells on, else bilinear between them.
///
/// # Errors
/// [`WarpError`]: as [`reproject`].
pub fn to_cells(raster: &Raster, cell: f64) -> Result<Warped<'_>, WarpError> {
    check_source(raster)?;
    let source = if raster.is_axis_aligned() { raster.turned_north_up() } else { Cow::Borrowed(raster) };
    let own = raster.crs.as_ref();
    let transform = CrsTransform::new(&source, own, own);
    let (resampler, method) =
        coarser_or_finer(&source, &transform, false, Some(cell), &|| data_extent(&source))?;
    let raster = if method == Resampling::Average { resampler.average() } else { resampler.bilinear() };
    Ok(Warped { raster: Cow::Owned(raster), method })
}

/// The result of [`reproject`] in memory, for a raster that stays on disk; `None` where its samples are kept, or
/// mirrored.
///
/// # Errors
/// As [`reproject`], and samples that cannot be read.
pub fn reproject_windows(
    source: &mut (impl Windows + ?Sized),
    target: Option<&Crs>,
    cell: Option<f64>,
) -> Result<Option<Warped<'static>>, WarpWindowsError> {
    let whole = source.metadata().without_samples();
    check_source(&whole)?;
    let own = whole.crs.as_ref().or(target);
    let system = target.or(own);
    let stays = own == system && whole.is_axis_aligned();
    let cell = cell.filter(|&cell| !stays || DVec2::splat(cell) != whole.spacing());
    if stays && (cell.is_none() || !whole.is_north_up()) {
        return Ok(None);
    }
    let transform = CrsTransform::new(&whole, own, system);
    let (resampler, method) =
        searched(source, |_, search| coarser_or_finer(&whole, &transform, stays, cell, &|| search.valid()))?;
    let raster = match method {
        Resampling::Average => average(source, &resampler)?,
        Resampling::Kept | Resampling::Bilinear | Resampling::OfTiles => {
            let cells = resampler.cells();
            let window = RasterWindow::all((cells.width(), cells.height()));
            resampler.raster(bilinear_window(source, &resampler, window)?)
        }
    };
    Ok(Some(Warped { raster: Cow::Owned(raster), method }))
}

/// How cells are made: of the stated size, or of that of the samples.
fn coarser_or_finer<'a>(
    source: &'a Raster,
    transform: &'a CrsTransform<'a>,
    stays: bool,
    cell: Option<f64>,
    valid: &dyn Fn() -> Option<Rect>,
) -> Result<(Resampler<'a>, Resampling), WarpError> {
    let resampler = match cell.filter(|_| stays) {
        Some(cell) => Resampler::over(source, transform, cell)?,
        None => Resampler::around_valid(source, transform, cell, valid().ok_or(WarpError::Empty)?)?,
    };
    if cell.is_none() {
        return Ok((resampler, Resampling::Bilinear));
    }
    let center = source.grid_from_map(source.center());
    let at = |grid: DVec2| transform.forward(source.map_from_grid.transform_point2(grid));
    let is_coarser = resampler.cell() >= COARSER * CellSize::new(center, &at)?.longest;
    Ok((resampler, if is_coarser { Resampling::Average } else { Resampling::Bilinear }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Samples;
    use crate::raster::tests::small;

    fn utm(code: u32) -> Option<Crs> {
        Some(Crs::from_epsg(code).expect("known"))
    }

    #[test]
    fn coarse_cells_hold_the_mean_of_the_samples_in_them() {
        let values = vec![1.0, 3.0, 10.0, 20.0, 5.0, 7.0, f32::NAN, 30.0, 2.0, 2.0, f32::NAN, f32::NAN];
        let raster = Raster { crs: utm(32612), ..small(4, 3, values) };
        let Warped { raster: coarse, method } = reproject(&raster, None, Some(20.0)).expect("in meters");
        assert_eq!((coarse.width, coarse.height, method), (2, 2, Resampling::Average));
        assert_eq!([coarse.at(0, 0), coarse.at(1, 0), coarse.at(0, 1)], [4.0, 20.0, 2.0]);
        assert!(coarse.at(1, 1).is_nan());
        assert_eq!(coarse.geotransform(), [1000.0, 20.0, 0.0, 2030.0, 0.0, -20.0]);
    }

    #[test]
    fn finer_cells_lie_between_the_samples() {
        let raster = Raster { crs: utm(32612), ..small(2, 2, vec![0.0, 10.0, 20.0, 30.0]) };
        let Warped { raster: fine, method } = reproject(&raster, None, Some(5.0)).expect("in meters");
        assert_eq!((fine.width, fine.height, method), (4, 4, Resampling::Bilinear));
        assert_eq!([fine.at(0, 0), fine.at(1, 1), fine.at(2, 2)], [0.0, 7.5, 22.5]);
    }

    #[test]
    fn without_another_system_or_cell_nothing_changes() {
        let raster = Raster { crs: utm(32612), ..small(2, 2, vec![0.0, 10.0, 20.0, f32::NAN]) };
        for cell in [None, Some(10.0)] {
            let warped = reproject(&raster, utm(32612).as_ref(), cell).expect("in meters");
            assert_eq!(warped.method, Resampling::Kept);
            assert_eq!(warped.raster.geotransform(), raster.geotransform());
            assert_eq!(warped.raster.at(1, 0), 10.0);
        }
    }

    #[test]
    fn a_plane_in_degrees_comes_back_from_meters_and_the_date_line_is_no_border() {
        let value = |at: DVec2| at.y * 100.0;
        let place = crate::raster::north_up(DVec2::new(179.9, -17.0), DVec2::splat(0.001));
        let centers =
            (0..200u32 * 100).map(|i| DVec2::new(f64::from(i % 200) + 0.5, f64::from(i / 200) + 0.5));
        let samples = Samples::F64(centers.map(|at| value(place.transform_point2(at))).collect());
        let degrees =
            Raster { samples, map_from_grid: place, crs: utm(4326), ..small(200, 100, vec![0.0; 20_000]) };
        let metric = reproject(&degrees, utm(32760).as_ref(), Some(100.0)).expect("one zone").raster;
        let again = reproject(&metric, utm(4326).as_ref(), Some(0.001)).expect("near the date line").raster;
        assert!((195..=205).contains(&again.width), "{} columns", again.width);
        let middle = (again.width / 2, again.height / 2);
        let center = again
            .map_from_grid
            .transform_point2(DVec2::new(f64::from(middle.0) + 0.5, f64::from(middle.1) + 0.5));
        assert!((again.at(middle.0, middle.1) - value(center)).abs() < 0.01);
    }

    #[test]
    fn a_raster_on_disk_becomes_the_same_as_one_in_memory() {
        let value = |index: u32| if index % 37 == 5 { f32::NAN } else { (index * 7919 % 1013) as f32 / 3.0 };
        let values: Vec<f32> = (0..130 * 90).map(value).collect();
        let metric = Raster { crs: utm(32612), ..small(130, 90, values.clone()) };
        let place = crate::raster::north_up(DVec2::new(-111.3, 37.2), DVec2::splat(1.0 / 1200.0));
        let degrees = Raster { crs: utm(4326), map_from_grid: place, ..small(130, 90, values) };
        for (mut source, target, cell, method) in [
            (metric.clone(), None, Some(25.0), Resampling::Average),
            (metric.clone(), None, Some(7.0), Resampling::Bilinear),
            (metric.clone(), utm(32611), Some(60.0), Resampling::Average),
            (degrees.clone(), utm(32612), None, Resampling::Bilinear),
            (degrees, utm(32612), Some(400.0), Resampling::Average),
        ] {
            let whole = reproject(&source, target.as_ref(), cell).expect("one zone").raster.into_owned();
            let warped = reproject_windows(&mut source, target.as_ref(), cell).expect("in memory");
            let Warped { raster, method: found } = warped.expect("resampled");
            assert_eq!(
                (found, raster.geotransform(), &raster.crs),
                (method, whole.geotransform(), &whole.crs)
            );
            let bits = |raster: &Raster| raster.samples.iter().map(f64::to_bits).collect::<Vec<_>>();
            assert_eq!((raster.size(), bits(&raster)), (whole.size(), bits(&whole)), "{cell:?}");
        }
        assert!(
            reproject_windows(&mut metric.clone(), None, Some(10.0)).expect("in memory").is_none(),
            "kept"
        );
    }

    #[test]
    fn a_pole_has_no_place_in_degrees() {
        let mut polar = Raster { crs: utm(3413), ..small(3, 3, vec![1.0; 9]) };
        polar.map_from_grid = crate::raster::north_up(DVec2::new(-15.0, 15.0), DVec2::splat(10.0));
        assert!(matches!(reproject(&polar, utm(4326).as_ref(), None), Err(WarpError::Pole(_))));
    }
}
