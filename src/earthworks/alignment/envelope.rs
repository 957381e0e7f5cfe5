//! The highest profile below given levels, and the lowest above, that keep the grade: over a whole network.
//!
//! Under a level every profile must lie within the cone of its grade, so the highest profile below all levels is at each
//! place the lowest of all cones (McShane 1934):
//!
//! ```text
//!      o           o         levels
//!       ╲    o    ╱
//!         ╲╱   ╲╱            below(s) = min over t of level(t) + grade · |s − t|
//! ```
//!
//! Along one road two sweeps find it. Over a network the distance is the shortest way along roads, each with its own
//! grade: the sweeps bring every section's cones to its ends, a search from all nodes at once (Dijkstra 1959) carries them
//! on, and two more sweeps bring them back in. The cost is that of the stations, and of sorting the nodes.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::alignment::network::{RoadSection, SectionNetwork, StationLevels};

/// The highest profile that nowhere lies above `levels` and keeps the grade; infinite where none of the levels reaches.
/// `levels` may be NaN where there is none.
pub fn below(network: &SectionNetwork, levels: &StationLevels) -> StationLevels {
    let mut nodes = vec![f64::INFINITY; network.nodes];
    for (section, levels) in network.sections.iter().zip(levels) {
        let swept = sweep(section, levels, [f64::INFINITY; 2]);
        for (node, level) in section.ends.into_iter().zip([swept[0], swept[swept.len() - 1]]) {
            nodes[node.index()] = nodes[node.index()].min(level);
        }
    }
    spread(network, &mut nodes);
    let ends = |section: &RoadSection| section.ends.map(|node| nodes[node.index()]);
    network
        .sections
        .iter()
        .zip(levels)
        .map(|(section, levels)| sweep(section, levels, ends(section)))
        .collect()
}

/// The lowest profile that nowhere lies below `levels` and keeps the grade; minus infinity where none of the levels
/// reaches.
pub fn above(network: &SectionNetwork, levels: &StationLevels) -> StationLevels {
    negated(below(network, &negated(levels.clone())))
}

fn negated(mut levels: StationLevels) -> StationLevels {
    levels.iter_mut().flatten().for_each(|level| *level = -*level);
    levels
}

/// The lowest cone at each station, of those over the section's own levels and at its ends.
fn sweep(section: &RoadSection, levels: &[f64], [first, last]: [f64; 2]) -> Vec<f64> {
    let stations = &section.stations_m;
    let mut swept: Vec<f64> = Vec::with_capacity(stations.len());
    let (mut lowest, mut before) = (first, 0.0);
    for (&station, &level) in stations.iter().zip(levels) {
        // A NaN loses against any number.
        lowest = (lowest + (station - before) * section.max_grade).min(level);
        before = station;
        swept.push(lowest);
    }
    lowest = last;
    for (station, level) in stations.iter().zip(&mut swept).rev() {
        lowest = (lowest + (before - station) * section.max_grade).min(*level);
        before = *station;
        *level = lowest;
    }
    swept
}

/// Lowers every node to the lowest cone over any other.
fn spread(network: &SectionNetwork, nodes: &mut [f64]) {
    let arms = network.arms();
    let starts = nodes.iter().enumerate().filter(|(_, level)| level.is_finite());
    let mut waiting: BinaryHeap<Reverse<Reached>> =
        starts.map(|(node, &level_m)| Reverse(Reached { level_m, node })).collect();
    while let Some(Reverse(Reached { level_m, node })) = waiting.pop() {
        if level_m > nodes[node] {
            continue;
        }
        for arm in &arms[node] {
            let section = &network.sections[arm.line];
            let other = section.ends[arm.opposite().end].index();
            let cone = level_m + section.length_m() * section.max_grade;
            if cone < nodes[other] {
                nodes[other] = cone;
                waiting.push(Reverse(Reached { level_m: cone, node: other }));
            }
        }
    }
}

/// A node with the level of a cone there.
#[derive(PartialEq)]
struct Reached {
    level_m: f64,
    node: usize,
}

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        self.level_m.total_cmp(&other.level_m).then(self.node.cmp(&other.node))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::network::tests::section;
    use proptest::prelude::*;

    /// A star of three sections of the given stations that meet in node 0.
    fn star(stations: [Vec<f64>; 3], max_grade: f64) -> SectionNetwork {
        let section = |(index, stations_m): (u32, Vec<f64>)| section([0, index], stations_m, max_grade);
        SectionNetwork { nodes: 4, sections: (1..).zip(stations).map(section).collect() }
    }

    proptest! {
        #[test]
        fn the_envelopes_are_the_cones_of_all_levels_over_all_ways(
            steps in prop::array::uniform3(prop::collection::vec((0.5..40.0f64, -50.0..50.0f64), 2..9)),
            grade in 0.02..0.5f64,
        ) {
            let stations = steps.each_ref().map(|steps| {
                let along = steps.iter().scan(0.0, |at, (step, _)| { let here = *at; *at += step; Some(here) });
                along.collect::<Vec<f64>>()
            });
            let network = star(stations, grade);
            let levels: StationLevels = steps.iter().map(|steps| steps.iter().map(|step| step.1).collect()).collect();
            let (low, high) = (below(&network, &levels), above(&network, &levels));
            prop_assert_eq!(network.check(&low, 1e-9), Ok(()));
            prop_assert_eq!(network.check(&high, 1e-9), Ok(()));
            for (section, own) in network.sections.iter().enumerate() {
                for (index, &at) in own.stations_m.iter().enumerate() {
                    let way = |other: usize, to: f64| if other == section { (to - at).abs() } else { to + at };
                    let all = || network.sections.iter().enumerate().flat_map(|(other, that)| {
                        let levels = levels[other].iter();
                        that.stations_m.iter().zip(levels).map(move |(&to, &level)| (level, way(other, to) * grade))
                    });
                    let lowest = all().map(|(level, cone)| level + cone).fold(f64::INFINITY, f64::min);
                    let highest = all().map(|(level, cone)| level - cone).fold(f64::NEG_INFINITY, f64::max);
                    prop_assert!((low[section][index] - lowest).abs() < 1e-9);
                    prop_assert!((high[section][index] - highest).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn where_no_level_reaches_the_envelope_is_infinite() {
        let network = star([vec![0.0, 5.0], vec![0.0, 5.0], vec![0.0, 5.0]], 0.1);
        assert_eq!(below(&network, &network.nowhere())[1], [f64::INFINITY; 2]);
        assert_eq!(above(&network, &network.nowhere())[1], [f64::NEG_INFINITY; 2]);
    }
}
