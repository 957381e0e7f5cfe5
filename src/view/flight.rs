//! Flights: where the eye is and what it looks at, frame by frame, over a ground that is only a function.
//!
//! A flight is a list of stations and nothing else, so that every method sees the same cameras and a frame can be
//! looked at again. Flights over the ground follow its mean height along the way, not its height below: an eye
//! that jumps over every boulder would measure the boulders.

use glam::{Vec2, Vec3};

use crate::view::camera::{Camera, CameraError};

/// The papers' window in pixels.
pub const PICTURE_SIZE: (u32, u32) = (1024, 768);

/// Half the picture's width seen from one unit away: the tangent of 30°.
const TAN_HALF_WIDTH: f32 = 0.577_350_26;

/// What the eye falls on the way of one meter ahead: 8° down.
const FALL: f32 = 0.14;

/// Heights of the ground that the mean is taken of, on either side of the eye.
const SMOOTHED: i16 = 8;

/// How far ahead the target lies, in units of the direction's length: far enough for its f32 to tell directions.
const AHEAD: f32 = 1000.0;

/// Where the eye is and what it looks at, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightStation {
    /// The eye.
    pub eye: Vec3,
    /// What it looks at; not the eye itself.
    pub target: Vec3,
}

impl FlightStation {
    /// The camera of a flight: 60° wide, 1024 × 768 pixels, from `near_m` to `far_m`.
    ///
    /// # Errors
    /// See [`CameraError`]; the eye is its own target, or the planes are out of order.
    pub fn camera(&self, near_m: f32, far_m: f32) -> Result<Camera, CameraError> {
        let (width, height) = PICTURE_SIZE;
        let fov_y = 2.0 * libm::atanf(TAN_HALF_WIDTH * height as f32 / width as f32);
        Camera::new(self.eye, self.target, fov_y, PICTURE_SIZE, (near_m, far_m))
    }
}

/// How a flight keeps to the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundClearance {
    /// Meters of the eye above the smoothed ground.
    pub height_m: f32,
    /// Meters along the way between the 17 heights whose mean is the smoothed ground.
    pub smoothing_m: f32,
}

/// A circle flown counter-clockwise from its easternmost point, looking ahead and 8° down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircularFlight {
    /// The middle, world X and Y.
    pub center: Vec2,
    /// Its radius in meters, above 0.
    pub radius_m: f32,
    /// Meters from one frame to the next.
    pub step_m: f32,
    /// How it keeps to the ground.
    pub clearance: GroundClearance,
}

impl CircularFlight {
    /// The first `frames` stations over a ground of world Z `ground`.
    pub fn stations(&self, frames: usize, ground: &impl Fn(Vec2) -> f32) -> Vec<FlightStation> {
        (0..frames).map(|frame| self.station(frame as f32 * self.step_m, ground)).collect()
    }

    /// The station after `way_m` meters of travel.
    pub fn station(&self, way_m: f32, ground: &impl Fn(Vec2) -> f32) -> FlightStation {
        let place = |way_m: f32| {
            let angle = way_m / self.radius_m;
            self.center + self.radius_m * Vec2::new(libm::cosf(angle), libm::sinf(angle))
        };
        let angle = way_m / self.radius_m;
        let ahead = Vec2::new(-libm::sinf(angle), libm::cosf(angle));
        over(place, way_m, ahead, self.clearance, ground)
    }
}

/// Straight on from one place to another, looking ahead and 8° down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightFlight {
    /// Where it starts, world X and Y.
    pub from: Vec2,
    /// Where it ends; not where it starts.
    pub to: Vec2,
    /// How it keeps to the ground.
    pub clearance: GroundClearance,
}

impl StraightFlight {
    /// `frames` stations at equal distances, both ends among them, over a ground of world Z `ground`.
    pub fn stations(&self, frames: usize, ground: &impl Fn(Vec2) -> f32) -> Vec<FlightStation> {
        let (length, ahead) = (self.from.distance(self.to), (self.to - self.from).normalize_or(Vec2::X));
        let place = |way_m: f32| self.from + ahead * way_m;
        let step_m = length / frames.saturating_sub(1).max(1) as f32;
        (0..frames).map(|frame| over(place, frame as f32 * step_m, ahead, self.clearance, ground)).collect()
    }
}

/// The station at `way_m` of the way `place`, above the mean ground around it.
fn over(
    place: impl Fn(f32) -> Vec2,
    way_m: f32,
    ahead: Vec2,
    keeping: GroundClearance,
    ground: &impl Fn(Vec2) -> f32,
) -> FlightStation {
    let heights = (-SMOOTHED..=SMOOTHED).map(|at| ground(place(way_m + f32::from(at) * keeping.smoothing_m)));
    let mean = heights.sum::<f32>() / f32::from(2 * SMOOTHED + 1);
    let eye = place(way_m).extend(mean + keeping.height_m);
    FlightStation { eye, target: eye + ahead.extend(-FALL) * AHEAD }
}

