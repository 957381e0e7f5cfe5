//! The levels of bridges and tunnels that are stated on roads which follow the ground.
//!
//! Such a bridge knows the level of its ends: that of the ground or of the road that leads there. Between, it runs
//! straight. Files cut bridges into several lines, and lines meet on them; then no end in the middle is known, and each
//! such node takes the mean of its neighbours, weighted by nearness. Along one bridge of many lines that is a straight
//! line from end to end; where bridges meet on a bridge, it is where as many taut strings would hold each other.

use crate::scene::roads::centreline::{Carried, Centreline};
use crate::scene::roads::meetings::Meetings;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};

/// Levels are settled when none moves by more than this, in metres.
const SETTLED_M: f64 = 1e-5;

/// No more than so many levels are taken anew, whatever the number of nodes: enough for a bridge of a thousand lines.
const MOST_STEPS: usize = 100_000_000;

/// A stretch of bridge or tunnel between two nodes.
struct Strut {
    ends: [usize; 2],
    length_m: f64,
}

/// Gives bridges and tunnels without levels theirs, where some ground is near that their ends can stand on. `known` are
/// levels of nodes that are settled already, NaN for others.
pub fn settle(lattice: &Lattice, roads: &mut [Centreline], meetings: &Meetings, known: &[f64]) {
    let is_open = |road: &Centreline| road.carried != Carried::Ground && road.levels_m.is_none();
    if !roads.iter().any(is_open) {
        return;
    }
    let mut nodes = grounded(lattice, roads, meetings, known);
    relax(&mut nodes, &struts(roads, meetings, is_open));
    for (road, stops) in roads.iter_mut().zip(&meetings.stops) {
        if !is_open(road) {
            continue;
        }
        let level_at = |&station: &f64| {
            let after = stops.partition_point(|stop| stop.station_m < station).clamp(1, stops.len() - 1);
            let (from, to) = (stops[after - 1], stops[after]);
            let part = ((station - from.station_m) / (to.station_m - from.station_m)).clamp(0.0, 1.0);
            let levels = [from, to].map(|stop| nodes[stop.node.index()]);
            levels[0] + (levels[1] - levels[0]) * part
        };
        let levels: Vec<f64> = road.line.stations().iter().map(level_at).collect();
        road.levels_m = Some(levels).filter(|levels| levels.iter().all(|level| level.is_finite()));
    }
}

/// The levels of the nodes that stand on something: where a road on the ground comes, or nothing else does.
fn grounded(lattice: &Lattice, roads: &[Centreline], meetings: &Meetings, known: &[f64]) -> Vec<f64> {
    let mut nodes = known.to_vec();
    nodes.resize(meetings.nodes, f64::NAN);
    let mut arms = vec![0usize; meetings.nodes];
    let mut stands = vec![false; meetings.nodes];
    let mut places = vec![None; meetings.nodes];
    for (road, stops) in roads.iter().zip(&meetings.stops) {
        for (index, stop) in stops.iter().enumerate() {
            let node = stop.node.index();
            arms[node] += if index == 0 || index + 1 == stops.len() { 1 } else { 2 };
            stands[node] |= road.carried == Carried::Ground;
            places[node] = Some(road.line.at(stop.station_m));
        }
    }
    for (node, level) in nodes.iter_mut().enumerate() {
        if let Some(at) = places[node].filter(|_| level.is_nan() && (stands[node] || arms[node] == 1)) {
            let ground = ground_height(lattice, Interpolation::Planar, at + lattice.origin());
            *level = ground.height_m().unwrap_or(f64::NAN);
        }
    }
    nodes
}

fn struts(roads: &[Centreline], meetings: &Meetings, counts: impl Fn(&Centreline) -> bool) -> Vec<Strut> {
    let chosen = roads.iter().zip(&meetings.stops).filter(|(road, _)| counts(road));
    let between = chosen.flat_map(|(_, stops)| stops.windows(2));
    let strut = |pair: &[crate::scene::roads::meetings::Stop]| Strut {
        ends: [pair[0].node.index(), pair[1].node.index()],
        length_m: pair[1].station_m - pair[0].station_m,
    };
    between.map(strut).filter(|strut| strut.length_m > 0.0 && strut.ends[0] != strut.ends[1]).collect()
}

