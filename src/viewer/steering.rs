//! The camera of the window: gestures in, poses out. Pure mathematics: it knows neither window nor keys.
//!
//! Three ways to move share one pose: turning about a place, flying, and walking at the height of an eye. Whatever moves
//! the camera at once may also be reached smoothly, by a transition.

use glam::{Vec2, Vec3};

use crate::geom::aabb::Aabb;
use crate::view::axes::DirectionAxes;
use crate::view::camera::{Camera, CameraError, far_m};
use crate::viewer::commands::HeldMotion;

/// The nearest that is drawn, in meters, as in pictures.
const NEAR_M: f32 = 0.5;
/// How steeply the camera may look down: straight down has no side that is up.
const STEEPEST_DOWN_DEG: f32 = 89.0;
/// How steeply it may look up.
const STEEPEST_UP_DEG: f32 = 70.0;
/// The least height over ground, in meters.
const CLEARANCE_M: f32 = 1.0;
/// The height of an eye that walks, in meters.
const EYE_HEIGHT_M: f32 = 1.7;
/// Degrees that dragging over the height of the picture turns.
const DEG_PER_PICTURE: f32 = 110.0;
/// Degrees a second that a held key turns.
const DEG_PER_SECOND: f32 = 50.0;
/// The share of the height over ground that a held key moves in a second, and the least, in meters.
const FLOWN_PER_SECOND: (f32, f32) = (0.8, 4.0);
/// Meters a second on foot: a brisk walk.
const WALKED_PER_SECOND: f32 = 2.5;
/// How many times as fast everything is with Shift.
const FAST: f32 = 4.0;
/// Seconds of a transition.
const TRANSITION_S: f32 = 1.1;
/// The nearest that zooming comes to a place, in meters.
const NEAREST_M: f32 = 2.0;
/// The longest time that one frame moves the camera by, in seconds: after a pause nothing leaps.
const LONGEST_STEP_S: f32 = 0.1;

/// How the camera moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SteeringMode {
    /// Dragging turns about a place.
    #[default]
    Orbit,
    /// Dragging turns the head; keys fly.
    Fly,
    /// As flying, at the height of an eye over ground.
    Walk,
}

/// Where the eye is and where it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPose {
    /// World space.
    pub eye: Vec3,
    /// Clockwise from north, radians.
    pub azimuth_rad: f32,
    /// Below the horizon, radians; negative looking up.
    pub pitch_rad: f32,
    /// Vertical field of view, radians.
    pub fov_y_rad: f32,
}

impl CameraPose {
    /// The pose of a camera that looks from `eye` along `forward`.
    pub fn looking(eye: Vec3, forward: Vec3, fov_y_rad: f32) -> Self {
        let pitch_rad = -libm::asinf(forward.z.clamp(-1.0, 1.0));
        Self { eye, azimuth_rad: libm::atan2f(forward.x, forward.y), pitch_rad, fov_y_rad }.limited()
    }

    /// The pose of a camera; straight down, north is up.
    pub fn of(camera: &Camera) -> Self {
        let fov_y_rad = match camera.parallel_frame() {
            None => 2.0 * libm::atanf(camera.tan_half_fov().y),
            Some(_) => 40f32.to_radians(),
        };
        let level = (camera.forward() + camera.up()).truncate();
        let pose = Self::looking(camera.eye(), camera.forward(), fov_y_rad);
        Self { azimuth_rad: libm::atan2f(level.x, level.y), ..pose }
    }

    /// The directions of its picture.
    pub fn axes(&self) -> DirectionAxes {
        DirectionAxes::new(self.azimuth_rad, self.pitch_rad)
    }

