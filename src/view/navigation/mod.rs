//! Moving a camera by hand: around a point, toward the cursor, on foot, in flight, and from one view to another.
//!
//! A [`Navigator`] is mathematics alone: it takes turns, steps, points and spans of time, and the ground's height as a
//! function. It never takes the eye below the ground.
//!
//! - `pose`: where somebody stands and whither they look.
//! - `transition`: from one pose to another.

pub mod pose;
pub mod transition;

use glam::{DVec2, DVec3};

use crate::navigation::pose::ViewPose;
use crate::navigation::transition::PoseTransition;

/// World Z of the ground at a world position; `None` where there is none.
pub type GroundZ<'a> = &'a dyn Fn(DVec2) -> Option<f64>;

/// The least height of an eye above the ground, meters: nearer to it the near plane cuts the ground open.
const CLEARANCE_M: f64 = 1.5;

/// The nearest that an eye comes to the point that it turns around or moves toward, meters.
const NEAREST_M: f64 = 2.0;

/// The farthest that an eye goes from the middle of the scene, in diagonals of the scene: from there the scene is a few
/// pixels wide.
const FARTHEST_DIAGONALS: f64 = 20.0;

/// How far a fly crosses in a second, as a share of its height above the ground: the ground then passes at the same pace at
/// every height.
const FLIGHT_PACE: f64 = 0.8;

/// The speed of a flight near the ground, and the greatest, meters a second.
const FLIGHT_MPS: [f64; 2] = [8.0, 20_000.0];

/// Walking speed, meters a second: a fast walk is easier to look at than a true one.
const WALK_MPS: f64 = 3.0;

/// The time in which the eye of a walker comes half as near to its height above the ground, seconds: steps of the ground do
/// not shake the picture.
const SETTLE_S: f64 = 0.06;

/// The height of a walker's eye above the ground, meters.
const EYE_HEIGHT_M: f64 = 1.7;

/// How far within the border of the scene a walker stays, as a share of its sides: on it there may be no ground.
const BORDER_SHARE: f64 = 1e-3;

/// The places on the way to the middle of a scene at which ground is looked for where there is none at its border.
const WAY_IN: u32 = 64;

/// The seconds in which a named view is flown to.
pub const TRANSITION_S: f64 = 1.2;

/// The way in which steps move the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NavigationMode {
    /// Around and toward what is under the cursor; steps fly.
    #[default]
    Orbit,
    /// On foot, at a height above the ground.
    OnFoot,
    /// In any direction.
    Flight,
}

/// Steps in one frame, each -1 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NavigationSteps {
    /// Forward; negative for backward.
    pub forward: f64,
    /// To the right; negative for the left.
    pub right: f64,
    /// Up; negative for down.
    pub up: f64,
}

/// The scene that is moved in, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigatedSpace {
    /// The least corner of its box.
    pub min: DVec3,
    /// The greatest.
    pub max: DVec3,
}

/// A camera moved by hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Navigator {
    pose: ViewPose,
    mode: NavigationMode,
    space: NavigatedSpace,
    transition: Option<PoseTransition>,
}

impl Navigator {
    /// Starts at a pose.
    pub fn new(pose: ViewPose, space: NavigatedSpace) -> Self {
        Self { pose, mode: NavigationMode::default(), space, transition: None }
    }

    /// The position of the eye and its viewing direction.
    pub fn pose(&self) -> ViewPose {
        self.pose
    }

    /// The mode, which decides how steps move the eye.
    pub fn mode(&self) -> NavigationMode {
        self.mode
    }

    /// Changes how steps move the eye. Who begins to walk stands on the ground below at the next step of time; off the scene,
    /// he is brought to its nearest ground.
    pub fn set_mode(&mut self, mode: NavigationMode) {
        self.mode = mode;
    }

    /// Whether it is on the way to another pose.
    pub fn is_on_its_way(&self) -> bool {
        self.transition.is_some()
    }

