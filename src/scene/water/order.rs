//! The order of rivers, after Strahler (1957), made continuous along them.
//!
//! A stream that nothing flows into is of order 1. Where two streams of one order meet, the order rises by one; the higher
//! of two orders goes on unchanged. A map draws a river the wider the higher its order, and lets the width grow from one
//! confluence to the next rather than jump, so what is computed here is a number that grows with the station:
//!
//! ```text
//!   source 0 ────── 1 ┐
//!                     ├─ 1 ──────────── 2 ┐
//!   source 0 ────── 1 ┘                   ├─ 2 ───── 3
//!               (another of order 2) ── 2 ┘
//! ```
//!
//! A stream of order `n`, however many lines it is drawn in and whatever lesser ones it takes up, grows from `n − 1` where
//! its order begins to `n` where it ends. What begins at the edge of the data is no source and has its order all along.
//! Arms that part from one stream and meet again are one stream, and do not raise the order.

use std::collections::BTreeMap;

use glam::DVec2;

use sandtable_geom::polyline::{Polyline, VertexKey, vertex_key};
use sandtable_geom::profile::Profile;

/// Where a line begins or ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum RiverNode {
    /// At a vertex.
    At(VertexKey),
    /// In a lake: all that flows in flows out.
    Lake(usize),
}

/// The surroundings of a network of rivers.
pub struct RiverSurroundings<'a> {
    /// The number of the lake that a place lies in.
    pub lake_at: &'a dyn Fn(DVec2) -> Option<usize>,
    /// Whether a line that begins at a place, and that nothing flows into, has its source there.
    pub may_rise_at: &'a dyn Fn(DVec2) -> bool,
}

/// The order of each of `lines`, all drawn downstream, along its stations: 0 at a source, and whole where the order ends.
pub fn orders(lines: &[&Polyline], around: &RiverSurroundings<'_>) -> Vec<Profile> {
    let mut network = ReachNetwork::new(lines, around);
    network.find_orders();
    network.find_rests();
    network.find_totals();
    lines.iter().enumerate().map(|(line, polyline)| network.profile(line, polyline)).collect()
}

/// A part of a line between two nodes.
#[derive(Debug)]
struct Reach {
    line: usize,
    /// The stations where it begins and ends, in meters.
    stations: [f64; 2],
    nodes: [usize; 2],
    /// 0 until it is found.
    order: u32,
    /// The node where the stream parted last; arms from there that meet again are one.
    parted_at: Option<usize>,
    /// Whether its order begins at its start and grows from one less.
    grows: bool,
    /// How long its stream is of the same order above and below its start, in meters.
    above_m: f64,
    rest_m: f64,
    total_m: f64,
}

impl Reach {
    fn length_m(&self) -> f64 {
        self.stations[1] - self.stations[0]
    }
}

#[derive(Default)]
struct ReachNetwork {
    reaches: Vec<Reach>,
    /// The reaches that end and that begin at each node.
    inflows: Vec<Vec<usize>>,
    outflows: Vec<Vec<usize>>,
    /// Whether a reach that begins at a node without inflow has its source there.
    is_source: Vec<bool>,
    /// The reaches in an order in which those above come first.
    downstream: Vec<usize>,
}

impl ReachNetwork {
    fn new(lines: &[&Polyline], around: &RiverSurroundings<'_>) -> Self {
        let end_keys = lines.iter().flat_map(|line| line.ends()).map(|at| (vertex_key(at), at));
        let node_of: BTreeMap<VertexKey, RiverNode> = end_keys
            .map(|(key, at)| (key, (around.lake_at)(at).map_or(RiverNode::At(key), RiverNode::Lake)))
            .collect();
        let mut numbers: BTreeMap<RiverNode, usize> = BTreeMap::new();
        let mut network = Self::default();
        for (line, polyline) in lines.iter().enumerate() {
            let mut start: Option<(usize, f64)> = None;
            for (&at, &station_m) in polyline.points().iter().zip(polyline.stations()) {
                let Some(&place) = node_of.get(&vertex_key(at)) else { continue };
                let next = numbers.len();
                let node = *numbers.entry(place).or_insert(next);
                if node == network.inflows.len() {
                    network.inflows.push(Vec::new());
                    network.outflows.push(Vec::new());
                    network.is_source.push((around.may_rise_at)(at) && !matches!(place, RiverNode::Lake(_)));
                }
                // What begins and ends in one lake or on one vertex flows nowhere.
                if let Some((from, from_m)) = start.filter(|&(from, _)| from != node) {
                    network.add(line, [from_m, station_m], [from, node]);
                }
                start = Some((node, station_m));
            }
        }
        network
    }