    /// A camera on a picture of `size` pixels; `scene` is the box of what is seen.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn camera(&self, size: (u32, u32), scene: &Aabb) -> Result<Camera, CameraError> {
        let target = self.eye + self.axes().forward * self.eye.length().max(1_000.0);
        Camera::new(self.eye, target, self.fov_y_rad, size, (NEAR_M, far_m(scene, self.eye)))
    }

    fn limited(self) -> Self {
        let pitch_rad = self.pitch_rad.clamp(-STEEPEST_UP_DEG.to_radians(), STEEPEST_DOWN_DEG.to_radians());
        Self { pitch_rad, ..self }
    }

    /// The pose turned by angles about the place `pivot`, which stays where it is on the picture.
    fn turned_about(self, pivot: Vec3, azimuth_rad: f32, pitch_rad: f32) -> Self {
        let place = self.axes().coordinates(pivot - self.eye);
        let (azimuth_rad, pitch_rad) = (self.azimuth_rad + azimuth_rad, self.pitch_rad + pitch_rad);
        let turned = Self { azimuth_rad, pitch_rad, ..self }.limited();
        let DirectionAxes { right, up, forward } = turned.axes();
        Self { eye: pivot - right * place.x - up * place.y - forward * place.z, ..turned }
    }

    fn between(&self, to: &Self, share: f32) -> Self {
        let turn = (to.azimuth_rad - self.azimuth_rad + std::f32::consts::PI)
            .rem_euclid(std::f32::consts::TAU)
            - std::f32::consts::PI;
        let mix = |from: f32, to: f32| from + (to - from) * share;
        Self {
            eye: self.eye.lerp(to.eye, share),
            azimuth_rad: self.azimuth_rad + turn * share,
            pitch_rad: mix(self.pitch_rad, to.pitch_rad),
            fov_y_rad: mix(self.fov_y_rad, to.fov_y_rad),
        }
    }
}

/// The camera and how it moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Steering {
    /// Where it is.
    pub pose: CameraPose,
    mode: SteeringMode,
    transition: Option<PoseTransition>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct PoseTransition {
    from: CameraPose,
    to: CameraPose,
    elapsed_s: f32,
}

/// World Z of the ground at world X and Y; `None` where there is none.
pub type GroundBelow<'a> = &'a dyn Fn(Vec3) -> Option<f32>;

impl Steering {
    /// A camera at `pose` that turns about places.
    pub fn new(pose: CameraPose) -> Self {
        Self { pose, mode: SteeringMode::Orbit, transition: None }
    }

    /// How it moves.
    pub fn mode(&self) -> SteeringMode {
        self.mode
    }

    /// Moves in another way from now on.
    pub fn set_mode(&mut self, mode: SteeringMode) {
        self.mode = mode;
    }

    /// Whether it moves by itself.
    pub fn is_under_way(&self) -> bool {
        self.transition.is_some()
    }

    /// Goes to a pose smoothly.
    pub fn go_to(&mut self, to: CameraPose) {
        self.transition = Some(PoseTransition { from: self.pose, to, elapsed_s: 0.0 });
    }

    /// Is at a pose at once.
    pub fn jump_to(&mut self, to: CameraPose) {
        self.transition = None;
        self.pose = to;
    }

    /// Goes to where `place` lies in the middle, `distance_m` away, looking as now but down by at least 25°.
    pub fn go_toward(&mut self, place: Vec3, distance_m: f32) {
        let pitch_rad = self.pose.pitch_rad.max(25f32.to_radians());
        let pose = CameraPose { pitch_rad, ..self.pose };
        self.go_to(CameraPose { eye: place - pose.axes().forward * distance_m.max(NEAREST_M), ..pose });
    }

    /// Looks in a direction, turned about `pivot`.
    pub fn look(&mut self, pivot: Vec3, azimuth_rad: f32, pitch_rad: f32) {
        let turn = (azimuth_rad - self.pose.azimuth_rad + std::f32::consts::PI)
            .rem_euclid(std::f32::consts::TAU)
            - std::f32::consts::PI;
        self.go_to(self.pose.turned_about(pivot, turn, pitch_rad - self.pose.pitch_rad));
    }

    /// Turns by a drag of `drag` pixels on a picture `height` pixels high: about `pivot`, or the head alone.
    pub fn turn(&mut self, drag: Vec2, height: f32, pivot: Option<Vec3>) {
        self.transition = None;
        let turn = drag / height.max(1.0) * DEG_PER_PICTURE.to_radians();
        self.pose = match pivot.filter(|_| self.mode == SteeringMode::Orbit) {
            Some(pivot) => self.pose.turned_about(pivot, turn.x, turn.y),
            None => {
                let (azimuth_rad, pitch_rad) = (self.pose.azimuth_rad - turn.x, self.pose.pitch_rad - turn.y);
                CameraPose { azimuth_rad, pitch_rad, ..self.pose }.limited()
            }
        };
    }

