//! A camera in world space, in perspective or with parallel rays.
//!
//! Parallel rays give a picture with one scale. With pixels that are square, it is an orthographic picture. Where a pixel
//! stands for fewer meters up the picture than across it, it is oblique: looking down by 45° with `√2` as many pixels up,
//! level ground is drawn as in plan, and heights go straight up at the same scale (a military oblique).
//!
//! Pixels count from the upper left corner of the picture; the center of the first pixel is (0.5, 0.5).

use glam::{Vec2, Vec3};

use crate::axes::DirectionAxes;
use sandtable_geom::aabb::Aabb;

/// The projection of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewProjection {
    /// Rays meet in the eye.
    Perspective {
        /// The tangent of half the vertical field of view.
        tan_half_fov: f32,
    },
    /// Rays are parallel to the viewing direction.
    Parallel(ParallelFrame),
}

/// The frame of a picture with parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelFrame {
    /// Half of what the picture's width and its height span across the rays, in meters.
    pub half_m: Vec2,
    /// Pixels per inch of the sheet that the picture is printed on, which turns pixels into a map scale.
    pub dpi: f32,
}

/// Meters in an inch.
pub const INCH_M: f64 = 0.0254;

/// The eye, its orthonormal basis, the projection and the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    projection: ViewProjection,
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
    /// Meters from the eye along the viewing direction; in perspective at least the near distance.
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
    /// What a picture with parallel rays spans, or its dots per inch, are not positive.
    #[error("a picture with parallel rays spans {0} × {1} m; it must span more than 0 m each way")]
    Span(f32, f32),
    /// Near and far are not `0 < near < far`.
    #[error("the near and far planes are {0} m and {1} m, they must satisfy 0 < near < far")]
    Planes(f32, f32),
}

/// A distance behind the box `ground` from `eye`, in any direction, in meters: a far plane that cuts nothing of it off.
pub fn far_m(ground: &Aabb, eye: Vec3) -> f32 {
    eye.distance(ground.farthest_from(eye)) * 1.5 + 1000.0
}

