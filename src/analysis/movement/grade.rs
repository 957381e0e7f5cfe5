//! How grades along the way slow movement: tables by grade, since a cost surface needs them hundreds of millions of times.

use crate::movement::vehicle::{Drive, LEVEL_FOOT_KMH, Vehicle};

/// Steps of the table for a grade of 1: Tobler's and Langmuir's kinks, at −0.05 and −0.2125, are steps.
const STEPS: f32 = 2000.0;

/// The steepest grade of the table; steeper ones count as this.
const STEEPEST: f32 = 2.0;

/// The share of its level speed that a vehicle has at the end of where it goes freely, and at its limit.
const VEHICLE_SHARES: [f64; 2] = [0.6, 0.1];

/// How much longer than on the level a way takes, by its grade; infinite beyond the vehicle's limits.
pub(crate) struct GradeTable {
    /// From −[`STEEPEST`] to [`STEEPEST`]: the factor, and how much the next one is greater.
    factors: Vec<[f32; 2]>,
    /// The steepest grade downhill (below 0) and uphill that is passed.
    limits: [f32; 2],
    /// The steepest grade that a way counts with, downhill and uphill.
    way_limits: [f32; 2],
    /// Slopes across the way: free up to the first, not passed above the second. `None` on foot.
    across: Option<[f32; 2]>,
    /// The grade whose factor is the least.
    best_grade: f32,
}

impl GradeTable {
    /// The table of a vehicle; on foot by Langmuir's rule or by Tobler's function.
    pub fn new(vehicle: &Vehicle, is_langmuir: bool) -> Self {
        let count = (2.0 * STEEPEST * STEPS) as i32;
        let grade = |index: i32| f64::from(index) / f64::from(STEPS) - f64::from(STEEPEST);
        let factor = |grade: f64| match vehicle.drive {
            Drive::Foot if is_langmuir => langmuir(grade),
            Drive::Foot => tobler(grade),
            Drive::Wheels | Drive::Tracks if grade < 0.0 => slowed(-grade, vehicle.slope_down_percent),
            Drive::Wheels | Drive::Tracks => slowed(grade, vehicle.slope_up_percent),
        };
        let limit = |index: usize| {
            [
                -(vehicle.slope_down_percent[index] as f32) / 100.0,
                vehicle.slope_up_percent[index] as f32 / 100.0,
            ]
        };
        let is_foot = vehicle.drive == Drive::Foot;
        Self {
            factors: (0..=count)
                .map(|index| [factor(grade(index)), factor(grade(index + 1))].map(|factor| factor as f32))
                .map(|[factor, next]| [factor, next - factor])
                .collect(),
            limits: limit(1),
            way_limits: if is_foot { limit(1) } else { limit(0) },
            across: (!is_foot).then(|| vehicle.slope_across_percent.map(|percent| percent as f32 / 100.0)),
            best_grade: match vehicle.drive {
                // Steeper, Langmuir's rule leaps to more than thrice as long.
                Drive::Foot if is_langmuir => -0.2124,
                Drive::Foot => -0.05,
                Drive::Wheels | Drive::Tracks => 0.0,
            },
        }
    }

    /// The factor on open ground.
    #[inline(always)]
    pub fn open(&self, grade: f32) -> f32 {
        if grade < self.limits[0] || grade > self.limits[1] { f32::INFINITY } else { self.factor(grade) }
    }

    /// The factor on roads and bridges. They are passable as they are: a model of the ground shows the slope across which a
    /// road was cut, so a vehicle's grade there counts at most as the steepest that it goes freely.
    #[inline(always)]
    pub fn on_way(&self, grade: f32) -> f32 {
        self.factor(grade.clamp(self.way_limits[0], self.way_limits[1]))
    }

    /// Whether slopes across the way have an effect.
    pub fn has_across(&self) -> bool {
        self.across.is_some()
    }

    /// The grade whose factor is the least.
    pub fn best_grade(&self) -> f32 {
        self.best_grade
    }

    /// Whether a slope, given by its square, slows a vehicle that goes across it.
    #[inline]
    pub fn is_slowed_across(&self, slope2: f32) -> bool {
        self.across.is_some_and(|[free, _]| slope2 > free * free)
    }

    /// The greatest slope across the way that is passed, a ten-thousandth less for rounding; infinite on foot.
    #[inline]
    pub fn across_limit(&self) -> f32 {
        self.across.map_or(f32::INFINITY, |[_, limit]| limit * 0.9999)
    }

