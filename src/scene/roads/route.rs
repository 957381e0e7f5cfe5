//! A road with its design: its longitudinal profile, and the road cut where bridges and tunnels begin.

use crate::roads::centerline::Centerline;
use sandtable_earthworks::alignment::{Alignment, Support, SupportSpan};
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_ribbon::junction::Street;

/// Spans shorter than this are part of their neighbors, in meters.
const SHORTEST_M: f64 = 0.05;

/// How far a deck may be off the design level between its vertices, in meters: less than its evenness.
const DECK_SLACK_M: f64 = 0.02;

/// Vertices nearer to each other than this are one, in meters.
const SAME_M: f64 = 0.001;

/// A road that the ground follows, designed.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// The index of the road.
    pub road: usize,
    /// The ground along its centerline in meters; NaN where there is none.
    pub ground: Profile,
    /// The road's level in meters, at the same stations.
    pub design: Profile,
    /// Where it leaves the ground, in order and apart from each other.
    pub spans: Vec<SupportSpan>,
}

impl Route {
    /// The stations in meters along the centerline, from 0 to its length.
    pub fn stations_m(&self) -> &[f64] {
        self.design.stations()
    }

    /// The spans from the road's start to its end, those on the ground included; at least one.
    pub fn all_spans(&self) -> Vec<SupportSpan> {
        let length_m = self.stations_m()[self.stations_m().len() - 1];
        let mut all: Vec<SupportSpan> = Vec::new();
        let mut add = |support, to_m: f64| {
            let from_m = all.last().map_or(0.0, |last| last.to_m);
            match all.last_mut() {
                Some(last) if last.support == support || to_m - from_m < SHORTEST_M => last.to_m = to_m,
                // At the very start there is nothing to add it to: the next span begins there.
                None if to_m < SHORTEST_M && to_m < length_m => {}
                _ => all.push(SupportSpan { support, from_m, to_m }),
            }
        };
        for span in &self.spans {
            add(Support::Ground, span.from_m);
            add(span.support, span.to_m);
        }
        add(Support::Ground, length_m);
        all
    }

    /// Adds a station wherever a span ends.
    pub fn with_ends(mut self) -> Self {
        for SupportSpan { to_m, .. } in self.all_spans() {
            self.ground.insert(to_m);
            self.design.insert(to_m);
        }
        self
    }

    /// The spans of `road` in order, each with its levels.
    ///
    /// On the ground a span has the road's own vertices. Bridges and tunnels have more, so that they are straight between
    /// them to two centimeters. A span that becomes a bridge or a tunnel passes over or under what the road was level with.
    pub fn cut(&self, road: &Centerline) -> Vec<Centerline> {
        self.all_spans().iter().filter_map(|span| self.part(road, span)).collect()
    }

    fn part(&self, road: &Centerline, span: &SupportSpan) -> Option<Centerline> {
        let whole = &road.street.alignment.line;
        let is_whole = span.from_m <= 0.0 && span.to_m >= whole.length();
        let line = match span.support {
            Support::Ground if is_whole => whole.clone(),
            Support::Ground => whole.slice(span.from_m, span.to_m, SAME_M)?,
            Support::Bridge | Support::Tunnel => self.deck(whole, span)?,
        };
        let levels = line.stations().iter().map(|station| self.design.at(span.from_m + station)).collect();
        let level = Profile::new(line.stations().to_vec(), levels);
        let width = road.street.alignment.width.along(&line, span.from_m);
        let raised = match (road.street.alignment.support, span.support) {
            (Support::Ground, Support::Bridge) => 1,
            (Support::Ground, Support::Tunnel) => -1,
            _ => 0,
        };
        let alignment = Alignment { line, level, width, support: span.support };
        let street = Street { alignment, level: road.street.level + raised, ..road.street.clone() };
        Some(Centerline { street, ..road.clone() })
    }

