//! The camera as the rasterizer uses it: world points to homogeneous pixels, and pixels to rays.
//!
//! A world point becomes `(x·w, y·w, w)` with `x`, `y` in pixels from the picture's upper left corner and `w` in meters
//! along the viewing direction. The form is a linear image of eye-centered world space, so that a triangle's attributes
//! divided by `w` are linear over the picture even where a corner lies behind the eye (Olano and Greer 1997); only the
//! outline needs clipping. All values are f64: the f32 corners are then exact, and what lies in one plane in the world
//! lies in one plane on the picture.
//!
//! Parallel rays need no division: there `w` is 1, `x` and `y` are pixels, and the depth is apart.
//!
//! # Nearness
//! What decides which surface is seen is linear over the picture and larger for what is nearer: `1 / w` in perspective,
//! and `2 − depth / far` for parallel rays, which is 1 at the far plane and 2 in the plane of the eye. Both are positive,
//! so that a share of a nearness is a tolerance.

use glam::{DMat4, DVec3, Mat4, Vec3};

use sandtable_view::camera::{Camera, ViewProjection};

#[derive(Clone, Copy, Debug)]
pub struct Screen {
    pub size: [u32; 2],
    /// The near distance in meters.
    pub near: f64,
    /// The far distance in meters.
    pub far: f64,
    /// The eye in world space.
    pub eye: DVec3,
    /// The viewing direction.
    pub forward: DVec3,
    /// Whether rays are parallel.
    pub is_parallel: bool,
    rows: [DVec3; 3],
    /// Added to the products of `rows`.
    shift: DVec3,
    /// At the picture's upper left corner: in perspective the ray, with parallel rays the ray's origin, from the eye.
    corner: Vec3,
    /// The change of rays, or of their origins, over one pixel to the right.
    pub right: Vec3,
    /// The same over one pixel down.
    pub down: Vec3,
}

/// Samples of ground whose depths differ by less than this share are taken to lie on one slope. Across a silhouette
/// depths differ by more; along a slope they differ by less, except close to the horizon.
const SAME_SLOPE: f32 = 0.01;

/// The same for parallel rays, in widths of a pixel: a slope of 80° against the picture.
const SAME_SLOPE_PX: f32 = 6.0;

/// Mesh space to the homogeneous pixels of one [`Screen`].
#[derive(Clone, Copy, Debug)]
pub struct Projection<'a> {
    world_from_mesh: DMat4,
    screen: &'a Screen,
}

impl Screen {
    pub fn new(camera: &Camera) -> Self {
        let (width, height) = camera.size();
        let half = [f64::from(width) / 2.0, f64::from(height) / 2.0];
        let [right, up, forward] =
            [camera.right(), camera.up(), camera.forward()].map(|axis| axis.as_dvec3());
        let (span, ahead) = match camera.projection() {
            ViewProjection::Perspective { .. } => (camera.tan_half_fov(), camera.forward()),
            ViewProjection::Parallel(frame) => (frame.half_m, Vec3::ZERO),
        };
        let is_parallel = camera.parallel_frame().is_some();
        let across = [right * (half[0] / f64::from(span.x)), up * -(half[1] / f64::from(span.y))];
        let center = DVec3::new(half[0], half[1], 1.0);
        let step = [2.0 * span.x / width as f32, 2.0 * span.y / height as f32];
        Self {
            size: [width, height],
            near: f64::from(camera.planes().0),
            far: f64::from(camera.planes().1),
            eye: camera.eye().as_dvec3(),
            forward,
            is_parallel,
            rows: match is_parallel {
                false => [across[0] + forward * half[0], across[1] + forward * half[1], forward],
                true => [across[0], across[1], DVec3::ZERO],
            },
            shift: if is_parallel { center } else { DVec3::ZERO },
            corner: ahead - camera.right() * span.x + camera.up() * span.y,
            right: camera.right() * step[0],
            down: camera.up() * -step[1],
        }
    }

    /// The direction of the ray through a pixel position, one meter long along the viewing direction.
    pub fn ray_at(&self, at: [f32; 2]) -> Vec3 {
        if self.is_parallel { self.forward.as_vec3() } else { self.across(at) }
    }

    /// The point of the ray through a pixel position that lies `depth_m` meters along the viewing direction.
    pub fn world_at(&self, at: [f32; 2], depth_m: f32) -> Vec3 {
        let (eye, across) = (self.eye.as_vec3(), self.across(at));
        if self.is_parallel {
            eye + across + self.forward.as_vec3() * depth_m
        } else {
            eye + across * depth_m
        }
    }

