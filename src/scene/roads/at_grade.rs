//! Where centerlines of one level cross, whether or not they have a vertex there.
//!
//! Legs are sorted into the squares of a grid that they pass through, and only legs of one square are compared. Squares
//! are about as wide as a leg is long, so that a city's legs meet a few others each.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::geom::rect::Rect;
use crate::geom::segment;
use crate::scene::roads::centerline::Centerline;

/// No square is smaller, in meters: a file of very short legs would fill more squares than it has legs.
const SMALLEST_SQUARE_M: f64 = 20.0;

/// No more pairs of legs are compared. A city of 100 000 legs has some hundred thousand pairs; only lines drawn all over
/// each other have more than this, and comparing those would take minutes.
const MOST_PAIRS: usize = 20_000_000;

/// Nor are more crossings kept: each parts two roads.
const MOST_CROSSINGS: usize = 1_000_000;

/// A road and a station on it.
pub type RoadStation = (usize, f64);

/// A leg of a road.
#[derive(Clone, Copy)]
struct RoadLeg {
    road: usize,
    start_m: f64,
    ends: [DVec2; 2],
    level: i32,
}

/// The crossings of those roads for which `counts` holds: the same place on both roads, each pair of places once, in
/// order of the roads. `None` where the lines are too tangled to compare all that may cross.
pub fn crossings(
    roads: &[Centerline],
    counts: impl Fn(&Centerline) -> bool,
) -> Option<Vec<[RoadStation; 2]>> {
    let chosen = roads.iter().enumerate().filter(|(_, road)| counts(road));
    let legs: Vec<RoadLeg> = chosen.flat_map(|(index, road)| legs(index, road)).collect();
    let total_m: f64 = legs.iter().map(|leg| leg.ends[0].distance(leg.ends[1])).sum();
    let square_m = (2.0 * total_m / legs.len().max(1) as f64).max(SMALLEST_SQUARE_M);
    let mut squares: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (index, leg) in legs.iter().enumerate() {
        each_square(leg, square_m, &mut |square| squares.entry(square).or_default().push(index));
    }
    let pairs: usize = squares.values().map(|inside| inside.len() * inside.len() / 2).sum();
    let found = (pairs <= MOST_PAIRS).then(|| compare(&legs, squares.values()));
    found.filter(|found| found.len() <= MOST_CROSSINGS)
}

/// The crossings of legs that share a square, each once.
fn compare<'a>(legs: &[RoadLeg], squares: impl Iterator<Item = &'a Vec<usize>>) -> Vec<[RoadStation; 2]> {
    let mut found = Vec::new();
    for inside in squares {
        for (position, &one) in inside.iter().enumerate() {
            let crosses = |&other: &usize| Some(((one, other), crossing(&legs[one], &legs[other])?));
            found.extend(inside[position + 1..].iter().filter_map(crosses));
        }
    }
    // Two legs may share several squares.
    found.sort_by_key(|(pair, _)| *pair);
    found.dedup_by_key(|(pair, _)| *pair);
    found.into_iter().map(|(_, places)| places).collect()
}

fn legs(road: usize, centerline: &Centerline) -> impl Iterator<Item = RoadLeg> + '_ {
    let (points, stations) = (centerline.alignment.line.points(), centerline.alignment.line.stations());
    let leg = move |(ends, &start_m): (&[DVec2], &f64)| RoadLeg {
        road,
        start_m,
        ends: [ends[0], ends[1]],
        level: centerline.level,
    };
    points.windows(2).zip(stations).map(leg)
}

/// Visits the squares that a leg passes through, row by row.
fn each_square(leg: &RoadLeg, square_m: f64, visit: &mut impl FnMut((i64, i64))) {
    let [from, to] = leg.ends;
    let index = |at: f64| (at / square_m).floor() as i64;
    let (low, high) = (from.y.min(to.y), from.y.max(to.y));
    for row in index(low)..=index(high) {
        let band = Rect {
            min: DVec2::new(f64::NEG_INFINITY, row as f64 * square_m),
            max: DVec2::new(f64::INFINITY, (row + 1) as f64 * square_m),
        };
        let Some((enter, leave)) = band.clip_line(from, to) else { continue };
        for column in index(enter.x.min(leave.x))..=index(enter.x.max(leave.x)) {
            visit((column, row));
        }
    }
}

/// Where two legs of one level cross or touch; `None` where they do not, and for legs side by side.
fn crossing(one: &RoadLeg, other: &RoadLeg) -> Option<[RoadStation; 2]> {
    if one.level != other.level {
        return None;
    }
    let (a, b) = (one.ends[1] - one.ends[0], other.ends[1] - other.ends[0]);
    if a.perp_dot(b).abs() < 1e-9 * a.length() * b.length() {
        return None;
    }
    let parts = segment::crossing(one.ends.into(), other.ends.into())?;
    // Legs of one road that follow each other touch at their vertex.
    let follows = one.road == other.road && (one.ends[1] == other.ends[0] || other.ends[1] == one.ends[0]);
    let place = |leg: &RoadLeg, part: f64| (leg.road, leg.start_m + leg.ends[0].distance(leg.ends[1]) * part);
    (!follows).then(|| [place(one, parts[0]), place(other, parts[1])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::earthworks::alignment::Support;
    use crate::scene::roads::centerline::tests::road;

    #[test]
    fn every_pair_of_a_dense_web_is_found_once() {
        for quarter in 0..4 {
            let turned = |(x, y): (f64, f64)| (0..quarter).fold((x, y), |(x, y), _| (-y, x));
            let ends = |index: u32| 10.0 * f64::from(index);
            let east = |index| {
                road(&[(-5.0, ends(index)), (200.0, ends(index) + 3.0)].map(turned), Support::Ground, 0)
            };
            let north = |index| {
                road(&[(ends(index), -5.0), (ends(index) + 2.0, 200.0)].map(turned), Support::Ground, 0)
            };
            let roads: Vec<Centerline> = (0..15).map(east).chain((0..15).map(north)).collect();
            let found = crossings(&roads, |_| true).expect("not too tangled");
            assert_eq!(found.len(), 15 * 15);
            for [(one, at), (other, there)] in found {
                let apart = roads[one].alignment.line.at(at).distance(roads[other].alignment.line.at(there));
                assert!(apart < 1e-9, "{apart}");
            }
        }
    }

    #[test]
    fn lines_all_over_each_other_are_not_compared() {
        let back_and_forth = |index: u32| (f64::from(index % 2) * 1e4, f64::from(index) * 0.01);
        let points: Vec<(f64, f64)> = (0..12_000).map(back_and_forth).collect();
        assert_eq!(crossings(&[road(&points, Support::Ground, 0)], |_| true), None);
    }
}
