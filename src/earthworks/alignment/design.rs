//! The design levels of a network and what must leave the ground, settled together.
//!
//! Which ground counts depends on where the bridges are, and where the bridges are on the levels. So the network is
//! fitted to all ground first; ground that a bridge then passes over, or a tunnel under, no longer pulls at the road,
//! and the network is fitted again. What was let go of once stays so, which makes the rounds end.

use std::collections::BTreeMap;

use crate::alignment::chain::{ChainLink, Direction, SectionChain};
use crate::alignment::fit;
use crate::alignment::network::{NodeId, RoadSection, SectionNetwork, StationLevels};
use crate::alignment::spans::spans;
use crate::alignment::{Support, SupportSpan};
use sandtable_geom::profile::Profile;

/// The most fits: the second moves roads by meters, the third by decimeters.
const ROUNDS: usize = 4;

/// A network's levels and spans.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The road's level at each station in meters; NaN in a part of the network without any ground.
    pub levels_m: StationLevels,
    /// For each section the spans along it in order, in its own stations.
    pub spans: Vec<Vec<SupportSpan>>,
}

/// Designs a network: a level a node that roads should pass through or NaN, and the length of vertical curves in meters.
pub fn design(network: &SectionNetwork, pins: &[f64], curve_m: f64) -> Design {
    let chains = SectionChain::all(network);
    let target = |section: &RoadSection| match (&section.stated_m, section.support) {
        (Some(stated_m), _) => stated_m.clone(),
        (None, Support::Ground) => section.ground_m.clone(),
        _ => vec![f64::NAN; section.ground_m.len()],
    };
    let mut targets: StationLevels = network.sections.iter().map(target).collect();
    let mut round = 1;
    loop {
        let mut levels_m = fit::through(network, &targets, pins);
        let mut found = vec![Vec::new(); network.sections.len()];
        for chain in &chains {
            shape(network, chain, &targets, curve_m, &mut levels_m);
        }
        keep_stated(network, &mut levels_m);
        for chain in &chains {
            find(network, chain, &levels_m, &mut found);
        }
        let released = release(network, &found, &mut targets);
        if released == 0 || round == ROUNDS {
            state(network, &mut found);
            return Design { levels_m, spans: found };
        }
        round += 1;
    }
}

/// Puts stated levels in place of designed ones, and leads the roads that meet them there.
fn keep_stated(network: &SectionNetwork, levels: &mut StationLevels) {
    let mut at_nodes: BTreeMap<NodeId, f64> = BTreeMap::new();
    for (section, levels) in network.sections.iter().zip(levels.iter_mut()) {
        if let Some(stated_m) = &section.stated_m {
            levels.clone_from(stated_m);
            at_nodes.entry(section.ends[0]).or_insert(stated_m[0]);
            at_nodes.entry(section.ends[1]).or_insert(stated_m[stated_m.len() - 1]);
        }
    }
    let designed = network.sections.iter().zip(levels).filter(|(section, _)| section.stated_m.is_none());
    for (section, levels) in designed {
        let last = levels.len() - 1;
        let off =
            |end: usize, at: usize| at_nodes.get(&section.ends[end]).map_or(0.0, |level| level - levels[at]);
        let (first_m, last_m) = (off(0, 0), off(1, last));
        let length_m = section.length_m().max(f64::MIN_POSITIVE);
        for (level, station) in levels.iter_mut().zip(&section.stations_m) {
            let share = station / length_m;
            *level += first_m * (1.0 - share) + last_m * share;
        }
    }
}

/// Draws a chain straight where no ground counts, and rounds its kinks.
fn shape(
    network: &SectionNetwork,
    chain: &SectionChain,
    targets: &StationLevels,
    curve_m: f64,
    levels: &mut StationLevels,
) {
    let mut along = chain.gather(levels);
    if along.iter().any(|level| level.is_nan()) {
        return;
    }
    let stations = chain.stations(network);
    straighten(&stations, &chain.gather(targets), &mut along);
    if let Some(profile) = Profile::new(stations, along) {
        chain.scatter(profile.smoothed(curve_m).values(), levels);
    }
}

