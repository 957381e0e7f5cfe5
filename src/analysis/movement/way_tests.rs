//! Ways beside the times that they take: on real ground, where they are known, and beside all ways over fine points.

use std::collections::BTreeMap;

use super::*;
use crate::land::{Land, RoadClass, RoadLine, Step};
use crate::movement::going::Going;
use crate::movement::vehicle::Vehicle;
use crate::test_land::{random, shaped};
use crate::test_places::{PLACES, place};
use glam::DVec2;

fn travel<'a>(land: &'a Land, vehicle: &Vehicle) -> TravelGround<'a> {
    let going = Going::new(land, vehicle).expect("memory");
    TravelGround::new(land, going, vehicle, false).expect("memory")
}

fn built_in(name: &str) -> Vehicle {
    Vehicle::built_in(name).expect("built in")
}

/// The way between two posts.
fn way(ground: &TravelGround<'_>, from: usize, to: usize) -> Vec<WayPoint> {
    ground.quickest_way(&[from], &[to], &StopFlag::default()).expect("not stopped").expect("a way")
}

/// Checks that a way leads from a post to another, over open posts and sides alone, in pieces within cells or steps.
fn check_way(ground: &TravelGround<'_>, way: &[WayPoint], [from, to]: [usize; 2]) {
    assert_eq!((way[0], way[way.len() - 1]), (ground.point_at(from), ground.point_at(to)));
    for point in way {
        assert!(point.ends().into_iter().all(|post| ground.pace(post).is_finite()), "{point:?}");
    }
    for ends in way.windows(2) {
        let [from, to] = [ends[0], ends[1]].map(|point| ground.position(point));
        let cells = ((to - from) / ground.lattice().cell()).abs();
        let most = if ends.iter().all(|point| point.is_post()) { 2.0 } else { 1.0 };
        assert!(cells.max_element() <= most + 1e-9, "{ends:?}");
    }
}

#[test]
fn on_real_ground_routes_take_what_times_say_and_no_longer_than_by_steps() {
    let stop = StopFlag::default();
    for (name, file) in PLACES {
        let Some(land) = place(file) else { return };
        for vehicle in ["foot", "truck", "tracked"] {
            let mut ground = travel(&land, &built_in(vehicle));
            let (columns, rows) = (land.ground.columns() as usize, land.ground.rows() as usize);
            let start = rows / 3 * columns + columns / 3;
            let found = ground.search(&[start], TravelGoal::within(f32::INFINITY), &stop);
            ground.has_triangles = false;
            let by_steps = ground.times(&[start], TravelGoal::within(f32::INFINITY), &stop);
            ground.has_triangles = true;
            let mut bits = random(7);
            let mut ratios = Vec::new();
            while ratios.len() < 40 {
                let post = bits() as usize % (columns * rows);
                let time_s = f64::from(found.time_s(ground.framed(post)));
                if !time_s.is_finite() || time_s == 0.0 {
                    continue;
                }
                let way = way(&ground, start, post);
                check_way(&ground, &way, [start, post]);
                let seconds = ground.seconds_along(&way);
                assert!(seconds <= f64::from(by_steps[post]) * (1.0 + 2e-5), "{name} {vehicle} {post}");
                ratios.push(seconds / time_s);
            }
            ratios.sort_by(f64::total_cmp);
            let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
            assert!((mean - 1.0).abs() < 0.01, "{name} {vehicle} {mean}");
            // Red Butte is near the limits of vehicles.
            let most = if name == "redbutte" && vehicle != "foot" { 1.08 } else { 1.03 };
            assert!(ratios[2] > 0.95 && ratios[37] < most, "{name} {vehicle} {ratios:?}");
        }
    }
}

/// Level ground on which a meter takes as long as on a cone of this angle, a share of a full turn, around its middle: its
/// distances are known.
#[test]
fn on_a_cone_and_on_level_ground_routes_take_the_least_time_there_and_back() {
    let side = 81_u32;
    let land = shaped(side, side, 10.0, |_, _| 0.0);
    let from_middle = |post: usize| {
        let post = land.ground.post_at(post).grid() - f64::from(side / 2);
        (post.length() * 10.0, post.y.atan2(post.x))
    };
    for angle in [1.0, 0.6, 0.35] {
        let speed = |post: usize| 3.6 / from_middle(post).0.max(1.0).powf(angle - 1.0);
        let posts = land.ground.heights().len();
        let going = Going {
            codes: Vec::new(),
            speed_kmh: (0..posts).map(|post| speed(post) as f32).collect(),
            is_way: vec![false; posts],
            closed: None,
            notes: Vec::new(),
        };
        // A vehicle, since people on foot go down a slope of 5 % quicker than on the level.
        let ground = TravelGround::new(&land, going, &built_in("truck"), false).expect("memory");
        let mut bits = random(3);
        for _ in 0..60 {
            let ends = [0, 1].map(|_| bits() as usize % posts);
            let [(one_m, one), (other_m, other)] = ends.map(from_middle);
            let apart = (one - other).abs();
            let turn = apart.min(std::f64::consts::TAU - apart) * angle;
            let [one, other] = [one_m, other_m].map(|radius_m| radius_m.powf(angle) / angle);
            // Near the top, paces differ too much from post to post.
            if one_m.min(other_m) < 150.0 || turn * one.min(other) / one.max(other) > 2.0 * angle {
                continue;
            }
            let exact = (one * one + other * other - 2.0 * one * other * turn.cos()).sqrt();
            let there = ground.seconds_along(&way(&ground, ends[0], ends[1]));
            let back = ground.seconds_along(&way(&ground, ends[1], ends[0]));
            let bound = if angle == 1.0 { 1.002 } else { 1.01 };
            assert!(there < exact * bound && there > exact * 0.998, "{angle}: {there} {exact}");
            assert!((there / back - 1.0).abs() < 0.01, "{angle}: {there} {back}");
        }
    }
}

