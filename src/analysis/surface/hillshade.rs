//! Hillshading: how directly the ground faces the sun, by the formula of `gdaldem hillshade`.

use super::window::{GradientMethod, WindowGradient, by_window};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use sandtable_terrain::stop_flag::StopFlag;

/// The azimuths of multidirectional light, degrees.
const AZIMUTHS_DEG: [f64; 4] = [225.0, 270.0, 315.0, 360.0];

/// The light on each post, 1 where the ground faces away from the sun to 255 where it faces it, not rounded; no data at
/// the border and beside posts without data.
///
/// With the unit normal n of the slopes and the direction s to the sun, it is `1 + 254 · max(0, n · s)`. Multidirectional light
/// is half the sum over four azimuths α of that, each weighted by `cos²(aspect − α)`, which are 2 in all (Mark 1992, as `gdaldem`
/// has it); on level ground that of one sun.
///
/// # Errors
/// None but [`AnalysisError::Stopped`].
pub(crate) fn hillshade(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let gradient = WindowGradient::new(&land.ground, GradientMethod::of(&arguments.word("method")));
    let altitude = arguments.number("altitude").to_radians();
    let stretch = arguments.number("exaggeration") as f32;
    let values = if arguments.word("light") == "multidirectional" {
        let suns = AZIMUTHS_DEG.map(|azimuth| ShadingSun::new(azimuth.to_radians(), altitude));
        by_window(&land.ground, stop, |window| {
            let slopes = gradient.of(window).map(|slope| slope * stretch);
            from_four(&suns, slopes)
        })?
    } else {
        let sun = ShadingSun::new(arguments.number("azimuth").to_radians(), altitude);
        by_window(&land.ground, stop, |window| {
            let slopes = gradient.of(window).map(|slope| slope * stretch);
            1.0 + 254.0 * (sun.facing(slopes) / stretched(slopes))
        })?
    };
    let raster = OutcomeRaster {
        name: "hillshade",
        unit: "",
        values: PostValues::Numbers(values),
        classes: classes(),
    };
    Ok(Outcome { raster: Some(raster), ..Outcome::default() })
}

/// Grays, the lighter the more light.
fn classes() -> Vec<ValueClass> {
    const CLASSES: u8 = 8;
    const STEP: u8 = 32;
    let class = |index: u8| {
        let (from, gray) = (index * STEP, index * STEP + STEP / 2);
        let label = format!("{} to {}", from.max(1), from + (STEP - 1));
        ValueClass::new(f32::from(from), label, [gray, gray, gray, 225], Hatching::None)
    };
    (0..CLASSES).map(class).collect()
}

/// A direction from which light comes.
#[derive(Clone, Copy)]
struct ShadingSun {
    /// The direction to it.
    east: f32,
    north: f32,
    up: f32,
    /// Its azimuth as a direction in plan.
    azimuth: [f32; 2],
}

impl ShadingSun {
    fn new(azimuth: f64, altitude: f64) -> Self {
        let (level, plan) = (libm::cos(altitude), [libm::sin(azimuth), libm::cos(azimuth)]);
        Self {
            east: (level * plan[0]) as f32,
            north: (level * plan[1]) as f32,
            up: libm::sin(altitude) as f32,
            azimuth: plan.map(|part| part as f32),
        }
    }

    /// How directly ground with these slopes faces it, times the length of its normal; 0 where it faces away.
    #[inline(always)]
    fn facing(&self, [east, north]: [f32; 2]) -> f32 {
        (self.up - east * self.east - north * self.north).max(0.0)
    }
}

/// The length of the normal of ground with these slopes whose rise is 1.
#[inline(always)]
fn stretched([east, north]: [f32; 2]) -> f32 {
    (1.0 + east * east + north * north).sqrt()
}

/// The light of four suns.
#[inline(always)]
fn from_four(suns: &[ShadingSun; 4], slopes: [f32; 2]) -> f32 {
    let [east, north] = slopes;
    let steepness = east * east + north * north;
    if steepness == 0.0 {
        return 1.0 + 254.0 * suns[0].up;
    }
    // The cosine of the angle between the fall line and an azimuth, times the slope.
    let along = |sun: &ShadingSun| east * sun.azimuth[0] + north * sun.azimuth[1];
    let weighted = suns.iter().map(|sun| along(sun) * along(sun) * sun.facing(slopes)).sum::<f32>();
    1.0 + 127.0 * weighted / (steepness * stretched(slopes))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::window::tests::{land, values};

    #[test]
    fn level_ground_has_the_light_of_one_sun_and_a_slope_that_of_those_it_faces() {
        let light = |heights: [f32; 9]| {
            let land = land(DVec2::splat(10.0), 3, heights.to_vec());
            values(&land, "hillshade", &[("light", "multidirectional")], &[("altitude", 30.0)])[4]
        };
        assert_eq!(light([5.0; 9]), 128.0);
        // Falls to the west at 45°: all of the light from 270°, none from 360°, half of that from 225° and from 315°.
        let (facing, aslant) = (0.5 + 0.75f32.sqrt(), 0.5 + 0.75f32.sqrt() * 0.5f32.sqrt());
        let wanted = 1.0 + 127.0 * (facing + aslant) / 2f32.sqrt();
        let found = light([0.0, 10.0, 20.0, 0.0, 10.0, 20.0, 0.0, 10.0, 20.0]);
        assert!((found - wanted).abs() < 1e-3, "{found} {wanted}");
    }
}