    /// Puts the eye at a pose at once.
    pub fn place(&mut self, pose: ViewPose, ground: GroundZ<'_>) {
        self.transition = None;
        self.pose = pose;
        self.keep_above(ground);
    }

    /// Moves to a pose in `seconds`, with [`Navigator::advance`].
    pub fn go_to(&mut self, pose: ViewPose, seconds: f64) {
        self.transition = Some(PoseTransition::new(self.pose, pose, seconds));
    }

    /// Turns the eye around `pivot`: radians to the right, and up over it. A transition ends.
    pub fn orbit(&mut self, pivot: DVec3, turn: DVec2, ground: GroundZ<'_>) {
        self.transition = None;
        let before = self.pose;
        self.pose = before.turned(turn);
        // What the turn of the view did, less what the limit of the pitch held back, moves the eye.
        self.pose.eye = pivot + self.pose.from_frame(before.to_frame(before.eye - pivot));
        self.keep_above(ground);
    }

    /// Turns the view where the eye is: radians to the right, and up. A transition ends.
    pub fn look(&mut self, turn: DVec2) {
        self.transition = None;
        self.pose = self.pose.turned(turn);
    }

    /// Moves the eye level so that `grabbed`, world space, comes under the ray from the eye along `direction`; not where that
    /// looks past the horizon of its height. A transition ends.
    pub fn drag(&mut self, grabbed: DVec3, direction: DVec3, ground: GroundZ<'_>) {
        self.transition = None;
        let eye = self.pose.eye;
        let rise = grabbed.z - eye.z;
        // Near its horizon a pixel is farther than a step may be.
        let along = rise / direction.z;
        let reach_m = FARTHEST_DIAGONALS * self.diagonal_m();
        if along.is_finite() && along > 0.0 && along * direction.truncate().length() < reach_m {
            let shift = (grabbed - (eye + direction * along)).truncate();
            self.pose.eye = self.within(eye + shift.extend(0.0));
            self.keep_above(ground);
        }
    }

    /// Moves the eye toward `point`, world space, until it is `factor` times as far from it: 0.5 for half the distance. A
    /// transition ends.
    pub fn zoom(&mut self, point: DVec3, factor: f64, ground: GroundZ<'_>) {
        self.transition = None;
        let off = self.pose.eye - point;
        let distance_m = off.length();
        if distance_m > 0.0 && factor.is_finite() && factor > 0.0 {
            let nearest_m = distance_m.min(NEAREST_M);
            let eye = point + off * ((distance_m * factor).max(nearest_m) / distance_m);
            self.pose.eye = self.within(eye);
            self.keep_above(ground);
        }
    }

    /// Lets `seconds` pass with `steps`, at most a quarter of a second at once: a hitch does not end behind a mountain.
    /// Returns whether the pose changed.
    pub fn advance(&mut self, seconds: f64, steps: NavigationSteps, ground: GroundZ<'_>) -> bool {
        let (before, seconds) = (self.pose, seconds.clamp(0.0, 0.25));
        let way = self.way(steps);
        if way != DVec3::ZERO {
            self.transition = None;
        }
        if let Some(transition) = &mut self.transition {
            self.pose = transition.advance(seconds);
            if transition.is_over() {
                self.transition = None;
            }
            self.keep_above(ground);
            return self.pose != before;
        }
        self.pose.eye = self.within(self.pose.eye + way * self.speed_mps(ground) * seconds);
        if self.mode == NavigationMode::OnFoot && self.holds(before.eye.truncate()) {
            self.pose.eye = self.nearest_within(self.pose.eye.truncate()).extend(self.pose.eye.z);
        }
        match self.mode {
            NavigationMode::OnFoot => self.settle(seconds, ground),
            NavigationMode::Orbit | NavigationMode::Flight => self.keep_above(ground),
        }
        self.pose != before
    }

