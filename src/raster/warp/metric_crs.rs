//! The system in which a raster's ground is in true meters: its own, a stated one, a UTM zone, or UPS near a pole.
//!
//! A system in meters may stretch lengths: Web Mercator by 1/cos φ, to twice their length at 60° north. Where lengths at the
//! center of the raster are off by more than [`MOST_SCALE_ERROR`], the ground is made in the UTM zone there instead. Where no
//! zone suits, because zones end or are narrower than the raster, it is made in Universal Polar Stereographic if all of it lies
//! near a pole.

use std::fmt;

use glam::DVec2;

use crate::raster::Raster;
use crate::warp::crs_transform::on_earth;
use crate::warp::data_extent::{data_extent, outline};
use crate::warp::error::{WarpError, check_source};
use sandtable_geom::crs::{Crs, UTM_LATITUDES_DEG};
use sandtable_geom::rect::Rect;
use sandtable_geom::scale_factors::ScaleFactors;

/// The largest error of lengths at the center of a raster that a system in meters may have. National and UTM grids stay
/// below 0.3 %; the systems beyond are made for maps of the world or of a continent.
pub const MOST_SCALE_ERROR: f64 = 0.01;

/// How far from its meridian a UTM zone is used where no system is chosen; at 9° lengths are off by up to 1.2 %.
const UTM_REACH_DEG: f64 = 9.0;

/// The latitude from which on UPS is used where no zone suits, at either pole: lengths are off by 1.1 % there, by nothing at
/// 81°, and by 0.6 % at the pole.
const UPS_LATITUDE_DEG: f64 = 75.0;

/// A system in meters whose lengths are not those of the ground, and what is used instead. Its text is a note for the user.
#[derive(Clone, Debug, PartialEq)]
pub struct OffScale {
    /// The system that the raster names or that the caller wanted.
    pub stated: Crs,
    /// Its scale at the center of the raster.
    pub scale: ScaleFactors,
    /// The UTM zone, or UPS, in which the ground is made; `None` where neither covers the raster, which stays in `stated`.
    pub zone: Option<Crs>,
}

impl fmt::Display for OffScale {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let stated = self.stated.name();
        let longer = self.scale.most >= 1.0 && self.scale.most - 1.0 >= 1.0 - self.scale.least;
        let comparison = if longer { "longer" } else { "shorter" };
        write!(
            f,
            "lengths in {stated} are {:.1} % {comparison} here than on the ground: ",
            self.scale.error() * 100.0
        )?;
        match &self.zone {
            Some(zone) => write!(f, "the ground is made in {}, in true meters; positions stay in {stated}", zone.name()),
            None => f.write_str(
                "distances, slopes and sight lines are off by as much, since no UTM zone covers the elevation; cut it, or \
                 state a system that suits its place as crs of the scene",
            ),
        }
    }
}

/// The system that [`to_metric`](crate::warp::to_metric) brings a raster to; `None` where the raster names none and no
/// `target` is given.
///
/// # Errors
/// [`WarpError`]: see [`to_metric`](crate::warp::to_metric).
pub fn metric_crs(raster: &Raster, target: Option<&Crs>) -> Result<Option<Crs>, WarpError> {
    metric_crs_around(raster, target, &|| data_extent(raster))
}

/// [`metric_crs`] of a raster whose samples are not in memory: `valid` finds the rectangle of its grid around the valid ones,
/// where that matters.
pub(super) fn metric_crs_around(
    raster: &Raster,
    target: Option<&Crs>,
    valid: &dyn Fn() -> Option<Rect>,
) -> Result<Option<Crs>, WarpError> {
    check_source(raster)?;
    if let Some(target) = target.filter(|target| !target.is_metric()) {
        return Err(WarpError::TargetNotMetric(target.name().into()));
    }
    let Some(own) = raster.crs.as_ref().or(target) else { return Ok(None) };
    let stated = target.unwrap_or(own);
    if !stated.is_metric() {
        return utm_zone(raster, own, valid).map(Some);
    }
    let off = off_scale_around(raster, target, valid)?;
    Ok(Some(off.and_then(|off| off.zone).unwrap_or_else(|| stated.clone())))
}

