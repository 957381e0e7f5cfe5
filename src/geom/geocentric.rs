//! Geocentric coordinates on WGS 84: meters from the Earth's center along axes to the equator at Greenwich (X), to the
//! equator at 90° E (Y) and to the north pole (Z).

use glam::{DVec2, DVec3};

/// Equatorial radius of WGS 84 in meters.
const EQUATORIAL_M: f64 = 6_378_137.0;
/// Flattening of WGS 84.
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// As far from the surface as the formula keeps a millimeter, and farther than anything on a map.
const MOST_HEIGHT_M: f64 = 1e6;

/// A place and its height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeodeticPlace {
    /// Longitude (x) and latitude (y) on WGS 84, degrees.
    pub lonlat: DVec2,
    /// Meters above the ellipsoid, not above sea level.
    pub height_m: f64,
}

/// Returns the place of geocentric coordinates in meters (Bowring 1985, to less than a micrometer near the surface); `None`
/// where they lie more than 1000 km off the Earth's surface or are no numbers.
///
/// ```
/// use glam::{DVec2, DVec3};
/// use sandtable_geom::geocentric::place_of;
///
/// let greenwich = place_of(DVec3::new(6_378_137.0, 0.0, 0.0)).unwrap();
/// assert_eq!((greenwich.lonlat, greenwich.height_m), (DVec2::ZERO, 0.0));
/// ```
pub fn place_of(at: DVec3) -> Option<GeodeticPlace> {
    let polar_m = EQUATORIAL_M * (1.0 - FLATTENING);
    let eccentricity = FLATTENING * (2.0 - FLATTENING);
    let second = eccentricity / (1.0 - eccentricity);
    let (from_center, from_axis) = (at.length(), at.truncate().length());
    if !at.is_finite() || (from_center - EQUATORIAL_M).abs() > MOST_HEIGHT_M {
        return None;
    }
    let reduced =
        libm::atan2(polar_m * at.z * (1.0 + second * polar_m / from_center), EQUATORIAL_M * from_axis);
    let (sin, cos) = (libm::sin(reduced), libm::cos(reduced));
    let latitude = libm::atan2(
        at.z + second * polar_m * sin.powi(3),
        from_axis - eccentricity * EQUATORIAL_M * cos.powi(3),
    );
    let (sin, cos) = (libm::sin(latitude), libm::cos(latitude));
    let height_m = from_axis * cos + at.z * sin - EQUATORIAL_M * (1.0 - eccentricity * sin * sin).sqrt();
    let longitude = libm::atan2(at.y, at.x);
    Some(GeodeticPlace { lonlat: DVec2::new(longitude.to_degrees(), latitude.to_degrees()), height_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn geocentric(longitude: f64, latitude: f64, height_m: f64) -> DVec3 {
        let (lon, lat) = (longitude.to_radians(), latitude.to_radians());
        let eccentricity = FLATTENING * (2.0 - FLATTENING);
        let normal_m = EQUATORIAL_M / (1.0 - eccentricity * lat.sin().powi(2)).sqrt();
        DVec3::new(
            (normal_m + height_m) * lat.cos() * lon.cos(),
            (normal_m + height_m) * lat.cos() * lon.sin(),
            (normal_m * (1.0 - eccentricity) + height_m) * lat.sin(),
        )
    }

    #[test]
    fn places_come_back_from_their_geocentric_coordinates() {
        for longitude in [-179.5, -84.2, 0.0, 15.04, 90.0, 180.0] {
            for latitude in [-90.0, -51.7, -1e-9, 0.0, 36.3, 58.5, 89.999, 90.0] {
                for height_m in [-400.0, 0.0, 137.7, 8848.0, 30_000.0] {
                    let place = place_of(geocentric(longitude, latitude, height_m)).expect("near the ground");
                    assert!((place.lonlat.y - latitude).abs() < 1e-10, "{latitude}: {place:?}");
                    assert!((place.height_m - height_m).abs() < 1e-5, "{height_m}: {place:?}");
                    let at_pole = latitude.abs() == 90.0;
                    assert!(at_pole || (place.lonlat.x - longitude).abs() < 1e-10, "{longitude}: {place:?}");
                }
            }
        }
    }

    #[test]
    fn coordinates_off_the_earth_have_no_place() {
        for at in [DVec3::ZERO, DVec3::splat(1e7), DVec3::new(f64::NAN, 0.0, 6.4e6), DVec3::splat(f64::MAX)] {
            assert_eq!(place_of(at), None, "{at}");
        }
    }
}
