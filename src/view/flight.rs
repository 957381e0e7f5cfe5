//! Flights: the eye and the target of every frame, over a ground given as a function.
//!
//! A flight is a list of stations, so that every method sees the same cameras and any frame can be drawn again.
//! It follows the mean height of the ground along its track: an eye at a fixed height above the ground itself
//! would jump over every boulder.

use glam::{Vec2, Vec3};

use crate::camera::{Camera, CameraError};

/// Width and height of a flight's picture in pixels, as in the papers on levels of detail.
pub const PICTURE_SIZE: (u32, u32) = (1024, 768);

/// The tangent of half the horizontal field of view: 30°.
const TAN_HALF_WIDTH: f32 = 0.577_350_26;

/// The descent of the line of sight per meter ahead: 8° down.
const DESCENT: f32 = 0.14;

/// Ground heights on either side of the eye that enter the mean.
const MEAN_REACH: i16 = 8;

/// Meters from the eye to the target: far enough for f32 to tell directions apart.
const TARGET_DISTANCE_M: f32 = 1000.0;

/// The eye and its target, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightStation {
    /// The eye.
    pub eye: Vec3,
    /// The point it looks at; differs from the eye.
    pub target: Vec3,
}

impl FlightStation {
    /// The camera of a flight: 60° wide, 1024 × 768 pixels, from `near_m` to `far_m`.
    ///
    /// # Errors
    /// See [`CameraError`]: the eye is the target, or the planes are out of order.
    pub fn camera(&self, near_m: f32, far_m: f32) -> Result<Camera, CameraError> {
        let (width, height) = PICTURE_SIZE;
        let fov_y = 2.0 * libm::atanf(TAN_HALF_WIDTH * height as f32 / width as f32);
        Camera::new(self.eye, self.target, fov_y, PICTURE_SIZE, (near_m, far_m))
    }

    /// Meters that the eye travels to `next`; where the eye does not move, meters that the target travels.
    fn distance_to(&self, next: &Self) -> f64 {
        let eye = self.eye.as_dvec3().distance(next.eye.as_dvec3());
        if eye > 0.0 { eye } else { self.target.as_dvec3().distance(next.target.as_dvec3()) }
    }

    fn lerp(&self, next: &Self, share: f32) -> Self {
        Self { eye: self.eye.lerp(next.eye, share), target: self.target.lerp(next.target, share) }
    }
}

/// The height of the eye above the smoothed ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundClearance {
    /// Meters between the eye and the smoothed ground.
    pub height_m: f32,
    /// Meters along the track between the 17 ground heights whose mean is the smoothed ground.
    pub smoothing_m: f32,
}

impl GroundClearance {
    /// The station after `distance_m` meters of `track`, looking `ahead` and 8° down.
    fn station(
        &self,
        track: impl Fn(f32) -> Vec2,
        distance_m: f32,
        ahead: Vec2,
        ground: &impl Fn(Vec2) -> f32,
    ) -> FlightStation {
        let height = |step: i16| ground(track(distance_m + f32::from(step) * self.smoothing_m));
        let sum = (-MEAN_REACH..=MEAN_REACH).map(height).sum::<f32>();
        let eye = track(distance_m).extend(sum / f32::from(2 * MEAN_REACH + 1) + self.height_m);
        FlightStation { eye, target: eye + ahead.extend(-DESCENT) * TARGET_DISTANCE_M }
    }
}

/// A circle flown counter-clockwise from its easternmost point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircularFlight {
    /// World X and Y of the center.
    pub center: Vec2,
    /// The radius in meters, above 0.
    pub radius_m: f32,
    /// Meters from one frame to the next.
    pub step_m: f32,
    /// The height above the ground.
    pub clearance: GroundClearance,
}

impl CircularFlight {
    /// The first `frames` stations over a ground of world Z `ground`.
    pub fn stations(&self, frames: usize, ground: &impl Fn(Vec2) -> f32) -> Vec<FlightStation> {
        (0..frames).map(|frame| self.station(frame as f32 * self.step_m, ground)).collect()
    }

    /// The station after `distance_m` meters of travel.
    pub fn station(&self, distance_m: f32, ground: &impl Fn(Vec2) -> f32) -> FlightStation {
        let outward = |distance_m: f32| {
            let angle = distance_m / self.radius_m;
            Vec2::new(libm::cosf(angle), libm::sinf(angle))
        };
        let track = |distance_m: f32| self.center + self.radius_m * outward(distance_m);
        self.clearance.station(track, distance_m, outward(distance_m).perp(), ground)
    }
}

/// A straight line flown at constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightFlight {
    /// World X and Y of the start.
    pub from: Vec2,
    /// World X and Y of the end; differs from the start.
    pub to: Vec2,
    /// The height above the ground.
    pub clearance: GroundClearance,
}

impl StraightFlight {
    /// `frames` stations at equal distances, both ends included, over a ground of world Z `ground`.
    pub fn stations(&self, frames: usize, ground: &impl Fn(Vec2) -> f32) -> Vec<FlightStation> {
        let (length, ahead) = (self.from.distance(self.to), (self.to - self.from).normalize_or(Vec2::X));
        let track = |distance_m: f32| self.from + ahead * distance_m;
        let step_m = length / frames.saturating_sub(1).max(1) as f32;
        (0..frames).map(|frame| self.clearance.station(track, frame as f32 * step_m, ahead, ground)).collect()
    }
}

/// `frames` stations at equal distances along the legs between `stations`, both ends included.
///
/// Distance is that of the eye; on a leg where the eye stays in place, that of the target. All frames are the
/// first station where nothing moves or one station is given; without stations there are no frames.
pub fn evenly_spaced(stations: &[FlightStation], frames: usize) -> Vec<FlightStation> {
    let Some(first) = stations.first() else {
        return Vec::new();
    };
    let lengths: Vec<f64> = stations.windows(2).map(|ends| ends[0].distance_to(&ends[1])).collect();
    let step = lengths.iter().sum::<f64>() / frames.saturating_sub(1).max(1) as f64;
    let (mut leg, mut leg_start) = (0, 0.0);
    let station = |frame: usize| {
        let distance = frame as f64 * step;
        while leg + 1 < lengths.len() && leg_start + lengths[leg] < distance {
            leg_start += lengths[leg];
            leg += 1;
        }
        match lengths.get(leg) {
            Some(&length) if length > 0.0 => {
                let share = ((distance - leg_start) / length).clamp(0.0, 1.0) as f32;
                stations[leg].lerp(&stations[leg + 1], share)
            }
            _ => stations.get(leg).copied().unwrap_or(*first),
        }
    };
    (0..frames).map(station).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLEARANCE: GroundClearance = GroundClearance { height_m: 30.0, smoothing_m: 2.0 };

    #[test]
    fn a_circle_keeps_its_distance_its_pace_and_its_height_over_level_ground() {
        let circle = CircularFlight {
            center: Vec2::new(500.0, 400.0),
            radius_m: 150.0,
            step_m: 3.0,
            clearance: CLEARANCE,
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
        let line = StraightFlight { from: Vec2::ZERO, to: Vec2::new(300.0, 400.0), clearance: CLEARANCE };
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
