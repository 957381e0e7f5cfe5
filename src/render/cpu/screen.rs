//! The camera as the rasterizer uses it: world points to homogeneous pixels, and pixels to rays.
//!
//! A world point becomes `(x·w, y·w, w)` with `x`, `y` in pixels from the picture's upper left corner and `w` in meters
//! along the viewing direction. The form is a linear image of eye-centered world space, so that a triangle's attributes
//! divided by `w` are linear over the picture even where a corner lies behind the eye (Olano and Greer 1997); only the
//! outline needs clipping. All values are f64: the f32 corners are then exact, and what lies in one plane in the world
//! lies in one plane on the picture.

use glam::{DMat4, DVec3, Mat4, Vec3};

use crate::view::camera::Camera;

#[derive(Clone, Copy, Debug)]
pub struct Screen {
    pub size: [u32; 2],
    /// The near distance in meters.
    pub near: f64,
    /// The far distance in meters.
    pub far: f64,
    /// The eye in world space.
    pub eye: DVec3,
    rows: [DVec3; 3],
    ray_corner: Vec3,
    /// The change of [`Screen::ray_at`] over one pixel to the right.
    pub ray_right: Vec3,
    /// The change of [`Screen::ray_at`] over one pixel down.
    pub ray_down: Vec3,
}

/// Mesh space to the homogeneous pixels of one [`Screen`].
#[derive(Clone, Copy, Debug)]
pub struct Projection<'a> {
    world_from_mesh: DMat4,
    screen: &'a Screen,
}

impl Screen {
    pub fn new(camera: &Camera) -> Self {
        let (width, height) = camera.size();
        let tan = camera.tan_half_fov();
        let half = [f64::from(width) / 2.0, f64::from(height) / 2.0];
        let [right, up, forward] =
            [camera.right(), camera.up(), camera.forward()].map(|axis| axis.as_dvec3());
        let step = [2.0 * tan.x / width as f32, 2.0 * tan.y / height as f32];
        Self {
            size: [width, height],
            near: f64::from(camera.planes().0),
            far: f64::from(camera.planes().1),
            eye: camera.eye().as_dvec3(),
            rows: [
                right * (half[0] / f64::from(tan.x)) + forward * half[0],
                up * -(half[1] / f64::from(tan.y)) + forward * half[1],
                forward,
            ],
            ray_corner: camera.forward() - camera.right() * tan.x + camera.up() * tan.y,
            ray_right: camera.right() * step[0],
            ray_down: camera.up() * -step[1],
        }
    }

    /// The direction from the eye through a pixel position, one meter long along the viewing direction.
    pub fn ray_at(&self, at: [f32; 2]) -> Vec3 {
        self.ray_corner + self.ray_right * at[0] + self.ray_down * at[1]
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

    /// An eye-centered position as homogeneous pixels `(x·w, y·w, w)`.
    pub fn pixels_from_eye(&self, offset: DVec3) -> DVec3 {
        DVec3::from(self.screen.rows.map(|row| row.dot(offset)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
