//! What of the ground along a line can be seen from its start.
//!
//! From the observer's eye the ground is seen where it rises above all that lies before it: where its direction, as rise
//! over distance, is steeper than any before. On straight ground the edge between hidden and seen is where the steepest
//! direction so far meets it.

use crate::terrain::profile::ProfileStation;
use crate::terrain::sight::Curvature;

/// A stretch of a line in sight of its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleStretch {
    /// Where it begins, meters along the line.
    pub from_m: f64,
    /// Where it ends.
    pub to_m: f64,
}

/// The stretches of a straight line's ground that an eye `eye_m` high at its first station sees, in order; ground without
/// data is not seen and hides nothing.
pub fn seen_along(stations: &[ProfileStation], eye_m: f64, curvature: Curvature) -> Vec<VisibleStretch> {
    let mut seen: Vec<VisibleStretch> = Vec::new();
    let mut steepest = f64::NEG_INFINITY;
    for pair in stations.windows(2) {
        let sunk = |station: &ProfileStation| {
            let along_m = station.station_m;
            let height_m = station.ground.height_m()?;
            Some((along_m, height_m - eye_m - curvature.drop_per_square_m() * along_m * along_m))
        };
        let (Some(from), Some(to)) = (sunk(&pair[0]), sunk(&pair[1])) else { continue };
        let direction = |(along_m, above_m): (f64, f64)| above_m / along_m;
        if from.0 > 0.0 {
            steepest = steepest.max(direction(from));
        }
        // Ground that begins at the observer's feet is in sight from there, should the eye be above it.
        let rises = to.0 > from.0 && (direction(to) > steepest || (from.0 == 0.0 && from.1 <= 0.0));
        if !rises {
            continue;
        }
        // Where the ground before was seen up to here, no rounding may cut the two apart.
        let is_seen = from.0 == 0.0 || direction(from) >= steepest;
        let from_m = if is_seen { from.0 } else { edge(from, to, steepest) };
        steepest = steepest.max(direction(to));
        match seen.last_mut().filter(|last| last.to_m == from_m) {
            Some(last) => last.to_m = to.0,
            None => seen.push(VisibleStretch { from_m, to_m: to.0 }),
        }
    }
    seen
}

/// Where on the ground between two points, that is steeper to see at the second, a direction meets it.
fn edge(from: (f64, f64), to: (f64, f64), direction: f64) -> f64 {
    let over = |(along_m, above_m): (f64, f64)| above_m - direction * along_m;
    let (first, second) = (over(from), over(to));
    let share = if second > first { (-first / (second - first)).clamp(0.0, 1.0) } else { 0.0 };
    from.0 + (to.0 - from.0) * share
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::dem::answer::Answer;

    fn stations(heights: &[(f64, f64)]) -> Vec<ProfileStation> {
        let station = |&(station_m, height): &(f64, f64)| ProfileStation {
            station_m,
            at: DVec2::new(station_m, 0.0),
            ground: if height.is_nan() { Answer::NoData } else { Answer::Height(height) },
        };
        heights.iter().map(station).collect()
    }

    #[test]
    fn behind_a_ridge_ground_is_hidden_until_it_rises_into_the_line_over_the_ridge() {
        let ground = stations(&[(0.0, 0.0), (100.0, 0.0), (200.0, 50.0), (300.0, 0.0), (500.0, 200.0)]);
        let seen = seen_along(&ground, 10.0, Curvature::FLAT);
        // Over the ridge the line rises 40 m in 200; 10 + x/5 meets x − 300 at 387.5.
        assert_eq!(
            seen,
            [VisibleStretch { from_m: 0.0, to_m: 200.0 }, VisibleStretch { from_m: 387.5, to_m: 500.0 }]
        );
    }

    #[test]
    fn at_sea_the_last_of_the_water_in_sight_is_the_horizon() {
        let water: Vec<(f64, f64)> = (0..=1000).map(|step| (f64::from(step) * 10.0, 0.0)).collect();
        let curvature = Curvature { radius_m: 6_371_000.0, refraction: 0.0 };
        let seen = seen_along(&stations(&water), 2.0, curvature);
        assert_eq!(seen.len(), 1);
        assert!((seen[0].to_m - 5048.0).abs() < 15.0, "{seen:?}");
    }

    #[test]
    fn a_hole_is_not_seen_and_hides_nothing() {
        let ground = stations(&[(0.0, 0.0), (100.0, 0.0), (200.0, f64::NAN), (300.0, 0.0), (400.0, 0.0)]);
        let seen = seen_along(&ground, 10.0, Curvature::FLAT);
        assert_eq!(
            seen,
            [VisibleStretch { from_m: 0.0, to_m: 100.0 }, VisibleStretch { from_m: 300.0, to_m: 400.0 }]
        );
    }
}