    /// The speed of a step of 1, meters a second.
    pub fn speed_mps(&self, ground: GroundZ<'_>) -> f64 {
        let [least, most] = FLIGHT_MPS;
        match self.mode {
            NavigationMode::OnFoot => WALK_MPS,
            NavigationMode::Orbit | NavigationMode::Flight => {
                (self.height_m(ground) * FLIGHT_PACE).clamp(least, most)
            }
        }
    }

    /// The height of the eye above the ground, or above the lowest of it where there is none.
    pub fn height_m(&self, ground: GroundZ<'_>) -> f64 {
        let eye = self.pose.eye;
        (eye.z - ground(eye.truncate()).unwrap_or(self.space.min.z)).max(0.0)
    }

    /// The direction of steps in world space, at most 1 long.
    fn way(&self, steps: NavigationSteps) -> DVec3 {
        let NavigationSteps { forward, right, up } = steps;
        let (level, aside) = (self.pose.level_forward(), self.pose.right());
        let way = match self.mode {
            NavigationMode::OnFoot => level * forward + aside * right,
            NavigationMode::Flight => self.pose.forward() * forward + aside * right + DVec3::Z * up,
            NavigationMode::Orbit => level * forward + aside * right + DVec3::Z * up,
        };
        way.clamp_length_max(1.0)
    }

    /// Brings a walker's eye nearer to its height above the ground, or to the scene, where it is off that.
    fn settle(&mut self, seconds: f64, ground: GroundZ<'_>) {
        let at = self.pose.eye.truncate();
        match ground(at) {
            Some(z) => {
                let wanted = z + EYE_HEIGHT_M;
                let left = libm::exp2(-seconds / SETTLE_S);
                self.pose.eye.z = wanted + (self.pose.eye.z - wanted) * left;
            }
            None if !self.holds(at) => self.step_onto_the_scene(ground),
            // A void, or ground that is still being read.
            None => {}
        }
        self.keep_above(ground);
    }

    /// Begins the way to the ground nearest to the eye: at the border of the scene, else on the line to its middle.
    fn step_onto_the_scene(&mut self, ground: GroundZ<'_>) {
        let border = self.nearest_within(self.pose.eye.truncate());
        let middle = self.space.min.midpoint(self.space.max).truncate();
        let way_in = (0..=WAY_IN).map(|step| border.lerp(middle, f64::from(step) / f64::from(WAY_IN)));
        let mut places = way_in.filter_map(|at| Some(at.extend(ground(at)?)));
        if let Some(place) = places.next() {
            let eye = place + DVec3::Z * EYE_HEIGHT_M;
            self.go_to(ViewPose { eye, ..self.pose }, TRANSITION_S);
        }
    }

    /// Whether a place lies on the scene, as far within its border as a walker stays.
    fn holds(&self, at: DVec2) -> bool {
        self.nearest_within(at) == at
    }

    /// The nearest place that a walker may stand at.
    fn nearest_within(&self, at: DVec2) -> DVec2 {
        let (min, max) = (self.space.min.truncate(), self.space.max.truncate());
        let margin = (max - min) * BORDER_SHARE;
        at.max(min + margin).min(max - margin)
    }

    fn keep_above(&mut self, ground: GroundZ<'_>) {
        if let Some(z) = ground(self.pose.eye.truncate()) {
            self.pose.eye.z = self.pose.eye.z.max(z + CLEARANCE_M);
        }
    }

    fn diagonal_m(&self) -> f64 {
        self.space.min.distance(self.space.max).max(1.0)
    }

