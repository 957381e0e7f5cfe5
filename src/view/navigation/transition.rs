//! A transition from one pose to another: it begins and ends at rest, and turns the shorter way round.

use crate::navigation::pose::{ViewPose, wrapped};

/// A pose between two others, by the time that has passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseTransition {
    from: ViewPose,
    to: ViewPose,
    seconds: f64,
    passed_s: f64,
}

impl PoseTransition {
    /// A transition from one pose to another in `seconds`; at once where that is not above 0.
    pub fn new(from: ViewPose, to: ViewPose, seconds: f64) -> Self {
        Self { from, to, seconds, passed_s: 0.0 }
    }

    /// Lets time pass; returns the pose then.
    pub fn advance(&mut self, seconds: f64) -> ViewPose {
        self.passed_s += seconds;
        if self.is_over() {
            return self.to;
        }
        let part = eased(self.passed_s / self.seconds);
        ViewPose {
            eye: self.from.eye.lerp(self.to.eye, part),
            azimuth_rad: wrapped(
                self.from.azimuth_rad + wrapped(self.to.azimuth_rad - self.from.azimuth_rad) * part,
            ),
            pitch_rad: self.from.pitch_rad + (self.to.pitch_rad - self.from.pitch_rad) * part,
        }
    }

    /// Whether it has arrived.
    pub fn is_over(&self) -> bool {
        self.passed_s >= self.seconds || self.seconds.is_nan()
    }
}

/// 0 to 1 with neither speed nor acceleration at both ends (Perlin 2002).
fn eased(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * part * (part * (part * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn it_is_half_way_after_half_the_time_and_hardly_moves_at_first() {
        let from = ViewPose { eye: DVec3::ZERO, azimuth_rad: 3.0, pitch_rad: 0.0 };
        let to = ViewPose { eye: DVec3::X * 100.0, azimuth_rad: -3.0, pitch_rad: -0.5 };
        let mut transition = PoseTransition::new(from, to, 2.0);
        assert!(transition.advance(0.1).eye.x < 0.2);
        let middle = transition.advance(0.9);
        assert!((middle.eye.x - 50.0).abs() < 1e-9 && (middle.pitch_rad + 0.25).abs() < 1e-9);
        assert!(middle.azimuth_rad.abs() > 3.1, "across the south, not the north");
        assert_eq!((transition.advance(1.1), transition.is_over()), (to, true));
        assert_eq!(PoseTransition::new(from, to, 0.0).advance(0.0), to);
    }
}
