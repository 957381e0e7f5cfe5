//! The roads of the demonstration: which places they join, and where they meet.
//!
//! The courses are planned by [`Planner::road`], not surveyed: they are roads as they could be, between
//! places that are. A road that branches off another begins on one of its vertices, so that both share the
//! point exactly.

use glam::DVec2;

use super::flow::Flow;
use super::ground::Ground;
use super::line;
use super::roads::{Design, Planner};
use super::streams::Stream;

/// A road of the network.
pub struct Road {
    /// Its name.
    pub name: &'static str,
    /// `valley`, `pass` or `track`.
    pub class: &'static str,
    /// `asphalt`, `gravel` or `track`.
    pub surface: &'static str,
    /// Its course.
    pub points: Vec<DVec2>,
}

/// A gentle road along the valleys.
const VALLEY: Design = Design { grade: 0.05, climb_cost: 4.0, slope_cost: 6.0, rounds: 60, grading: 0.1 };
/// A road over a pass, with bends to keep its grade.
const PASS: Design = Design { grade: 0.08, climb_cost: 1.0, slope_cost: 1.5, rounds: 10, grading: 0.4 };
/// A forest track.
const TRACK: Design = Design { grade: 0.12, climb_cost: 1.0, slope_cost: 1.5, rounds: 8, grading: 0.35 };

/// Plans the network.
pub fn build(ground: &Ground, flow: &Flow, water: &[bool], notes: &mut Vec<String>) -> Vec<Road> {
    let planner = Planner::over(ground, flow, water);
    let places = |list: &[(f64, f64)]| -> Vec<DVec2> {
        list.iter().map(|&(lon, lat)| ground.locate(lon, lat)).collect()
    };
    let valley = planner.road(
        &places(&[
            (-84.1460, 36.1610),
            (-84.1546, 36.2223),
            (-84.2235, 36.2975),
            (-84.1838, 36.3301),
            (-84.1199, 36.3828),
            (-84.0790, 36.4080),
        ]),
        VALLEY,
    );
    let junction = nearest_vertex(&valley, ground.locate(-84.2120, 36.2815));
    let mut stops = vec![junction];
    stops.extend(places(&[(-84.2429, 36.2778), (-84.2615, 36.2655), (-84.2735, 36.2610)]));
    let pass = planner.road(&stops, PASS);
    let crest = highest_vertex(ground, &pass);
    note(ground, notes, "junction", junction);
    note(ground, notes, "pass", crest);
    let mut stops = vec![nearest_vertex(&pass, ground.locate(-84.2425, 36.2790))];
    note(ground, notes, "summit fork", stops[0]);
    stops.extend(places(&[(-84.2308, 36.1992)]));
    let summit = planner.road(&stops, TRACK);
    let fork = nearest_vertex(&valley, ground.locate(-84.1838, 36.3301));
    let mut stops = vec![fork];
    stops.extend(places(&[(-84.1500, 36.2830)]));
    let shore = planner.road(&stops, TRACK);
    note(ground, notes, "shore fork", fork);
    vec![
        Road { name: "Powell Valley road", class: "valley", surface: "asphalt", points: valley },
        Road { name: "Cross Mountain road", class: "pass", surface: "gravel", points: pass },
        Road { name: "Summit track", class: "track", surface: "track", points: summit },
        Road { name: "Lake track", class: "track", surface: "track", points: shore },
    ]
}

/// Notes where roads cross streams, with the road's heading there.
pub fn note_crossings(ground: &Ground, roads: &[Road], streams: &[Stream], notes: &mut Vec<String>) {
    for road in roads {
        let long = line::length(&road.points) / 1e3;
        let steepest = steepest_grade(ground, &road.points, 200.0) * 100.0;
        notes.push(format!("{}: {long:.1} km, at most {steepest:.1} % over 200 m", road.name));
        for (stream, side) in streams.iter().flat_map(|s| s.points.windows(2).map(move |side| (s, side))) {
            for pair in road.points.windows(2) {
                if let Some(at) = line::crossing((pair[0], pair[1]), (side[0], side[1])) {
                    let way = pair[1] - pair[0];
                    let heading = libm::atan2(way.x, way.y).to_degrees();
                    let name = stream.name.unwrap_or("a stream");
                    note(ground, notes, &format!("{} over {name}, heading {heading:.0}", road.name), at);
                }
            }
        }
    }
}

/// The steepest rise over run of a line's ground, over stretches of `base_m`.
pub fn steepest_grade(ground: &Ground, points: &[DVec2], base_m: f64) -> f64 {
    let steps = 4;
    let even = line::resample(points, base_m / steps as f64);
    let heights: Vec<f64> = even.iter().map(|&at| ground.at(at)).collect();
    let rises = heights.windows(steps + 1).map(|pair| (pair[steps] - pair[0]).abs() / base_m);
    rises.fold(0.0, f64::max)
}

fn nearest_vertex(points: &[DVec2], at: DVec2) -> DVec2 {
    let far = |point: &DVec2| point.distance_squared(at);
    points.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).expect("a road has vertices")
}

fn highest_vertex(ground: &Ground, points: &[DVec2]) -> DVec2 {
    let height = |point: &DVec2| ground.at(*point);
    points.iter().copied().max_by(|a, b| height(a).total_cmp(&height(b))).expect("a road has vertices")
}

fn note(ground: &Ground, notes: &mut Vec<String>, what: &str, at: DVec2) {
    let place = ground.lon_lat(at);
    notes.push(format!("{what}: [{:.5}, {:.5}] at {:.0} m", place.x, place.y, ground.at(at)));
}
