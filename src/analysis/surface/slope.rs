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
        by_window(&land.ground, stop, |window| tangent(gradient.of(window)) * 100.0)?
    } else {
        by_window(&land.ground, stop, |window| libm::atanf(tangent(gradient.of(window))).to_degrees())?
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
