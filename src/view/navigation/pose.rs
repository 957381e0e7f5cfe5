//! The pose of a viewer: the eye and the viewing direction.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use crate::camera::{Camera, CameraError};
use sandtable_geom::azimuth::toward;

/// The steepest that a view looks up or down, radians: a hair from the vertical, where there would be no north.
pub const STEEPEST_RAD: f64 = FRAC_PI_2 - 1e-3;

/// How far ahead a camera's target is, meters: near the eye its direction would be lost in the rounding of f32.
const AHEAD_M: f64 = 20_000.0;

/// An eye in world space and the direction in which it looks, upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewPose {
    /// The eye, meters.
    pub eye: DVec3,
    /// Clockwise from north, radians, -π to π.
    pub azimuth_rad: f64,
    /// Above the horizon, radians; within [`STEEPEST_RAD`] either way.
    pub pitch_rad: f64,
}

/// The picture of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewPicture {
    /// The vertical field of view, radians.
    pub fov_y_rad: f32,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// The near and the far plane, meters.
    pub planes: (f32, f32),
}

impl ViewPose {
    /// The pose at `eye` that looks at `target`; `None` where they are one point or not finite. Straight down is north up.
    pub fn looking(eye: DVec3, target: DVec3) -> Option<Self> {
        let way = (target - eye).try_normalize()?;
        let level = way.truncate();
        let azimuth_rad = if level.length() > 1e-9 { libm::atan2(level.x, level.y) } else { 0.0 };
        let pitch_rad = libm::asin(way.z.clamp(-1.0, 1.0)).clamp(-STEEPEST_RAD, STEEPEST_RAD);
        Some(Self { eye, azimuth_rad, pitch_rad })
    }

    /// The pose of a camera in perspective or with parallel rays.
    pub fn of_camera(camera: &Camera) -> Self {
        let (eye, forward) = (camera.eye().as_dvec3(), camera.forward().as_dvec3());
        // Where it looks straight down, what is up in the picture says which way it faces.
        let level = if forward.truncate().length() > 1e-4 { forward } else { camera.up().as_dvec3() };
        let azimuth_rad = libm::atan2(level.x, level.y);
        let pitch_rad = libm::asin(forward.z.clamp(-1.0, 1.0)).clamp(-STEEPEST_RAD, STEEPEST_RAD);
        Self { eye, azimuth_rad, pitch_rad }
    }

    /// The camera of a picture from here.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn camera(&self, picture: &ViewPicture) -> Result<Camera, CameraError> {
        let target = self.eye + self.forward() * AHEAD_M;
        let ViewPicture { fov_y_rad, size, planes } = *picture;
        Camera::new(self.eye.as_vec3(), target.as_vec3(), fov_y_rad, size, planes)
    }

    /// The viewing direction, of length 1.
    pub fn forward(&self) -> DVec3 {
        let (sin, cos) = (libm::sin(self.pitch_rad), libm::cos(self.pitch_rad));
        self.level_forward() * cos + DVec3::Z * sin
    }

    /// The viewing direction on the level, of length 1.
    pub fn level_forward(&self) -> DVec3 {
        toward(self.azimuth_rad).extend(0.0)
    }

    /// The direction to the right, level, of length 1.
    pub fn right(&self) -> DVec3 {
        DVec3::new(libm::cos(self.azimuth_rad), -libm::sin(self.azimuth_rad), 0.0)
    }

    /// The direction to the top of the picture, of length 1.
    pub fn up(&self) -> DVec3 {
        self.right().cross(self.forward())
    }

    /// This pose turned to the right and up by so many radians, up to the steepest.
    pub fn turned(&self, turn: DVec2) -> Self {
        Self {
            azimuth_rad: wrapped(self.azimuth_rad + turn.x),
            pitch_rad: (self.pitch_rad + turn.y).clamp(-STEEPEST_RAD, STEEPEST_RAD),
            ..*self
        }
    }

    /// A world direction as parts to the right, up and forward.
    pub fn to_frame(self, world: DVec3) -> DVec3 {
        DVec3::new(world.dot(self.right()), world.dot(self.up()), world.dot(self.forward()))
    }

    /// The world direction of parts to the right, up and forward.
    #[allow(clippy::wrong_self_convention, reason = "named as transforms are, to and from")]
    pub fn from_frame(self, parts: DVec3) -> DVec3 {
        self.right() * parts.x + self.up() * parts.y + self.forward() * parts.z
    }
}

/// An angle brought to -π to π.
pub fn wrapped(angle_rad: f64) -> f64 {
    let turned = (angle_rad + PI).rem_euclid(TAU) - PI;
    if turned.is_finite() { turned } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_becomes_the_camera_that_it_came_from() {
        let picture = ViewPicture { fov_y_rad: 0.7, size: (640, 480), planes: (0.5, 9e4) };
        for (azimuth_rad, pitch_rad) in [(0.3, -0.2), (-2.9, 0.4), (1.6, -1.5), (3.0, -STEEPEST_RAD)] {
            let pose = ViewPose { eye: DVec3::new(12_000.0, -300.0, 900.0), azimuth_rad, pitch_rad };
            let camera = pose.camera(&picture).expect("sound");
            assert!((camera.forward().as_dvec3() - pose.forward()).length() < 1e-6);
            assert!((camera.right().as_dvec3() - pose.right()).length() < 2e-4, "{pose:?}");
            let back = ViewPose::of_camera(&camera);
            assert!(wrapped(back.azimuth_rad - azimuth_rad).abs() < 2e-4, "{back:?}");
            assert!((back.pitch_rad - pitch_rad).abs() < 2e-3, "{back:?}");
            let parts = DVec3::new(3.0, -2.0, 7.0);
            assert!((pose.to_frame(pose.from_frame(parts)) - parts).length() < 1e-12);
        }
    }

    #[test]
    fn east_is_a_right_angle_from_north_and_down_is_below_the_horizon() {
        let east = ViewPose::looking(DVec3::ZERO, DVec3::X * 9.0).expect("a direction");
        assert!((east.azimuth_rad - FRAC_PI_2).abs() < 1e-12 && east.pitch_rad == 0.0);
        let down = ViewPose::looking(DVec3::Z, DVec3::ZERO).expect("a direction");
        assert_eq!((down.azimuth_rad, down.pitch_rad), (0.0, -STEEPEST_RAD));
        assert_eq!(ViewPose::looking(DVec3::ONE, DVec3::ONE), None);
    }
}
