//! Warps rasters to other coordinate systems and cells, with north up.

mod crs_transform;
mod data_extent;
pub mod error;
pub mod metric_crs;
pub mod metric_windows;
pub mod reproject;
mod resample;
pub mod row_positions;
pub mod valid_search;
mod windowed_resample;

use std::borrow::Cow;

use glam::DVec2;

use crate::raster::{Raster, Samples};
use crate::warp::crs_transform::CrsTransform;
use crate::warp::data_extent::data_extent;
use crate::warp::error::{WarpError, check_source};
use crate::warp::metric_crs::metric_crs;
use crate::warp::resample::Resampler;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;

/// The raster in a metric system, north up, with elevations in meters; borrowed where nothing changes.
///
/// A raster in true meters, and in `target` where that is given, keeps its samples (its cells need not be square); one that
/// only runs the other way along an axis is mirrored. Any other is resampled bilinearly to square cells in `target`, or in
/// the UTM zone (WGS 84) of its center, near a pole UPS, where none is given or its lengths are not true ([`metric_crs::off_scale`]): a cell's area is that of the source's cells at the center, the
/// grid lies on multiples of the cell size, its extent covers the valid samples, and cells outside them are NaN.
///
/// A raster without a system is taken to be in `target`, or in plain meters.
///
/// The same bits for every number of threads.
///
/// # Errors
/// [`WarpError`]: a raster that names no system but looks like degrees, one without a place, a target that is
/// not metric, a raster too large for UTM, and points that one of the systems does not cover.
///
/// ```
/// use glam::DVec2;
/// use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
/// use sandtable_raster::warp::to_metric;
/// let place = north_up_nodes(DVec2::new(500_015.0, 4_000_045.0), DVec2::splat(30.0));
/// let raster = Raster::new(2, Samples::F32(vec![1.0, 2.0, 3.0, 4.0])).placed(place);
/// assert_eq!(to_metric(&raster, None)?.at(1, 0), 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_metric<'a>(raster: &'a Raster, target: Option<&Crs>) -> Result<Cow<'a, Raster>, WarpError> {
    let system = metric_crs(raster, target)?;
    let own = raster.crs.as_ref().or(target).or(system.as_ref());
    let north_up = if own == system.as_ref() && raster.is_axis_aligned() {
        raster.turned_north_up()
    } else {
        let transform = CrsTransform::new(raster, own, system.as_ref());
        Cow::Owned(Resampler::around(raster, &transform, None)?.bilinear())
    };
    let metric = match north_up {
        Cow::Borrowed(raster) => raster.in_meters(),
        Cow::Owned(raster) => Cow::Owned(raster.into_meters()),
    };
    Ok(with_crs(metric, system.as_ref()))
}

/// Whether [`to_metric`] computes new samples: the raster lies in another system, or turned in its own.
///
/// # Errors
/// [`WarpError`]: see [`to_metric`].
pub fn resamples(raster: &Raster, target: Option<&Crs>) -> Result<bool, WarpError> {
    let system = metric_crs(raster, target)?;
    Ok(raster.crs.as_ref().or(target).or(system.as_ref()) != system.as_ref() || !raster.is_axis_aligned())
}

/// A raster with data all through the smallest rectangle of its grid around the samples with data, and none beyond: warped,
/// it shows what of the result lies outside that rectangle.
pub fn framed(raster: &Raster) -> Raster {
    let frame = data_extent(raster).unwrap_or(Rect::EMPTY);
    let (width, count) = (raster.width as usize, raster.samples.len());
    let center = |index: usize| DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
    let sample = |index: usize| if frame.contains(center(index)) { 0.0 } else { f32::NAN };
    Raster { samples: Samples::F32((0..count).map(sample).collect()), ..raster.without_samples() }
}

/// Checks that the raster lies in a system in meters already; its samples are ignored.
///
/// # Errors
/// [`WarpError`]: it has no place, it looks like degrees, or its system is not metric.
pub fn check_metric(raster: &Raster) -> Result<(), WarpError> {
    check_source(raster)?;
    match &raster.crs {
        Some(crs) if !crs.is_metric() => Err(WarpError::TargetNotMetric(crs.name().into())),
        _ => Ok(()),
    }
}

