//! The screen-space error whose tolerance holds at every post of the picture.

use glam::Vec3;

use crate::roam::criterion::Criterion;
use crate::roam::culling::PatchHeights;
use crate::roam::errors::ErrorMap;
use crate::roam::graph::Vertex;
use crate::roam::patched_ground::PatchedGround;
use crate::view::camera::Camera;
use crate::view::frustum::Frustum;

/// The largest length that an error could span in the picture, over the tolerance.
///
/// The error is taken at the point of the triangles' box nearest to the eye, and pixels at the picture's corner, where they
/// are largest, so that `|displayed − ground|` never exceeds the tolerance in the picture where the errors are exact
/// (distance-only form of the criterion; a vertical error seen from above shows smaller). Vertices out of view are not
/// wanted.
#[derive(Clone, Copy, Debug)]
pub struct ScreenError<'a> {
    ground: PatchedGround<'a>,
    errors: &'a ErrorMap,
    heights: &'a PatchHeights,
    frustum: Frustum,
    reach: ErrorReach,
}

/// Distances at which errors span the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ErrorReach {
    eye: Vec3,
    meters_per_meter: f32,
}

impl ErrorReach {
    fn new(camera: &Camera, tolerance_px: f32) -> Self {
        // A length δ at distance d from the eye, θ off the viewing direction, spans at most δ / (d · cos² θ) on the
        // picture's plane: cos θ since depth is shorter than distance, and once more since the plane is met at a slant.
        let corner = 1.0 + camera.tan_half_fov().length_squared();
        let pixels = camera.pixels_per_meter(1.0) * corner;
        Self { eye: camera.eye(), meters_per_meter: pixels / tolerance_px }
    }

    /// The distance in meters within which an error of `error_m` must be refined.
    fn reach_m(&self, error_m: f32) -> f32 {
        error_m * self.meters_per_meter
    }

    /// The largest multiple of the tolerance that an error of `error_m` meters inside the box `min..=max` can span.
    fn excess(&self, error_m: f32, min: Vec3, max: Vec3) -> f32 {
        let nearest = self.eye.clamp(min, max);
        self.reach_m(error_m) / nearest.distance(self.eye)
    }
}

impl<'a> ScreenError<'a> {
    /// The criterion for one camera.
    pub fn new(
        ground: PatchedGround<'a>,
        errors: &'a ErrorMap,
        heights: &'a PatchHeights,
        camera: &Camera,
        tolerance_px: f32,
    ) -> Self {
        let reach = ErrorReach::new(camera, tolerance_px);
        Self { ground, errors, heights, frustum: Frustum::new(camera), reach }
    }
}

impl Criterion for ScreenError<'_> {
    fn excess(&self, vertex: Vertex) -> f32 {
        let error = self.errors.at(self.ground.layout, vertex);
        if error == 0.0 {
            return 0.0;
        }
        match self.heights.diamond(self.ground, vertex) {
            Some((min, max)) if self.frustum.may_see(min, max) => self.reach.excess(error, min, max),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_refined_up_to_the_distance_where_it_spans_the_tolerance() {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 0.8, (640, 480), (1.0, 9000.0)).expect("sound");
        let criterion = ErrorReach::new(&camera, 2.0);
        let at = |distance: f32| criterion.excess(3.0, Vec3::Y * distance, Vec3::Y * distance) > 1.0;
        let seen_px = |distance: f32| 3.0 * camera.pixels_per_meter(distance);
        assert!(at(500.0) && seen_px(500.0) > 2.0);
        let reach = criterion.reach_m(3.0);
        assert!(at(reach * 0.999) && !at(reach * 1.001));
        assert!(seen_px(reach) <= 2.0);
    }
}
