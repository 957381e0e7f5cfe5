//! Roads cut where the ground gives way to a bridge or a tunnel.

use crate::geom::polyline::Polyline;
use crate::scene::roads::centerline::{Centerline, Support};
use crate::scene::roads::route::{Route, RouteStretch, points_between};

/// How far a deck may be off the design level between its vertices, in meters: less than anyone sees, and than a
/// carriageway's own evenness.
const DECK_SLACK_M: f64 = 0.02;

/// Vertices nearer to each other than this are one, in meters.
const SAME_M: f64 = 0.001;

/// The stretches of a road in order, each with its levels.
///
/// On the ground a stretch has the road's own vertices. On bridges and in tunnels it has more, so that it is straight
/// between them to two centimeters. A stretch that becomes a bridge or a tunnel passes over or under what the road was
/// level with.
pub fn cut(road: &Centerline, route: &Route) -> Vec<Centerline> {
    route.stretches().iter().filter_map(|stretch| part(road, route, stretch)).collect()
}

fn part(road: &Centerline, route: &Route, stretch: &RouteStretch) -> Option<Centerline> {
    let is_whole = stretch.from_m <= 0.0 && stretch.to_m >= road.line.length();
    let line = match stretch.carried {
        Support::Ground if is_whole => road.line.clone(),
        Support::Ground => Polyline::new(points_between(&road.line, stretch.from_m, stretch.to_m), SAME_M)?,
        Support::Bridge | Support::Tunnel => deck(&road.line, route, stretch)?,
    };
    let level_at = |station: &f64| route.design_at(stretch.from_m + station);
    let levels_m = Some(line.stations().iter().map(level_at).collect());
    let level = road.level
        + match (road.carried, stretch.carried) {
            (Support::Ground, Support::Bridge) => 1,
            (Support::Ground, Support::Tunnel) => -1,
            _ => 0,
        };
    let widths_m = road.widths_along(&line, stretch.from_m);
    Some(Centerline { line, levels_m, widths_m, carried: stretch.carried, level, ..road.clone() })
}

/// The line along a stretch, with vertices wherever its level bends.
fn deck(line: &Polyline, route: &Route, stretch: &RouteStretch) -> Option<Polyline> {
    let (stations, levels) = route.levels_along(stretch);
    let bends = bends(&stations, &levels).into_iter().map(|at| stretch.from_m + at);
    let inside = |at: &f64| *at > stretch.from_m && *at < stretch.to_m;
    let mut all: Vec<f64> = bends.chain(line.stations().iter().copied()).filter(inside).collect();
    // The ends as they were stated: the neighbors end there to the last bit.
    all.extend([stretch.from_m, stretch.to_m]);
    all.sort_by(f64::total_cmp);
    Polyline::new(all.into_iter().map(|station| line.at(station)), SAME_M)
}

/// The stations that a profile needs to be within [`DECK_SLACK_M`] of its levels where it is straight between them
/// (Douglas and Peucker 1973), its ends with them.
fn bends(stations: &[f64], levels: &[f64]) -> Vec<f64> {
    let last = stations.len() - 1;
    let mut kept = vec![false; stations.len()];
    (kept[0], kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let run = stations[to] - stations[from];
        let off = |&index: &usize| {
            let part = if run > 0.0 { (stations[index] - stations[from]) / run } else { 0.0 };
            (levels[index] - (levels[from] + (levels[to] - levels[from]) * part)).abs()
        };
        let worst = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(worst) = worst.filter(|worst| off(worst) > DECK_SLACK_M) {
            kept[worst] = true;
            open.extend([(from, worst), (worst, to)]);
        }
    }
    stations.iter().zip(kept).filter(|(_, kept)| *kept).map(|(&station, _)| station).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::earthworks::alignment::spans::{DesignSpan, SpanKind};
    use crate::scene::roads::centerline::tests::road;

    #[test]
    fn a_road_is_cut_into_stretches_that_end_on_each_other() {
        for quarter in 0..4 {
            let turned = |(x, y): (f64, f64)| (0..quarter).fold((x, y), |(x, y), _| (-y, x));
            let whole = road(&[(0.0, 0.0), (60.0, 0.0), (60.0, 40.0)].map(turned), Support::Ground, 0);
            let stations_m: Vec<f64> = (0..=100).map(f64::from).collect();
            let arch = |at: &f64| 20.0 - (at - 50.0) * (at - 50.0) / 400.0;
            let route = Route {
                road: 0,
                design_m: stations_m.iter().map(arch).collect(),
                ground_m: vec![0.0; 101],
                stations_m,
                spans: vec![DesignSpan { kind: SpanKind::Bridge, from_m: 20.5, to_m: 80.0 }],
            };
            let parts = cut(&whole, &route);
            assert_eq!(
                parts.iter().map(|part| (part.carried, part.level)).collect::<Vec<_>>(),
                [(Support::Ground, 0), (Support::Bridge, 1), (Support::Ground, 0)]
            );
            for pair in parts.windows(2) {
                let (end, start) = (pair[0].line.points().last(), pair[1].line.points().first());
                assert_eq!(end, start);
                let levels = |part: &Centerline| part.levels_m.clone().expect("levels");
                let step = levels(&pair[0])[levels(&pair[0]).len() - 1] - levels(&pair[1])[0];
                assert!(step.abs() < 1e-9, "{step}");
            }
            let bridge = &parts[1];
            assert!(bridge.line.points().len() > 6, "an arch needs more vertices than its road has");
            assert!((bridge.line.length() - 59.5).abs() < 1e-9);
            assert_eq!(parts.iter().map(|part| part.line.length()).sum::<f64>(), 100.0);
        }
    }
}
