//! Chains of spans: a bridge that its file cuts into pieces must not come down to the ground in the middle of the valley.
//!
//! ```text
//!   ground ──●━━━━━━━○━━━━━━━━━○━━━━━●── ground      three spans, one chain
//!                    ┃ branch                       a span that meets it: a chain that ends on it
//! ```
//!
//! A chain ends on the ground where a road on the ground has a vertex or something of another kind ends, and where nothing
//! continues it.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rayon::prelude::*;

use crate::roads::centerline::Centerline;
use crate::roads::spans::RoadSpan;
use sandtable_earthworks::alignment::Support;
use sandtable_earthworks::alignment::chain::{self, ChainLink, LineEnd};
use sandtable_geom::polyline::{VertexKey, vertex_key};

/// Spans in a row, each from where the one before ends.
#[derive(Clone, Debug, PartialEq)]
pub struct SpanChain {
    /// Its spans, at least one.
    pub links: Vec<ChainLink>,
    /// Its length in meters.
    pub length_m: f64,
    /// What it meets at its start and end.
    pub ends: [ChainEnd; 2],
}

/// The end of a chain: what it meets there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainEnd {
    /// A road on the ground, or something that ends on it.
    Ground,
    /// Nothing: the file ends there.
    Loose,
    /// Others of its kind, and no ground.
    Onward(VertexKey),
}

impl SpanChain {
    /// The chains of `spans`, in order of their first spans; a span whose levels are stated is a chain alone.
    pub fn all(spans: &[RoadSpan], roads: &[Centerline]) -> Vec<Self> {
        let meetings = SpanMeetings::new(spans, roads);
        let lengths_m: Vec<f64> = spans.iter().map(|span| span.street.alignment.line.length()).collect();
        let chain = |links: Vec<ChainLink>| {
            let (first, last) = (links[0], links[links.len() - 1]);
            let ends = [first.entry(), last.entry().opposite()].map(|end| meetings.end(end));
            Self { length_m: last.end_m(), ends, links }
        };
        chain::chains(&lengths_m, |end| meetings.next(end)).into_iter().map(chain).collect()
    }

    /// The point at a station in meters.
    pub fn at(&self, spans: &[RoadSpan], station_m: f64) -> DVec2 {
        let link = self.links.iter().find(|link| station_m <= link.end_m());
        let link = link.unwrap_or(&self.links[self.links.len() - 1]);
        spans[link.line].street.alignment.line.at((station_m - link.reach_m()[0]).abs())
    }
}

/// Which spans end where.
struct SpanMeetings<'a> {
    spans: &'a [RoadSpan],
    /// The ends of spans by support and vertex.
    ends: BTreeMap<(Support, VertexKey), Vec<LineEnd>>,
    /// The vertices inside spans, by support.
    inside: BTreeSet<(Support, VertexKey)>,
    /// The vertices at which the ground, or something of another kind, fixes the level.
    fixed: BTreeSet<VertexKey>,
}

impl<'a> SpanMeetings<'a> {
    fn new(spans: &'a [RoadSpan], roads: &[Centerline]) -> Self {
        let mut ends: BTreeMap<(Support, VertexKey), Vec<LineEnd>> = BTreeMap::new();
        let mut inside = BTreeSet::new();
        for (line, span) in spans.iter().enumerate() {
            let support = span.street.alignment.support;
            for (end, at) in span.street.alignment.line.ends().into_iter().enumerate() {
                ends.entry((support, vertex_key(at))).or_default().push(LineEnd { line, end });
            }
            let points = span.street.alignment.line.points();
            inside.extend(points[1..points.len() - 1].iter().map(|&at| (support, vertex_key(at))));
        }
        let ends_at = |support, at| ends.contains_key(&(support, at));
        let on_ground = roads.par_iter().filter(|road| road.street.alignment.is_on_ground());
        let touched =
            on_ground.flat_map_iter(|road| road.street.alignment.line.points()).map(|&at| vertex_key(at));
        let touched: Vec<VertexKey> =
            touched.filter(|&at| ends_at(Support::Bridge, at) || ends_at(Support::Tunnel, at)).collect();
        let mut fixed = BTreeSet::from_iter(touched);
        let both = ends.keys().map(|&(_, at)| at);
        fixed.extend(both.filter(|&at| ends_at(Support::Bridge, at) && ends_at(Support::Tunnel, at)));
        Self { spans, ends, inside, fixed }
    }

