//! The five planes that bound a camera's view, for culling boxes.

use glam::{Vec2, Vec3};

use crate::camera::{Camera, ViewProjection};
use crate::planes;

/// The left, right, bottom, top and far planes of a camera, normals inward.
///
/// The near plane is left out: it would cull only a sliver before the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    planes: [(Vec3, f32); 5],
}

impl Frustum {
    /// All planes, as bits for [`Frustum::crossed_planes`].
    pub const ALL: u8 = 0b1_1111;

    /// The frustum of `camera`.
    pub fn new(camera: &Camera) -> Self {
        let (eye, forward) = (camera.eye(), camera.forward());
        let (right, up) = (camera.right(), camera.up());
        // Past the eye, by how much a side opens per meter ahead, and by how much it lies aside.
        let (tan, half_m) = match camera.projection() {
            ViewProjection::Perspective { .. } => (camera.tan_half_fov(), Vec2::ZERO),
            ViewProjection::Parallel(frame) => (Vec2::ZERO, frame.half_m),
        };
        let side = |normal: Vec3, aside_m: f32| (normal, aside_m - normal.dot(eye));
        let far_point = eye + forward * camera.planes().1;
        Self {
            planes: [
                side(forward * tan.x + right, half_m.x),
                side(forward * tan.x - right, half_m.x),
                side(forward * tan.y + up, half_m.y),
                side(forward * tan.y - up, half_m.y),
                (-forward, forward.dot(far_point)),
            ],
        }
    }

    /// Whether part of the box `min..=max` may be in view. Never false for a box in view; may be true for one
    /// just outside a corner.
    pub fn may_see(&self, min: Vec3, max: Vec3) -> bool {
        self.crossed_planes(min, max, Self::ALL).is_some()
    }

    /// The planes of the bit set `planes` that the box crosses, or `None` where it lies outside one of them. A
    /// box inside this one needs to be tested against the returned planes only.
    pub fn crossed_planes(&self, min: Vec3, max: Vec3, planes: u8) -> Option<u8> {
        planes::crossed_planes(&self.planes, min, max, planes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axes::DirectionAxes;
    use crate::camera::ParallelFrame;

    #[test]
    fn a_box_is_culled_beside_and_behind_but_not_before_the_eye() {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (100, 100), (1.0, 1000.0)).expect("sound");
        let frustum = Frustum::new(&camera);
        let unit_box_at = |center: Vec3| frustum.may_see(center - 1.0, center + 1.0);
        assert!(unit_box_at(Vec3::Y * 50.0));
        assert!(!unit_box_at(Vec3::Y * -50.0));
        assert!(!unit_box_at(Vec3::new(100.0, 50.0, 0.0)));
        assert!(!unit_box_at(Vec3::new(0.0, 50.0, 60.0)));
        assert!(!unit_box_at(Vec3::Y * 1100.0));
    }

    #[test]
    fn parallel_rays_see_a_slab() {
        let axes = DirectionAxes::new(0.0, 0.0);
        let frame = ParallelFrame { half_m: Vec2::new(20.0, 10.0), dpi: 96.0 };
        let camera = Camera::parallel(Vec3::ZERO, &axes, frame, (200, 100), (1.0, 1000.0)).expect("sound");
        let frustum = Frustum::new(&camera);
        let unit_box_at = |x: f32, y: f32, z: f32| {
            let center = Vec3::new(x, y, z);
            frustum.may_see(center - 1.0, center + 1.0)
        };
        assert!(unit_box_at(20.5, 500.0, 0.0) && unit_box_at(0.0, 900.0, -10.5));
        assert!(!unit_box_at(21.5, 500.0, 0.0) && !unit_box_at(0.0, 900.0, -11.5));
        assert!(!unit_box_at(0.0, 1100.0, 0.0));
    }
}
