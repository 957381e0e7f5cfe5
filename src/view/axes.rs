//! Directions of view by compass direction and pitch.

use std::f32::consts::FRAC_PI_2;

use glam::Vec3;

/// A direction of view: an orthonormal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionAxes {
    /// The picture's right; level.
    pub right: Vec3,
    /// The picture's upper border.
    pub up: Vec3,
    /// The viewing direction.
    pub forward: Vec3,
}

impl DirectionAxes {
    /// The axes of a camera that looks toward `azimuth_rad`, clockwise from north, and `pitch_rad` below the horizon, a
    /// right angle at most: straight down, the azimuth is at the top of the picture.
    pub fn new(azimuth_rad: f32, pitch_rad: f32) -> Self {
        let (sin, cos) = (libm::sinf(azimuth_rad), libm::cosf(azimuth_rad));
        // The cosine of the nearest f32 to a right angle is not 0: heights would move in a plan.
        let (down, level) = match pitch_rad < FRAC_PI_2 {
            true => (libm::sinf(pitch_rad), libm::cosf(pitch_rad)),
            false => (1.0, 0.0),
        };
        let forward = Vec3::new(sin * level, cos * level, -down);
        let right = Vec3::new(cos, -sin, 0.0);
        Self { right, up: right.cross(forward), forward }
    }

    /// The coordinates of a point to the right, up and forward.
    pub fn coordinates(&self, point: Vec3) -> Vec3 {
        Vec3::new(point.dot(self.right), point.dot(self.up), point.dot(self.forward))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_look_where_they_are_told_with_the_picture_upright() {
        let axes = DirectionAxes::new(0.5, 0.8);
        assert!((axes.forward.z + libm::sinf(0.8)).abs() < 1e-6 && axes.up.z > 0.0 && axes.right.z == 0.0);
        assert!(axes.right.cross(axes.forward).abs_diff_eq(axes.up, 1e-6));
    }

    #[test]
    fn straight_down_the_azimuth_is_up() {
        let axes = DirectionAxes::new(0.5, FRAC_PI_2);
        assert_eq!((axes.forward, axes.up.z), (-Vec3::Z, 0.0));
        assert!(axes.up.abs_diff_eq(Vec3::new(libm::sinf(0.5), libm::cosf(0.5), 0.0), 1e-6));
    }
}
