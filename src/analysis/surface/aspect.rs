//! The aspect of the ground: the azimuth toward which a post's ground falls, as `gdaldem aspect` gives it.
//!
//! Differences of heights are added up without rounding. `gdaldem` rounds their sums to f32 and is off by more than 1e-5° where
//! the ground is nearly level: by up to a degree where heights have many digits.

use super::window::{GradientMethod, WindowGradient, by_window};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use sandtable_terrain::stop_flag::StopFlag;

/// The aspect at each post, degrees clockwise from the grid's north, 0 to below 360; no data on level ground, at the
/// border and beside posts without data.
///
/// # Errors
/// None but [`AnalysisError::Stopped`].
pub(crate) fn aspect(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let gradient = WindowGradient::new(&land.ground, GradientMethod::of(&arguments.word("method")));
    let values = by_window(&land.ground, stop, |window| azimuth(gradient.exact(window)))?;
    let raster =
        OutcomeRaster { name: "aspect", unit: "°", values: PostValues::Numbers(values), classes: classes() };
    Ok(Outcome { raster: Some(raster), ..Outcome::default() })
}

/// The azimuth of the fall in degrees, 0 to below 360; NaN for level ground.
fn azimuth([east, north]: [f64; 2]) -> f32 {
    if east == 0.0 && north == 0.0 {
        return f32::NAN;
    }
    let degrees = libm::atan2(-east, -north).to_degrees();
    let turned = (if degrees < 0.0 { degrees + 360.0 } else { degrees }) as f32;
    // An azimuth just west of north may round to 360, and due north may be −0.
    if turned >= 360.0 { 0.0 } else { turned + 0.0 }
}

/// The eight winds; north is there twice.
fn classes() -> Vec<ValueClass> {
    let rows = [
        (0.0, "north", [70, 110, 190, 110]),
        (22.5, "north-east", [90, 160, 190, 110]),
        (67.5, "east", [130, 190, 130, 110]),
        (112.5, "south-east", [215, 200, 90, 110]),
        (157.5, "south", [225, 140, 60, 110]),
        (202.5, "south-west", [205, 95, 85, 110]),
        (247.5, "west", [165, 95, 150, 110]),
        (292.5, "north-west", [110, 90, 175, 110]),
        (337.5, "north", [70, 110, 190, 110]),
    ];
    ValueClass::of_rows(rows.map(|(from, label, tint)| (from, label, tint, Hatching::None)))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::window::tests::{land, values};

    #[test]
    fn ground_that_falls_toward_each_wind_has_its_azimuth_and_level_ground_none() {
        let plane = |east: f32, north: f32| {
            let heights =
                (0..9u8).map(|index| f32::from(index % 3) * 10.0 * east + f32::from(index / 3) * 5.0 * north);
            values(&land(DVec2::new(10.0, 5.0), 3, heights.collect()), "aspect", &[], &[])[4]
        };
        let falls = [(0.0, -1.0, 0.0), (-1.0, -1.0, 45.0), (-1.0, 0.0, 90.0), (-1.0, 1.0, 135.0)];
        let rises = [(0.0, 1.0, 180.0), (1.0, 1.0, 225.0), (1.0, 0.0, 270.0), (1.0, -1.0, 315.0)];
        for (east, north, azimuth) in falls.into_iter().chain(rises) {
            assert_eq!(plane(east, north), azimuth, "{east} {north}");
        }
        assert!(plane(0.0, 0.0).is_nan());
    }

    #[test]
    fn on_nearly_level_ground_high_above_the_sea_no_digit_of_the_fall_is_lost() {
        // The last digits of f32 at 3 km: the sums of three such heights have none of them.
        let step = 3000.0_f32.next_up() - 3000.0;
        let falls: [u8; 9] = [3, 1, 2, 5, 4, 7, 6, 9, 8];
        let heights = falls.map(|steps| 3000.0 + f32::from(steps) * step).to_vec();
        let (east, north) =
            (2.0 + 2.0 * 7.0 + 8.0 - (3.0 + 2.0 * 5.0 + 6.0), 6.0 + 18.0 + 8.0 - (3.0 + 2.0 + 2.0));
        let wanted = libm::atan2(-east, -north).to_degrees() + 360.0;
        let found = f64::from(values(&land(DVec2::splat(10.0), 3, heights), "aspect", &[], &[])[4]);
        assert!((found - wanted).abs() < 2e-5, "{found} {wanted}");
    }
}