    /// The line along a span, with vertices wherever its level bends.
    fn deck(&self, line: &Polyline, span: &SupportSpan) -> Option<Polyline> {
        let profile = self.design.slice(span.from_m, span.to_m, 0.0);
        let bends = profile.bends(DECK_SLACK_M).into_iter().map(|at| span.from_m + at);
        let inside = |at: &f64| *at > span.from_m && *at < span.to_m;
        let mut all: Vec<f64> = bends.chain(line.stations().iter().copied()).filter(inside).collect();
        // The ends as they were stated: the neighbors end there to the last bit.
        all.extend([span.from_m, span.to_m]);
        all.sort_by(f64::total_cmp);
        Polyline::new(all.into_iter().map(|station| line.at(station)), SAME_M)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roads::centerline::tests::road;

    fn profile(stations: &[f64], values: &[f64]) -> Profile {
        Profile::new(stations.to_vec(), values.to_vec()).expect("stations rise")
    }

    fn route(spans: &[(Support, f64, f64)]) -> Route {
        let span = |&(kind, from_m, to_m): &(Support, f64, f64)| SupportSpan { support: kind, from_m, to_m };
        Route {
            road: 0,
            ground: profile(&[0.0, 40.0, 100.0], &[0.0, f64::NAN, 0.0]),
            design: profile(&[0.0, 40.0, 100.0], &[10.0, 14.0, 8.0]),
            spans: spans.iter().map(span).collect(),
        }
    }

    fn stretches(spans: &[(Support, f64, f64)]) -> Vec<(Support, f64, f64)> {
        route(spans).all_spans().into_iter().map(|at| (at.support, at.from_m, at.to_m)).collect()
    }

    #[test]
    fn stretches_cover_the_road_without_gap_or_overlap() {
        use Support::{Bridge, Tunnel};
        assert_eq!(stretches(&[]), [(Support::Ground, 0.0, 100.0)]);
        assert_eq!(stretches(&[(Bridge, 0.0, 100.0)]), [(Support::Bridge, 0.0, 100.0)]);
        assert_eq!(
            stretches(&[(Bridge, 20.0, 50.0), (Tunnel, 50.01, 99.99)]),
            [(Support::Ground, 0.0, 20.0), (Support::Bridge, 20.0, 50.01), (Support::Tunnel, 50.01, 100.0)]
        );
        assert_eq!(
            stretches(&[(Bridge, 0.01, 30.0), (Bridge, 30.0, 60.0)]),
            [(Support::Bridge, 0.0, 60.0), (Support::Ground, 60.0, 100.0)]
        );
    }

    #[test]
    fn a_stretch_has_its_own_stations_and_both_its_ends() {
        let route = route(&[(Support::Bridge, 20.0, 70.0)]).with_ends();
        assert_eq!(route.stations_m(), [0.0, 20.0, 40.0, 70.0, 100.0]);
        assert_eq!(route.design.values(), [10.0, 12.0, 14.0, 11.0, 8.0]);
        let bridge = route.all_spans()[1];
        let level = route.design.slice(bridge.from_m, bridge.to_m, 0.0);
        assert_eq!(level, profile(&[0.0, 20.0, 50.0], &[12.0, 14.0, 11.0]));
    }

    #[test]
    fn a_road_is_cut_into_stretches_that_end_on_each_other() {
        for quarter in 0..4 {
            let turned = |(x, y): (f64, f64)| (0..quarter).fold((x, y), |(x, y), _| (-y, x));
            let whole = road(&[(0.0, 0.0), (60.0, 0.0), (60.0, 40.0)].map(turned), Support::Ground, 0);
            let stations_m: Vec<f64> = (0..=100).map(f64::from).collect();
            let arch = |at: &f64| 20.0 - (at - 50.0) * (at - 50.0) / 400.0;
            let route = Route {
                road: 0,
                design: profile(&stations_m, &stations_m.iter().map(arch).collect::<Vec<_>>()),
                ground: profile(&stations_m, &[0.0; 101]),
                spans: vec![SupportSpan { support: Support::Bridge, from_m: 20.5, to_m: 80.0 }],
            };
            let parts = route.cut(&whole);
            assert_eq!(
                parts
                    .iter()
                    .map(|part| (part.street.alignment.support, part.street.level))
                    .collect::<Vec<_>>(),
                [(Support::Ground, 0), (Support::Bridge, 1), (Support::Ground, 0)]
            );
            for pair in parts.windows(2) {
                let (end, start) = (
                    pair[0].street.alignment.line.points().last(),
                    pair[1].street.alignment.line.points().first(),
                );
                assert_eq!(end, start);
                let levels = |part: &Centerline| {
                    part.street.alignment.level.clone().expect("levels").values().to_vec()
                };
                let step = levels(&pair[0])[levels(&pair[0]).len() - 1] - levels(&pair[1])[0];
                assert!(step.abs() < 1e-9, "{step}");
            }
            let bridge = &parts[1];
            assert!(
                bridge.street.alignment.line.points().len() > 6,
                "an arch needs more vertices than its road has"
            );
            assert!((bridge.street.alignment.line.length() - 59.5).abs() < 1e-9);
            assert_eq!(parts.iter().map(|part| part.street.alignment.line.length()).sum::<f64>(), 100.0);
        }
    }
}
