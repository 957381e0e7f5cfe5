//! The scale of a coordinate reference system at a place: lengths on its map over lengths on the ellipsoid.
//!
//! A map projection stretches lengths, by another factor at every place and, unless it is conformal, in every direction. The
//! least and the largest factor are the axes of Tissot's indicatrix (Snyder 1987, *Map projections: a working manual*, USGS
//! Professional Paper 1395, pages 20 to 27). They are measured here, for any projection: the inverse projection of four
//! points around the place gives the derivative of the ground by the map.

use glam::{DMat2, DVec2};

use crate::crs::Crs;

/// Meters from the place to the points at which the projection is measured: the inverse projections end their iterations
/// within about a millimeter, which is a hundred-thousandth of this, and the curvature of the map over it is less still.
const MEASURED_M: f64 = 200.0;

/// The scale factors of a map at a place: 1 where its lengths are those of the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleFactors {
    /// In the direction in which the map stretches least; above 0.
    pub least: f64,
    /// In the direction in which the map stretches most.
    pub most: f64,
}

impl ScaleFactors {
    /// The scale of `crs` at `at`, a position in its coordinates; `None` for a system in degrees or without a place on Earth,
    /// and for a position that the projection does not cover.
    ///
    /// The ellipsoid is that of the system's datum. Web Mercator computes on a sphere with the latitudes of WGS 84, so that
    /// its lengths are measured on the ellipsoid of WGS 84.
    ///
    /// ```
    /// use glam::DVec2;
    /// use sandtable_geom::{crs::Crs, scale_factors::ScaleFactors};
    /// let utm = Crs::from_epsg(32616).unwrap();
    /// let scale = ScaleFactors::at(&utm, DVec2::new(500_000.0, 4_000_000.0)).unwrap();
    /// assert!((scale.most - 0.9996).abs() < 1e-5);
    /// ```
    pub fn at(crs: &Crs, at: DVec2) -> Option<Self> {
        let degrees = crs.geographic_base()?;
        let step = MEASURED_M / crs.meters_per_unit();
        let center = crs.transform(&degrees, at).ok()?;
        let (north_m, east_m) = meters_per_radian(degrees.ellipsoid(), center.y.to_radians());
        // The ground's meters east and north by one meter of the map along an axis.
        let column = |axis: DVec2| {
            let [behind, ahead] = [-step, step].map(|by| crs.transform(&degrees, at + axis * by));
            let turned = ahead.ok()? - behind.ok()?;
            let east = (turned.x + 540.0).rem_euclid(360.0) - 180.0;
            let radians = DVec2::new(east, turned.y) * 1f64.to_radians();
            Some(radians * DVec2::new(east_m, north_m) / (2.0 * MEASURED_M))
        };
        let (largest, smallest) = singular_values(DMat2::from_cols(column(DVec2::X)?, column(DVec2::Y)?));
        let scale = Self { least: 1.0 / largest, most: 1.0 / smallest };
        (scale.least > 0.0 && scale.most.is_finite()).then_some(scale)
    }

    /// The largest error of a length on the map, as a share of the length on the ellipsoid.
    pub fn error(self) -> f64 {
        (self.most - 1.0).abs().max((self.least - 1.0).abs())
    }
}

/// Meters on an ellipsoid for a radian of latitude and of longitude, at a latitude in radians.
fn meters_per_radian((major_m, minor_m): (f64, f64), latitude: f64) -> (f64, f64) {
    let eccentricity2 = 1.0 - (minor_m / major_m).powi(2);
    let shrunk = 1.0 - eccentricity2 * libm::sin(latitude).powi(2);
    let across_m = major_m / shrunk.sqrt();
    (across_m * (1.0 - eccentricity2) / shrunk, across_m * libm::cos(latitude))
}

