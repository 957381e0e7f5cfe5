//! The levels of bridges and tunnels: the elevations of each chain, from its ends and the lines that it passes over.
//!
//! A chain that ends on the ground has its height there. Where chains meet in the air, the levels of the meetings solve
//! Laplace's equation on the network, each chain weighing as the inverse of its length: all of them rise evenly there.
//! Chains of lower level come first, so that those above know what they pass over.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::roads::centerline::Centerline;
use crate::roads::chains::{ChainEnd, SpanChain};
use crate::roads::crossings::{self, Overpass};
use crate::roads::spans::RoadSpan;
use crate::vertical_scale::VerticalScale;
use sandtable_earthworks::alignment::Support;
use sandtable_geom::polyline::{VertexKey, vertex_key};
use sandtable_geom::profile::Profile;
use sandtable_ribbon::junction::Street;
use sandtable_structure::bridge::depth_m;
use sandtable_structure::deck_profile::{ClearancePoint, clearing};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::deck::Deck;
use sandtable_terrain::query::{Interpolation, ground_height};

/// The clearance of a bridge over roads and water where it can be climbed to, in meters: 4.5 m for traffic and a reserve.
pub const CLEARANCE_M: f64 = 5.0;

/// The steepest climb to that, rise over run.
pub const STEEPEST: f64 = 0.10;

/// The default of the greatest distance between piers of a low bridge, in meters.
pub const PIER_SPACING_M: f64 = 25.0;

/// A high bridge's spans grow with its height, as its piers cost more: this part of it.
const SPACING_PER_HEIGHT: f64 = 0.6;

/// They grow up to this, in meters, the longest that a girder without haunches carries.
const WIDEST_SPACING_M: f64 = 70.0;

/// The most points at which the ground under a chain is sampled.
const MOST_SAMPLES: f64 = 4096.0;

/// How often levels of meetings are averaged: changes die off the faster, the fewer chains lie between two grounds.
const EVENINGS: usize = 200;

/// The ground and the water under bridges.
pub struct Site<'a> {
    /// The ground.
    pub lattice: &'a Lattice,
    /// Where there is water; its heights have no meaning.
    pub water: &'a Deck,
    /// How elevations are drawn.
    pub scale: VerticalScale,
}

impl Site<'_> {
    /// The ground's elevation at a world position in meters, on the finest triangles.
    pub fn ground_m(&self, at: DVec2) -> Option<f64> {
        ground_height(self.lattice, Interpolation::Planar, at + self.lattice.origin()).height_m()
    }

    /// The ground's World Z at a world position, as it is drawn.
    pub fn ground_z(&self, at: DVec2) -> Option<f64> {
        self.ground_m(at).map(|height_m| self.scale.world_z(height_m))
    }
}

/// Something that passes below a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// From where to where along the chain, in meters.
    pub reach_m: [f64; 2],
    /// Its elevation in meters.
    pub level_m: f64,
}

/// The levels of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainRun {
    /// Its elevations by station.
    pub profile: Profile,
    /// The ground below it, at stations rising, where there is some.
    pub ground: Vec<ClearancePoint>,
    /// What passes below; none below a tunnel.
    pub passages: Vec<Passage>,
    /// The widest span between piers, in meters.
    pub spacing_m: f64,
    /// How deep its deck is drawn, in meters.
    pub depth_m: f64,
}

/// The levels of every chain; `None` where there is no ground along it.
pub fn settle(
    spans: &[RoadSpan],
    chains: &[SpanChain],
    roads: &[Centerline],
    site: &Site<'_>,
) -> Vec<Option<ChainRun>> {
    let below = Below::new(spans, chains, roads, site);
    let samples: Vec<Vec<ClearancePoint>> =
        chains.par_iter().map(|chain| sampled(chain, spans, site)).collect();
    let meetings = meetings(&samples, &below);
    let mut order: Vec<usize> = (0..chains.len()).collect();
    order.sort_by_key(|&chain| {
        (below.leans_on_another(&chains[chain]), top_level(&chains[chain], spans), chain)
    });
    let mut runs: Vec<Option<ChainRun>> = vec![None; chains.len()];
    for index in order {
        runs[index] = below.run(index, &samples[index], &meetings, &runs);
    }
    runs
}