    /// Moves the ground along: the ray `to` meets the level of `grabbed` where the ray `from` did.
    pub fn pan(&mut self, grabbed: Vec3, from: Vec3, to: Vec3) {
        self.transition = None;
        let height = self.pose.eye.z - grabbed.z;
        // Near the horizon a pixel is a mile.
        let at_level = |ray: Vec3| (ray.z * height < -0.02 * height.abs()).then(|| ray * (-height / ray.z));
        match (at_level(from), at_level(to)) {
            (Some(from), Some(to)) => self.pose.eye -= (to - from).with_z(0.0),
            _ => self.pose.eye -= (to - from) * self.pose.eye.distance(grabbed),
        }
    }

    /// Comes nearer to `place` by the factor `zoom`, or goes farther off where it is below 1.
    pub fn zoom(&mut self, place: Vec3, zoom: f32) {
        self.transition = None;
        let offset = self.pose.eye - place;
        let distance = offset.length();
        let nearer = (distance / zoom.clamp(0.05, 20.0)).max(NEAREST_M.min(distance));
        self.pose.eye = place + offset * (nearer / distance.max(1e-3));
    }

    /// Moves by keys that are held for `seconds`; `focus` is the place in the picture's middle.
    pub fn hold(
        &mut self,
        motions: &[HeldMotion],
        is_fast: bool,
        seconds: f32,
        focus: Vec3,
        ground: GroundBelow<'_>,
    ) {
        if motions.is_empty() {
            return;
        }
        self.transition = None;
        let seconds = seconds.min(LONGEST_STEP_S) * if is_fast { FAST } else { 1.0 };
        let above =
            ground(self.pose.eye).map_or(self.pose.eye.distance(focus), |ground| self.pose.eye.z - ground);
        let speed = match self.mode {
            SteeringMode::Walk => WALKED_PER_SECOND,
            _ => (above * FLOWN_PER_SECOND.0).max(FLOWN_PER_SECOND.1),
        };
        let DirectionAxes { right, up, forward } = self.pose.axes();
        let level = (forward + up).with_z(0.0).normalize_or_zero();
        let ahead = if self.mode == SteeringMode::Fly { forward } else { level };
        let (step, turn) = (speed * seconds, (DEG_PER_SECOND * seconds).to_radians());
        let about = (self.mode == SteeringMode::Orbit).then_some(focus);
        for motion in motions {
            match motion {
                HeldMotion::Forward => self.pose.eye += ahead * step,
                HeldMotion::Backward => self.pose.eye -= ahead * step,
                HeldMotion::Left => self.pose.eye -= right * step,
                HeldMotion::Right => self.pose.eye += right * step,
                HeldMotion::Up => self.pose.eye.z += step,
                HeldMotion::Down => self.pose.eye.z -= step,
                HeldMotion::TurnLeft => self.turn_by(about, -turn, 0.0),
                HeldMotion::TurnRight => self.turn_by(about, turn, 0.0),
                HeldMotion::LookUp => self.turn_by(about, 0.0, -turn * 0.6),
                HeldMotion::LookDown => self.turn_by(about, 0.0, turn * 0.6),
                HeldMotion::ZoomIn => self.zoom(focus, libm::powf(4.0, seconds)),
                HeldMotion::ZoomOut => self.zoom(focus, libm::powf(4.0, -seconds)),
            }
        }
    }

    fn turn_by(&mut self, about: Option<Vec3>, azimuth_rad: f32, pitch_rad: f32) {
        self.pose = self.pose.turned_about(about.unwrap_or(self.pose.eye), azimuth_rad, pitch_rad);
    }