    fn key(&self, LineEnd { line, end }: LineEnd) -> (Support, VertexKey) {
        let alignment = &self.spans[line].street.alignment;
        (alignment.support, vertex_key(alignment.line.ends()[end]))
    }

    /// The one end of an open span that continues an end of another.
    fn next(&self, at: LineEnd) -> Option<LineEnd> {
        let key = self.key(at);
        let others: Vec<_> = self.ends[&key].iter().copied().filter(|&other| other != at).collect();
        let is_free = !self.fixed.contains(&key.1) && !self.inside.contains(&key);
        let is_open = |end: LineEnd| self.spans[end.line].street.alignment.level.is_none();
        match others[..] {
            [other] if is_free && is_open(at) && is_open(other) => Some(other),
            _ => None,
        }
    }

    /// What a span meets at its end.
    fn end(&self, at: LineEnd) -> ChainEnd {
        let key = self.key(at);
        let meets_others = self.ends[&key].len() > 1 || self.inside.contains(&key);
        match (self.fixed.contains(&key.1), meets_others) {
            (true, _) => ChainEnd::Ground,
            (false, true) => ChainEnd::Onward(key.1),
            (false, false) => ChainEnd::Loose,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feature_origin::FeatureOrigin;
    use crate::roads::centerline;
    use crate::roads::spans::SpanOrigin;
    use sandtable_geom::offset::Continuations;

    fn span(support: Support, points: &[(f64, f64)]) -> RoadSpan {
        RoadSpan {
            street: centerline::tests::road(points, support, 1).street,
            road: None,
            beyond: Continuations::default(),
            pier_spacing_m: None,
            max_grade: None,
            name: String::new(),
            origin: SpanOrigin::Tag,
            place: FeatureOrigin::default(),
        }
    }

    #[test]
    fn pieces_of_a_bridge_are_one_chain_whichever_way_they_run() {
        let pieces = [
            span(Support::Bridge, &[(20.0, 0.0), (10.0, 0.0)]),
            span(Support::Bridge, &[(0.0, 0.0), (10.0, 0.0)]),
            span(Support::Bridge, &[(20.0, 0.0), (50.0, 0.0)]),
        ];
        let chains = SpanChain::all(&pieces, &[]);
        assert_eq!(chains.len(), 1);
        assert_eq!((chains[0].length_m, chains[0].ends), (50.0, [ChainEnd::Loose; 2]));
        for (index, piece) in pieces.iter().enumerate() {
            let link = chains[0].links.iter().find(|link| link.line == index).expect("a link");
            for end in 0..2 {
                assert_eq!(
                    chains[0].at(&pieces, link.reach_m()[end]),
                    piece.street.alignment.line.ends()[end]
                );
            }
        }
    }

    #[test]
    fn three_that_meet_are_three_chains_that_go_on_and_a_tunnel_ends_a_bridge() {
        let pieces = [
            span(Support::Bridge, &[(0.0, 0.0), (10.0, 0.0)]),
            span(Support::Bridge, &[(10.0, 0.0), (20.0, 5.0)]),
            span(Support::Bridge, &[(10.0, 0.0), (20.0, -5.0)]),
            span(Support::Tunnel, &[(0.0, 0.0), (-30.0, 0.0)]),
        ];
        let chains = SpanChain::all(&pieces, &[]);
        assert_eq!(chains.len(), 4);
        let meeting = ChainEnd::Onward(vertex_key(DVec2::new(10.0, 0.0)));
        assert_eq!(chains[0].ends, [ChainEnd::Ground, meeting]);
        assert_eq!(chains[1].ends, [meeting, ChainEnd::Loose]);
        assert_eq!(chains[3].ends, [ChainEnd::Ground, ChainEnd::Loose]);
    }
}
