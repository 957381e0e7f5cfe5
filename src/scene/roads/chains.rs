//! Spans that go on in one another are one structure: a bridge that its file cuts into pieces must not come down to the
//! ground where one piece ends in the middle of the valley.
//!
//! ```text
//!   ground ──●━━━━━━━○━━━━━━━━━○━━━━━●── ground      three spans, one chain
//!                    ┃ branch                       a span that meets it: a chain of its own that ends on it
//! ```
//!
//! A chain's end lies on the ground wherever a road on the ground has a vertex, or something of another kind ends; so it
//! does where nothing goes on, for want of anything better.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use crate::scene::roads::centerline::{Centerline, Support};
use crate::scene::roads::spans::{PointKey, RoadSpan, place};

/// Spans in a row, each from where the one before ends.
#[derive(Clone, Debug, PartialEq)]
pub struct SpanChain {
    /// Its spans.
    pub links: Vec<SpanLink>,
    /// Its length in meters.
    pub length_m: f64,
    /// What it meets at its start and end.
    pub ends: [ChainEnd; 2],
}

/// A span's place in a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanLink {
    /// Which span.
    pub span: usize,
    /// Where the span's own start and end lie along the chain, in meters; the second lower where it runs backwards.
    pub reach_m: [f64; 2],
}

/// What a chain meets at an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainEnd {
    /// A road on the ground, or something that ends on it.
    Ground,
    /// Nothing: the file ends there.
    Loose,
    /// Others of its kind, and no ground.
    Onward(PointKey),
}

impl SpanChain {
    /// The point at a station in meters.
    pub fn at(&self, spans: &[RoadSpan], station_m: f64) -> DVec2 {
        let within = |link: &&SpanLink| station_m <= link.reach_m[0].max(link.reach_m[1]);
        let link = self.links.iter().find(within).unwrap_or(&self.links[self.links.len() - 1]);
        spans[link.span].line.at((station_m - link.reach_m[0]).abs())
    }

    /// The station on the chain of a station on one of its links' spans.
    pub fn station_m(link: &SpanLink, on_span_m: f64) -> f64 {
        let [start, end] = link.reach_m;
        if start <= end { start + on_span_m } else { start - on_span_m }
    }
}

/// Joins spans whose levels are open to chains; a span whose levels are settled is a chain alone. In order of their first
/// spans.
pub fn join(spans: &[RoadSpan], roads: &[Centerline]) -> Vec<SpanChain> {
    let meetings = SpanMeetings::new(spans, roads);
    let mut is_taken = vec![false; spans.len()];
    let mut chains = Vec::new();
    for first in 0..spans.len() {
        if is_taken[first] {
            continue;
        }
        is_taken[first] = true;
        let forward = meetings.walk((first, 1), &mut is_taken);
        let backward = meetings.walk((first, 0), &mut is_taken);
        // A step's end lies away from the first span: walked back it is where the span is entered, forward where left.
        let steps = backward.iter().rev().copied();
        let onward = forward.iter().map(|&(span, end)| (span, 1 - end));
        chains.push(chain(spans, &meetings, steps.chain([(first, 0)]).chain(onward)));
    }
    chains
}

/// A chain of spans, each with the end by which it is entered.
fn chain(
    spans: &[RoadSpan],
    meetings: &SpanMeetings,
    steps: impl Iterator<Item = (usize, usize)>,
) -> SpanChain {
    let mut length_m = 0.0;
    let mut links = Vec::new();
    let mut corners: Option<[(usize, usize); 2]> = None;
    for (span, entered) in steps {
        let (from, to) = (length_m, length_m + spans[span].line.length());
        let reach_m = if entered == 0 { [from, to] } else { [to, from] };
        links.push(SpanLink { span, reach_m });
        length_m = to;
        let left = (span, 1 - entered);
        corners = Some([corners.map_or((span, entered), |corners| corners[0]), left]);
    }
    let ends = corners.map_or([ChainEnd::Ground; 2], |corners| corners.map(|corner| meetings.end(corner)));
    SpanChain { links, length_m, ends }
}

/// Which spans end where.
struct SpanMeetings {
    /// For each kind and place, the ends of the spans there.
    ends: BTreeMap<(bool, PointKey), Vec<(usize, usize)>>,
    /// Places inside a span's line, by kind.
    inside: BTreeSet<(bool, PointKey)>,
    /// Where the ground, or something of another kind, holds a level.
    held: BTreeSet<PointKey>,
    /// For each span its two places.
    places: Vec<[PointKey; 2]>,
    /// Whether each span may be joined with others.
    is_open: Vec<bool>,
    /// Whether each span is a tunnel.
    kinds: Vec<bool>,
}