    fn add(&mut self, line: usize, stations: [f64; 2], nodes: [usize; 2]) {
        let number = self.reaches.len();
        let (above_m, rest_m, total_m) = (0.0, 0.0, 0.0);
        let (order, parted_at, grows) = (0, None, false);
        self.reaches.push(Reach { line, stations, nodes, order, parted_at, grows, above_m, rest_m, total_m });
        self.outflows[nodes[0]].push(number);
        self.inflows[nodes[1]].push(number);
    }

    /// Walks downstream (Kahn 1962). Where water runs in a circle, the walk goes on at the first reach that is left.
    fn find_orders(&mut self) {
        let mut waiting: Vec<usize> = self.inflows.iter().map(Vec::len).collect();
        let mut is_passed = vec![false; self.inflows.len()];
        let mut ready: Vec<usize> = (0..waiting.len()).rev().filter(|&node| waiting[node] == 0).collect();
        let mut left = 0..self.inflows.len();
        loop {
            let next = ready.pop().or_else(|| left.find(|&node| !is_passed[node]));
            let Some(node) = next else { return };
            if std::mem::replace(&mut is_passed[node], true) {
                continue;
            }
            self.pass(node);
            for &reach in &self.outflows[node] {
                let below = self.reaches[reach].nodes[1];
                waiting[below] = waiting[below].saturating_sub(1);
                if waiting[below] == 0 {
                    ready.push(below);
                }
            }
        }
    }

    /// Gives the reaches that leave a node their order.
    fn pass(&mut self, node: usize) {
        let inflows = self.inflows[node].iter().map(|&reach| &self.reaches[reach]);
        let highest = inflows.clone().map(|reach| reach.order).max().unwrap_or(0);
        let mut main: Vec<&Reach> = inflows.filter(|reach| reach.order == highest).collect();
        main.sort_by(|a, b| b.above_m.total_cmp(&a.above_m));
        let are_arms =
            main.iter().all(|reach| reach.parted_at.is_some() && reach.parted_at == main[0].parted_at);
        let rises = main.len() > 1 && !are_arms;
        let order = highest.max(1) + u32::from(rises);
        let begins = rises || highest == 0;
        let above_m = main.first().filter(|_| !begins).map_or(0.0, |reach| reach.above_m + reach.length_m());
        let parts = self.outflows[node].len() > 1;
        let parted_at = match (parts, main.first()) {
            (true, _) => Some(node),
            (false, Some(main)) if !begins && !are_arms => main.parted_at,
            _ => None,
        };
        let grows = if highest == 0 { self.is_source[node] } else { true };
        let inherited = main.first().filter(|_| !begins).map(|reach| reach.grows);
        for &number in &self.outflows[node] {
            let reach = &mut self.reaches[number];
            reach.order = order;
            reach.parted_at = parted_at;
            reach.above_m = above_m;
            reach.grows = inherited.unwrap_or(grows);
            self.downstream.push(number);
        }
    }

    /// How far each stream goes on in its order, from below.
    fn find_rests(&mut self) {
        for &number in self.downstream.iter().rev() {
            let reach = &self.reaches[number];
            let below = self.outflows[reach.nodes[1]].iter().map(|&next| &self.reaches[next]);
            let longest_m =
                below.filter(|next| next.order == reach.order).map(|next| next.rest_m).fold(0.0, f64::max);
            self.reaches[number].rest_m = reach.length_m() + longest_m;
        }
    }

    /// How long each stream is, from above, so that the arms of one agree where they part.
    fn find_totals(&mut self) {
        for &number in &self.downstream {
            let reach = &self.reaches[number];
            let above = self.inflows[reach.nodes[0]].iter().map(|&before| &self.reaches[before]);
            let same = above.filter(|before| {
                before.order == reach.order && before.above_m + before.length_m() == reach.above_m
            });
            let own_m = reach.above_m + reach.rest_m;
            let inherited_m = same.map(|before| before.total_m).fold(0.0, f64::max);
            self.reaches[number].total_m = if inherited_m > 0.0 { inherited_m } else { own_m };
        }
    }

