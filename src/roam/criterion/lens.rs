//! How large lengths appear: what the criteria that measure on the picture share.

use glam::Vec3;

use crate::view::camera::Camera;

/// The eye, and how many tolerances a meter of error spans at a distance of one meter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    pub(super) eye: Vec3,
    scale: f32,
}

impl Lens {
    /// Errors are meters without exaggeration; `tolerance_px`, above 0, is pixels in the middle of the picture.
    pub(super) fn new(camera: &Camera, tolerance_px: f32) -> Self {
        Self { eye: camera.eye(), scale: camera.pixels_per_meter(1.0) / tolerance_px }
    }

    /// A lens of given strength: tolerances spanned by a drawn meter at a distance of one meter.
    pub(super) fn of_strength(eye: Vec3, strength: f32) -> Self {
        Self { eye, scale: strength }
    }

    /// How many tolerances `error_m` spans at `distance_m`; 0 without error, infinite for an infinite error.
    #[inline]
    pub(super) fn excess(&self, error_m: f32, distance_m: f32) -> f32 {
        if error_m == 0.0 || error_m == f32::INFINITY { error_m } else { error_m * self.scale / distance_m }
    }

    /// Whether `error_m` spans more than a tolerance at the distance whose square is `squared_m2`: the same as
    /// an excess above 1, to rounding, without a root or a division.
    #[inline]
    pub(super) fn shows(&self, error_m: f32, squared_m2: f32) -> bool {
        let reach_m = error_m * self.scale;
        error_m > 0.0 && (reach_m * reach_m > squared_m2 || error_m == f32::INFINITY)
    }
}