/// The scale error where a raster in meters, or `target`, stretches lengths by more than [`MOST_SCALE_ERROR`] at the
/// center of the raster; `None` where lengths are true.
///
/// # Errors
/// [`WarpError`]: the raster holds no data, or its border lies outside what its system covers.
pub fn off_scale(raster: &Raster, target: Option<&Crs>) -> Result<Option<OffScale>, WarpError> {
    off_scale_around(raster, target, &|| data_extent(raster))
}

/// [`off_scale`], as [`metric_crs_around`].
pub(super) fn off_scale_around(
    raster: &Raster,
    target: Option<&Crs>,
    valid: &dyn Fn() -> Option<Rect>,
) -> Result<Option<OffScale>, WarpError> {
    let Some(own) = raster.crs.as_ref().or(target) else { return Ok(None) };
    let stated = target.unwrap_or(own);
    let center = own.transform(stated, raster.center()).ok();
    let scale = center.filter(|_| stated.is_metric()).and_then(|center| ScaleFactors::at(stated, center));
    let Some(scale) = scale.filter(|scale| scale.error() > MOST_SCALE_ERROR) else { return Ok(None) };
    let zone = match utm_zone(raster, own, valid) {
        Ok(zone) => Some(zone),
        // The datum's shift is not known, or no zone suits: there is nothing better than what is stated.
        Err(WarpError::NoZone { .. } | WarpError::Crs(_)) => None,
        Err(error) => return Err(error),
    };
    Ok(Some(OffScale { stated: stated.clone(), scale, zone }))
}

