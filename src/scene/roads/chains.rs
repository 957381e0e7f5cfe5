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

use crate::scene::roads::centreline::{Carried, Centreline};
use crate::scene::roads::spans::{Place, Span, place};

/// Spans in a row, each from where the one before ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Its spans.
    pub links: Vec<Link>,
    /// Its length in metres.
    pub length_m: f64,
    /// What it meets at its start and end.
    pub ends: [End; 2],
}

/// A span's place in a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Which span.
    pub span: usize,
    /// Where the span's own start and end lie along the chain, in metres; the second lower where it runs backwards.
    pub reach_m: [f64; 2],
}

/// What a chain meets at an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// A road on the ground, or something that ends on it.
    Ground,
    /// Nothing: the file ends there.
    Loose,
    /// Others of its kind, and no ground.
    Onward(Place),
}

impl Chain {
    /// The point at a station in metres.
    pub fn at(&self, spans: &[Span], station_m: f64) -> DVec2 {
        let within = |link: &&Link| station_m <= link.reach_m[0].max(link.reach_m[1]);
        let link = self.links.iter().find(within).unwrap_or(&self.links[self.links.len() - 1]);
        spans[link.span].line.at((station_m - link.reach_m[0]).abs())
    }

    /// The station on the chain of a station on one of its links' spans.
    pub fn station_m(link: &Link, on_span_m: f64) -> f64 {
        let [start, end] = link.reach_m;
        if start <= end { start + on_span_m } else { start - on_span_m }
    }
}

/// Joins spans whose levels are open to chains; a span whose levels are settled is a chain alone. In order of their first
/// spans.
pub fn join(spans: &[Span], roads: &[Centreline]) -> Vec<Chain> {
    let meetings = Meetings::new(spans, roads);
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
fn chain(spans: &[Span], meetings: &Meetings, steps: impl Iterator<Item = (usize, usize)>) -> Chain {
    let mut length_m = 0.0;
    let mut links = Vec::new();
    let mut corners: Option<[(usize, usize); 2]> = None;
    for (span, entered) in steps {
        let (from, to) = (length_m, length_m + spans[span].line.length());
        let reach_m = if entered == 0 { [from, to] } else { [to, from] };
        links.push(Link { span, reach_m });
        length_m = to;
        let left = (span, 1 - entered);
        corners = Some([corners.map_or((span, entered), |corners| corners[0]), left]);
    }
    let ends = corners.map_or([End::Ground; 2], |corners| corners.map(|corner| meetings.end(corner)));
    Chain { links, length_m, ends }
}

/// Which spans end where.
struct Meetings {
    /// For each kind and place, the ends of the spans there.
    ends: BTreeMap<(bool, Place), Vec<(usize, usize)>>,
    /// Places inside a span's line, by kind.
    inside: BTreeSet<(bool, Place)>,
    /// Where the ground, or something of another kind, holds a level.
    held: BTreeSet<Place>,
    /// For each span its two places.
    places: Vec<[Place; 2]>,
    /// Whether each span may be joined with others.
    is_open: Vec<bool>,
    /// Whether each span is a tunnel.
    kinds: Vec<bool>,
}

impl Meetings {
    fn new(spans: &[Span], roads: &[Centreline]) -> Self {
        let kind = |span: &Span| span.carried == Carried::Tunnel;
        let places: Vec<[Place; 2]> =
            spans.iter().map(|span| [0, 1].map(|end| place(span.end(end)))).collect();
        let mut ends: BTreeMap<(bool, Place), Vec<(usize, usize)>> = BTreeMap::new();
        let mut inside = BTreeSet::new();
        for (index, span) in spans.iter().enumerate() {
            for (end, &at) in places[index].iter().enumerate() {
                ends.entry((kind(span), at)).or_default().push((index, end));
            }
            let points = span.line.points();
            inside.extend(points[1..points.len() - 1].iter().map(|&at| (kind(span), place(at))));
        }
        let mut held: BTreeSet<Place> = BTreeSet::new();
        for road in roads.iter().filter(|road| road.carried == Carried::Ground) {
            let touched = road.line.points().iter().map(|&at| place(at));
            held.extend(
                touched.filter(|&at| [false, true].iter().any(|&kind| ends.contains_key(&(kind, at)))),
            );
        }
        let mixed: Vec<Place> =
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
    fn end(&self, (span, end): (usize, usize)) -> End {
        let at = self.places[span][end];
        let key = (self.kinds[span], at);
        let meets_others = self.ends[&key].len() > 1 || self.inside.contains(&key);
        match (self.held.contains(&at), meets_others) {
            (true, _) => End::Ground,
            (false, true) => End::Onward(at),
            (false, false) => End::Loose,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polyline::Polyline;
    use crate::ribbon::stroke::StrokeOptions;
    use crate::ribbon::texture::Surface;
    use crate::scene::roads::spans::By;

    fn span(carried: Carried, points: &[(f64, f64)]) -> Span {
        Span {
            line: Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line"),
            carried,
            road: None,
            levels_m: None,
            beyond: [None; 2],
            options: StrokeOptions::default(),
            surface: Surface::Asphalt,
            level: 1,
            pier_spacing_m: None,
            name: String::new(),
            by: By::Tag,
            place: 0..0,
        }
    }

    #[test]
    fn pieces_of_a_bridge_are_one_chain_whichever_way_they_run() {
        let pieces = [
            span(Carried::Bridge, &[(20.0, 0.0), (10.0, 0.0)]),
            span(Carried::Bridge, &[(0.0, 0.0), (10.0, 0.0)]),
            span(Carried::Bridge, &[(20.0, 0.0), (50.0, 0.0)]),
        ];
        let chains = join(&pieces, &[]);
        assert_eq!(chains.len(), 1);
        assert_eq!((chains[0].length_m, chains[0].ends), (50.0, [End::Loose; 2]));
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
            span(Carried::Bridge, &[(0.0, 0.0), (10.0, 0.0)]),
            span(Carried::Bridge, &[(10.0, 0.0), (20.0, 5.0)]),
            span(Carried::Bridge, &[(10.0, 0.0), (20.0, -5.0)]),
            span(Carried::Tunnel, &[(0.0, 0.0), (-30.0, 0.0)]),
        ];
        let chains = join(&pieces, &[]);
        assert_eq!(chains.len(), 4);
        let meeting = End::Onward(place(DVec2::new(10.0, 0.0)));
        assert_eq!(chains[0].ends, [End::Ground, meeting]);
        assert_eq!(chains[1].ends, [meeting, End::Loose]);
        assert_eq!(chains[3].ends, [End::Ground, End::Loose]);
    }
}
