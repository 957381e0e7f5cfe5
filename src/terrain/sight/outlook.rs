//! The stretches of ground along a line that are visible from its start.
//!
//! Ground is visible where its direction from the observer's eye, as rise over distance, is steeper than that of all
//! ground before it. On straight ground the edge between hidden and visible is where the steepest direction so far meets
//! it.

use crate::profile::ProfileStation;
use crate::sight::Curvature;

/// A stretch of a line that is visible from its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleStretch {
    /// Where it begins, meters along the line.
    pub from_m: f64,
    /// Where it ends.
    pub to_m: f64,
}

/// A point of the ground along a line, as the eye sees it.
#[derive(Clone, Copy)]
struct SightPoint {
    along_m: f64,
    /// Above the eye's horizontal, lowered by curvature.
    above_m: f64,
}

impl SightPoint {
    /// Rise over distance.
    fn direction(self) -> f64 {
        self.above_m / self.along_m
    }
}

/// The stretches of a straight line's ground that are visible to an eye `eye_m` high at its first station, in order;
/// ground without data is not visible and hides nothing.
pub fn visible_stretches(
    stations: &[ProfileStation],
    eye_m: f64,
    curvature: Curvature,
) -> Vec<VisibleStretch> {
    let point = |station: &ProfileStation| {
        let along_m = station.station_m;
        let drop_m = curvature.drop_per_square_m() * along_m * along_m;
        Some(SightPoint { along_m, above_m: station.ground.height_m()? - eye_m - drop_m })
    };
    let mut visible: Vec<VisibleStretch> = Vec::new();
    let mut steepest = f64::NEG_INFINITY;
    for pair in stations.windows(2) {
        let (Some(from), Some(to)) = (point(&pair[0]), point(&pair[1])) else { continue };
        if from.along_m > 0.0 {
            steepest = steepest.max(from.direction());
        }
        // Ground that begins at the observer's feet is visible from there if the eye is above it.
        let starts_below_eye = from.along_m == 0.0 && from.above_m <= 0.0;
        let rises = to.along_m > from.along_m && (to.direction() > steepest || starts_below_eye);
        if !rises {
            continue;
        }
        // Where the ground before was visible up to here, rounding must not separate the two.
        let is_visible = from.along_m == 0.0 || from.direction() >= steepest;
        let from_m = if is_visible { from.along_m } else { edge_m(from, to, steepest) };
        steepest = steepest.max(to.direction());
        match visible.last_mut().filter(|last| last.to_m == from_m) {
            Some(last) => last.to_m = to.along_m,
            None => visible.push(VisibleStretch { from_m, to_m: to.along_m }),
        }
    }
    visible
}

/// Where a direction meets the ground between two points of which the second is seen in a steeper one.
fn edge_m(from: SightPoint, to: SightPoint, direction: f64) -> f64 {
    let over = |point: SightPoint| point.above_m - direction * point.along_m;
    let (first, second) = (over(from), over(to));
    let share = if second > first { (-first / (second - first)).clamp(0.0, 1.0) } else { 0.0 };
    from.along_m + (to.along_m - from.along_m) * share
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use sandtable_raster::answer::Answer;

    fn stations(heights: &[(f64, f64)]) -> Vec<ProfileStation> {
        let station = |&(station_m, height): &(f64, f64)| ProfileStation {
            station_m,
            at: DVec2::new(station_m, 0.0),
            ground: if height.is_nan() { Answer::NoData } else { Answer::Height(height) },
        };
        heights.iter().map(station).collect()
    }

    #[test]
    fn ground_behind_a_ridge_is_hidden_up_to_the_line_over_the_ridge() {
        let ground = stations(&[(0.0, 0.0), (100.0, 0.0), (200.0, 50.0), (300.0, 0.0), (500.0, 200.0)]);
        let visible = visible_stretches(&ground, 10.0, Curvature::FLAT);
        // Over the ridge the line rises 40 m in 200; 10 + x/5 meets x − 300 at 387.5.
        assert_eq!(
            visible,
            [VisibleStretch { from_m: 0.0, to_m: 200.0 }, VisibleStretch { from_m: 387.5, to_m: 500.0 }]
        );
    }

    #[test]
    fn at_sea_the_visible_water_ends_at_the_horizon() {
        let water: Vec<(f64, f64)> = (0..=1000).map(|step| (f64::from(step) * 10.0, 0.0)).collect();
        let curvature = Curvature { radius_m: 6_371_000.0, refraction: 0.0 };
        let visible = visible_stretches(&stations(&water), 2.0, curvature);
        assert_eq!(visible.len(), 1);
        assert!((visible[0].to_m - 5048.0).abs() < 15.0, "{visible:?}");
    }

    #[test]
    fn a_hole_is_not_visible_and_hides_nothing() {
        let ground = stations(&[(0.0, 0.0), (100.0, 0.0), (200.0, f64::NAN), (300.0, 0.0), (400.0, 0.0)]);
        let visible = visible_stretches(&ground, 10.0, Curvature::FLAT);
        assert_eq!(
            visible,
            [VisibleStretch { from_m: 0.0, to_m: 100.0 }, VisibleStretch { from_m: 300.0, to_m: 400.0 }]
        );
    }
}
