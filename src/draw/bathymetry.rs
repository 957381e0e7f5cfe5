//! The color of water by its depth, in meters below 0 and the same on every map.
//!
//! As in hypsometric tints below sea level, each stop is darker than the one above it, so that depth reads as depth and
//! never as shade: L* falls from 60 at the surface to 19 in a deep-sea trench. The stops lie close together on the
//! shelf, where most models of sea have their forms, and far apart in the deep sea.

use std::sync::LazyLock;

use glam::Vec3;

use crate::color::Srgba;
use crate::ground::ColorRamp;
use crate::water::WaterColor;

/// The number of stops.
pub const STOP_COUNT: usize = 9;

/// Heights of the bed in meters, rising, and the colors of the water over them. −200 m is the edge of the shelf, −4000 m
/// the deep-sea plain, and below −6000 m lie trenches.
const STOPS: [(f32, Srgba); STOP_COUNT] = [
    (-9000.0, Srgba::opaque(18, 46, 86)),
    (-6000.0, Srgba::opaque(25, 60, 104)),
    (-4000.0, Srgba::opaque(33, 74, 122)),
    (-2000.0, Srgba::opaque(43, 90, 141)),
    (-1000.0, Srgba::opaque(52, 103, 154)),
    (-500.0, Srgba::opaque(62, 116, 165)),
    (-200.0, Srgba::opaque(72, 129, 175)),
    (-50.0, Srgba::opaque(84, 142, 184)),
    (0.0, WaterColor::SURFACE),
];

/// The ramp; above 0 it keeps the color of the surface.
pub fn bathymetry() -> &'static ColorRamp {
    static RAMP: LazyLock<ColorRamp> =
        LazyLock::new(|| ColorRamp::new(STOPS.to_vec()).expect("the heights rise"));
    &RAMP
}

/// `land` with [`bathymetry`] in place of its colors below `shore_m` meters: the meaning of colors on a map with a sea.
pub fn with_bathymetry(land: &ColorRamp, shore_m: f32) -> ColorRamp {
    /// How far below the shore the water begins, meters: less than any legend shows, and a share of the height, since
    /// numbers are of 24 bits.
    const BELOW: f32 = 1e-3;
    let surface_m = shore_m - BELOW * (shore_m.abs() * 1e-3).max(1.0);
    let color = |light: Vec3| Srgba::from_linear(light);
    let water = STOPS.iter().copied().filter(|stop| stop.0 < surface_m);
    let surface = (surface_m, color(bathymetry().linear_at(shore_m)));
    let shore = (shore_m, color(land.linear_at(shore_m)));
    let above =
        land.stops().iter().filter(|stop| stop.0 > shore_m).map(|&(height, light)| (height, color(light)));
    ColorRamp::new(water.chain([surface, shore]).chain(above).collect()).expect("the heights rise")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::lightness;

    #[test]
    fn deeper_water_is_darker_at_every_depth() {
        let lightness: Vec<f32> =
            (0..=900).map(|step| lightness(bathymetry().linear_at(-10.0 * step as f32))).collect();
        assert!(lightness.windows(2).all(|pair| pair[1] < pair[0]), "{lightness:?}");
        assert!(lightness[0] > 58.0 && lightness[900] > 15.0);
    }

    #[test]
    fn a_map_with_a_sea_has_depths_below_0_and_its_own_tints_above() {
        let land =
            ColorRamp::new(vec![(-30.0, Srgba::WHITE), (40.0, Srgba::opaque(9, 9, 9))]).expect("rising");
        let both = with_bathymetry(&land, 0.0);
        assert_eq!(both.linear_at(-1000.0), Srgba::opaque(52, 103, 154).linear());
        assert!(both.linear_at(-0.01).abs_diff_eq(WaterColor::SURFACE.linear(), 1e-3));
        assert!(both.linear_at(20.0).abs_diff_eq(land.linear_at(20.0), 0.01));
        for shore_m in [-1e7, -9000.0, -28.0, 12.5, 1e7] {
            let both = with_bathymetry(&land, shore_m);
            // Colors of stops are of 8 bits.
            assert!(both.linear_at(shore_m).abs_diff_eq(land.linear_at(shore_m), 5e-3), "{shore_m}");
            let below = both.linear_at(shore_m - shore_m.abs() * 1e-5 - 1.0);
            assert!(below.abs_diff_eq(bathymetry().linear_at(shore_m), 0.02), "{shore_m}: {below}");
        }
    }
}
