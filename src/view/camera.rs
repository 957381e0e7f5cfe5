//! A perspective camera in world space.
//!
//! Pixels count from the upper left corner of the picture; the center of the first pixel is (0.5, 0.5).

use glam::{Vec2, Vec3};

use crate::geom::aabb::Aabb;

/// The eye, its orthonormal basis, the field of view and the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    tan_half_fov: f32,
    width: u32,
    height: u32,
    near: f32,
    far: f32,
}

/// A point on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Pixels from the upper left corner, X right and Y down; may lie outside the picture.
    pub pixel: Vec2,
    /// Meters from the eye along the viewing direction; at least the near distance.
    pub depth_m: f32,
}

/// Why a camera cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// The eye and the target coincide, or one of them is not finite.
    #[error("the camera's eye and target are the same point or not finite")]
    NoDirection,
    /// The field of view is outside 1..=170 degrees.
    #[error("the field of view is {0}°, it must lie between 1° and 170°")]
    FieldOfView(f32),
    /// Width or height is outside 1..=16384 pixels.
    #[error("the picture is {0}×{1} pixels, each side must lie between 1 and 16384")]
    Size(u32, u32),
    /// Near and far are not `0 < near < far`.
    #[error("the near and far planes are {0} m and {1} m, they must satisfy 0 < near < far")]
    Planes(f32, f32),
}

/// A distance behind the box `ground` from `eye`, in any direction, in meters: a far plane that cuts nothing of it off.
pub fn far_m(ground: &Aabb, eye: Vec3) -> f32 {
    eye.distance(ground.farthest_from(eye)) * 1.5 + 1000.0
}

impl Camera {
    /// A camera at `eye` that looks at `target`, upright: Z is up, and north where it looks straight down.
    ///
    /// `fov_y_rad` is the vertical field of view. `width` and `height` are pixels; `near` and `far` are meters
    /// along the viewing direction.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn new(
        eye: Vec3,
        target: Vec3,
        fov_y_rad: f32,
        (width, height): (u32, u32),
        (near, far): (f32, f32),
    ) -> Result<Self, CameraError> {
        let forward = (target - eye).try_normalize().ok_or(CameraError::NoDirection)?;
        if !(1f32.to_radians()..=170f32.to_radians()).contains(&fov_y_rad) {
            return Err(CameraError::FieldOfView(fov_y_rad.to_degrees()));
        }
        if !(1..=16384).contains(&width) || !(1..=16384).contains(&height) {
            return Err(CameraError::Size(width, height));
        }
        if !(near > 0.0 && near < far && far.is_finite()) {
            return Err(CameraError::Planes(near, far));
        }
        let right = forward.cross(Vec3::Z).try_normalize().unwrap_or(Vec3::X);
        let (up, tan_half_fov) = (right.cross(forward), libm::tanf(fov_y_rad * 0.5));
        Ok(Self { eye, right, up, forward, tan_half_fov, width, height, near, far })
    }

    /// The eye, in world space.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// The viewing direction, of unit length.
    pub fn forward(&self) -> Vec3 {
        self.forward
    }

    /// The direction to the right of the picture, of unit length.
    pub fn right(&self) -> Vec3 {
        self.right
    }

    /// The direction to the top of the picture, of unit length.
    pub fn up(&self) -> Vec3 {
        self.up
    }

    /// From `point` toward the eye, in world space; of any length.
    pub fn toward_eye(&self, point: Vec3) -> Vec3 {
        self.eye - point
    }

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The near and far distances in meters along the viewing direction.
    pub fn planes(&self) -> (f32, f32) {
        (self.near, self.far)
    }

    /// The tangents of half the horizontal and half the vertical field of view.
    pub fn tan_half_fov(&self) -> Vec2 {
        let aspect = self.width as f32 / self.height as f32;
        Vec2::new(self.tan_half_fov * aspect, self.tan_half_fov)
    }

    /// Pixels that one meter across the line of sight spans, `depth_m` meters along the viewing direction.
    pub fn pixels_per_meter(&self, depth_m: f32) -> f32 {
        self.height as f32 / (2.0 * self.tan_half_fov * depth_m)
    }

    /// The picture position of `world`, or `None` where it lies before the near plane or behind the eye.
    pub fn project(&self, world: Vec3) -> Option<Projected> {
        let offset = world - self.eye;
        let depth_m = offset.dot(self.forward);
        if depth_m < self.near {
            return None;
        }
        let tan = self.tan_half_fov();
        let x = offset.dot(self.right) / (depth_m * tan.x);
        let y = offset.dot(self.up) / (depth_m * tan.y);
        let pixel = Vec2::new((x * 0.5 + 0.5) * self.width as f32, (0.5 - y * 0.5) * self.height as f32);
        Some(Projected { pixel, depth_m })
    }

    /// The direction from the eye through a picture position, one meter long along the viewing direction.
    pub fn ray_through(&self, pixel: Vec2) -> Vec3 {
        let tan = self.tan_half_fov();
        let x = (pixel.x / self.width as f32 * 2.0 - 1.0) * tan.x;
        let y = (1.0 - pixel.y / self.height as f32 * 2.0) * tan.y;
        self.forward + self.right * x + self.up * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let eye = Vec3::new(100.0, -50.0, 30.0);
        Camera::new(eye, Vec3::new(0.0, 400.0, 5.0), 0.8, (640, 480), (1.0, 5000.0)).expect("a sound camera")
    }

    #[test]
    fn projecting_and_the_ray_through_the_pixel_agree() {
        let camera = camera();
        let world = Vec3::new(-40.0, 300.0, 12.0);
        let seen = camera.project(world).expect("in front of the eye");
        let back = camera.eye() + camera.ray_through(seen.pixel) * seen.depth_m;
        assert!((back - world).length() < 1e-3, "{back} against {world}");
    }

    #[test]
    fn looking_straight_down_keeps_north_up() {
        let camera =
            Camera::new(Vec3::Z * 100.0, Vec3::ZERO, 1.0, (100, 100), (1.0, 200.0)).expect("a sound camera");
        let north = camera.project(Vec3::Y * 10.0).expect("below the eye");
        assert!(north.pixel.y < 50.0 && (north.pixel.x - 50.0).abs() < 1e-3);
    }

    #[test]
    fn a_point_behind_the_eye_is_not_projected() {
        assert_eq!(camera().project(Vec3::new(100.0, -500.0, 30.0)), None);
    }
}
