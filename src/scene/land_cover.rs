//! The elevations at which land cover changes by latitude: the tree line and the snow line.
//!
//! Both follow the profiles along the Americas, Europe and Africa that Körner (1998) compiled: no trend between 32° N
//! and 20° S, then a fall of about 110 m for each degree of latitude. Mountains far from the sea differ by some hundred
//! meters, so colors change over [`TRANSITION_M`] and not at a line.

use sandtable_geom::profile::value_at;

/// Degrees of latitude on either side of the equator.
const LATITUDES_DEG: [f64; 7] = [0.0, 20.0, 32.0, 45.0, 55.0, 70.0, 90.0];
/// Elevations in meters above which no trees grow.
const TREE_LINES_M: [f64; 7] = [3900.0, 3900.0, 3700.0, 2200.0, 1500.0, 300.0, 0.0];
/// Elevations in meters above which snow lies all year.
const SNOW_LINES_M: [f64; 7] = [4900.0, 5400.0, 5000.0, 3000.0, 2100.0, 800.0, 0.0];

/// The latitude in degrees that a scene without a place on Earth is taken to have.
const MIDDLE_DEG: f64 = 45.0;

/// The height in meters over which one cover gives way to the next: narrower bands look like lines, wider ones lie.
pub const TRANSITION_M: f64 = 400.0;

/// The elevations in meters at which land cover changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoverLines {
    /// No trees grow above it.
    pub tree_m: f64,
    /// Snow lies above it all year; above the tree line.
    pub snow_m: f64,
}

impl CoverLines {
    /// The elevations for a latitude in degrees; `None` for a scene without a place on Earth.
    pub fn at(latitude_deg: Option<f64>) -> Self {
        let latitude = latitude_deg.filter(|degrees| degrees.is_finite()).unwrap_or(MIDDLE_DEG).abs();
        let line = |elevations: &[f64]| value_at(&LATITUDES_DEG, elevations, latitude);
        let tree_m = line(&TREE_LINES_M);
        Self { tree_m, snow_m: line(&SNOW_LINES_M).max(tree_m + TRANSITION_M) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_lines_fall_toward_the_poles_and_are_alike_north_and_south() {
        let lines: Vec<CoverLines> = (25..=90).map(|degrees| CoverLines::at(Some(degrees.into()))).collect();
        let falls = |of: fn(&CoverLines) -> f64| lines.windows(2).all(|pair| of(&pair[1]) <= of(&pair[0]));
        assert!(falls(|lines| lines.tree_m) && falls(|lines| lines.snow_m));
        assert_eq!(CoverLines::at(Some(-36.0)), CoverLines::at(Some(36.0)));
    }

    #[test]
    fn the_alps_have_snow_above_three_thousand_meters_and_tennessee_has_none() {
        let alps = CoverLines::at(Some(46.5));
        assert!((2700.0..3100.0).contains(&alps.snow_m) && (1900.0..2300.0).contains(&alps.tree_m));
        assert!(CoverLines::at(Some(36.3)).snow_m > 4000.0);
        assert_eq!(CoverLines::at(None), CoverLines::at(Some(45.0)));
        assert_eq!(CoverLines::at(Some(f64::NAN)), CoverLines::at(None));
    }
}
