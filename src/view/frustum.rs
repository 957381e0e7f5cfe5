//! The five planes that bound a camera's view, for culling boxes.

use glam::Vec3;

use crate::view::camera::Camera;
use crate::view::planes;

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
        let tan = camera.tan_half_fov();
        let through_eye = |normal: Vec3| (normal, -normal.dot(eye));
        let far_point = eye + forward * camera.planes().1;
        Self {
            planes: [
                through_eye(forward * tan.x + camera.right()),
                through_eye(forward * tan.x - camera.right()),
                through_eye(forward * tan.y + camera.up()),
                through_eye(forward * tan.y - camera.up()),
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
}