    /// The factor of a slope across the way, from 1 where it is free to 2 at the limit.
    #[inline(always)]
    pub fn across(&self, slope: f32) -> f32 {
        match self.across {
            Some([_, limit]) if slope > limit => f32::INFINITY,
            Some([free, limit]) if slope > free => 1.0 + (slope - free) / (limit - free),
            _ => 1.0,
        }
    }

    /// The greatest finite factor on open ground, slopes across included.
    pub fn greatest(&self) -> f32 {
        self.factors.iter().fold(1.0f32, |greatest, &[factor, _]| greatest.max(factor)) * 2.0
    }

    /// The least factor.
    pub fn least(&self) -> f32 {
        self.factors.iter().fold(1.0f32, |least, &[factor, _]| least.min(factor))
    }

    #[inline(always)]
    fn factor(&self, grade: f32) -> f32 {
        let at = (grade.clamp(-STEEPEST, STEEPEST) + STEEPEST) * STEPS;
        // A grade without a value has the first.
        let index = (at as i32 as usize).min(self.factors.len() - 1);
        let [factor, rise] = self.factors[index];
        factor + rise * (at - index as f32)
    }
}

/// Tobler (1993): 6·exp(−3.5·|s + 0.05|) km/h.
fn tobler(grade: f64) -> f64 {
    LEVEL_FOOT_KMH / (6.0 * libm::exp(-3.5 * (grade + 0.05).abs()))
}

/// Naismith (1892) with Langmuir (1984), as `r.walk` has it: seconds per meter 0.72, and per meter of height 6 uphill,
/// −1.9998 (faster) moderately downhill, 1.9998 (slower) steeper than −0.2125.
fn langmuir(grade: f64) -> f64 {
    let per_height = match grade {
        up if up > 0.0 => 6.0,
        moderate if moderate >= -0.2125 - 1e-9 => 1.9998,
        _ => -1.9998,
    };
    (0.72 + per_height * grade) / 0.72
}

/// A vehicle's speed falls in a straight line to the first share where it goes freely, then to the second at its limit.
fn slowed(grade: f64, limits_percent: [f64; 2]) -> f64 {
    let [free, limit] = limits_percent.map(|percent| percent / 100.0);
    let [at_free, at_limit] = VEHICLE_SHARES;
    let share = if grade <= free {
        1.0 + (at_free - 1.0) * grade / free
    } else if grade < limit {
        at_free + (at_limit - at_free) * (grade - free) / (limit - free)
    } else {
        at_limit
    };
    1.0 / share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_on_foot_have_the_speeds_of_tobler_and_langmuir() {
        let foot = Vehicle::built_in("foot").expect("built in");
        let tobler = GradeTable::new(&foot, false);
        for grade in [-0.3f32, -0.05, 0.0, 0.1, 0.4] {
            let speed = 6.0 * libm::exp(-3.5 * (f64::from(grade) + 0.05).abs());
            assert!((5.0 / f64::from(tobler.open(grade)) - speed).abs() < 1e-5, "{grade}");
        }
        let langmuir = GradeTable::new(&foot, true);
        // 0.72 + 0.6, 0.72 − 0.19998, 0.72 + 0.59994 seconds per meter.
        for (grade, seconds) in [(0.1f32, 1.32f32), (-0.1, 0.52002), (-0.3, 1.31994)] {
            assert!((langmuir.open(grade) * 0.72 - seconds).abs() < 1e-4, "{grade}");
        }
        assert!(tobler.open(1.1).is_infinite(), "too steep");
    }

    #[test]
    fn a_vehicle_slows_down_to_its_limit_and_a_way_never_stops_it() {
        let truck = Vehicle::built_in("truck").expect("built in");
        let grades = GradeTable::new(&truck, false);
        assert!((grades.open(0.0) - 1.0).abs() < 1e-6);
        assert!((grades.open(0.15) - 1.0 / 0.6).abs() < 1e-3);
        assert!((grades.open(-0.3) - 10.0).abs() < 0.1);
        assert!(grades.open(0.301).is_infinite());
        assert!((grades.on_way(0.8) - 1.0 / 0.6).abs() < 1e-3);
        assert_eq!((grades.across(0.1), grades.across(0.15), grades.across(0.3)), (1.0, 1.5, f32::INFINITY));
    }
}
