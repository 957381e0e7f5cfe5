//! Directions of azimuths, and azimuths of directions.

use glam::DVec2;

/// The unit vector in plan, east and north, of an azimuth in radians, clockwise from north.
///
/// ```
/// use sandtable_geom::azimuth::toward;
/// assert_eq!(toward(0.0).to_array(), [0.0, 1.0]);
/// ```
pub fn toward(azimuth_rad: f64) -> DVec2 {
    DVec2::new(libm::sin(azimuth_rad), libm::cos(azimuth_rad))
}

/// [`toward`] of an azimuth in degrees.
pub fn heading(azimuth_deg: f64) -> DVec2 {
    toward(azimuth_deg.to_radians())
}

/// The azimuth of a direction, east and north, in degrees clockwise from north, 0..=360; 0 of none.
pub fn azimuth_deg(direction: DVec2) -> f64 {
    libm::atan2(direction.x, direction.y).to_degrees().rem_euclid(360.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_turn_clockwise_from_north() {
        for (azimuth_deg, wanted) in
            [(0.0, DVec2::Y), (90.0, DVec2::X), (180.0, -DVec2::Y), (-90.0, -DVec2::X)]
        {
            assert!(heading(azimuth_deg).distance(wanted) < 1e-15, "{azimuth_deg}");
            assert_eq!(super::azimuth_deg(wanted), azimuth_deg.rem_euclid(360.0));
        }
    }
}