    /// The nearest place that is not too far from the scene.
    fn within(&self, eye: DVec3) -> DVec3 {
        let middle = self.space.min.midpoint(self.space.max);
        middle + (eye - middle).clamp_length_max(FARTHEST_DIAGONALS * self.diagonal_m())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;
    use crate::navigation::pose::wrapped;

    fn hills(at: DVec2) -> Option<f64> {
        Some(40.0 * libm::sin(at.x * 0.01) * libm::cos(at.y * 0.013))
    }

    fn navigator() -> Navigator {
        let eye = DVec3::new(0.0, -500.0, 300.0);
        let pose = ViewPose::looking(eye, DVec3::ZERO).expect("a direction");
        let far = DVec3::new(2000.0, 2000.0, 40.0);
        Navigator::new(pose, NavigatedSpace { min: -far, max: far })
    }

    #[test]
    fn a_pivot_stays_where_it_is_in_the_picture_and_as_far_away() {
        let (mut navigator, pivot) = (navigator(), DVec3::new(80.0, 30.0, 10.0));
        let seen = |of: &Navigator| of.pose().to_frame(pivot - of.pose().eye);
        let before = seen(&navigator);
        for turn in [DVec2::new(0.7, 0.0), DVec2::new(-2.0, -0.3), DVec2::new(0.1, 0.2)] {
            navigator.orbit(pivot, turn, &|_| None);
            assert!((seen(&navigator) - before).length() < 1e-6, "{:?}", navigator.pose());
        }
    }

    #[test]
    fn zooming_keeps_the_direction_of_the_point_and_halves_its_distance() {
        let (mut navigator, point) = (navigator(), DVec3::new(80.0, 30.0, 10.0));
        let off = navigator.pose().eye - point;
        navigator.zoom(point, 0.5, &hills);
        assert!((navigator.pose().eye - point - off * 0.5).length() < 1e-9);
        for _ in 0..40 {
            navigator.zoom(point, 0.5, &|_| None);
        }
        assert!((navigator.pose().eye.distance(point) - NEAREST_M).abs() < 1e-9);
        for _ in 0..400 {
            navigator.zoom(point, 2.0, &|_| None);
        }
        assert!(navigator.pose().eye.length() < 21.0 * 5700.0);
    }

    #[test]
    fn what_is_dragged_stays_under_the_cursor() {
        let mut navigator = navigator();
        let grabbed = DVec3::new(40.0, 200.0, 12.0);
        let direction = (DVec3::new(-90.0, 60.0, 12.0) - navigator.pose().eye).normalize();
        navigator.drag(grabbed, direction, &|_| None);
        let along = (grabbed - navigator.pose().eye).normalize();
        assert!((along - direction).length() < 1e-9);
        let before = navigator.pose();
        navigator.drag(grabbed, DVec3::new(0.0, 1.0, 0.2), &|_| None);
        assert_eq!(navigator.pose(), before, "past the horizon");
    }

    /// Hills from -2000 to 2000 m both ways, and none beyond.
    fn cut_hills(at: DVec2) -> Option<f64> {
        hills(at).filter(|_| at.abs().max_element() < 2000.0)
    }

    #[test]
    fn who_begins_to_walk_off_the_scene_comes_down_on_its_border_and_stays_on_it() {
        for start in [DVec3::new(2600.0, 300.0, 900.0), DVec3::new(-9000.0, 9000.0, 50.0)] {
            let mut navigator = navigator();
            navigator.place(ViewPose { eye: start, ..navigator.pose() }, &cut_hills);
            navigator.set_mode(NavigationMode::OnFoot);
            navigator.advance(0.02, NavigationSteps::default(), &cut_hills);
            assert!(navigator.is_on_its_way(), "frames follow");
            for _ in 0..150 {
                navigator.advance(0.02, NavigationSteps::default(), &cut_hills);
            }
            let eye = navigator.pose().eye;
            let above = eye.z - cut_hills(eye.truncate()).expect("on the scene");
            assert!((above - 1.7).abs() < 0.01, "{above} at {eye}");
            let border = start.truncate().clamp(DVec2::splat(-2000.0), DVec2::splat(2000.0));
            assert!(eye.truncate().distance(border) < 10.0, "{eye}");
            // Backward and aside, over the border.
            let steps = NavigationSteps { forward: -1.0, right: 1.0, up: 0.0 };
            for _ in 0..900 {
                navigator.advance(0.02, steps, &cut_hills);
            }
            assert!(cut_hills(navigator.pose().eye.truncate()).is_some(), "{:?}", navigator.pose());
        }
    }

    #[test]
    fn a_walker_waits_where_ground_within_the_scene_is_not_known_yet() {
        let mut navigator = navigator();
        navigator.set_mode(NavigationMode::OnFoot);
        let before = navigator.pose();
        navigator.advance(0.02, NavigationSteps::default(), &|_| None);
        assert_eq!((navigator.pose(), navigator.is_on_its_way()), (before, false));
    }

    #[test]
    fn a_walker_s_eye_is_at_its_height_and_moves_at_walking_speed() {
        let mut navigator = navigator();
        navigator.set_mode(NavigationMode::OnFoot);
        let steps = NavigationSteps { forward: 1.0, ..NavigationSteps::default() };
        for _ in 0..200 {
            navigator.advance(0.02, NavigationSteps::default(), &hills);
        }
        let from = navigator.pose().eye;
        for _ in 0..100 {
            navigator.advance(0.02, steps, &hills);
            let eye = navigator.pose().eye;
            let above = eye.z - hills(eye.truncate()).expect("hills everywhere");
            assert!((above - 1.7).abs() < 0.15, "{above}");
        }
        let gone = navigator.pose().eye.truncate().distance(from.truncate());
        assert!((gone - 2.0 * WALK_MPS).abs() < 1e-6, "{gone}");
    }

    #[test]
    fn a_transition_ends_at_its_pose_in_its_time_the_shorter_way_round() {
        let mut navigator = navigator();
        let (start, mut pose) = (navigator.pose(), navigator.pose());
        (pose.azimuth_rad, pose.eye) =
            (wrapped(start.azimuth_rad - 0.4), start.eye + DVec3::new(900.0, 0.0, 50.0));
        navigator.go_to(pose, 1.0);
        for _ in 0..9 {
            assert!(navigator.advance(0.1, NavigationSteps::default(), &hills));
            let turned = wrapped(navigator.pose().azimuth_rad - start.azimuth_rad);
            assert!((-0.4..=0.0).contains(&turned), "{turned}");
        }
        assert!(navigator.is_on_its_way());
        navigator.advance(0.1001, NavigationSteps::default(), &hills);
        assert!(!navigator.is_on_its_way());
        assert!(navigator.pose().eye.distance(pose.eye) < 1e-9);
        assert!((navigator.pose().forward() - pose.forward()).length() < 1e-9);
    }

    proptest! {
        #[test]
        fn whatever_is_done_the_eye_is_above_the_ground_and_the_pitch_within_its_limits(
            deeds in proptest::collection::vec((0u8..6, -1.0..1.0f64, -1.0..1.0f64, 0.01..3.0f64), 1..60)
        ) {
            let mut navigator = navigator();
            for (deed, a, b, c) in deeds {
                let point = DVec3::new(a * 900.0, b * 900.0, hills(DVec2::new(a * 900.0, b * 900.0)).unwrap_or(0.0));
                let steps = NavigationSteps { forward: a, right: b, up: -c };
                match deed {
                    0 => navigator.orbit(point, DVec2::new(a, b) * 3.0, &hills),
                    1 => navigator.zoom(point, c, &hills),
                    2 => navigator.drag(point, DVec3::new(a, b, -c), &hills),
                    3 => navigator.look(DVec2::new(a, b) * 3.0),
                    4 => navigator.set_mode(if a > 0.0 { NavigationMode::OnFoot } else { NavigationMode::Flight }),
                    _ => { navigator.advance(c, steps, &hills); }
                }
                let pose = navigator.pose();
                let above = pose.eye.z - hills(pose.eye.truncate()).unwrap_or(0.0);
                prop_assert!(above >= CLEARANCE_M - 1e-9, "{above} m over the ground");
                prop_assert!(pose.pitch_rad.abs() < FRAC_PI_2 && pose.eye.is_finite());
            }
        }
    }
}