    fn profile(&self, line: usize, polyline: &Polyline) -> Profile {
        let [mut stations, mut values] = [Vec::new(), Vec::new()];
        let [first, end] =
            [line, line + 1].map(|line| self.reaches.partition_point(|reach| reach.line < line));
        for reach in &self.reaches[first..end] {
            let grown = |along_m: f64| {
                let part = if reach.grows { (reach.above_m + along_m) / reach.total_m } else { 1.0 };
                f64::from(reach.order) - 1.0 + part.clamp(0.0, 1.0)
            };
            stations.extend(reach.stations);
            values.extend([grown(0.0), grown(reach.length_m())]);
        }
        Profile::new(stations, values).unwrap_or_else(|| Profile::straight(polyline.length(), [1.0; 2]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&point| DVec2::from(point)), 0.0).expect("a line")
    }

    fn found(lines: &[Polyline], lake_at: &dyn Fn(DVec2) -> Option<usize>) -> Vec<Profile> {
        let lines: Vec<&Polyline> = lines.iter().collect();
        orders(&lines, &RiverSurroundings { lake_at, may_rise_at: &|at| at.x > -500.0 })
    }

    fn ends(profile: &Profile) -> [f64; 2] {
        [profile.values()[0], profile.values()[profile.values().len() - 1]]
    }

    #[test]
    fn streams_of_one_order_make_one_of_the_next_and_lesser_ones_none() {
        // Two springs, what they make together, a third spring that joins it midway, and its like.
        let lines = [
            line(&[(0.0, 100.0), (100.0, 0.0)]),
            line(&[(0.0, -100.0), (100.0, 0.0)]),
            line(&[(100.0, 0.0), (200.0, 0.0), (300.0, 0.0)]),
            line(&[(200.0, 100.0), (200.0, 0.0)]),
            line(&[(200.0, -200.0), (290.0, -100.0)]),
            line(&[(400.0, -200.0), (290.0, -100.0)]),
            line(&[(290.0, -100.0), (300.0, 0.0)]),
            line(&[(300.0, 0.0), (400.0, 0.0)]),
        ];
        let orders = found(&lines, &|_| None);
        assert_eq!(ends(&orders[0]), [0.0, 1.0]);
        assert_eq!(ends(&orders[2]), [1.0, 2.0]);
        assert!((orders[2].at(100.0) - 1.5).abs() < 1e-9, "a lesser stream does not make it grow");
        assert_eq!(ends(&orders[3]), [0.0, 1.0]);
        assert_eq!(ends(&orders[7]), [2.0, 3.0]);
    }

    #[test]
    fn a_stream_grows_on_from_line_to_line() {
        let lines = [line(&[(100.0, 0.0), (400.0, 0.0)]), line(&[(0.0, 0.0), (100.0, 0.0)])];
        let orders = found(&lines, &|_| None);
        assert_eq!(ends(&orders[1]), [0.0, 0.25]);
        assert_eq!(ends(&orders[0]), [0.25, 1.0]);
    }

    #[test]
    fn what_begins_at_the_edge_or_in_a_lake_is_no_source() {
        let lake = |at: DVec2| (at.x > 90.0 && at.x < 210.0).then_some(0);
        let lines = [
            line(&[(-900.0, 0.0), (0.0, 0.0)]),
            line(&[(0.0, 50.0), (100.0, 0.0)]),
            line(&[(0.0, -50.0), (100.0, -10.0)]),
            line(&[(200.0, 0.0), (300.0, 0.0)]),
        ];
        let orders = found(&lines, &lake);
        assert_eq!(ends(&orders[0]), [1.0, 1.0]);
        assert_eq!(ends(&orders[3]), [1.0, 2.0], "what flows into a lake flows out of it");
        assert_eq!(ends(&found(&lines[3..], &lake)[0]), [1.0, 1.0]);
    }

    #[test]
    fn arms_around_an_island_are_one_stream() {
        let lines = [
            line(&[(0.0, 0.0), (100.0, 0.0)]),
            line(&[(100.0, 0.0), (150.0, 30.0), (200.0, 0.0)]),
            line(&[(100.0, 0.0), (150.0, -30.0), (200.0, 0.0)]),
            line(&[(200.0, 0.0), (300.0, 0.0)]),
        ];
        let orders = found(&lines, &|_| None);
        assert_eq!(ends(&orders[3])[1], 1.0);
        assert_eq!(ends(&orders[1]), ends(&orders[2]));
    }

    #[test]
    fn water_that_runs_in_a_circle_has_an_order_too() {
        let ring = [
            line(&[(0.0, 0.0), (50.0, 0.0)]),
            line(&[(50.0, 0.0), (0.0, 50.0)]),
            line(&[(0.0, 50.0), (0.0, 0.0)]),
        ];
        let orders = found(&ring, &|_| None);
        assert!(orders.iter().flat_map(|order| order.values()).all(|order| (0.0..=2.0).contains(order)));
    }
}