/// Rough ground with a hole, a wall and a road.
fn rough() -> Land {
    let mut land = shaped(19, 14, 10.0, |column, row| {
        let wave = ((column * 7 + row * 13 + column * row) % 11) as f32;
        if (column, row) == (5, 5) { f32::NAN } else { wave * 0.35 + column as f32 }
    });
    land.steps = vec![Step { line: vec![DVec2::new(80.0, 0.0), DVec2::new(110.0, 90.0)], height_m: 3.0 }];
    let line = vec![DVec2::new(50.0, 100.0), DVec2::new(170.0, 40.0)];
    land.roads = Some(vec![RoadLine { name: String::new(), line, surface: RoadClass::Main, width_m: 12.0 }]);
    land
}

/// The least seconds from a post to each, over all pieces between points at eighths of sides, until nothing changes.
fn relaxed(ground: &TravelGround<'_>, start: usize) -> BTreeMap<usize, f64> {
    const PARTS: usize = 8;
    let width = ground.width;
    let is_open = |post: usize| ground.pace(post).is_finite();
    let mut seconds: BTreeMap<(usize, usize, u32), (WayPoint, f64)> = BTreeMap::new();
    let mut cells = Vec::new();
    for cell in (0..ground.framed_count() - width - 1).filter(|cell| cell % width + 1 < width) {
        let corners = [cell, cell + 1, cell + width, cell + width + 1];
        let open: Vec<usize> = corners.into_iter().filter(|&post| is_open(post)).collect();
        let mut points: Vec<WayPoint> = open.iter().map(|&post| WayPoint::at(post)).collect();
        for [one, other] in
            [[0, 1], [0, 2], [1, 3], [2, 3]].map(|ends: [usize; 2]| ends.map(|at| corners[at]))
        {
            if is_open(one) && is_open(other) {
                points
                    .extend((1..PARTS).map(|part| WayPoint::between(one, other, part as f32 / PARTS as f32)));
            }
        }
        seconds.extend(points.iter().map(|&point| (point.key(), (point, f64::INFINITY))));
        cells.push(points);
    }
    let mut pieces = Vec::new();
    for points in &cells {
        for &from in points {
            pieces.extend(points.iter().filter(|&&to| to != from).map(|&to| (from, to)));
        }
    }
    for post in (2 * width..ground.framed_count() - 2 * width).filter(|&post| is_open(post)) {
        let to = ground.steps.iter().map(|step| post.wrapping_add_signed(step.offset));
        pieces.extend(to.filter(|&to| is_open(to)).map(|to| (WayPoint::at(post), WayPoint::at(to))));
    }
    let pieces: Vec<_> = pieces
        .into_iter()
        .map(|(from, to)| (from.key(), to.key(), f64::from(ground.piece_s(from, to))))
        .filter(|piece| piece.2.is_finite())
        .collect();
    seconds.entry(ground.point_at(start).key()).and_modify(|point| point.1 = 0.0);
    loop {
        let mut is_changed = false;
        for (from, to, piece_s) in &pieces {
            let arrival_s = seconds[from].1 + piece_s;
            let to = seconds.get_mut(to).expect("a point");
            if arrival_s < to.1 {
                to.1 = arrival_s;
                is_changed = true;
            }
        }
        if !is_changed {
            break;
        }
    }
    let posts = seconds.into_values().filter(|(point, _)| point.is_post());
    posts.map(|(point, seconds)| (ground.nearest_post(point), seconds)).collect()
}

#[test]
fn routes_on_rough_ground_are_as_quick_as_any_over_fine_points() {
    let land = rough();
    for name in ["foot", "truck", "tracked"] {
        let ground = travel(&land, &built_in(name));
        let wanted = relaxed(&ground, 2);
        let times = ground.times(&[2], TravelGoal::within(f32::INFINITY), &StopFlag::default());
        let mut ratios = Vec::new();
        for (post, &wanted) in wanted.iter().filter(|(_, seconds)| **seconds > 0.0) {
            // Every post that times reach has a way.
            assert!(times[*post].is_finite() || wanted.is_infinite(), "{name} {post}");
            if times[*post].is_finite() {
                let way = way(&ground, 2, *post);
                check_way(&ground, &way, [2, *post]);
                ratios.push(ground.seconds_along(&way) / wanted);
            }
        }
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let range =
            ratios.iter().fold((9.0_f64, 0.0_f64), |(least, most), &at| (least.min(at), most.max(at)));
        assert!(
            ratios.len() > 150 && mean < 1.01 && range.0 > 0.9 && range.1 < 1.12,
            "{name} {mean} {range:?}"
        );
    }
}