fn top_level(chain: &SpanChain, spans: &[RoadSpan]) -> i32 {
    chain.links.iter().map(|link| spans[link.line].street.level).max().unwrap_or(0)
}

/// The widest span between piers of a bridge as high as this.
fn by_height(profile: &Profile, ground: &[ClearancePoint]) -> f64 {
    let above = |floor: &ClearancePoint| profile.at(floor.station_m) - floor.level_m;
    let highest = ground.iter().map(above).fold(0.0, f64::max);
    (SPACING_PER_HEIGHT * highest).clamp(PIER_SPACING_M, WIDEST_SPACING_M)
}

/// The ground along a chain: twice a cell, and often enough on short ones.
fn sampled(chain: &SpanChain, spans: &[RoadSpan], site: &Site<'_>) -> Vec<ClearancePoint> {
    let step = (site.lattice.cell().min_element() / 2.0)
        .min(chain.length_m / 16.0)
        .max(chain.length_m / MOST_SAMPLES);
    let count = (chain.length_m / step).ceil().clamp(2.0, MOST_SAMPLES) as usize;
    let station = |index: usize| chain.length_m * index as f64 / count as f64;
    let floor = |station_m: f64| {
        let level_m = site.ground_m(chain.at(spans, station_m))?;
        Some(ClearancePoint { station_m, level_m })
    };
    (0..=count).filter_map(|index| floor(station(index))).collect()
}

/// What chains pass over and lean on.
struct Below<'a> {
    spans: &'a [RoadSpan],
    chains: &'a [SpanChain],
    site: &'a Site<'a>,
    /// Where bridges cross lower lines: the roads on the ground first, then the bridges.
    crossings: Vec<Overpass>,
    /// The spans of the crossings' upper lines.
    bridges: Vec<usize>,
    /// How many of the lower lines are roads on the ground.
    roads: usize,
    /// The widths of the lower lines.
    widths_m: Vec<f64>,
    /// The chain and the link of each span.
    link_of: Vec<(usize, usize)>,
    /// The vertices inside spans: span and station.
    inside: BTreeMap<VertexKey, (usize, f64)>,
}

impl<'a> Below<'a> {
    fn new(
        spans: &'a [RoadSpan],
        chains: &'a [SpanChain],
        all_roads: &[Centerline],
        site: &'a Site<'a>,
    ) -> Self {
        let bridges: Vec<usize> = (0..spans.len())
            .filter(|&span| spans[span].street.alignment.support == Support::Bridge)
            .collect();
        let upper: Vec<&Street> = bridges.iter().map(|&span| &spans[span].street).collect();
        let on_ground =
            all_roads.iter().map(|road| &road.street).filter(|road| road.alignment.is_on_ground());
        let roads = on_ground.clone().count();
        let lower: Vec<&Street> = on_ground.chain(upper.iter().copied()).collect();
        let mut link_of = vec![(0, 0); spans.len()];
        for (index, chain) in chains.iter().enumerate() {
            for (link, placed) in chain.links.iter().enumerate() {
                link_of[placed.line] = (index, link);
            }
        }
        let mut inside = BTreeMap::new();
        for (index, span) in spans.iter().enumerate() {
            let (points, stations) =
                (span.street.alignment.line.points(), span.street.alignment.line.stations());
            let between = 1..points.len() - 1;
            inside.extend(between.map(|vertex| (vertex_key(points[vertex]), (index, stations[vertex]))));
        }
        Self {
            spans,
            chains,
            site,
            crossings: crossings::find(&upper, &lower),
            widths_m: lower.iter().map(|way| way.width_m).collect(),
            bridges,
            roads,
            link_of,
            inside,
        }
    }

