//! Natural land cover: meadow, scree, rock and snow by elevation, slope and aspect, as tints over the ramp's.
//!
//! Trees end at the tree line and snow begins at the snow line, both higher on slopes toward the equator. Scree lies up to
//! its angle of repose, about 36°; what is steeper is rock, and holds no snow. Value noise of three wavelengths in the
//! world moves all borders, so that they look grown and not drawn. Each cover keeps the tint's luminance but for a factor
//! that is at most 6 of lightness L*: relief and tint by height stay readable.

use glam::{FloatExt, Vec2, Vec3};

use crate::color::luminance;
use crate::ground::GroundPost;
use crate::ground_grain::noise_of;

/// Wavelengths in meters with their shares of the noise: from a gully to a mountainside.
pub(crate) const WAVES: [(f32, f32); 3] = [(60.0, 0.25), (170.0, 0.35), (480.0, 0.4)];
/// How far the noise moves the borders between covers, in meters of elevation and in rise.
pub(crate) const UNEVEN_M: f32 = 160.0;
pub(crate) const UNEVEN_RISE: f32 = 0.2;
/// How much higher shady ground counts than sunny ground where it is as steep as 45°, in meters.
pub(crate) const ASPECT_M: f32 = 150.0;
/// From and to which rise scree and rock take the place of what grows.
pub(crate) const SCREE_RISE: [f32; 2] = [0.50, 0.66];
pub(crate) const ROCK_RISE: [f32; 2] = [0.78, 1.05];
/// How far below the tree line meadows begin and below the snow line they end, and half the width of the snow's border;
/// meters.
pub(crate) const MEADOW_M: [f32; 3] = [300.0, 500.0, 200.0];

/// The hues of meadow, scree, rock and snow, linear, and the factors on a tint's luminance.
pub(crate) const COVERS: [(Vec3, f32); 4] = [
    (Vec3::new(0.42, 0.55, 0.25), 0.92),
    (Vec3::new(0.56, 0.53, 0.48), 0.97),
    (Vec3::new(0.45, 0.43, 0.42), 0.80),
    (Vec3::new(0.86, 0.90, 0.97), 1.2),
];
/// The greatest share of a cover over the tint.
pub(crate) const MOST: f32 = 0.8;

/// The elevations at which covers change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundCover {
    /// The elevation of the tree line, meters.
    pub tree_m: f32,
    /// The elevation of the snow line, meters; above the tree line.
    pub snow_m: f32,
    /// The ratio of true slopes to drawn slopes; positive.
    pub true_rise: f32,
    /// 1 where the shady side is the north, −1 where it is the south.
    pub shady_north: f32,
}

impl GroundCover {
    /// The color of covered ground in linear light, over the ramp's `tint` where the map reads `post`; `uneven` is
    /// [`cover_noise`] there.
    pub fn over(&self, tint: Vec3, post: &GroundPost, uneven: f32) -> Vec3 {
        let slope = Vec2::new(post.slope_east, post.slope_north) * self.true_rise;
        let shade = (-slope.y * self.shady_north).clamp(-1.0, 1.0);
        let height = post.height_m + UNEVEN_M * uneven + ASPECT_M * shade;
        let rise = slope.length() + UNEVEN_RISE * uneven;
        let [below_trees, below_snow, half] = MEADOW_M;
        let above_trees = step(height, [self.tree_m - below_trees, self.tree_m]);
        let meadow = above_trees * (1.0 - step(height, [self.snow_m - below_snow, self.snow_m]));
        let scree = above_trees * step(rise, SCREE_RISE);
        let rock = step(rise, ROCK_RISE);
        let snow = step(height, [self.snow_m - half, self.snow_m + half]) * (1.0 - rock);
        let own = luminance(tint);
        let mut color = tint;
        for ((hue, light), share) in COVERS.into_iter().zip([meadow, scree, rock, snow]) {
            if share == 0.0 {
                continue;
            }
            color = color.lerp(hue * (own * light / luminance(hue)), MOST * share);
        }
        color
    }
}

/// The noise at world X and Y over a pixel `pixel_m` meters wide, -1..=1.
pub fn cover_noise(at: Vec2, pixel_m: f32) -> f32 {
    noise_of(&WAVES, at, pixel_m)
}

fn step(value: f32, [from, to]: [f32; 2]) -> f32 {
    value.smoothstep(from, to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::lightness;

    const ALPS: GroundCover =
        GroundCover { tree_m: 2100.0, snow_m: 2900.0, true_rise: 1.0, shady_north: 1.0 };
    const TINT: Vec3 = Vec3::new(0.62, 0.60, 0.45);

    fn post(height_m: f32, slope_north: f32) -> GroundPost {
        GroundPost { height_m, slope_north, ..GroundPost::default() }
    }

    #[test]
    fn no_cover_changes_lightness_by_more_than_6() {
        for height in (0..4500).step_by(50) {
            for rise in -15..15 {
                for uneven in [-1.0, 0.0, 1.0] {
                    let shown = ALPS.over(TINT, &post(height as f32, rise as f32 * 0.1), uneven);
                    let change = lightness(shown) - lightness(TINT);
                    assert!(change.abs() <= 6.0, "{height} m, rise {rise}: {change}");
                }
            }
        }
    }

    #[test]
    fn meadows_lie_over_forests_under_snow_and_walls_are_rock() {
        let seen = |height: f32, rise: f32| ALPS.over(TINT, &post(height, rise), 0.0);
        assert_eq!(seen(1000.0, 0.1), TINT, "below the tree line the ramp speaks");
        assert!(seen(2250.0, 0.1).y / seen(2250.0, 0.1).x > 1.1 * TINT.y / TINT.x, "green");
        assert!(seen(3500.0, 0.1).z > seen(3500.0, 0.1).x, "snow is cool");
        assert!(lightness(seen(1000.0, 1.5)) < lightness(TINT) - 3.0, "rock is dark");
        assert_eq!(seen(3500.0, 1.5), seen(4500.0, 1.5), "and holds no snow");
        assert!(seen(2900.0, -0.4).z > seen(2900.0, 0.4).z, "shady slopes keep snow longer");
    }
}
