//! When is a triangle good enough?

use glam::Vec3;

use crate::view::camera::Camera;

/// The screen-space error against a camera: a triangle is split while its error could show as more than
/// `tolerance_px` pixels.
///
/// The error is taken at the point of the triangle's box nearest to the eye, and pixels at the picture's
/// corner where they are largest, so that `|displayed − ground|` never exceeds the tolerance on the picture
/// (distance-only form of the criterion; a vertical error seen from above shows smaller).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenError {
    eye: Vec3,
    metres_per_metre: f32,
}

impl ScreenError {
    /// The criterion for one camera; heights are drawn times `exaggeration`.
    pub fn new(camera: &Camera, tolerance_px: f32, exaggeration: f32) -> Self {
        // A length δ at distance d from the eye, θ off the viewing direction, spans at most δ / (d · cos² θ) on the
        // picture's plane: cos θ since depth is shorter than distance, and once more since the plane is met at a slant.
        let corner = 1.0 + camera.tan_half_fov().length_squared();
        let pixels = camera.pixels_per_metre(1.0) * corner;
        Self { eye: camera.eye(), metres_per_metre: pixels * exaggeration / tolerance_px }
    }

    /// The distance in metres within which an error of `error_m` must be refined.
    pub fn reach_m(&self, error_m: f32) -> f32 {
        error_m * self.metres_per_metre
    }

    /// Whether a triangle with an error of `error_m` metres inside the box `min..=max` must be split.
    pub fn must_split(&self, error_m: f32, min: Vec3, max: Vec3) -> bool {
        if error_m == 0.0 {
            return false;
        }
        let nearest = self.eye.clamp(min, max);
        let reach = self.reach_m(error_m);
        nearest.distance_squared(self.eye) < reach * reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_refined_up_to_the_distance_where_it_spans_the_tolerance() {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 0.8, (640, 480), (1.0, 9000.0)).expect("sound");
        let criterion = ScreenError::new(&camera, 2.0, 1.0);
        let at = |distance: f32| criterion.must_split(3.0, Vec3::Y * distance, Vec3::Y * distance);
        let seen_px = |distance: f32| 3.0 * camera.pixels_per_metre(distance);
        assert!(at(500.0) && seen_px(500.0) > 2.0);
        let reach = criterion.reach_m(3.0);
        assert!(at(reach * 0.999) && !at(reach * 1.001));
        assert!(seen_px(reach) <= 2.0);
    }
}