    /// The chain that has a vertex inside it, and the vertex' station.
    fn host(&self, at: VertexKey) -> Option<(usize, f64)> {
        let &(span, on_span_m) = self.inside.get(&at)?;
        let (chain, link) = self.link_of[span];
        Some((chain, self.chains[chain].links[link].station_m(on_span_m)))
    }

    fn leans_on_another(&self, chain: &SpanChain) -> bool {
        chain.ends.iter().any(|end| matches!(end, ChainEnd::Onward(at) if self.inside.contains_key(at)))
    }

    fn run(
        &self,
        index: usize,
        ground: &[ClearancePoint],
        meetings: &BTreeMap<VertexKey, f64>,
        runs: &[Option<ChainRun>],
    ) -> Option<ChainRun> {
        let (chain, spans) = (&self.chains[index], self.spans);
        let own = ground_ends(ground)?;
        let end_m = |end: usize| match chain.ends[end] {
            ChainEnd::Ground | ChainEnd::Loose => own[end],
            ChainEnd::Onward(at) => {
                let host = self.host(at).filter(|&(host, _)| host != index);
                let on_host = host.and_then(|(host, station)| Some(runs[host].as_ref()?.profile.at(station)));
                on_host.or_else(|| meetings.get(&at).copied()).unwrap_or(own[end])
            }
        };
        let first = &spans[chain.links[0].line];
        let ends_m = [end_m(0), end_m(1)];
        let stated = chain.links.iter().filter_map(|link| spans[link.line].pier_spacing_m).reduce(f64::min);
        let spacing_m =
            stated.unwrap_or_else(|| by_height(&Profile::straight(chain.length_m, ends_m), ground));
        let depth_m = depth_m(spacing_m.min(chain.length_m));
        let is_bridge = first.street.alignment.support == Support::Bridge;
        let passages = if is_bridge { self.passages(index, runs) } else { Vec::new() };
        let level = first.street.alignment.level.clone();
        let stated = level.filter(|level| level.values().iter().all(|level| level.is_finite()));
        let straight = Profile::straight(chain.length_m, ends_m);
        let profile = stated.unwrap_or_else(|| {
            if !is_bridge {
                return straight;
            }
            let room = CLEARANCE_M + self.site.scale.elevation_m(depth_m);
            let floors = passages.iter().flat_map(|passage| {
                passage.reach_m.map(|station_m| ClearancePoint { station_m, level_m: passage.level_m + room })
            });
            clearing(&straight, ground, &floors.collect::<Vec<_>>(), STEEPEST)
        });
        Some(ChainRun { profile, ground: ground.to_vec(), passages, spacing_m, depth_m })
    }

    /// What passes below a chain, by station.
    fn passages(&self, index: usize, runs: &[Option<ChainRun>]) -> Vec<Passage> {
        let (chain, chains, site) = (&self.chains[index], self.chains, self.site);
        let mut all = wet(chain, self.spans, site);
        for crossing in &self.crossings {
            let (upper, link) = self.link_of[self.bridges[crossing.upper]];
            if upper != index {
                continue;
            }
            let level_m = match crossing.lower.checked_sub(self.roads) {
                None => site.ground_m(crossing.at),
                Some(lower) => {
                    let (host, link) = self.link_of[self.bridges[lower]];
                    let station = chains[host].links[link].station_m(crossing.lower_m);
                    runs[host].as_ref().map(|run| run.profile.at(station))
                }
            };
            let station = chain.links[link].station_m(crossing.upper_m);
            let half = crossing.half_m.min(self.widths_m[crossing.lower] * 3.0);
            let reach_m = [(station - half).max(0.0), (station + half).min(chain.length_m)];
            all.extend(level_m.map(|level_m| Passage { reach_m, level_m }));
        }
        all.sort_by(|a, b| a.reach_m[0].total_cmp(&b.reach_m[0]));
        all
    }
}

