//! Crossings of centerlines of one level, whether or not they have a vertex there.

use crate::roads::centerline::Centerline;
use sandtable_base::limits::ROAD_CROSSINGS;
use sandtable_base::limits::ROAD_PAIRS;
use sandtable_geom::leg_tree::{LegTree, LineLeg};
use sandtable_geom::segment;

/// Legs whose angle has a smaller sine are parallel.
const PARALLEL: f64 = 1e-9;

/// A road and a station on it in meters.
pub type RoadStation = (usize, f64);

/// The crossings of those roads for which `counts` holds: the same point on both roads, each pair of legs once, in order of
/// the roads. `None` where the lines are too tangled to compare all that may cross.
pub fn crossings(
    roads: &[Centerline],
    counts: impl Fn(&Centerline) -> bool,
) -> Option<Vec<[RoadStation; 2]>> {
    let chosen = roads.iter().enumerate().filter(|(_, road)| counts(road));
    let tree =
        LegTree::new(chosen.flat_map(|(road, at)| LineLeg::all(road, &at.street.alignment.line)).collect());
    let (mut pairs, mut found) = (0, Vec::new());
    for (index, one) in tree.legs().iter().enumerate() {
        let near = tree.near(one);
        let after = &near[near.partition_point(|&other| other <= index)..];
        let others = after.iter().map(|&other| &tree.legs()[other]);
        let same = others.filter(|other| roads[one.line].street.level == roads[other.line].street.level);
        found.extend(same.filter_map(|other| crossing(one, other)));
        pairs += after.len();
        if pairs > ROAD_PAIRS.count() || found.len() > ROAD_CROSSINGS.count() {
            return None;
        }
    }
    Some(found)
}

/// Where two legs cross or touch; `None` where they do not, for parallel ones, and where one continues the other.
fn crossing(one: &LineLeg, other: &LineLeg) -> Option<[RoadStation; 2]> {
    let [a, b] = [one, other].map(|leg| leg.ends[1] - leg.ends[0]);
    if a.perp_dot(b).abs() < PARALLEL * a.length() * b.length() {
        return None;
    }
    let parts = segment::crossing(one.ends.into(), other.ends.into())?;
    let continues = one.line == other.line && (one.ends[1] == other.ends[0] || other.ends[1] == one.ends[0]);
    let station = |leg: &LineLeg, part: f64| leg.stations[0] + leg.ends[0].distance(leg.ends[1]) * part;
    (!continues).then(|| [(one.line, station(one, parts[0])), (other.line, station(other, parts[1]))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roads::centerline::tests::road;
    use sandtable_earthworks::alignment::Support;

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
                let apart = roads[one]
                    .street
                    .alignment
                    .line
                    .at(at)
                    .distance(roads[other].street.alignment.line.at(there));
                assert!(apart < 1e-9, "{apart}");
            }
        }
    }

    #[test]
    fn lines_all_over_each_other_are_not_compared() {
        let back_and_forth = |index: u32| {
            let (side, aside) = (f64::from(index % 2) * 1e4, f64::from(index) * 0.01);
            (side - aside, side + aside)
        };
        let points: Vec<(f64, f64)> = (0..12_000).map(back_and_forth).collect();
        assert_eq!(crossings(&[road(&points, Support::Ground, 0)], |_| true), None);
    }
}
