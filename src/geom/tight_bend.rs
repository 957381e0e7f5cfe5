//! Bends of a line that are too tight for a strip along it: its inner edge folds over itself there.
//!
//! An edge at distance `h` beside a line loses `h · tan(θ/2)` of each leg at a vertex that turns toward it by `θ`. Where
//! the two ends of a leg lose more than its length, the edge runs backward: on an arc exactly where the radius is less
//! than `h`, whatever the number of its vertices.
//!
//! ```text
//!        ╲  ╱           each leg loses h·tan(θ/2) at either end,
//!   ──────╳──────       so the edge beside a short leg runs backward
//!        ╱ ╲_ leg _╱
//! ```

use crate::polyline::Polyline;

/// A bend in which an edge of the strip folds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TightBend {
    /// The station at which the first leg of it starts, in the line's unit.
    pub from: f64,
    /// The station at which its last leg ends.
    pub to: f64,
    /// By how much the line turns in it, radians above 0.
    pub turn_rad: f64,
    /// The least radius in it, that of the arc which its tightest leg and the turns at its ends belong to.
    pub radius: f64,
}

/// Turns of less than this in all are kinks of drawing: what folds at them is too little to be seen, radians.
const LEAST_TURN_RAD: f64 = 60.0 * std::f64::consts::PI / 180.0;

/// At a vertex that turns by more the line comes back on itself; that is no curve, radians.
pub const REVERSAL_RAD: f64 = 170.0 * std::f64::consts::PI / 180.0;

/// The bends of `line` that are too tight for a strip whose half width at a station is `half_at`, in order of the line;
/// bends to the right after those to the left. Vertices at which the line comes back on itself count as straight.
pub fn tight_bends(line: &Polyline, half_at: impl Fn(f64) -> f64) -> Vec<TightBend> {
    let turns = turns(line);
    let mut bends = Vec::new();
    for side in [1.0, -1.0] {
        let lost = |vertex: usize| {
            let turn = (turns[vertex] * side).max(0.0);
            if turn < REVERSAL_RAD { turn } else { 0.0 }
        };
        let mut open: Option<TightBend> = None;
        for (leg, stations) in line.stations().windows(2).enumerate() {
            let (from, to) = (stations[0], stations[1]);
            let ends = [lost(leg), lost(leg + 1)];
            let tangents: f64 = ends.iter().map(|turn| libm::tan(turn / 2.0)).sum();
            if half_at((from + to) / 2.0) * tangents <= to - from {
                bends.extend(open.take());
                continue;
            }
            let radius = (to - from) / tangents;
            open = Some(match open {
                Some(bend) => TightBend {
                    to,
                    turn_rad: bend.turn_rad + ends[1],
                    radius: bend.radius.min(radius),
                    ..bend
                },
                None => TightBend { from, to, turn_rad: ends[0] + ends[1], radius },
            });
        }
        bends.extend(open);
    }
    bends.retain(|bend| bend.turn_rad >= LEAST_TURN_RAD);
    bends
}

/// The turn at each vertex in radians, to the left above 0; none at the ends.
pub fn turns(line: &Polyline) -> Vec<f64> {
    let points = line.points();
    let mut turns = vec![0.0; points.len()];
    for (turn, corner) in turns.iter_mut().skip(1).zip(points.windows(3)) {
        let (before, after) = (corner[1] - corner[0], corner[2] - corner[1]);
        *turn = libm::atan2(before.perp_dot(after), before.dot(after));
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// A half circle of this radius between two straights, at a quarter turn.
    fn hairpin(radius: f64, count: u32, quarter: u32) -> Polyline {
        let arc = (0..=count).map(|index| {
            let angle =
                f64::from(index) / f64::from(count) * std::f64::consts::PI - std::f64::consts::FRAC_PI_2;
            DVec2::from_angle(angle) * radius
        });
        let ends = [DVec2::new(-50.0, -radius), DVec2::new(-50.0, radius)];
        let all = std::iter::once(ends[0]).chain(arc).chain([ends[1]]);
        let turned = |at: DVec2| (0..quarter).fold(at, |at, _| at.perp());
        Polyline::new(all.map(turned), 0.0).expect("a line")
    }

    #[test]
    fn an_arc_is_tight_where_its_radius_is_less_than_half_the_width() {
        for quarter in 0..4 {
            for count in [6, 12, 40] {
                assert_eq!(tight_bends(&hairpin(5.5, count, quarter), |_| 5.0), [], "{count}");
                let [bend] = tight_bends(&hairpin(4.0, count, quarter), |_| 5.0)[..] else {
                    panic!("one bend")
                };
                // Chords run inside the arc, and the first and last may pass for parts of the straights.
                let half_turn = std::f64::consts::FRAC_PI_2 / f64::from(count);
                let (chord, inner) = (8.0 * libm::sin(half_turn), 4.0 * libm::cos(half_turn));
                assert!((inner - 1e-9..4.0 + 1e-9).contains(&bend.radius), "{bend:?}");
                assert!((bend.turn_rad - std::f64::consts::PI).abs() < 2.0 * half_turn + 1e-9, "{bend:?}");
                assert!((50.0 - 1e-9..50.0 + chord + 1e-9).contains(&bend.from), "{bend:?}");
            }
        }
    }

    #[test]
    fn a_corner_between_long_legs_and_a_kink_of_drawing_are_not_tight() {
        let line = |points: &[(f64, f64)]| {
            Polyline::new(points.iter().map(|&at| DVec2::from(at)), 0.0).expect("a line")
        };
        assert_eq!(tight_bends(&line(&[(0.0, 0.0), (40.0, 0.0), (40.0, 40.0)]), |_| 3.0), []);
        assert_eq!(tight_bends(&line(&[(0.0, 0.0), (40.0, 0.0), (40.3, 0.1), (80.0, 10.0)]), |_| 3.0), []);
        let jog = line(&[(0.0, 0.0), (40.0, 0.0), (40.0, 1.0), (0.0, 1.0)]);
        let [bend] = tight_bends(&jog, |_| 3.0)[..] else { panic!("one bend") };
        assert!((bend.radius - 0.5).abs() < 1e-9, "{bend:?}");
    }
}