/// Straightens every run of stations without a target between its neighbors with one, or the chain's ends.
fn straighten(stations: &[f64], targets: &[f64], levels: &mut [f64]) {
    let last = levels.len() - 1;
    let mut from = 0;
    for to in 1..=last {
        if targets[to].is_nan() && to < last {
            continue;
        }
        let (run, rise) = (stations[to] - stations[from], levels[to] - levels[from]);
        let grade = if run > 0.0 { rise / run } else { 0.0 };
        for between in from + 1..to {
            levels[between] = levels[from] + grade * (stations[between] - stations[from]);
        }
        from = to;
    }
}

/// Finds the spans along a chain for its sections. None reaches over a stated bridge or tunnel.
fn find(
    network: &SectionNetwork,
    chain: &SectionChain,
    levels: &StationLevels,
    found: &mut [Vec<SupportSpan>],
) {
    for links in chain.links.split(|link| network.sections[link.line].support != Support::Ground) {
        let part = SectionChain { links: links.to_vec() };
        let needs: StationLevels =
            part.links.iter().map(|link| needs(&network.sections[link.line], &levels[link.line])).collect();
        // The part's own sections in the order of its links.
        let own = |index: usize| ChainLink { line: index, ..part.links[index] };
        let local = SectionChain { links: (0..part.links.len()).map(own).collect() };
        let spans = spans(&part.stations(network), &local.gather(&needs));
        for link in &part.links {
            let length_m = network.sections[link.line].length_m();
            let within = spans.iter().filter_map(|span| {
                let from = (span.from_m - link.start_m).max(0.0);
                let to = (span.to_m - link.start_m).min(length_m);
                let (from_m, to_m) = match link.direction {
                    Direction::Forward => (from, to),
                    Direction::Backward => (length_m - to, length_m - from),
                };
                (to > from).then_some(SupportSpan { support: span.support, from_m, to_m })
            });
            found[link.line] = within.collect();
            if link.direction == Direction::Backward {
                found[link.line].reverse();
            }
        }
    }
}

fn needs(section: &RoadSection, levels: &[f64]) -> Vec<f64> {
    let rises = levels.iter().zip(&section.ground_m).map(|(level, ground)| level - ground);
    rises.map(|rise_m| section.limits.need(rise_m)).collect()
}

/// Releases the ground along spans and returns how many stations counted before.
fn release(network: &SectionNetwork, found: &[Vec<SupportSpan>], targets: &mut StationLevels) -> usize {
    let mut released = 0;
    for (index, section) in network.sections.iter().enumerate() {
        if section.support != Support::Ground {
            continue;
        }
        for span in &found[index] {
            let first = section.stations_m.partition_point(|&at| at <= span.from_m);
            let last = section.stations_m.partition_point(|&at| at < span.to_m);
            for target in targets[index].get_mut(first..last).into_iter().flatten() {
                released += usize::from(!target.is_nan());
                *target = f64::NAN;
            }
        }
    }
    released
}

