//! The point of a face at a pixel.

use glam::{Vec2, Vec3};

use crate::cpu::geometry::ScreenFace;
use crate::cpu::screen::Screen;

#[derive(Clone, Copy, Debug)]
pub struct FacePoint {
    pub world: Vec3,
    /// Meters from the eye; with parallel rays, along them.
    pub distance_m: f32,
    /// The change of `world` over one pixel to the right.
    pub right: Vec3,
    /// The change of `world` over one pixel down.
    pub down: Vec3,
}

/// The barycentric weights of a face's second and third corner at a point, and their change from pixel to pixel.
#[derive(Clone, Copy, Debug)]
pub struct Barycentric {
    at: Vec2,
    right: Vec2,
    down: Vec2,
}

impl FacePoint {
    pub fn new(face: &ScreenFace, screen: &Screen, at: [f32; 2]) -> Self {
        let plane = &face.planes.nearness;
        let depth_m = screen.depth_m(face.nearness(at));
        let world = screen.world_at(at, depth_m);
        if screen.is_parallel {
            // depth = far · (2 − plane).
            let forward = screen.forward.as_vec3();
            let change = |step: Vec3, slope: f64| step - forward * (slope * screen.far) as f32;
            let (right, down) = (change(screen.right, plane.right), change(screen.down, plane.down));
            return Self { world, distance_m: depth_m, right, down };
        }
        let ray = screen.ray_at(at);
        // p = eye + ray · depth and depth = 1 / plane, hence dp = depth · (dray − ray · depth · dplane).
        let change = |step: Vec3, slope: f64| (step - ray * (slope as f32 * depth_m)) * depth_m;
        Self {
            world,
            distance_m: ray.length() * depth_m,
            right: change(screen.right, plane.right),
            down: change(screen.down, plane.down),
        }
    }
}

impl FacePoint {
    /// The mean width of the pixel in plan, in meters: the geometric mean of its sides.
    pub fn mean_pixel_m(&self) -> f32 {
        (self.right.truncate().length_squared() * self.down.truncate().length_squared()).sqrt().sqrt()
    }

    /// The width of the pixel across the view, in meters: the surface may lie along it in one direction, not in both.
    pub fn across_m(&self) -> f32 {
        self.right.length_squared().min(self.down.length_squared()).sqrt()
    }

    /// The greatest width of the pixel in plan, in meters.
    pub fn pixel_m(&self) -> f32 {
        self.right.truncate().length_squared().max(self.down.truncate().length_squared()).sqrt()
    }
}

impl Barycentric {
    /// The weights at pixel position `at`, clamped to the triangle.
    pub fn new(face: &ScreenFace, at: [f32; 2]) -> Self {
        let weights = Self::extended(face, at);
        let second = weights.at.x.clamp(0.0, 1.0);
        Self { at: Vec2::new(second, weights.at.y.max(0.0).min(1.0 - second)), ..weights }
    }

    /// The weights at pixel position `at`; outside the triangle some are negative.
    pub fn extended(face: &ScreenFace, at: [f32; 2]) -> Self {
        let planes = &face.planes;
        let divisor = planes.divisor();
        let depth = 1.0 / divisor.at(at);
        let (second, third) = (planes.second.at(at) * depth, planes.third.at(at) * depth);
        let step = |[inverse, second_slope, third_slope]: [f64; 3]| {
            let change = |slope: f64, weight: f64| ((slope - weight * inverse) * depth) as f32;
            Vec2::new(change(second_slope, second), change(third_slope, third))
        };
        Self {
            at: Vec2::new(second as f32, third as f32),
            right: step([divisor.right, planes.second.right, planes.third.right]),
            down: step([divisor.down, planes.second.down, planes.third.down]),
        }
    }

    /// The distances from the three edges, and the triangle's heights over them, in pixels.
    pub fn edges_px(&self) -> [Vec3; 2] {
        let whole = |pair: Vec2, sum: f32| Vec3::new(sum - pair.x - pair.y, pair.x, pair.y);
        let (weights, right, down) = (whole(self.at, 1.0), whole(self.right, 0.0), whole(self.down, 0.0));
        let per_px = (right * right + down * down).map(|square| square.sqrt().max(f32::MIN_POSITIVE));
        [weights.abs() / per_px, per_px.recip()]
    }

    pub fn blend(&self, [a, b, c]: [Vec3; 3]) -> Vec3 {
        a + (b - a) * self.at.x + (c - a) * self.at.y
    }

    pub fn blend_number(&self, [a, b, c]: [f32; 3]) -> f32 {
        a + (b - a) * self.at.x + (c - a) * self.at.y
    }

    /// Texture coordinates, and their change over one pixel to the right and one down.
    pub fn blend_uv(&self, corners: [[f32; 2]; 3]) -> [Vec2; 3] {
        let [a, b, c] = corners.map(Vec2::from);
        let along = |weights: Vec2| (b - a) * weights.x + (c - a) * weights.y;
        [a + along(self.at), along(self.right), along(self.down)]
    }
}