/// The larger and the smaller singular value.
fn singular_values(matrix: DMat2) -> (f64, f64) {
    let DMat2 { x_axis: a, y_axis: b } = matrix;
    let sum = DVec2::new(a.x + b.y, a.y - b.x).length();
    let difference = DVec2::new(a.x - b.y, a.y + b.x).length();
    ((sum + difference) / 2.0, (sum - difference).abs() / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(code: u32, longitude: f64, latitude: f64) -> ScaleFactors {
        let crs = Crs::from_epsg(code).expect("known");
        let degrees = crs.geographic_base().expect("on Earth");
        let at = degrees.transform(&crs, DVec2::new(longitude, latitude)).expect("inside");
        ScaleFactors::at(&crs, at).expect("inside")
    }

    #[test]
    fn mercator_stretches_by_the_secant_of_the_latitude() {
        for latitude in [0.0f64, 30.0, -45.0, 60.0, 75.0] {
            let (sine, cosine) = latitude.to_radians().sin_cos();
            // Snyder 1987, equation 7-8.
            let published = (1.0 - 0.006_694_379_99 * sine * sine).sqrt() / cosine;
            let found = scale(3395, 12.0, latitude);
            assert!((found.least / published - 1.0).abs() < 2e-5, "{latitude}: {found:?}, {published}");
            assert!((found.most / published - 1.0).abs() < 2e-5, "{latitude}: {found:?}, {published}");
            // Web Mercator is the sphere's: 1/cos φ by the ellipsoid's own radii, which differ from the sphere's.
            let web = scale(3857, 12.0, latitude);
            let secant = 1.0 / cosine;
            assert!((web.least / secant - 1.0).abs() < 0.007, "{latitude}: {web:?}, {secant}");
            assert!((web.most / secant - 1.0).abs() < 0.007, "{latitude}: {web:?}, {secant}");
        }
    }

    #[test]
    fn utm_shrinks_its_central_meridian_and_is_true_180_km_beside_it() {
        let central = scale(32616, -87.0, 45.0);
        assert!((central.least - 0.9996).abs() < 1e-5 && (central.most - 0.9996).abs() < 1e-5, "{central:?}");
        let crs = Crs::from_epsg(32616).expect("known");
        let beside = ScaleFactors::at(&crs, DVec2::new(680_000.0, 3_000_000.0)).expect("inside");
        assert!((beside.most - 1.0).abs() < 1e-4, "{beside:?}");
    }

    #[test]
    fn an_equal_area_map_stretches_one_way_as_it_shrinks_the_other() {
        // Lambert's azimuthal map 20 degrees from its center: the factors are cos 10° and its reciprocal (Snyder 1987,
        // equations 24-1 to 24-3), but for the ellipsoid.
        let found = scale(3035, 10.0, 32.0);
        let published = 10f64.to_radians().cos();
        assert!((found.least - published).abs() < 3e-3, "{found:?}, {published}");
        assert!((found.least * found.most - 1.0).abs() < 1e-4, "{found:?}");
        assert!(found.error() > 0.01);
    }

    #[test]
    fn feet_and_datums_without_a_shift_are_measured_too() {
        let feet = Crs::from_epsg(2225).expect("known");
        let found = ScaleFactors::at(&feet, DVec2::new(6_500_000.0, 2_000_000.0)).expect("inside");
        assert!(found.error() < 1e-3, "{found:?}");
        let old = Crs::from_epsg(26711).expect("known");
        let found = ScaleFactors::at(&old, DVec2::new(500_000.0, 4_000_000.0)).expect("inside");
        assert!((found.most - 0.9996).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn degrees_and_local_meters_have_no_scale() {
        assert_eq!(ScaleFactors::at(&Crs::wgs84(), DVec2::ZERO), None);
        assert_eq!(ScaleFactors::at(&Crs::local(), DVec2::ZERO), None);
        let utm = Crs::from_epsg(32616).expect("known");
        assert_eq!(ScaleFactors::at(&utm, DVec2::splat(1e300)), None);
    }
}
