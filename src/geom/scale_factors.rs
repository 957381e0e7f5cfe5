//! The scale of a coordinate reference system at a place: lengths on its map over lengths on the ellipsoid.
//!
//! A map projection stretches lengths, by another factor at every place and, unless it is conformal, in every direction. The
//! least and the largest factor are the axes of Tissot's indicatrix (Snyder 1987, *Map projections: a working manual*, USGS
//! Professional Paper 1395, pages 20 to 27). They are measured here, for any projection: the inverse projection of four
//! points around the place gives the derivative of the ground by the map.

use glam::{DMat2, DVec2, DVec3};

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
        let ellipsoid = degrees.ellipsoid();
        // What a meter of the map along an axis is on the ground, in space: at a pole it has no direction.
        let column = |axis: DVec2| {
            let place = |by: f64| Some(in_space(ellipsoid, crs.transform(&degrees, at + axis * by).ok()?));
            Some((place(step)? - place(-step)?) / (2.0 * MEASURED_M))
        };
        let (x, y) = (column(DVec2::X)?, column(DVec2::Y)?);
        let along = x.try_normalize()?;
        let across = (y - along * y.dot(along)).length();
        let matrix = DMat2::from_cols(DVec2::new(x.length(), 0.0), DVec2::new(y.dot(along), across));
        let (largest, smallest) = singular_values(matrix);
        let scale = Self { least: 1.0 / largest, most: 1.0 / smallest };
        (scale.least > 0.0 && scale.most.is_finite()).then_some(scale)
    }

    /// The largest error of a length on the map, as a share of the length on the ellipsoid.
    pub fn error(self) -> f64 {
        (self.most - 1.0).abs().max((self.least - 1.0).abs())
    }
}

/// Where a longitude and a latitude in degrees lie on an ellipsoid: meters from its center.
fn in_space((major_m, minor_m): (f64, f64), at: DVec2) -> DVec3 {
    let (longitude, latitude) = (at.x.to_radians(), at.y.to_radians());
    let flat2 = (minor_m / major_m).powi(2);
    let (sin, cos) = (libm::sin(latitude), libm::cos(latitude));
    let across_m = major_m / (cos * cos + flat2 * sin * sin).sqrt();
    DVec3::new(cos * libm::cos(longitude), cos * libm::sin(longitude), flat2 * sin) * across_m
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
    fn a_pole_has_a_scale_though_it_has_no_direction() {
        // Of UPS by its definition; of EPSG:3413 the ratio of Snyder 1987, equations 21-33 and 21-34.
        for (code, at, published) in [(5041, 2e6, 0.994), (5042, 2e6, 0.994), (3413, 0.0, 0.969_858)] {
            let crs = Crs::from_epsg(code).expect("known");
            for beside in [0.0, 30.0, 5000.0] {
                let found = ScaleFactors::at(&crs, DVec2::new(at + beside, at)).expect("on Earth");
                let off = (found.least - published).abs().max((found.most - published).abs());
                assert!(off < 2e-5, "EPSG:{code} {beside}: {found:?}");
            }
        }
    }

    #[test]
    fn degrees_and_local_meters_have_no_scale() {
        assert_eq!(ScaleFactors::at(&Crs::wgs84(), DVec2::ZERO), None);
        assert_eq!(ScaleFactors::at(&Crs::local(), DVec2::ZERO), None);
        let utm = Crs::from_epsg(32616).expect("known");
        assert_eq!(ScaleFactors::at(&utm, DVec2::splat(1e300)), None);
    }
}