    fn across(&self, at: [f32; 2]) -> Vec3 {
        self.corner + self.right * at[0] + self.down * at[1]
    }

    /// The nearness of a depth in meters along the viewing direction.
    pub fn nearness(&self, depth_m: f64) -> f64 {
        if self.is_parallel { 2.0 - depth_m / self.far } else { 1.0 / depth_m }
    }

    /// The depth in meters of a nearness.
    pub fn depth_m(&self, nearness: f32) -> f32 {
        if self.is_parallel { (2.0 - nearness) * self.far as f32 } else { 1.0 / nearness }
    }

    /// Meters along the viewing direction to an eye-centered position.
    pub fn depth_from_eye(&self, offset: DVec3) -> f64 {
        offset.dot(self.forward)
    }

    /// The greatest difference from `nearness` of a sample of ground that is taken to lie on the same slope.
    pub fn same_slope(&self, nearness: f32) -> f32 {
        match self.is_parallel {
            false => SAME_SLOPE * nearness,
            true => SAME_SLOPE_PX * self.right.length() / self.far as f32,
        }
    }

    pub fn projection(&self, world_from_mesh: &Mat4) -> Projection<'_> {
        Projection { world_from_mesh: world_from_mesh.as_dmat4(), screen: self }
    }
}

impl Projection<'_> {
    /// `position` of a mesh, in meters from the eye along the world's axes.
    pub fn eye_from_mesh(&self, position: [f32; 3]) -> DVec3 {
        let position = DVec3::from(position.map(f64::from));
        self.world_from_mesh.transform_point3(position) - self.screen.eye
    }

    /// An eye-centered position as homogeneous pixels `(x·w, y·w, w)`; `w` is 1 with parallel rays.
    pub fn pixels_from_eye(&self, offset: DVec3) -> DVec3 {
        DVec3::from(self.screen.rows.map(|row| row.dot(offset))) + self.screen.shift
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use sandtable_view::axes::DirectionAxes;
    use sandtable_view::camera::ParallelFrame;

    #[test]
    fn the_screen_agrees_with_the_camera_on_pixels_depths_and_rays() {
        let eye = Vec3::new(100.0, -50.0, 30.0);
        let camera =
            Camera::new(eye, Vec3::new(0.0, 400.0, 5.0), 0.8, (640, 480), (1.0, 5000.0)).expect("sound");
        let screen = Screen::new(&camera);
        let to_screen = screen.projection(&Mat4::IDENTITY);
        let world = Vec3::new(-40.0, 300.0, 12.0);
        let seen = camera.project(world).expect("in front of the eye");
        let point = to_screen.pixels_from_eye(to_screen.eye_from_mesh(world.into()));
        assert!((point.z - f64::from(seen.depth_m)).abs() < 1e-3);
        assert!((point.x / point.z - f64::from(seen.pixel.x)).abs() < 1e-2);
        assert!((point.y / point.z - f64::from(seen.pixel.y)).abs() < 1e-2);
        let ray = screen.ray_at([123.5, 67.5]);
        assert!((ray - camera.ray_through(glam::Vec2::new(123.5, 67.5))).length() < 1e-6);
    }

    #[test]
    fn the_screen_agrees_with_a_camera_of_parallel_rays() {
        let axes = DirectionAxes::new(0.7, 0.9);
        let frame = ParallelFrame { half_m: Vec2::new(900.0, 500.0), dpi: 96.0 };
        let eye = Vec3::new(100.0, -50.0, 30.0);
        let camera = Camera::parallel(eye, &axes, frame, (640, 480), (1.0, 5000.0)).expect("sound");
        let screen = Screen::new(&camera);
        let to_screen = screen.projection(&Mat4::IDENTITY);
        let world = Vec3::new(340.0, 300.0, -212.0);
        let seen = camera.project(world).expect("parallel rays see all");
        let offset = to_screen.eye_from_mesh(world.into());
        let point = to_screen.pixels_from_eye(offset);
        assert_eq!(point.z, 1.0);
        assert!((point.x - f64::from(seen.pixel.x)).abs() < 1e-2, "{point} against {seen:?}");
        assert!((point.y - f64::from(seen.pixel.y)).abs() < 1e-2, "{point} against {seen:?}");
        let depth_m = screen.depth_m(screen.nearness(screen.depth_from_eye(offset)) as f32);
        assert!((depth_m - seen.depth_m).abs() < 2e-3, "{depth_m} against {}", seen.depth_m);
        let back = screen.world_at(seen.pixel.into(), depth_m);
        assert!((back - world).length() < 1e-2, "{back} against {world}");
    }
}