impl Camera {
    /// A camera in perspective at `eye` that looks at `target`, upright: Z is up, and north where it looks straight down.
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
        check_frame((width, height), (near, far))?;
        let right = forward.cross(Vec3::Z).try_normalize().unwrap_or(Vec3::X);
        let up = right.cross(forward);
        let projection = ViewProjection::Perspective { tan_half_fov: libm::tanf(fov_y_rad * 0.5) };
        Ok(Self { eye, right, up, forward, projection, width, height, near, far })
    }

    /// A camera with parallel rays that looks along `axes`, with `eye` in the picture's middle.
    ///
    /// `near` and `far` are meters from the eye along the viewing direction; what lies nearer may be seen all the same.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn parallel(
        eye: Vec3,
        axes: &DirectionAxes,
        frame: ParallelFrame,
        (width, height): (u32, u32),
        (near, far): (f32, f32),
    ) -> Result<Self, CameraError> {
        if !eye.is_finite() {
            return Err(CameraError::NoDirection);
        }
        let ParallelFrame { half_m, dpi } = frame;
        if !(half_m.is_finite() && half_m.min_element() > 0.0 && dpi > 0.0) {
            return Err(CameraError::Span(2.0 * half_m.x, 2.0 * half_m.y));
        }
        check_frame((width, height), (near, far))?;
        let DirectionAxes { right, up, forward } = *axes;
        let projection = ViewProjection::Parallel(frame);
        Ok(Self { eye, right, up, forward, projection, width, height, near, far })
    }

    /// This camera with its eye moved.
    pub fn moved(&self, by: Vec3) -> Self {
        Self { eye: self.eye + by, ..*self }
    }

    /// This camera with a picture of another size, of one pixel at the least, which shows the same height of the view.
    pub fn resized(&self, (width, height): (u32, u32)) -> Self {
        Self { width: width.max(1), height: height.max(1), ..*self }
    }

    /// The projection.
    pub fn projection(&self) -> ViewProjection {
        self.projection
    }

    /// The frame of parallel rays; `None` in perspective.
    pub fn parallel_frame(&self) -> Option<ParallelFrame> {
        match self.projection {
            ViewProjection::Perspective { .. } => None,
            ViewProjection::Parallel(frame) => Some(frame),
        }
    }

    /// The number `n` of the picture's scale 1:n on level lines across the view; `None` in perspective, which has no
    /// single scale.
    pub fn scale_denominator(&self) -> Option<f64> {
        let ParallelFrame { half_m, dpi } = self.parallel_frame()?;
        let pixels_per_meter = f64::from(self.width) / (2.0 * f64::from(half_m.x));
        Some(f64::from(dpi) / (INCH_M * pixels_per_meter))
    }

    /// The ratio of the pixels that a meter across the rays spans up the picture to those across it; 1 in perspective.
    pub fn stretch(&self) -> f32 {
        match self.projection {
            ViewProjection::Perspective { .. } => 1.0,
            ViewProjection::Parallel(ParallelFrame { half_m, .. }) => {
                (half_m.x / half_m.y) * (self.height as f32 / self.width as f32)
            }
        }
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

    /// The vector from `point` toward the eye, in world space; of any length.
    pub fn toward_eye(&self, point: Vec3) -> Vec3 {
        if self.parallel_frame().is_some() { -self.forward } else { self.eye - point }
    }

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The near and far distances in meters along the viewing direction.
    pub fn planes(&self) -> (f32, f32) {
        (self.near, self.far)
    }

    /// The tangents of half the horizontal and half the vertical field of view; 0 for parallel rays.
    pub fn tan_half_fov(&self) -> Vec2 {
        match self.projection {
            ViewProjection::Perspective { tan_half_fov } => {
                Vec2::new(tan_half_fov * (self.width as f32 / self.height as f32), tan_half_fov)
            }
            ViewProjection::Parallel(_) => Vec2::ZERO,
        }
    }

    /// Pixels that one meter across the line of sight and across the picture spans, `depth_m` meters along the viewing
    /// direction; with parallel rays the same at any depth.
    pub fn pixels_per_meter(&self, depth_m: f32) -> f32 {
        match self.projection {
            ViewProjection::Perspective { tan_half_fov } => {
                self.height as f32 / (2.0 * tan_half_fov * depth_m)
            }
            ViewProjection::Parallel(ParallelFrame { half_m, .. }) => self.width as f32 / (2.0 * half_m.x),
        }
    }

    /// The picture position of `world`; in perspective `None` where it lies before the near plane or behind the eye.
    pub fn project(&self, world: Vec3) -> Option<Projected> {
        let offset = world - self.eye;
        let depth_m = offset.dot(self.forward);
        let half = match self.projection {
            ViewProjection::Perspective { .. } if depth_m < self.near => return None,
            ViewProjection::Perspective { .. } => self.tan_half_fov() * depth_m,
            ViewProjection::Parallel(frame) => frame.half_m,
        };
        let x = offset.dot(self.right) / half.x;
        let y = offset.dot(self.up) / half.y;
        let pixel = Vec2::new((x * 0.5 + 0.5) * self.width as f32, (0.5 - y * 0.5) * self.height as f32);
        Some(Projected { pixel, depth_m })
    }

    /// The world point that is seen at a picture position, `depth_m` along the viewing direction.
    pub fn point_at(&self, pixel: Vec2, depth_m: f32) -> Vec3 {
        self.ray_origin(pixel) + self.ray_through(pixel) * depth_m
    }

    /// The direction of the ray through a picture position, one meter long along the viewing direction.
    pub fn ray_through(&self, pixel: Vec2) -> Vec3 {
        self.forward + self.across(pixel, self.tan_half_fov())
    }

    /// The point at depth 0 of the ray through a picture position: the eye or, with parallel rays, a point beside it.
    pub fn ray_origin(&self, pixel: Vec2) -> Vec3 {
        match self.projection {
            ViewProjection::Perspective { .. } => self.eye,
            ViewProjection::Parallel(frame) => self.eye + self.across(pixel, frame.half_m),
        }
    }

    /// From the picture's middle to a picture position, where half of the picture spans `half`.
    fn across(&self, pixel: Vec2, half: Vec2) -> Vec3 {
        let x = (pixel.x / self.width as f32 * 2.0 - 1.0) * half.x;
        let y = (1.0 - pixel.y / self.height as f32 * 2.0) * half.y;
        self.right * x + self.up * y
    }
}