    /// Lets `seconds` pass: transitions go on, and the eye stays over ground.
    pub fn advance(&mut self, seconds: f32, ground: GroundBelow<'_>) {
        if let Some(transition) = &mut self.transition {
            transition.elapsed_s += seconds.min(LONGEST_STEP_S);
            let share = (transition.elapsed_s / TRANSITION_S).min(1.0);
            let eased = share * share * (3.0 - 2.0 * share);
            self.pose = transition.from.between(&transition.to, eased);
            if share == 1.0 {
                self.pose = transition.to;
                self.transition = None;
            }
        }
        if let Some(ground) = ground(self.pose.eye) {
            if self.mode == SteeringMode::Walk && self.transition.is_none() {
                self.pose.eye.z = ground + EYE_HEIGHT_M;
            } else {
                self.pose.eye.z = self.pose.eye.z.max(ground + CLEARANCE_M);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (800, 600);
    const SCENE: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::new(5_000.0, 5_000.0, 900.0) };

    fn pose() -> CameraPose {
        CameraPose::looking(Vec3::new(1_000.0, 500.0, 700.0), Vec3::new(0.3, 0.8, -0.4).normalize(), 0.7)
    }

    fn pixel(pose: &CameraPose, place: Vec3) -> Vec2 {
        pose.camera(SIZE, &SCENE).expect("sound").project(place).expect("before the eye").pixel
    }

    #[test]
    fn a_pose_and_its_camera_are_the_same() {
        let again = CameraPose::of(&pose().camera(SIZE, &SCENE).expect("sound"));
        assert!(again.eye == pose().eye && (again.azimuth_rad - pose().azimuth_rad).abs() < 1e-4);
        assert!((again.pitch_rad - pose().pitch_rad).abs() < 1e-4 && (again.fov_y_rad - 0.7).abs() < 1e-4);
    }

    #[test]
    fn the_place_turned_about_stays_under_the_pointer() {
        let place = Vec3::new(1_600.0, 2_000.0, 120.0);
        let mut steering = Steering::new(pose());
        let before = pixel(&steering.pose, place);
        for drag in [Vec2::new(70.0, 0.0), Vec2::new(-20.0, 35.0), Vec2::new(3.0, -300.0)] {
            steering.turn(drag, 600.0, Some(place));
            assert!(pixel(&steering.pose, place).distance(before) < 0.5, "{drag}");
        }
        assert!(steering.pose.eye.distance(place) > 900.0);
    }

    #[test]
    fn the_ground_grabbed_follows_the_pointer_and_zooming_keeps_the_place() {
        let place = Vec3::new(1_600.0, 2_000.0, 120.0);
        let mut steering = Steering::new(pose());
        let camera = steering.pose.camera(SIZE, &SCENE).expect("sound");
        let from = pixel(&steering.pose, place);
        let to = from + Vec2::new(55.0, 21.0);
        steering.pan(place, camera.ray_through(from), camera.ray_through(to));
        assert!(pixel(&steering.pose, place).distance(to) < 0.5);
        assert_eq!(steering.pose.eye.z, 700.0);
        steering.zoom(place, 2.0);
        assert!(pixel(&steering.pose, place).distance(to) < 0.5);
        let distance = steering.pose.eye.distance(place);
        steering.zoom(place, 0.5);
        assert!((steering.pose.eye.distance(place) / distance - 2.0).abs() < 1e-3);
    }

    #[test]
    fn a_transition_arrives_by_the_short_way_round() {
        let mut steering = Steering::new(CameraPose { azimuth_rad: 0.1, ..pose() });
        steering.go_to(CameraPose { azimuth_rad: std::f32::consts::TAU - 0.1, ..pose() });
        let mut widest = 0f32;
        for _ in 0..40 {
            steering.advance(0.05, &|_| None);
            widest = widest.max(libm::fabsf(libm::sinf(steering.pose.azimuth_rad)));
        }
        assert!(!steering.is_under_way() && widest < 0.11, "{widest}");
    }

    #[test]
    fn walking_follows_the_ground_and_flying_never_goes_under_it() {
        let mut steering = Steering::new(pose());
        let ground = |at: Vec3| Some(at.y * 0.1);
        steering.set_mode(SteeringMode::Walk);
        for _ in 0..10 {
            steering.hold(&[HeldMotion::Forward], true, 0.1, Vec3::ZERO, &ground);
            steering.advance(0.1, &ground);
            assert!((steering.pose.eye.z - steering.pose.eye.y * 0.1 - EYE_HEIGHT_M).abs() < 1e-3);
        }
        assert!(steering.pose.eye.y > 505.0);
        steering.set_mode(SteeringMode::Fly);
        for _ in 0..100 {
            steering.hold(&[HeldMotion::Down], true, 0.1, Vec3::ZERO, &ground);
            steering.advance(0.1, &ground);
        }
        assert!((steering.pose.eye.z - steering.pose.eye.y * 0.1 - CLEARANCE_M).abs() < 1e-3);
    }
}
