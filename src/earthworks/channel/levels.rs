//! The water's level at every station of a network: along each reach it never rises, no bank drowns, and no cut is deeper
//! than allowed.
//!
//! Each reach of a course is fitted by itself ([`crate::falling_levels`]) and held between two series that never rise
//! either: the lowest bank so far, and the highest ground yet to come less the deepest cut. Where they cross there is no
//! water that falls, and that is where reaches end ([`super::reaches`]). So a bank that is a pit lowers the water below it
//! by the deepest cut at most.
//!
//! Then courses are lowered at the vertices they share: none may be higher there than what flows in, nor lower than a lake
//! that its water has yet to reach. Levels only fall, and only to levels that exist, so the rounds end.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::channel::course::{ChannelCourse, CourseStation};
use crate::channel::reaches::{Sill, reaches};
use crate::channel::river_cut::{Climb, Cut};
use crate::falling_levels::{WeightedLevel, fit_falling};
use sandtable_geom::polyline::{VertexKey, vertex_key};

/// The least that a station weighs in meters: two on one spot still count.
const LEAST_WEIGHT_M: f64 = 1e-3;

/// A vertex that several courses share.
struct ChannelNode {
    /// The courses that have it.
    courses: BTreeSet<usize>,
    /// The lowest level that water has when it comes here.
    cap_m: f64,
    /// The highest lake that water from here comes to.
    floor_m: f64,
}

/// Shared vertices, and for each course which of its stations are such.
struct Nodes {
    nodes: Vec<ChannelNode>,
    of_courses: Vec<Vec<(usize, usize)>>,
}

