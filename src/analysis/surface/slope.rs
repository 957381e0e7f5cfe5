//! The slope of the ground, from the eight neighbors of a post (Horn 1981) or from four (Zevenbergen and Thorne 1987):
//! what `gdaldem slope` gives.

use super::window::{GradientMethod, WindowGradient, by_window};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use sandtable_terrain::stop_flag::StopFlag;

/// The slope at each post; no data at the border and beside posts without data.
///
/// # Errors
/// None but [`AnalysisError::Stopped`].
pub(crate) fn slope(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let gradient = WindowGradient::new(&land.ground, GradientMethod::of(&arguments.word("method")));
    let is_percent = arguments.word("unit") == "percent";
    let values = if is_percent {
        by_window(
            &land.ground,
            stop,
            #[inline(always)]
            |window| tangent(gradient.of(window)) * 100.0,
        )?
    } else {
        by_window(
            &land.ground,
            stop,
            #[inline(always)]
            |window| degrees_of(tangent(gradient.of(window))),
        )?
    };
    let unit = if is_percent { "%" } else { "°" };
    let raster = OutcomeRaster {
        name: "slope",
        unit,
        values: PostValues::Numbers(values),
        classes: classes(is_percent),
    };
    Ok(Outcome { raster: Some(raster), ..Outcome::default() })
}

#[inline(always)]
fn tangent([east, north]: [f32; 2]) -> f32 {
    (east * east + north * north).sqrt()
}

/// The angle in degrees whose tangent is given, 0 or more: within 2e-7 of it, relatively.
///
/// The polynomial and the parts of the angle are those of `atanf` of the Cephes library (Moshier 1989), without branches, so
/// that the compiler makes vectors of it.
#[inline(always)]
fn degrees_of(tangent: f32) -> f32 {
    /// tan(π/8) and tan(3π/8): between them the angle is counted from π/4, beyond from π/2.
    const TURNS: [f32; 2] = [0.414_213_56, 2.414_213_6];
    let (is_middle, is_steep) = (tangent > TURNS[0], tangent > TURNS[1]);
    let (above, below) = if is_middle { (tangent - 1.0, tangent + 1.0) } else { (tangent, 1.0) };
    let (above, below) = if is_steep { (-1.0, tangent) } else { (above, below) };
    let start = if is_middle { std::f32::consts::FRAC_PI_4 } else { 0.0 };
    let start = if is_steep { std::f32::consts::FRAC_PI_2 } else { start };
    let x = above / below;
    let z = x * x;
    let series =
        (((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1) * z * x + x;
    (start + series) * (180.0 / std::f32::consts::PI)
}

/// The classes of FM 5-33 for cross-country movement.
fn classes(is_percent: bool) -> Vec<ValueClass> {
    let rows = [
        (0.0, "0–3 %", [0, 0, 0, 0], Hatching::None),
        (3.0, "3–10 %", [255, 245, 170, 90], Hatching::None),
        (10.0, "10–20 %", [254, 217, 118, 110], Hatching::Dots),
        (20.0, "20–30 %", [253, 160, 60, 120], Hatching::Dots),
        (30.0, "30–45 %", [240, 59, 32, 130], Hatching::Single),
        (45.0, "over 45 %", [150, 0, 38, 140], Hatching::Crossed),
    ];
    let from = |percent: f32| if is_percent { percent } else { libm::atanf(percent / 100.0).to_degrees() };
    ValueClass::of_rows(rows.map(|(percent, label, tint, hatching)| (from(percent), label, tint, hatching)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_library_to_two_parts_in_ten_million() {
        let mut most = 0.0_f64;
        for step in 0..200_000 {
            let tangent = libm::exp2f(step as f32 / 5000.0 - 20.0);
            let wanted = libm::atan(f64::from(tangent)).to_degrees();
            most = most.max((f64::from(degrees_of(tangent)) / wanted - 1.0).abs());
        }
        assert!(most < 2.5e-7, "{most}");
        assert_eq!(degrees_of(0.0), 0.0);
        assert!(degrees_of(f32::NAN).is_nan() && (degrees_of(1e30) - 90.0).abs() < 1e-5);
    }
}