/// Settles every node without a level among its neighbours; those that no level reaches stay without.
fn relax(nodes: &mut [f64], struts: &[Strut]) {
    let mut neighbours = vec![Vec::new(); nodes.len()];
    for strut in struts {
        let [one, other] = strut.ends;
        neighbours[one].push((other, 1.0 / strut.length_m));
        neighbours[other].push((one, 1.0 / strut.length_m));
    }
    let open: Vec<usize> =
        (0..nodes.len()).filter(|&node| nodes[node].is_nan() && !neighbours[node].is_empty()).collect();
    if open.is_empty() {
        return;
    }
    for _ in 0..MOST_STEPS / open.len() {
        let mut moved_m: f64 = 0.0;
        for &node in &open {
            let reached = neighbours[node].iter().filter(|(other, _)| !nodes[*other].is_nan());
            let sum = |(level, weight): (f64, f64), (other, pull): &(usize, f64)| {
                (level + nodes[*other] * pull, weight + pull)
            };
            let (level, weight) = reached.fold((0.0, 0.0), sum);
            if weight > 0.0 {
                let before = std::mem::replace(&mut nodes[node], level / weight);
                moved_m =
                    moved_m.max(if before.is_nan() { f64::INFINITY } else { (nodes[node] - before).abs() });
            }
        }
        if moved_m < SETTLED_M {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::roads::centreline::tests::road;
    use crate::scene::roads::meetings::meetings;
    use glam::DVec2;

    /// Ground that rises by a tenth eastward and holds a ravine from 40 m to 160 m.
    fn ravine() -> Lattice {
        let height = |index: u32| {
            let x = f64::from(index % 21) * 10.0;
            (if x > 40.0 && x < 160.0 { -30.0 } else { x / 10.0 }) as f32
        };
        Lattice::new(DVec2::new(5e5, 4e6), DVec2::splat(10.0), 21, (0..21 * 11).map(height).collect())
            .expect("sound")
    }

    #[test]
    fn a_bridge_of_several_lines_runs_straight_from_end_to_end() {
        let mut roads = vec![
            road(&[(0.0, 50.0), (40.0, 50.0)], Carried::Ground, 0),
            road(&[(100.0, 50.0), (40.0, 50.0)], Carried::Bridge, 1),
            road(&[(100.0, 50.0), (130.0, 50.0)], Carried::Bridge, 1),
            road(&[(130.0, 50.0), (145.0, 50.0), (160.0, 50.0)], Carried::Bridge, 1),
            road(&[(160.0, 50.0), (200.0, 50.0)], Carried::Ground, 0),
        ];
        let found = meetings(&roads, |_| false);
        settle(&ravine(), &mut roads, &found, &[]);
        for road in &roads[1..4] {
            for (at, level) in road.line.points().iter().zip(road.levels_m.as_ref().expect("levels")) {
                assert!((level - at.x / 10.0).abs() < 0.01, "{level} at {at}");
            }
        }
        assert_eq!(roads[0].levels_m, None);
    }

    #[test]
    fn what_is_settled_already_holds_and_off_the_ground_there_is_nothing() {
        let mut roads = vec![
            road(&[(10.0, 50.0), (30.0, 50.0)], Carried::Bridge, 1),
            road(&[(900.0, 50.0), (990.0, 50.0)], Carried::Tunnel, -1),
        ];
        let found = meetings(&roads, |_| false);
        let mut known = vec![f64::NAN; found.nodes];
        known[found.stops[0][1].node.index()] = 9.0;
        settle(&ravine(), &mut roads, &found, &known);
        assert_eq!(roads[0].levels_m, Some(vec![1.0, 9.0]));
        assert_eq!(roads[1].levels_m, None);
    }
}
