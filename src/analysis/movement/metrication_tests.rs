//! How far times over sixteen neighbors are from those over all directions: on planes the quickest way is known.

use super::tests::{everywhere, travel};
use super::*;
use crate::land::{RoadClass, RoadLine};
use crate::movement::search::TravelGoal;
use crate::test_land::shaped;
use sandtable_terrain::stop_flag::StopFlag;

/// Directions of the brute force.
const DIRECTIONS: usize = 720;

/// The least seconds to go by (1, 0) turned by `toward`, where a meter in each direction takes `costs`: along it, or to and
/// fro in two directions around it. No way with more directions is quicker in the plane (Carathéodory 1911).
fn least_seconds(costs: &[f64], toward: f64) -> f64 {
    let turn = std::f64::consts::TAU / costs.len() as f64;
    let mut least = f64::INFINITY;
    for right in 0..costs.len() / 2 {
        for left in 0..costs.len() / 2 {
            let (u, v) = ((right as f64 + 0.5) * turn, (left as f64 + 0.5) * turn);
            if u + v >= std::f64::consts::PI {
                continue;
            }
            let cost = |angle: f64| {
                let at = (toward + angle).rem_euclid(std::f64::consts::TAU) / turn;
                costs[at.round() as usize % costs.len()]
            };
            let (share_u, share_v) = (v.sin() / (u + v).sin(), u.sin() / (u + v).sin());
            least = least.min(share_u * cost(-u) + share_v * cost(v));
        }
    }
    least
}

/// The greatest and the least of found over least times on a plane that rises eastward by `slope`.
fn ratios(slope: f64, vehicle: &Vehicle) -> (f64, f64) {
    let land = shaped(65, 65, 10.0, |column, _| column as f32 * (slope * 10.0) as f32);
    let ground = travel(&land, vehicle);
    let times = everywhere(&ground, &[32 * 65 + 32]);
    let cost = |index: usize| {
        let angle = index as f64 * std::f64::consts::TAU / DIRECTIONS as f64;
        let across = ground.grades.across((slope * angle.sin()).abs() as f32);
        f64::from(ground.grades.open((slope * angle.cos()) as f32) * across) * 3.6 / vehicle.speed_kmh
    };
    let costs: Vec<f64> = (0..DIRECTIONS).map(cost).collect();
    let (mut greatest, mut least) = (0.0_f64, f64::INFINITY);
    for post in 0..32 {
        for (column, row) in [(64, 32 + post), (32 + post, 64), (32 - post, 64), (0, 32 + post)] {
            let (east, north) = ((column as f64 - 32.0) * 10.0, (row as f64 - 32.0) * 10.0);
            let wanted = least_seconds(&costs, north.atan2(east)) * east.hypot(north);
            let ratio = f64::from(times[row * 65 + column]) / wanted;
            (greatest, least) = (greatest.max(ratio), least.min(ratio));
        }
    }
    (greatest, least)
}

#[test]
fn on_planes_times_are_too_long_by_no_more_than_the_catalog_says() {
    let foot = Vehicle::built_in("foot").expect("built in");
    let tracked = Vehicle::built_in("tracked").expect("built in");
    let bounds = [
        (0.0, &foot, 1.0276),
        (0.1, &foot, 1.04),
        (0.2, &foot, 1.20),
        (0.4, &foot, 1.33),
        (0.7, &foot, 1.42),
        (0.1, &tracked, 1.028),
        (0.18, &tracked, 1.03),
        (0.4, &tracked, 1.15),
    ];
    for (slope, vehicle, bound) in bounds {
        let (greatest, least) = ratios(slope, vehicle);
        // The brute force turns by half degrees.
        let is_within = greatest < bound && greatest > 1.0 + (bound - 1.0) * 0.8 && least > 0.99;
        assert!(is_within, "{} {slope}: {greatest} {least}", vehicle.name);
    }
}

#[test]
fn toward_a_goal_times_are_those_of_looking_everywhere() {
    let mut land = shaped(61, 47, 20.0, |column, row| {
        ((column * 7 + row * 13 + column * row) % 17) as f32 * 0.4 + (column as f32 * 0.2).sin() * 30.0
    });
    let line = |ends: [[f64; 2]; 2]| ends.map(DVec2::from).to_vec();
    let road =
        |ends| RoadLine { name: String::new(), line: line(ends), surface: RoadClass::Main, width_m: 6.0 };
    land.roads = Some(vec![road([[0.0, 100.0], [1200.0, 300.0]]), road([[300.0, 0.0], [900.0, 920.0]])]);
    for name in ["foot", "truck", "tracked"] {
        let mut ground = travel(&land, &Vehicle::built_in(name).expect("built in"));
        ground.slow_down(1000..1100, 3.0);
        for start in [0, 61 * 20 + 7, 61 * 47 - 1] {
            let all = everywhere(&ground, &[start]);
            for ends in [vec![61 * 30 + 50], vec![5, 6, 7, 70], vec![61 * 46, 61 * 46 + 60], vec![start]] {
                let times = ground.times(&[start], TravelGoal::any_of(&ends), &StopFlag::default());
                let nearest = |times: &[f32]| {
                    ends.iter().copied().min_by(|&a, &b| times[a].total_cmp(&times[b])).expect("ends")
                };
                let end = nearest(&all);
                assert_eq!((nearest(&times), times[end]), (end, all[end]), "{name} {start} {ends:?}");
                assert_eq!(ground.way_to(&times, end), ground.way_to(&all, end), "{name} {start} {ends:?}");
                assert!(times.iter().zip(&all).all(|(found, least)| found >= least));
            }
        }
    }
}