/// The raster with another name for its system; cloned only where that changes.
fn with_crs<'a>(mut raster: Cow<'a, Raster>, crs: Option<&Crs>) -> Cow<'a, Raster> {
    if raster.crs.as_ref() != crs {
        raster.to_mut().crs = crs.cloned();
    }
    raster
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::north_up;
    use crate::raster::tests::small;
    use glam::{DAffine2, DMat2};

    /// A raster whose value at each center is `value` of its map position.
    fn painted(size: (u32, u32), place: DAffine2, crs: Option<Crs>, value: impl Fn(DVec2) -> f64) -> Raster {
        let centers = (0..size.0 * size.1)
            .map(|i| DVec2::new(f64::from(i % size.0) + 0.5, f64::from(i / size.0) + 0.5));
        let samples = Samples::F64(centers.map(|at| value(place.transform_point2(at))).collect());
        Raster {
            samples,
            map_from_grid: place,
            crs,
            ..small(size.0, size.1, vec![0.0; (size.0 * size.1) as usize])
        }
    }

    fn utm_12() -> Crs {
        Crs::from_epsg(32612).expect("known")
    }

    #[test]
    fn what_is_metric_and_north_up_stays_as_it_is() {
        let raster = Raster { crs: Some(utm_12()), ..small(2, 2, vec![1.0, 2.0, 3.0, f32::NAN]) };
        let metric = to_metric(&raster, None).expect("metric");
        assert_eq!(metric.map_from_grid, raster.map_from_grid);
        assert_eq!([metric.at(0, 0), metric.at(1, 0), metric.at(0, 1)], [1.0, 2.0, 3.0]);
    }

    #[test]
    fn south_up_is_mirrored_without_a_change_of_values() {
        let mut raster = small(2, 2, vec![1.0, 2.0, 3.0, 4.0]);
        raster.map_from_grid = DAffine2 {
            matrix2: DMat2::from_diagonal(DVec2::splat(10.0)),
            translation: DVec2::new(1000.0, 2000.0),
        };
        let metric = to_metric(&raster, None).expect("metric");
        assert_eq!(metric.samples, Samples::F32(vec![3.0, 4.0, 1.0, 2.0]));
        assert_eq!(metric.geotransform(), [1000.0, 10.0, 0.0, 2020.0, 0.0, -10.0]);
    }

    #[test]
    fn degrees_become_the_utm_zone_and_heights_stay_in_place() {
        // Easting as elevation shows every shift.
        let easting = |at: DVec2| Crs::wgs84().transform(&utm_12(), at).expect("inside").x;
        let place = north_up(DVec2::new(-111.3, 37.2), DVec2::splat(1.0 / 1200.0));
        let source = painted((200, 150), place, Some(Crs::wgs84()), easting);
        let metric = to_metric(&source, None).expect("metric");
        assert_eq!(metric.crs.as_ref().and_then(Crs::epsg), Some(32612));
        let mut valid = 0;
        for row in 1..metric.height - 1 {
            for column in 1..metric.width - 1 {
                let wanted = metric
                    .map_from_grid
                    .transform_point2(DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5))
                    .x;
                let found = metric.at(column, row);
                // The outer half sample is held, so that the border reads up to half a cell inward.
                assert!(found.is_nan() || (found - wanted).abs() < 45.0, "{found} for {wanted}");
                valid += u32::from((found - wanted).abs() < 0.01);
            }
        }
        assert!((29_000..=31_500).contains(&valid), "{valid} cells for 30000 samples");
        assert!((metric.spacing().x / 82.7 - 1.0).abs() < 0.01, "{}", metric.spacing().x);
    }

    #[test]
    fn a_turned_raster_keeps_a_plane() {
        let place =
            DAffine2::from_scale_angle_translation(DVec2::new(20.0, -20.0), 0.3, DVec2::new(5e5, 4e6));
        let plane = |at: DVec2| 0.25 * (at.x - 5e5) - 0.5 * (at.y - 4e6);
        let raster = painted((60, 40), place, Some(utm_12()), plane);
        let metric = to_metric(&raster, None).expect("metric");
        assert!(metric.is_north_up() && (metric.spacing().x - 20.0).abs() < 1e-9);
        let mut met = 0;
        for row in 0..metric.height {
            for column in 0..metric.width {
                let at = metric
                    .map_from_grid
                    .transform_point2(DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5));
                met += u32::from((metric.at(column, row) - plane(at)).abs() < 1e-6);
            }
        }
        assert!(met > 2200, "{met} of 2400");
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let place = north_up(DVec2::new(179.9, -16.0), DVec2::splat(0.001));
        let raster = painted((300, 90), place, Some(Crs::wgs84()), |at| at.x * at.y);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let metric = pool.install(|| to_metric(&raster, None)).expect("across the date line");
            metric.samples.iter().map(f64::to_bits).collect::<Vec<_>>()
        };
        assert_eq!(with(1), with(3));
        assert!(with(2).iter().filter(|bits| !f64::from_bits(**bits).is_nan()).count() > 25_000);
    }

    #[test]
    fn feet_become_meters_up_and_along() {
        let crs = Crs::from_epsg_in(2853, 1200.0 / 3937.0).expect("known");
        let place = north_up(DVec2::new(11_882_500.0, 7_011_250.0), DVec2::splat(10.0));
        let mut raster = painted((20, 20), place, Some(crs), |_| 1000.0);
        raster.meters_per_z = 0.3048;
        let metric = to_metric(&raster, None).expect("metric");
        assert!((metric.spacing().x / 3.048 - 1.0).abs() < 1e-3, "{}", metric.spacing().x);
        assert!((metric.at(10, 10) - 304.8).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_done_is_refused_with_the_remedy() {
        let refused = |raster: &Raster, target: Option<&Crs>| {
            to_metric(raster, target).expect_err("refused").to_string()
        };
        let mut degrees = small(2, 2, vec![1.0; 4]);
        degrees.map_from_grid = north_up(DVec2::new(7.0, 44.0), DVec2::splat(0.01));
        assert!(refused(&degrees, None).contains("EPSG:4326"));
        assert!(refused(&Raster { georeferenced: false, ..small(1, 1, vec![1.0]) }, None).contains("cell"));
        assert!(refused(&small(1, 1, vec![1.0]), Some(&Crs::wgs84())).contains("not one"));
        degrees.crs = Some(Crs::wgs84());
        degrees.samples = Samples::F32(vec![f32::NAN; 4]);
        assert!(refused(&degrees, None).contains("no valid sample"));
        let globe = Raster {
            crs: Some(Crs::wgs84()),
            map_from_grid: north_up(DVec2::new(-180.0, 90.0), DVec2::splat(90.0)),
            ..small(4, 2, vec![1.0; 8])
        };
        assert!(refused(&globe, None).contains("no UTM zone"));
    }
}