/// The stretches of a chain over water, each with the highest ground under it.
fn wet(chain: &SpanChain, spans: &[RoadSpan], site: &Site<'_>) -> Vec<Passage> {
    let mut all: Vec<Passage> = Vec::new();
    if site.water.facets().is_empty() {
        return all;
    }
    let step = (chain.length_m / MOST_SAMPLES).max(1.0);
    let count = (chain.length_m / step).ceil().max(1.0) as usize;
    let mut was_wet = false;
    for index in 0..=count {
        let station = chain.length_m * index as f64 / count as f64;
        let at = chain.at(spans, station);
        let level_m = site.water.height_m(at).and_then(|_| site.ground_m(at));
        match (level_m, all.last_mut()) {
            (Some(level), Some(last)) if was_wet => {
                last.reach_m[1] = station;
                last.level_m = last.level_m.max(level);
            }
            (Some(level_m), _) => all.push(Passage { reach_m: [station; 2], level_m }),
            (None, _) => {}
        }
        was_wet = level_m.is_some();
    }
    all
}

/// The ground at both ends of a chain, or where there is some nearest to them.
fn ground_ends(ground: &[ClearancePoint]) -> Option<[f64; 2]> {
    Some([ground.first()?.level_m, ground.last()?.level_m])
}

/// What pulls at a meeting: the level at the other end of a chain, fixed or that of another meeting.
struct LevelPull {
    at: VertexKey,
    other: Option<VertexKey>,
    level_m: f64,
    length_m: f64,
}

/// The levels of the vertices where chains meet above or below the ground.
fn meetings(samples: &[Vec<ClearancePoint>], below: &Below<'_>) -> BTreeMap<VertexKey, f64> {
    let mut levels: BTreeMap<VertexKey, f64> = BTreeMap::new();
    let mut lowest: BTreeMap<VertexKey, f64> = BTreeMap::new();
    let mut pulls: Vec<LevelPull> = Vec::new();
    for (chain, ground) in below.chains.iter().zip(samples) {
        let Some(own) = ground_ends(ground) else { continue };
        let first = &below.spans[chain.links[0].line].street.alignment;
        let stated = first.level.as_ref().map(Profile::values);
        let own = stated.map_or(own, |levels| [levels[0], levels[levels.len() - 1]]);
        for end in 0..2 {
            let ChainEnd::Onward(at) = chain.ends[end] else { continue };
            levels.entry(at).or_insert(own[end]);
            if first.support == Support::Bridge && stated.is_none() {
                lowest.insert(at, own[end]);
            }
            let other = match chain.ends[1 - end] {
                ChainEnd::Onward(other) => Some(other),
                _ => None,
            };
            pulls.push(if stated.is_some() {
                LevelPull { at, other: None, level_m: own[end], length_m: 1e-3 }
            } else {
                LevelPull { at, other, level_m: own[1 - end], length_m: chain.length_m }
            });
            if let Some((host, station)) = below.host(at) {
                let ends = ground_ends(&samples[host]).unwrap_or(own);
                let lengths = [station, below.chains[host].length_m - station];
                pulls.extend(ends.into_iter().zip(lengths).map(|(level_m, length_m)| LevelPull {
                    at,
                    other: None,
                    level_m,
                    length_m: length_m.max(1e-3),
                }));
            }
        }
    }
    pulls.sort_by_key(|pull| pull.at);
    for _ in 0..EVENINGS {
        for group in pulls.chunk_by(|a, b| a.at == b.at) {
            let level = |pull: &LevelPull| pull.other.map_or(pull.level_m, |at| levels[&at]);
            let weight: f64 = group.iter().map(|pull| 1.0 / pull.length_m).sum();
            let sum: f64 = group.iter().map(|pull| level(pull) / pull.length_m).sum();
            levels.insert(group[0].at, sum / weight);
        }
    }
    for (at, ground_m) in lowest {
        levels.entry(at).and_modify(|level| *level = level.max(ground_m));
    }
    levels
}
