//! A camera's view reduced to lines on the ground plane: far, left and right.
//!
//! A wedge needs no height ranges and never culls what the camera's
//! [frustum](crate::frustum::Frustum) sees. For a level camera its sides are the frustum's. Pitched up or
//! down, the far corners of the picture reach further round, and the sides open:
//!
//! ```text
//!     far                 h: meters along the heading per meter along the viewing
//!  ╲──────────╱              direction, of the ray through a lower (or upper) corner
//!   ╲        ╱               of the picture
//!    ╲      ╱ tan / h     tan: the same ray's meters sideways
//!     ╲    ╱
//!      ╲  ╱               h = cos pitch − tan(fov_y / 2) · |sin pitch|
//!      eye
//! ```
//!
//! Where h is 0 or less, the camera sees ground behind its own heading. The sides vanish, and the strip between the
//! farthest point ahead and the farthest point behind remains.

use glam::{Vec2, Vec3};

use crate::camera::Camera;
use crate::planes;

/// The share by which the sides open and the far line recedes, so that rounding never culls a box that the frustum
/// just touches: a hundred times the rounding of f32.
const SLACK: f32 = 1e-5;

/// Lines on the ground plane, normals inward.
///
/// Where there are no sides, the left line is the farthest behind and the right one bounds nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundWedge {
    /// As vertical planes.
    lines: [(Vec3, f32); 3],
}

impl GroundWedge {
    /// All lines, as bits for [`GroundWedge::crossed_lines`].
    pub const ALL: u8 = 0b111;

    /// The wedge of `camera`; with parallel rays, which no wedge holds, one that culls nothing.
    pub fn new(camera: &Camera) -> Self {
        if camera.parallel_frame().is_some() {
            return Self { lines: [(Vec3::ZERO, 0.0); 3] };
        }
        let (eye, right) = (camera.eye().truncate(), camera.right().truncate());
        // The camera's right is level, whatever its pitch.
        let heading = right.perp();
        let tan = camera.tan_half_fov() * (1.0 + SLACK);
        let along = |ray: Vec3| ray.truncate().dot(heading);
        let (level, opening) = (along(camera.forward()), (tan.y * along(camera.up())).abs());
        let (nearest, farthest) = (level - opening, level + opening);
        let far_m = camera.planes().1 * (1.0 + SLACK);
        let line = |normal: Vec2, distance_m: f32| (normal.extend(0.0), distance_m - normal.dot(eye));
        let far = line(-heading, far_m * farthest);
        let lines = if nearest > 0.0 {
            let side = |normal: Vec2| line(heading * tan.x + normal * nearest, 0.0);
            [far, side(right), side(-right)]
        } else {
            [far, line(heading, -far_m * nearest), (Vec3::ZERO, 0.0)]
        };
        Self { lines }
    }

    /// Whether something above the rectangle `min..=max` may be in view. Never false for what is in view.
    pub fn may_see(&self, min: Vec2, max: Vec2) -> bool {
        self.crossed_lines(min, max, Self::ALL).is_some()
    }

    /// The lines of the bit set `lines` that the rectangle crosses, or `None` where it lies outside one of them. A
    /// rectangle inside this one needs to be tested against the returned lines only.
    pub fn crossed_lines(&self, min: Vec2, max: Vec2, lines: u8) -> Option<u8> {
        planes::crossed_planes(&self.lines, min.extend(0.0), max.extend(0.0), lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn camera(eye: Vec3, direction: Vec3) -> Camera {
        Camera::new(eye, eye + direction, 0.8, (640, 480), (1.0, 1000.0)).expect("sound")
    }

    #[test]
    fn a_level_wedge_culls_beside_behind_and_beyond_whatever_the_height() {
        let wedge = GroundWedge::new(&camera(Vec3::Z * 900.0, Vec3::Y));
        let unit_at = |x: f32, y: f32| wedge.may_see(Vec2::new(x, y) - 1.0, Vec2::new(x, y) + 1.0);
        assert!(unit_at(0.0, 50.0) && unit_at(27.0, 50.0));
        assert!(!unit_at(31.0, 50.0) && !unit_at(-31.0, 50.0));
        assert!(!unit_at(0.0, -50.0) && !unit_at(0.0, 1002.0));
    }

    #[test]
    fn looking_straight_down_leaves_a_strip() {
        let wedge = GroundWedge::new(&camera(Vec3::Z * 900.0, -Vec3::Z));
        let unit_at = |x: f32, y: f32| wedge.may_see(Vec2::new(x, y) - 1.0, Vec2::new(x, y) + 1.0);
        assert!(unit_at(0.0, -300.0) && unit_at(0.0, 300.0) && unit_at(5000.0, 0.0));
        assert!(!unit_at(0.0, -500.0) && !unit_at(0.0, 500.0));
    }

    proptest! {
        #[test]
        fn the_wedge_never_culls_what_the_camera_sees(
            heading in 0.0..std::f32::consts::TAU, pitch in -1.57..1.57f32,
            x in 0.5..639.5f32, y in 0.5..479.5f32, depth_m in 1.0..1000.0f32,
            eye_x in -3000.0..3000.0f32, eye_y in -3000.0..3000.0f32,
        ) {
            let (sin, cos) = (libm::sinf(pitch), libm::cosf(pitch));
            let direction = Vec3::new(libm::cosf(heading) * cos, libm::sinf(heading) * cos, sin);
            let camera = camera(Vec3::new(eye_x, eye_y, 700.0), direction);
            let seen = camera.eye() + camera.ray_through(Vec2::new(x, y)) * depth_m;
            let slack = Vec2::splat(2e-3);
            let at = seen.truncate();
            prop_assert!(GroundWedge::new(&camera).may_see(at - slack, at + slack), "{seen} of {camera:?}");
        }
    }
}