impl SpanMeetings {
    fn new(spans: &[RoadSpan], roads: &[Centerline]) -> Self {
        let kind = |span: &RoadSpan| span.carried == Support::Tunnel;
        let places: Vec<[PointKey; 2]> =
            spans.iter().map(|span| [0, 1].map(|end| place(span.end(end)))).collect();
        let mut ends: BTreeMap<(bool, PointKey), Vec<(usize, usize)>> = BTreeMap::new();
        let mut inside = BTreeSet::new();
        for (index, span) in spans.iter().enumerate() {
            for (end, &at) in places[index].iter().enumerate() {
                ends.entry((kind(span), at)).or_default().push((index, end));
            }
            let points = span.line.points();
            inside.extend(points[1..points.len() - 1].iter().map(|&at| (kind(span), place(at))));
        }
        let mut held: BTreeSet<PointKey> = BTreeSet::new();
        for road in roads.iter().filter(|road| road.carried == Support::Ground) {
            let touched = road.line.points().iter().map(|&at| place(at));
            held.extend(
                touched.filter(|&at| [false, true].iter().any(|&kind| ends.contains_key(&(kind, at)))),
            );
        }
        let mixed: Vec<PointKey> =
            ends.keys().filter(|&&(kind, at)| ends.contains_key(&(!kind, at))).map(|&(_, at)| at).collect();
        held.extend(mixed);
        let is_open = spans.iter().map(|span| span.levels_m.is_none()).collect();
        Self { ends, inside, held, places, is_open, kinds: spans.iter().map(kind).collect() }
    }

    /// The steps from a span's end on through others, each the next span with its end farther on.
    fn walk(&self, from: (usize, usize), is_taken: &mut [bool]) -> Vec<(usize, usize)> {
        let mut steps = Vec::new();
        let (mut span, mut end) = from;
        while let Some((next, met)) = self.goes_on((span, end)) {
            if is_taken[next] {
                break;
            }
            is_taken[next] = true;
            steps.push((next, 1 - met));
            (span, end) = (next, 1 - met);
        }
        steps
    }

    /// The one open end that an open span goes on in.
    fn goes_on(&self, (span, end): (usize, usize)) -> Option<(usize, usize)> {
        let at = self.places[span][end];
        let here = &self.ends[&(self.kinds[span], at)];
        let others: Vec<_> = here.iter().copied().filter(|&other| other != (span, end)).collect();
        let is_free = !self.held.contains(&at) && !self.inside.contains(&(self.kinds[span], at));
        match others[..] {
            [other] if is_free && self.is_open[span] && self.is_open[other.0] => Some(other),
            _ => None,
        }
    }

    /// What a span meets at its end.
    fn end(&self, (span, end): (usize, usize)) -> ChainEnd {
        let at = self.places[span][end];
        let key = (self.kinds[span], at);
        let meets_others = self.ends[&key].len() > 1 || self.inside.contains(&key);
        match (self.held.contains(&at), meets_others) {
            (true, _) => ChainEnd::Ground,
            (false, true) => ChainEnd::Onward(at),
            (false, false) => ChainEnd::Loose,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polyline::Polyline;
    use crate::ribbon::stroke::StrokeOptions;
    use crate::ribbon::texture::RibbonSurface;
    use crate::scene::roads::spans::SpanOrigin;

    fn span(carried: Support, points: &[(f64, f64)]) -> RoadSpan {
        RoadSpan {
            line: Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line"),
            carried,
            road: None,
            levels_m: None,
            beyond: [None; 2],
            options: StrokeOptions::default(),
            surface: RibbonSurface::Asphalt,
            level: 1,
            pier_spacing_m: None,
            name: String::new(),
            by: SpanOrigin::Tag,
            place: 0..0,
        }
    }

    #[test]
    fn pieces_of_a_bridge_are_one_chain_whichever_way_they_run() {
        let pieces = [
            span(Support::Bridge, &[(20.0, 0.0), (10.0, 0.0)]),
            span(Support::Bridge, &[(0.0, 0.0), (10.0, 0.0)]),
            span(Support::Bridge, &[(20.0, 0.0), (50.0, 0.0)]),
        ];
        let chains = join(&pieces, &[]);
        assert_eq!(chains.len(), 1);
        assert_eq!((chains[0].length_m, chains[0].ends), (50.0, [ChainEnd::Loose; 2]));
        for (index, piece) in pieces.iter().enumerate() {
            let link = chains[0].links.iter().find(|link| link.span == index).expect("a link");
            for end in 0..2 {
                assert_eq!(chains[0].at(&pieces, link.reach_m[end]), piece.end(end));
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
        let chains = join(&pieces, &[]);
        assert_eq!(chains.len(), 4);
        let meeting = ChainEnd::Onward(place(DVec2::new(10.0, 0.0)));
        assert_eq!(chains[0].ends, [ChainEnd::Ground, meeting]);
        assert_eq!(chains[1].ends, [meeting, ChainEnd::Loose]);
        assert_eq!(chains[3].ends, [ChainEnd::Ground, ChainEnd::Loose]);
    }
}