/// Adds what is stated from end to end.
fn state(network: &SectionNetwork, found: &mut [Vec<SupportSpan>]) {
    for (section, found) in network.sections.iter().zip(found) {
        if section.support != Support::Ground {
            *found = vec![SupportSpan { support: section.support, from_m: 0.0, to_m: section.length_m() }];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::network::tests::section;
    use crate::alignment::spans::EarthworkLimits;

    const ANY: EarthworkLimits = EarthworkLimits::NONE;

    /// A straight road of sections with 10 m between stations; every section begins where the last one ended.
    fn road(grounds: &[Vec<f64>], max_grade: f64, limits: EarthworkLimits) -> SectionNetwork {
        let section = |(index, ground_m): (u32, &Vec<f64>)| {
            let stations_m = (0..ground_m.len()).map(|at| at as f64 * 10.0).collect();
            let ground_m = ground_m.clone();
            RoadSection { ground_m, limits, ..section([index, index + 1], stations_m, max_grade) }
        };
        SectionNetwork { nodes: grounds.len() + 1, sections: (0..).zip(grounds).map(section).collect() }
    }

    fn valley(width: usize, depth_m: f64) -> Vec<f64> {
        let bottom = |index: usize| (30..30 + width).contains(&index);
        (0..60 + width).map(|index| if bottom(index) { 100.0 - depth_m } else { 100.0 }).collect()
    }

    #[test]
    fn a_deep_valley_is_bridged_and_no_longer_pulls_the_road_down() {
        let limits = EarthworkLimits { max_fill_m: 6.0, max_cut_m: f64::INFINITY };
        let network = road(&[valley(20, 40.0)], 0.06, limits);
        let design = design(&network, &[100.0, 100.0], 50.0);
        assert_eq!(network.check(&design.levels_m, 1e-9), Ok(()));
        assert_eq!(design.spans[0].len(), 1);
        let SupportSpan { support, from_m, to_m } = design.spans[0][0];
        assert_eq!(support, Support::Bridge);
        assert!(from_m > 285.0 && to_m < 505.0, "{from_m}..{to_m}");
        assert!(design.levels_m[0].iter().all(|level| (level - 100.0).abs() < 1e-6), "{:?}", design.levels_m);
    }

    #[test]
    fn a_bridge_goes_on_from_one_section_into_the_next() {
        let limits = EarthworkLimits { max_fill_m: 6.0, max_cut_m: f64::INFINITY };
        let ground = valley(20, 40.0);
        let network = road(&[ground[..=40].to_vec(), ground[40..].to_vec()], 0.06, limits);
        let design = design(&network, &[f64::NAN; 3], 50.0);
        assert_eq!(design.spans[0].len(), 1);
        assert_eq!(design.spans[0][0].to_m, 400.0);
        assert_eq!(design.spans[1][0].from_m, 0.0);
    }

    #[test]
    fn a_ridge_too_high_to_cut_is_tunneled() {
        let ridge: Vec<f64> = (0..81).map(|index| 160.0 - 2.0 * f64::abs(f64::from(index) - 40.0)).collect();
        let limits = EarthworkLimits { max_fill_m: f64::INFINITY, max_cut_m: 12.0 };
        let network = road(std::slice::from_ref(&ridge), 0.05, limits);
        let design = design(&network, &[80.0, 80.0], 50.0);
        assert_eq!(design.spans[0].len(), 1);
        assert_eq!(design.spans[0][0].support, Support::Tunnel);
        for ((&station, &level), ground) in
            network.sections[0].stations_m.iter().zip(&design.levels_m[0]).zip(ridge)
        {
            let span = design.spans[0][0];
            let inside = (span.from_m..=span.to_m).contains(&station);
            assert!(inside || ground - level <= 12.0 + 1e-9, "cut {} at {station}", ground - level);
        }
    }

    #[test]
    fn a_stated_bridge_runs_straight_whatever_lies_under_it() {
        let grounds = [vec![10.0; 11], vec![10.0, 2.0, 30.0, 2.0, 14.0], vec![14.0; 11]];
        let mut network = road(&grounds, 0.2, ANY);
        network.sections[1].support = Support::Bridge;
        let design = design(&network, &[10.0, f64::NAN, f64::NAN, 14.0], 0.0);
        assert_eq!(design.spans[1], [SupportSpan { support: Support::Bridge, from_m: 0.0, to_m: 40.0 }]);
        for (level, straight) in design.levels_m[1].iter().zip([10.0, 11.0, 12.0, 13.0, 14.0]) {
            assert!((level - straight).abs() < 1e-9, "{:?}", design.levels_m[1]);
        }
    }
}