/// Finds the level at every station that has ground.
pub(super) fn settle(courses: &mut [ChannelCourse<'_>]) {
    courses.par_iter_mut().for_each(fit);
    let mut nodes = Nodes::shared(courses);
    relax(courses, &mut nodes, lower);
    relax(courses, &mut nodes, raise_floor);
    for (index, course) in courses.iter_mut().enumerate() {
        let floors_m = floors_m(course, &nodes, index);
        for (station, floor_m) in course.stations.iter_mut().zip(floors_m) {
            // NaN stays: there is no ground to raise.
            if station.level_m < floor_m {
                station.level_m = floor_m;
            }
        }
    }
}

/// The reaches of a course, and the levels of each by itself.
fn fit(course: &mut ChannelCourse<'_>) {
    let grounded: Vec<usize> =
        (0..course.stations.len()).filter(|&at| !course.stations[at].raw_m.is_nan()).collect();
    let sill = |&at: &usize| Sill {
        ground_m: course.stations[at].raw_m,
        bank_m: course.stations[at].bank_m.max(course.stations[at].raw_m),
    };
    let sills: Vec<Sill> = grounded.iter().map(sill).collect();
    let found = reaches(&sills, course.channel.max_cut_m);
    for (number, &(first, last)) in found.iter().enumerate() {
        fit_reach(course, &grounded[first..=last], &sills[first..=last]);
        // Stations without ground are of the reach around them: the ground may begin between two stations.
        let from = if first == 0 { 0 } else { grounded[first] };
        let to = if last + 1 == grounded.len() { course.stations.len() - 1 } else { grounded[last] };
        course.stations[from..=to].iter_mut().for_each(|station| station.reach = Some(number));
    }
}

/// The levels of the stations `reach` by themselves: those nearest to the ground that never rise and keep both bounds.
fn fit_reach(course: &mut ChannelCourse<'_>, reach: &[usize], sills: &[Sill]) {
    let mut highest_ahead_m = f64::NEG_INFINITY;
    for (&at, sill) in reach.iter().zip(sills).rev() {
        highest_ahead_m = highest_ahead_m.max(sill.ground_m);
        course.stations[at].lowest_m = highest_ahead_m - course.channel.max_cut_m;
    }
    let station_m = |index: usize| course.stations[reach[index]].station_m;
    let last = reach.len() - 1;
    let weighted = |(index, sill): (usize, &Sill)| {
        let stands_for_m = station_m((index + 1).min(last)) - station_m(index.saturating_sub(1));
        // Ground deeper than the level may go would only pull down what lies below it.
        let level_m = sill.ground_m.max(course.stations[reach[index]].lowest_m);
        WeightedLevel { level_m, weight: (stands_for_m / 2.0).max(LEAST_WEIGHT_M) }
    };
    let fitted = fit_falling(&sills.iter().enumerate().map(weighted).collect::<Vec<_>>());
    let mut lowest_bank_m = f64::INFINITY;
    for ((&at, sill), fitted_m) in reach.iter().zip(sills).zip(fitted) {
        lowest_bank_m = lowest_bank_m.min(sill.bank_m);
        let station = &mut course.stations[at];
        // Rounding aside the bounds leave room; the bank's wins.
        station.level_m = fitted_m.max(station.lowest_m).min(lowest_bank_m);
    }
}

impl Nodes {
    fn shared(courses: &[ChannelCourse<'_>]) -> Self {
        let mut at: BTreeMap<VertexKey, BTreeSet<usize>> = BTreeMap::new();
        for (index, course) in courses.iter().enumerate() {
            for &point in course.channel.alignment.line.points() {
                at.entry(vertex_key(point)).or_default().insert(index);
            }
        }
        at.retain(|_, courses| courses.len() > 1);
        let places: BTreeMap<VertexKey, usize> = at.keys().copied().zip(0..).collect();
        let nodes = at.into_values().map(|courses| ChannelNode {
            courses,
            cap_m: f64::INFINITY,
            floor_m: f64::NEG_INFINITY,
        });
        let stations_of = |course: &ChannelCourse<'_>| {
            let points = course.channel.alignment.line.points();
            let node_of = |station: &CourseStation| {
                station.vertex.and_then(|vertex| places.get(&vertex_key(points[vertex])).copied())
            };
            let stations = course.stations.iter().enumerate();
            stations.filter_map(|(at, station)| node_of(station).map(|node| (at, node))).collect()
        };
        Self { nodes: nodes.collect(), of_courses: courses.iter().map(stations_of).collect() }
    }
}

/// Visits every course, and again those that share a node which `visit` has changed, until nothing changes.
fn relax(
    courses: &mut [ChannelCourse<'_>],
    nodes: &mut Nodes,
    visit: fn(&mut ChannelCourse<'_>, &mut Nodes, usize) -> Vec<usize>,
) {
    let mut waiting: BTreeSet<usize> = (0..courses.len()).collect();
    while let Some(index) = waiting.pop_first() {
        for node in visit(&mut courses[index], nodes, index) {
            waiting.extend(nodes.nodes[node].courses.iter().filter(|&&other| other != index));
        }
    }
}

/// Lowers a course to what flows in at its nodes, as far as allowed, and returns the nodes that it lowers.
fn lower(course: &mut ChannelCourse<'_>, nodes: &mut Nodes, index: usize) -> Vec<usize> {
    let (mut lowered, mut lowest_m, mut reach) = (Vec::new(), f64::INFINITY, None);
    let mut own = nodes.of_courses[index].iter().peekable();
    for (at, station) in course.stations.iter_mut().enumerate() {
        let node = own.next_if(|(own, _)| *own == at).map(|&(_, node)| node);
        if station.reach != reach {
            (reach, lowest_m) = (station.reach, f64::INFINITY);
        }
        if reach.is_none() {
            continue;
        }
        if let Some(node) = node {
            lowest_m = lowest_m.min(nodes.nodes[node].cap_m);
        }
        if !station.level_m.is_nan() {
            lowest_m = lowest_m.max(station.lowest_m).min(station.level_m);
            station.level_m = lowest_m;
        }
        if let Some(node) = node.filter(|&node| lowest_m < nodes.nodes[node].cap_m) {
            nodes.nodes[node].cap_m = lowest_m;
            lowered.push(node);
        }
    }
    lowered
}

/// Raises the floors of the nodes from which water of this course comes to a lake, and returns these nodes.
fn raise_floor(course: &mut ChannelCourse<'_>, nodes: &mut Nodes, index: usize) -> Vec<usize> {
    let floors_m = floors_m(course, nodes, index);
    let mut raised = Vec::new();
    for &(at, node) in nodes.of_courses[index].iter().rev() {
        // What ends here says nothing about the water that continues from here.
        let continues = at + 1 < course.stations.len() && course.stations[at].reach.is_some();
        if continues && floors_m[at] > nodes.nodes[node].floor_m {
            nodes.nodes[node].floor_m = floors_m[at];
            raised.push(node);
        }
    }
    raised
}

/// For each station of a course the highest lake that its water has yet to reach; minus infinity for none.
fn floors_m(course: &ChannelCourse<'_>, nodes: &Nodes, index: usize) -> Vec<f64> {
    let mut floors_m = vec![f64::NEG_INFINITY; course.stations.len()];
    let mut own = nodes.of_courses[index].iter().rev().peekable();
    let (mut floor_m, mut reach) = (f64::NEG_INFINITY, None);
    for (at, station) in course.stations.iter().enumerate().rev() {
        let node = own.next_if(|(own, _)| *own == at);
        if station.reach != reach {
            (reach, floor_m) = (station.reach, f64::NEG_INFINITY);
        }
        if reach.is_none() {
            continue;
        }
        let of_node = node.map_or(f64::NEG_INFINITY, |&(_, node)| nodes.nodes[node].floor_m);
        floor_m = floor_m.max(station.lake_m.unwrap_or(f64::NEG_INFINITY)).max(of_node);
        floors_m[at] = floor_m;
    }
    floors_m
}

/// The levels at a course's ends, nothing cut yet.
pub(super) fn ends(course: &ChannelCourse<'_>) -> Cut {
    let mut levels = course.stations.iter().map(|station| station.level_m).filter(|level| !level.is_nan());
    let first = levels.next();
    let last = levels.next_back().or(first);
    Cut { levels_m: first.zip(last), climbs: climbs(course), ..Cut::default() }
}

/// Where a course goes from one reach to the next. The ground there stays as it is.
fn climbs(course: &ChannelCourse<'_>) -> Vec<Climb> {
    let grounded: Vec<&CourseStation> = course
        .stations
        .iter()
        .filter(|station| station.reach.is_some() && !station.level_m.is_nan())
        .collect();
    let breaks = grounded.windows(2).filter(|pair| pair[0].reach != pair[1].reach);
    let climb = |pair: &[&CourseStation]| Climb {
        from_m: pair[0].station_m,
        to_m: pair[1].station_m,
        rise_m: pair[1].level_m - pair[0].level_m,
    };
    breaks.map(climb).collect()
}
