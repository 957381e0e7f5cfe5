//! A road with its design: its longitudinal profile and the stretches that it is carried along by one thing.

use glam::DVec2;

use crate::earthworks::alignment::spans::{DesignSpan, SpanKind};
use crate::geom::polyline::Polyline;
use crate::scene::roads::centerline::Support;

/// Stretches shorter than this are not told apart from their neighbors, in meters.
const SHORTEST_M: f64 = 0.05;

/// A road that the ground follows, designed.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// Which of the roads.
    pub road: usize,
    /// Meters along its centerline, from 0, never falling, to its length.
    pub stations_m: Vec<f64>,
    /// The ground there; NaN where there is none.
    pub ground_m: Vec<f64>,
    /// The road there.
    pub design_m: Vec<f64>,
    /// Where it leaves the ground, in order and apart from each other.
    pub spans: Vec<DesignSpan>,
}

/// A stretch of a road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RouteStretch {
    /// What carries it.
    pub carried: Support,
    /// The station where it begins, in meters.
    pub from_m: f64,
    /// The station where it ends.
    pub to_m: f64,
}

impl Route {
    /// The road from its start to its end, stretch by stretch; at least one.
    pub fn stretches(&self) -> Vec<RouteStretch> {
        let length_m = self.length_m();
        let mut all: Vec<RouteStretch> = Vec::new();
        let mut add = |carried, to_m: f64| {
            let from_m = all.last().map_or(0.0, |last| last.to_m);
            match all.last_mut() {
                Some(last) if last.carried == carried || to_m - from_m < SHORTEST_M => last.to_m = to_m,
                // At the very start there is nothing to add it to: what comes next begins there.
                None if to_m < SHORTEST_M && to_m < length_m => {}
                _ => all.push(RouteStretch { carried, from_m, to_m }),
            }
        };
        for span in &self.spans {
            add(Support::Ground, span.from_m);
            add(carried(span.kind), span.to_m);
        }
        add(Support::Ground, length_m);
        all
    }

    fn length_m(&self) -> f64 {
        self.stations_m[self.stations_m.len() - 1]
    }

    /// The road's level at a station.
    pub fn design_at(&self, station_m: f64) -> f64 {
        at(&self.stations_m, &self.design_m, station_m)
    }

    /// Adds a station wherever a stretch ends, so that each has its own.
    pub fn with_ends(mut self) -> Self {
        for RouteStretch { to_m, .. } in self.stretches() {
            let place = self.stations_m.partition_point(|&station| station < to_m);
            if self.stations_m.get(place).is_some_and(|&station| station > to_m) {
                let (ground, design) = (at(&self.stations_m, &self.ground_m, to_m), self.design_at(to_m));
                self.stations_m.insert(place, to_m);
                self.ground_m.insert(place, ground);
                self.design_m.insert(place, design);
            }
        }
        self
    }

    /// The road's stations and levels along a stretch, with both ends of it, in stations of its own from 0.
    pub fn levels_along(&self, stretch: &RouteStretch) -> (Vec<f64>, Vec<f64>) {
        let first = self.stations_m.partition_point(|&at| at <= stretch.from_m);
        let past = self.stations_m.partition_point(|&at| at < stretch.to_m).max(first);
        let mut stations = vec![0.0];
        let mut levels = vec![self.design_at(stretch.from_m)];
        stations.extend(self.stations_m[first..past].iter().map(|at| at - stretch.from_m));
        levels.extend(&self.design_m[first..past]);
        stations.push(stretch.to_m - stretch.from_m);
        levels.push(self.design_at(stretch.to_m));
        (stations, levels)
    }
}

/// What carries a span.
pub fn carried(kind: SpanKind) -> Support {
    match kind {
        SpanKind::Bridge => Support::Bridge,
        SpanKind::Tunnel => Support::Tunnel,
    }
}

/// The value at a station, straight between those given.
fn at(stations_m: &[f64], values: &[f64], station_m: f64) -> f64 {
    let after = stations_m.partition_point(|&at| at < station_m).clamp(1, stations_m.len() - 1);
    let (from, to) = (stations_m[after - 1], stations_m[after]);
    let part = if to > from { ((station_m - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
    values[after - 1] + (values[after] - values[after - 1]) * part
}

/// The vertices of a line from one station to another, both ends with them.
pub fn points_between(line: &Polyline, from_m: f64, to_m: f64) -> Vec<DVec2> {
    let (first, past) = (
        line.stations().partition_point(|&at| at <= from_m),
        line.stations().partition_point(|&at| at < to_m),
    );
    let inner = line.points().get(first..past).unwrap_or_default();
    std::iter::once(line.at(from_m)).chain(inner.iter().copied()).chain([line.at(to_m)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route(spans: &[(SpanKind, f64, f64)]) -> Route {
        let span = |&(kind, from_m, to_m): &(SpanKind, f64, f64)| DesignSpan { kind, from_m, to_m };
        Route {
            road: 0,
            stations_m: vec![0.0, 40.0, 100.0],
            ground_m: vec![0.0, f64::NAN, 0.0],
            design_m: vec![10.0, 14.0, 8.0],
            spans: spans.iter().map(span).collect(),
        }
    }

    fn stretches(spans: &[(SpanKind, f64, f64)]) -> Vec<(Support, f64, f64)> {
        route(spans).stretches().into_iter().map(|at| (at.carried, at.from_m, at.to_m)).collect()
    }

    #[test]
    fn stretches_cover_the_road_without_gap_or_overlap() {
        use SpanKind::{Bridge, Tunnel};
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
        let route = route(&[(SpanKind::Bridge, 20.0, 70.0)]).with_ends();
        assert_eq!(route.stations_m, [0.0, 20.0, 40.0, 70.0, 100.0]);
        assert_eq!(route.design_m, [10.0, 12.0, 14.0, 11.0, 8.0]);
        let (stations, levels) = route.levels_along(&route.stretches()[1]);
        assert_eq!(stations, [0.0, 20.0, 50.0]);
        assert_eq!(levels, [12.0, 14.0, 11.0]);
    }
}