/// `frames` stations at equal distances along the legs between `stations`, both ends among them.
///
/// The eye's distance counts; on a leg where the eye stays in its place, the target's. Where nothing moves, or one
/// station is given, all frames are the first station; where none is given, there are no frames.
pub fn evenly_spaced(stations: &[FlightStation], frames: usize) -> Vec<FlightStation> {
    let Some(first) = stations.first() else {
        return Vec::new();
    };
    let lengths: Vec<f64> = stations.windows(2).map(|ends| leg_length(&ends[0], &ends[1])).collect();
    let whole: f64 = lengths.iter().sum();
    let step = whole / frames.saturating_sub(1).max(1) as f64;
    let (mut leg, mut before) = (0, 0.0);
    let station = |frame: usize| {
        let way = frame as f64 * step;
        while leg + 1 < lengths.len() && before + lengths[leg] < way {
            before += lengths[leg];
            leg += 1;
        }
        match lengths.get(leg) {
            Some(&length) if length > 0.0 => {
                let part = ((way - before) / length).clamp(0.0, 1.0) as f32;
                between(&stations[leg], &stations[leg + 1], part)
            }
            _ => stations.get(leg).copied().unwrap_or(*first),
        }
    };
    (0..frames).map(station).collect()
}

fn leg_length(from: &FlightStation, to: &FlightStation) -> f64 {
    let eye = from.eye.as_dvec3().distance(to.eye.as_dvec3());
    if eye > 0.0 { eye } else { from.target.as_dvec3().distance(to.target.as_dvec3()) }
}

fn between(from: &FlightStation, to: &FlightStation, part: f32) -> FlightStation {
    FlightStation { eye: from.eye.lerp(to.eye, part), target: from.target.lerp(to.target, part) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEEPING: GroundClearance = GroundClearance { height_m: 30.0, smoothing_m: 2.0 };

    #[test]
    fn a_circle_keeps_its_distance_its_pace_and_its_height_over_level_ground() {
        let circle = CircularFlight {
            center: Vec2::new(500.0, 400.0),
            radius_m: 150.0,
            step_m: 3.0,
            clearance: KEEPING,
        };
        let stations = circle.stations(400, &|_| 70.0);
        assert_eq!(stations[0].eye, Vec3::new(650.0, 400.0, 100.0));
        for pair in stations.windows(2) {
            assert!((pair[0].eye.truncate().distance(circle.center) - 150.0).abs() < 1e-3);
            assert!((pair[0].eye.distance(pair[1].eye) - 3.0).abs() < 1e-2);
            assert!((pair[0].eye.z - 100.0).abs() < 1e-3);
            let ahead = (pair[0].target - pair[0].eye).normalize();
            assert!((libm::asinf(-ahead.z).to_degrees() - 8.0).abs() < 0.05, "{ahead}");
            assert!(ahead.truncate().dot(pair[1].eye.truncate() - pair[0].eye.truncate()) > 0.0);
        }
    }

    #[test]
    fn a_line_goes_from_end_to_end_above_the_smoothed_slope() {
        let line = StraightFlight { from: Vec2::ZERO, to: Vec2::new(300.0, 400.0), clearance: KEEPING };
        let stations = line.stations(11, &|at| at.x);
        assert_eq!(stations.len(), 11);
        assert!(stations[10].eye.truncate().distance(line.to) < 1e-2);
        assert!(stations.iter().all(|station| (station.eye.z - station.eye.x - 30.0).abs() < 1e-2));
    }

    #[test]
    fn stations_along_legs_are_equally_far_apart() {
        let at = |x: f32, y: f32| FlightStation { eye: Vec3::new(x, y, 5.0), target: Vec3::new(x, y, 0.0) };
        let stations = evenly_spaced(&[at(0.0, 0.0), at(10.0, 0.0), at(10.0, 0.0), at(10.0, 30.0)], 9);
        let eyes: Vec<Vec2> = stations.iter().map(|station| station.eye.truncate()).collect();
        assert_eq!((eyes[0], eyes[2], eyes[8]), (Vec2::ZERO, Vec2::X * 10.0, Vec2::new(10.0, 30.0)));
        assert!(eyes.windows(2).all(|pair| (pair[0].distance(pair[1]) - 5.0).abs() < 1e-4), "{eyes:?}");
    }

    #[test]
    fn an_eye_that_stays_turns_by_its_target_and_one_station_is_enough() {
        let at = |x: f32| FlightStation { eye: Vec3::Z, target: Vec3::new(x, 7.0, 0.0) };
        let turned: Vec<f32> = evenly_spaced(&[at(0.0), at(4.0)], 5).iter().map(|s| s.target.x).collect();
        assert_eq!(turned, [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(evenly_spaced(&[at(2.0)], 3), vec![at(2.0); 3]);
        assert_eq!(evenly_spaced(&[at(2.0), at(2.0)], 2), vec![at(2.0); 2]);
        assert!(evenly_spaced(&[], 3).is_empty());
    }

    #[test]
    fn the_camera_of_a_flight_is_sixty_degrees_wide() {
        let station = FlightStation { eye: Vec3::ZERO, target: Vec3::Y };
        let camera = station.camera(0.5, 100.0).expect("sound");
        assert!((libm::atanf(camera.tan_half_fov().x).to_degrees() - 30.0).abs() < 1e-3);
        assert!((libm::atanf(camera.tan_half_fov().y).to_degrees() - 23.4).abs() < 0.05);
    }
}
