//! A perspective camera in world space.
//!
//! View space is right-handed with X right, Y up and −Z forward; clip space follows WebGPU: X and Y in
//! −w..w with Y up, Z in 0..w with 0 at the near plane. Pixels count from the upper left corner, the
//! center of the first pixel at (0.5, 0.5).

use glam::{Mat4, Vec2, Vec3, Vec4};

/// Where the eye is, where it looks and how wide, and the size of the picture it makes.
///
/// Built by [`Camera::new`], which keeps the basis orthonormal and the planes in order.
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

/// A point on the picture: pixels from the upper left corner, and meters along the viewing direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Pixels from the upper left corner, X right and Y down; may lie outside the picture.
    pub pixel: Vec2,
    /// Meters from the eye, measured along the viewing direction; at least the near distance.
    pub depth_m: f32,
}

/// What can be wrong with a camera.
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

impl Camera {
    /// A camera at `eye` looking at `target`, upright (Z up; looking straight down, north is up).
    ///
    /// `fov_y_rad` is the vertical field of view; `width` and `height` are pixels; `near` and `far` are
    /// meters along the viewing direction.
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
        Ok(Self {
            eye,
            right,
            up: right.cross(forward),
            forward,
            tan_half_fov: libm::tanf(fov_y_rad * 0.5),
            width,
            height,
            near,
            far,
        })
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

    /// How many pixels one meter spans across the line of sight, `depth_m` meters along the viewing direction.
    pub fn pixels_per_meter(&self, depth_m: f32) -> f32 {
        self.height as f32 / (2.0 * self.tan_half_fov * depth_m)
    }

    /// World space to view space.
    pub fn view_from_world(&self) -> Mat4 {
        let rows = [self.right, self.up, -self.forward];
        Mat4::from_cols(
            Vec4::new(rows[0].x, rows[1].x, rows[2].x, 0.0),
            Vec4::new(rows[0].y, rows[1].y, rows[2].y, 0.0),
            Vec4::new(rows[0].z, rows[1].z, rows[2].z, 0.0),
            Vec4::new(-rows[0].dot(self.eye), -rows[1].dot(self.eye), -rows[2].dot(self.eye), 1.0),
        )
    }

    /// View space to WebGPU's clip space.
    pub fn clip_from_view(&self) -> Mat4 {
        let tan = self.tan_half_fov();
        let range = self.far / (self.near - self.far);
        Mat4::from_cols(
            Vec4::new(1.0 / tan.x, 0.0, 0.0, 0.0),
            Vec4::new(0.0, 1.0 / tan.y, 0.0, 0.0),
            Vec4::new(0.0, 0.0, range, -1.0),
            Vec4::new(0.0, 0.0, range * self.near, 0.0),
        )
    }

    /// Where `world` falls on the picture; `None` where it lies nearer than the near plane or behind the eye.
    pub fn project(&self, world: Vec3) -> Option<Projected> {
        let offset = world - self.eye;
        let depth_m = offset.dot(self.forward);
        if depth_m < self.near {
            return None;
        }
        let tan = self.tan_half_fov();
        let x = offset.dot(self.right) / (depth_m * tan.x);
        let y = offset.dot(self.up) / (depth_m * tan.y);
        Some(Projected {
            pixel: Vec2::new((x * 0.5 + 0.5) * self.width as f32, (0.5 - y * 0.5) * self.height as f32),
            depth_m,
        })
    }

    /// The direction from the eye through a point of the picture, scaled so that it advances one meter
    /// along the viewing direction.
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
    fn the_matrices_put_a_point_on_the_same_pixel_as_project() {
        let camera = camera();
        let world = Vec3::new(30.0, 200.0, -4.0);
        let clip = camera.clip_from_view() * camera.view_from_world() * world.extend(1.0);
        let ndc = clip / clip.w;
        let pixel = Vec2::new((ndc.x * 0.5 + 0.5) * 640.0, (0.5 - ndc.y * 0.5) * 480.0);
        let seen = camera.project(world).expect("in front of the eye");
        assert!((pixel - seen.pixel).length() < 1e-2);
        assert!((0.0..=1.0).contains(&ndc.z));
    }

    #[test]
    fn looking_straight_down_keeps_north_up() {
        let camera =
            Camera::new(Vec3::Z * 100.0, Vec3::ZERO, 1.0, (100, 100), (1.0, 200.0)).expect("a sound camera");
        let north = camera.project(Vec3::Y * 10.0).expect("below the eye");
        assert!(north.pixel.y < 50.0 && (north.pixel.x - 50.0).abs() < 1e-3);
    }

    #[test]
    fn what_is_behind_the_eye_is_not_projected() {
        assert_eq!(camera().project(Vec3::new(100.0, -500.0, 30.0)), None);
    }
}
