//! The size of lengths in the picture, for the criteria that measure in pixels.

use glam::Vec3;

use sandtable_view::camera::Camera;

/// The eye, and the number of tolerances that a meter of error spans at a distance of one meter; with parallel rays, at
/// any distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    pub(super) eye: Vec3,
    pub(super) scale: f32,
    pub(super) is_parallel: bool,
}

impl Lens {
    /// `tolerance_px`, above 0, is pixels in the middle of the picture.
    pub(super) fn new(camera: &Camera, tolerance_px: f32) -> Self {
        Self::with_scale(camera, camera.pixels_per_meter(1.0) / tolerance_px)
    }

    /// The lens of a camera by which a meter at a distance of one meter spans `scale` tolerances.
    pub(super) fn with_scale(camera: &Camera, scale: f32) -> Self {
        Self { eye: camera.eye(), scale, is_parallel: camera.parallel_frame().is_some() }
    }

    /// The number of tolerances that `error_m` spans at `distance_m`; 0 without error, infinite for an infinite error.
    #[inline]
    pub(super) fn excess(&self, error_m: f32, distance_m: f32) -> f32 {
        let distance_m = if self.is_parallel { 1.0 } else { distance_m };
        if error_m == 0.0 || error_m == f32::INFINITY { error_m } else { error_m * self.scale / distance_m }
    }

    /// Whether `error_m` spans more than a tolerance at the distance whose square is `squared_m2`: but for rounding an
    /// excess above 1, without a root or a division.
    #[inline]
    pub(super) fn shows(&self, error_m: f32, squared_m2: f32) -> bool {
        let squared_m2 = if self.is_parallel { 1.0 } else { squared_m2 };
        let reach_m = error_m * self.scale;
        error_m > 0.0 && (reach_m * reach_m > squared_m2 || error_m == f32::INFINITY)
    }
}