fn check_frame((width, height): (u32, u32), (near, far): (f32, f32)) -> Result<(), CameraError> {
    if !(1..=16384).contains(&width) || !(1..=16384).contains(&height) {
        return Err(CameraError::Size(width, height));
    }
    if !(near > 0.0 && near < far && far.is_finite()) {
        return Err(CameraError::Planes(near, far));
    }
    Ok(())
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

    /// A camera with parallel rays, one pixel a meter across the view.
    fn parallel(azimuth: f32, pitch: f32, stretch: f32) -> Camera {
        let frame = ParallelFrame { half_m: Vec2::new(320.0, 240.0 / stretch), dpi: 96.0 };
        let axes = DirectionAxes::new(azimuth, pitch);
        let eye = Vec3::new(1000.0, 2000.0, 300.0) - axes.forward * 5000.0;
        Camera::parallel(eye, &axes, frame, (640, 480), (1.0, 20_000.0)).expect("sound")
    }

    #[test]
    fn a_plan_keeps_its_scale_at_any_height() {
        let camera = parallel(0.0, std::f32::consts::FRAC_PI_2, 1.0);
        let pixel = |at: Vec3| camera.project(at).expect("parallel rays see all").pixel;
        let at = Vec3::new(1000.0, 2000.0, 0.0);
        assert!((pixel(at + Vec3::X * 100.0) - pixel(at) - Vec2::X * 100.0).length() < 1e-3);
        assert!((pixel(at + Vec3::Y * 100.0) - pixel(at) + Vec2::Y * 100.0).length() < 1e-3);
        assert_eq!(pixel(at + Vec3::Z * 4000.0), pixel(at));
        assert_eq!(camera.pixels_per_meter(1.0), camera.pixels_per_meter(9999.0));
    }

    #[test]
    fn an_oblique_picture_is_a_plan_whose_heights_go_straight_up() {
        for azimuth in [0.0, 0.7, 3.0] {
            let camera = parallel(azimuth, std::f32::consts::FRAC_PI_4, std::f32::consts::SQRT_2);
            let pixel = |at: Vec3| camera.project(at).expect("parallel rays see all").pixel;
            let at = Vec3::new(900.0, 2100.0, 30.0);
            for way in [Vec3::X, Vec3::Y, Vec3::new(0.6, -0.8, 0.0)] {
                assert!(((pixel(at + way * 100.0) - pixel(at)).length() - 100.0).abs() < 1e-2, "{way}");
            }
            assert!((pixel(at + Vec3::Z * 100.0) - pixel(at) + Vec2::Y * 100.0).length() < 1e-2);
        }
    }

    #[test]
    fn parallel_rays_lead_back_from_the_pixel() {
        let camera = parallel(0.4, 0.8, 1.3);
        let world = Vec3::new(960.0, 2100.0, 12.0);
        let seen = camera.project(world).expect("parallel rays see all");
        let back = camera.point_at(seen.pixel, seen.depth_m);
        assert!((back - world).length() < 2e-2, "{back} against {world}");
        let span = camera.scale_denominator().expect("a scale") * 0.0254 / 96.0;
        assert!((span - 1.0).abs() < 1e-6, "one meter a pixel, not {span}");
    }
}
