//! The haze of a view: how much of it depends on what the view is for.
//!
//! Haze counts from the near edge of the scene, so that a distant camera does not veil all of it. An overview shows the
//! far edge nearly as clear as the near one; where the horizon is in view, haze gives depth, and begins at a quarter of it, so
//! that the foreground keeps all of its contrast and the distance opens behind it; a plan has none, and neither
//! has a picture by parallel rays, which come from no distance.

use glam::Vec3;

use crate::setting::PictureSetting;
use sandtable_draw::lighting::Haze;
use sandtable_geom::aabb::Aabb;
use sandtable_view::camera::Camera;

/// The share of a depth, of the scene's or of the stated distance, in which the air is clear: less veils what is nearest, more
/// leaves the middle ground no depth.
const CLEAR_DEPTH: f32 = 0.25;
/// Transmittance at the far edge of the scene in a view from above.
const OVERVIEW_CLEAR: f32 = 0.94;
/// Transmittance at the far edge of the scene where the horizon shows.
const HORIZON_CLEAR: f32 = 0.62;

/// The haze of `color` for a camera over the box of the scene. `stated_m` is the distance in
/// meters from the near edge at which 63 % is haze, of which the first quarter is clear, 0 for clear air; `None` fits it to the
/// picture's `setting`.
pub(super) fn haze(
    color: Vec3,
    stated_m: Option<f32>,
    camera: &Camera,
    scene: Aabb,
    setting: PictureSetting,
) -> Haze {
    let eye = camera.eye();
    let near_m = eye.distance(scene.nearest_to(eye));
    let depth_m = eye.distance(scene.farthest_from(eye)) - near_m;
    let is_parallel = camera.parallel_frame().is_some();
    // How deep the air is looked into, its optical depth there, and the share of it that is clear.
    let (reach_m, depth, clear) = match (stated_m, setting) {
        _ if is_parallel => (0.0, 1.0, 0.0),
        (Some(stated_m), _) => (stated_m, 1.0, CLEAR_DEPTH),
        (None, PictureSetting::Plan) => (0.0, 1.0, 0.0),
        (None, PictureSetting::Landscape) => (depth_m, -libm::logf(HORIZON_CLEAR), CLEAR_DEPTH),
        // So little haze veils nothing.
        (None, _) => (depth_m, -libm::logf(OVERVIEW_CLEAR), 0.0),
    };
    if reach_m <= 0.0 {
        return Haze { color, near_m, distance_m: f32::INFINITY };
    }
    let near_m = near_m + clear * reach_m;
    let distance_m = (1.0 - clear) * reach_m / depth;
    Haze { color, near_m, distance_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIN: Vec3 = Vec3::ZERO;
    const MAX: Vec3 = Vec3::new(10_000.0, 8000.0, 900.0);

    /// The share of the light from the farthest corner that a camera at `eye` receives.
    fn clear(eye: Vec3, target: Vec3, stated_m: Option<f32>) -> f32 {
        let camera = Camera::new(eye, target, 0.5, (160, 90), (1.0, 1e6)).expect("sound");
        let setting = PictureSetting::new(&camera, (MIN, MAX));
        let haze = haze(Vec3::ONE, stated_m, &camera, Aabb { min: MIN, max: MAX }, setting);
        let corners = [0.0, 1.0].map(|x| [0.0, 1.0].map(|y| eye.distance(MAX * Vec3::new(x, y, 0.0))));
        let farthest = corners.into_iter().flatten().fold(0.0, f32::max);
        libm::expf(-(farthest - haze.near_m) / haze.distance_m)
    }

    #[test]
    fn an_overview_is_clear_and_a_horizon_is_hazy_and_a_plan_has_no_haze() {
        let middle = MAX / 2.0;
        let overview = clear(Vec3::new(5000.0, -9000.0, 12_000.0), middle, None);
        assert!((0.92..0.97).contains(&overview), "{overview}");
        let horizon = clear(Vec3::new(5000.0, 500.0, 950.0), Vec3::new(5000.0, 8000.0, 900.0), None);
        assert!((0.6..0.7).contains(&horizon), "{horizon}");
        assert_eq!(clear(Vec3::new(5000.0, 3990.0, 20_000.0), Vec3::new(5000.0, 4000.0, 0.0), None), 1.0);
    }

    #[test]
    fn the_foreground_is_clear_and_haze_begins_at_a_quarter_of_the_depth() {
        let (eye, bounds) = (Vec3::new(5000.0, -2000.0, 900.0), Aabb { min: MIN, max: MAX });
        let camera = Camera::new(eye, MAX / 2.0, 0.5, (160, 90), (1.0, 1e6)).expect("sound");
        let near_m = eye.distance(bounds.nearest_to(eye));
        let depth_m = eye.distance(bounds.farthest_from(eye)) - near_m;
        for (stated_m, reach_m) in [(None, depth_m), (Some(4000.0), 4000.0)] {
            let haze = haze(Vec3::ONE, stated_m, &camera, bounds, PictureSetting::Landscape);
            assert!((haze.near_m - near_m - 0.25 * reach_m).abs() < 1.0, "{haze:?}");
        }
    }

    #[test]
    fn a_stated_distance_counts_from_the_near_edge() {
        let eye = Vec3::new(-50_000.0, 4000.0, 0.0);
        // As far beyond the near edge as the farthest corner lies.
        let stated = clear(eye, MAX / 2.0, Some(10_133.0));
        assert!((0.36..0.38).contains(&stated), "{stated}");
        assert_eq!(clear(eye, MAX / 2.0, Some(0.0)), 1.0);
    }
}
