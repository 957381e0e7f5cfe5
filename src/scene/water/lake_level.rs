//! The level of a lake, and levels that no lake has: far from all ground along the shore.

use glam::DVec2;

/// A level farther than this from all ground along the shore is a slip of the pen, or in another unit or of another datum,
/// meters. Vertical datums differ by up to this, elevation models are off by a tenth of it.
const ABSURD_M: f64 = 100.0;

/// A lake's outline in world coordinates with its level in meters.
#[derive(Clone, Debug, PartialEq)]
pub struct LakeSurface {
    /// Its outer shore.
    pub outline: Vec<DVec2>,
    /// Of the water.
    pub level_m: f64,
    /// Whether the scene states it.
    pub is_stated: bool,
}

/// The height of a level above the highest ground along its shore, or below the lowest (then negative), in meters, if it
/// is too great to be meant.
pub fn far_off_m(level_m: f64, [lowest_m, highest_m]: [f64; 2]) -> Option<f64> {
    let off_m = (level_m - lowest_m).min(0.0) + (level_m - highest_m).max(0.0);
    (off_m.abs() > ABSURD_M).then_some(off_m)
}

/// The message about such a lake.
pub fn far_off_message(lake: &str, level_m: f64, shore_m: [f64; 2], off_m: f64) -> String {
    let (side, [lowest_m, highest_m]) = (if off_m < 0.0 { "below" } else { "above" }, shore_m);
    format!(
        "{lake} lies level at {level_m:.0} m, {:.0} m {side} all ground along its shore, which is {lowest_m:.0} to \
         {highest_m:.0} m high",
        off_m.abs()
    )
}

/// The remedy.
pub const FAR_OFF_HELP: &str =
    "state its `level` in meters as the elevation model counts them, or remove it: the shore gives one";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_far_off_below_and_above_its_shore() {
        assert_eq!(far_off_m(-5000.0, [100.0, 130.0]), Some(-5100.0));
        assert_eq!(far_off_m(1030.0, [100.0, 130.0]), Some(900.0));
        assert_eq!([20.0, 100.0, 115.0, 229.0].map(|level_m| far_off_m(level_m, [100.0, 130.0])), [None; 4]);
    }
}
