//! Hillshading: how directly the ground faces the sun, by the formula of `gdaldem hillshade`.

use super::window::{GradientMethod, WindowGradient, by_window};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Outcome, OutcomeRaster, PostValues};
use sandtable_terrain::stop_flag::StopFlag;

/// The light on each post, 1 where the ground faces away from the sun to 255 where it faces it, not rounded; no data at
/// the border and beside posts without data.
///
/// With the unit normal n of the slopes and the direction s to the sun, it is `1 + 254 · max(0, n · s)`.
///
/// # Errors
/// None but [`AnalysisError::Stopped`].
pub(crate) fn hillshade(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let gradient = WindowGradient::new(&land.ground, GradientMethod::of(&arguments.word("method")));
    let (azimuth, altitude) =
        (arguments.number("azimuth").to_radians(), arguments.number("altitude").to_radians());
    let stretch = arguments.number("exaggeration") as f32;
    let level = libm::cos(altitude);
    let (sun_east, sun_north) = ((level * libm::sin(azimuth)) as f32, (level * libm::cos(azimuth)) as f32);
    let sun_up = libm::sin(altitude) as f32;
    let values = by_window(&land.ground, stop, |window| {
        let [east, north] = gradient.of(window).map(|slope| slope * stretch);
        let facing = sun_up - east * sun_east - north * sun_north;
        1.0 + 254.0 * (facing / (1.0 + east * east + north * north).sqrt()).max(0.0)
    })?;
    let raster = OutcomeRaster {
        name: "hillshade",
        unit: "",
        values: PostValues::Numbers(values),
        classes: Vec::new(),
    };
    Ok(Outcome { raster: Some(raster), ..Outcome::default() })
}