/// The UTM zone of the raster's center, if its valid samples lie near enough; else UPS, if they lie near a pole.
fn utm_zone(raster: &Raster, own: &Crs, valid: &dyn Fn() -> Option<Rect>) -> Result<Crs, WarpError> {
    let valid = valid().ok_or(WarpError::Empty)?;
    let degrees = Crs::wgs84();
    let at = |grid: DVec2| {
        own.transform(&degrees, on_earth(raster, own, raster.map_from_grid.transform_point2(grid)))
    };
    let center = at(valid.center())?;
    let border = outline(valid).map(at).collect::<Result<Vec<_>, _>>()?;
    // Measured from the center, so that a raster across the date line stays in one piece.
    let east_of_center = |point: &DVec2| (point.x - center.x + 540.0).rem_euclid(360.0) - 180.0;
    let around =
        Rect::around(border.iter().map(|point| DVec2::new(center.x + east_of_center(point), point.y)));
    let meridian = ((center.x + 180.0) / 6.0).floor() * 6.0 - 177.0;
    let reach = (around.max.x - meridian).max(meridian - around.min.x);
    // All around the globe both borders are the same meridian: the samples' own span counts.
    let span =
        if own.is_geographic() { valid.size().x * raster.map_from_grid.matrix2.x_axis.x.abs() } else { 0.0 };
    let (south, north) = UTM_LATITUDES_DEG;
    if reach > UTM_REACH_DEG || span > 2.0 * UTM_REACH_DEG || around.min.y < south || around.max.y > north {
        // A pole lies within its border: all samples lie nearer to it.
        if around.min.y >= UPS_LATITUDE_DEG || around.max.y <= -UPS_LATITUDE_DEG {
            return Ok(Crs::ups_at(around.min.y));
        }
        let (west, east) = (around.min.x, around.max.x.max(around.min.x + span));
        return Err(WarpError::NoZone { west, east, south: around.min.y, north: around.max.y });
    }
    Ok(Crs::utm_at(center.x, center.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::north_up;
    use crate::raster::tests::small;

    fn raster(code: u32, west: f64, north: f64, cell: f64) -> Raster {
        let crs = Some(Crs::from_epsg(code).expect("known"));
        let map_from_grid = north_up(DVec2::new(west, north), DVec2::splat(cell));
        Raster { crs, map_from_grid, ..small(3, 3, vec![1.0; 9]) }
    }

    fn found(raster: &Raster, target: Option<u32>) -> Option<u32> {
        let target = target.map(|code| Crs::from_epsg(code).expect("known"));
        metric_crs(raster, target.as_ref()).expect("metric").and_then(|crs| crs.epsg())
    }

    #[test]
    fn web_mercator_gives_way_to_a_utm_zone_but_at_the_equator() {
        let north = raster(3857, -8_998_000.0, 5_998_000.0, 30.0);
        assert_eq!(found(&north, None), Some(32617));
        let off = off_scale(&north, None).expect("metric").expect("off");
        assert!((off.scale.error() - 0.475).abs() < 0.01, "{off:?}");
        let note = off.to_string();
        assert!(
            note.contains("EPSG:3857") && note.contains("EPSG:32617") && note.contains("% longer"),
            "{note}"
        );
        assert_eq!(found(&raster(3857, -8_998_000.0, 1000.0, 30.0), None), Some(3857));
    }

    #[test]
    fn a_target_that_stretches_lengths_gives_way_too() {
        let utm = raster(32617, 530_000.0, 5_221_300.0, 30.0);
        assert_eq!(found(&utm, None), Some(32617));
        assert_eq!(found(&utm, Some(3857)), Some(32617));
        assert_eq!(found(&utm, Some(32616)), Some(32616), "a neighboring zone is off by less");
        let unnamed = Raster { crs: None, ..raster(3857, -8_998_000.0, 5_998_000.0, 30.0) };
        assert_eq!(found(&unnamed, Some(3857)), Some(32617), "a raster without a system lies in the target");
    }

    #[test]
    fn near_a_pole_the_ground_is_made_in_polar_stereographic() {
        let degrees = |west: f64, north: f64, cell: f64| found(&raster(4326, west, north, cell), None);
        assert_eq!(degrees(10.0, 84.1, 0.1), Some(5041), "across the end of UTM");
        assert_eq!(degrees(10.0, 84.0, 0.1), Some(32632));
        assert_eq!(degrees(10.0, -79.9, 0.1), Some(5042));
        assert_eq!(degrees(-180.0, 90.0, 5.0), Some(5041), "the pole, and 15 degrees beside it");
        assert_eq!(degrees(-10.0, 80.0, 1.5), Some(32629));
        let wide = |north: f64| {
            let place = north_up(DVec2::new(-30.0, north), DVec2::new(10.0, 0.5));
            Raster { map_from_grid: place, ..raster(4326, 0.0, 0.0, 1.0) }
        };
        assert_eq!(found(&wide(80.0), None), Some(5041), "wider than a zone");
        assert!(metric_crs(&wide(70.0), None).is_err(), "wider than a zone, too far from the pole");
        // Nodes lie on the pole: the border of their cells lies beyond it.
        assert_eq!(degrees(-180.05, 90.05, 0.1), Some(5041));
        // The pole in the polar systems of maps, which are 3 % shorter there.
        for (code, ups) in [(3413, 5041), (3995, 5041), (3031, 5042)] {
            let polar = raster(code, -150_000.0, 150_000.0, 100_000.0);
            assert_eq!(found(&polar, None), Some(ups), "EPSG:{code}");
            let note = off_scale(&polar, None).expect("metric").expect("off").to_string();
            assert!(note.contains("shorter") && note.contains(&format!("EPSG:{ups}")), "{note}");
        }
    }

    #[test]
    fn what_no_zone_covers_stays_and_is_reported() {
        // Half of Greenland in the polar system, 3 % longer at 62 degrees north.
        let wide = raster(3413, 0.0, -2_000_000.0, 500_000.0);
        assert_eq!(found(&wide, None), Some(3413));
        let note = off_scale(&wide, None).expect("metric").expect("off").to_string();
        assert!(note.contains("no UTM zone"), "{note}");
    }
}
