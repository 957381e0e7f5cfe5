//! Landing zones against brute force, and by hand.

use super::*;
use crate::arguments::ArgumentValue;
use crate::outcome::OutcomeShape;
use crate::test_land::{bare, codes_of, plant};

const COLUMNS: usize = 41;
const ROWS: usize = 37;

fn arguments(size: &str) -> AnalysisArguments {
    let kind = sandtable_catalog::kind("landing-zones").expect("a kind");
    AnalysisArguments::new(kind)
        .with("size", ArgumentValue::Word(size.to_owned()))
        .with("approach_m", ArgumentValue::Number(120.0))
}

fn land(seed: u64) -> Land {
    let height = |index: usize| {
        let (x, y) = ((index % COLUMNS) as f32, (index / COLUMNS) as f32);
        16.0 * (x / 9.0).sin() * (y / 7.0).cos() + y * 0.2
    };
    let mut heights: Vec<f32> = (0..COLUMNS * ROWS).map(height).collect();
    heights[700] = f32::NAN;
    let mut land = bare((DVec2::new(500.0, 900.0), DVec2::new(10.0, 8.0)), COLUMNS as u32, heights);
    plant(&mut land, seed);
    land
}

/// The code of a post by the definition, post by post.
fn brute(land: &Land, radius: f64, column: i64, row: i64) -> u8 {
    let ground = &land.ground;
    let obstacles = land.obstacles_m.as_ref().expect("a layer");
    let height = |c: i64, r: i64| ground.heights()[r as usize * COLUMNS + c as usize];
    let inside = |c: i64, r: i64| (0..COLUMNS as i64).contains(&c) && (0..ROWS as i64).contains(&r);
    if height(column, row).is_nan() {
        return 255;
    }
    let disk = |c: i64, r: i64| {
        let near = |&(x, y): &(i64, i64)| {
            ((x - c) as f64 * 10.0).powi(2) + ((y - r) as f64 * 8.0).powi(2) <= radius * radius
        };
        (r - 12..=r + 12)
            .flat_map(move |y| (c - 12..=c + 12).map(move |x| (x, y)))
            .filter(near)
            .collect::<Vec<_>>()
    };
    let mut slope = 0.0_f32;
    for (x, y) in disk(column, row) {
        if !inside(x, y) || obstacles[y as usize * COLUMNS + x as usize] > 0.45 {
            return 0;
        }
        let here = ground.slopes_of_row(y as u32)[x as usize].length();
        slope = if height(x, y).is_nan() { f32::INFINITY } else { slope.max(here) };
    }
    let clear = |(east, north): (i64, i64)| {
        let step = ((east as f64 * 10.0).powi(2) + (north as f64 * 8.0).powi(2)).sqrt();
        (1..=(120.0 / step) as i64).all(|n| {
            let (c, r) = (column + n * east, row + n * north);
            !inside(c, r)
                || disk(c, r).into_iter().filter(|&(x, y)| inside(x, y)).all(|(x, y)| {
                    let top = height(x, y) + obstacles[y as usize * COLUMNS + x as usize];
                    top.is_nan() || f64::from(top - height(column, row)) <= 0.45 + n as f64 * step / 10.0
                })
        })
    };
    let axes = [(0, 1), (1, 1), (1, 0), (1, -1)];
    let has_axis = axes.into_iter().any(|(e, n)| clear((e, n)) && clear((-e, -n)));
    match slope.atan().to_degrees() {
        _ if !has_axis => 0,
        degrees if degrees <= 7.0 => 2,
        degrees if degrees <= 15.0 => 1,
        _ => 0,
    }
}

#[test]
fn codes_are_those_of_the_definition_post_by_post_among_random_obstacles() {
    let mut seen = [0; 3];
    for seed in 1..=4 {
        for (size, radius) in [("1", 12.5), ("3", 25.0), ("5", 50.0)] {
            let land = land(seed);
            let outcome = landing_zones(&land, &arguments(size), &StopFlag::default()).expect("valid input");
            for (index, &code) in codes_of(outcome).iter().enumerate() {
                let wanted = brute(&land, radius, (index % COLUMNS) as i64, (index / COLUMNS) as i64);
                assert_eq!(code, wanted, "seed {seed} size {size} post {index}");
                if code < 3 {
                    seen[code as usize] += 1;
                }
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn sites_lie_apart_and_a_land_of_four_posts_has_none() {
    let land = land(9);
    let outcome = landing_zones(&land, &arguments("1"), &StopFlag::default()).expect("valid input");
    let centers: Vec<DVec2> = outcome
        .features
        .iter()
        .map(|feature| match &feature.shape {
            OutcomeShape::Area(rings) => rings[0].iter().sum::<DVec2>() / 32.0,
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(centers.len() == 3, "{centers:?}");
    for (index, center) in centers.iter().enumerate() {
        assert!(centers[..index].iter().all(|other| other.distance(*center) >= 74.999), "{centers:?}");
    }
    let four = bare((DVec2::ZERO, DVec2::ONE), 2, vec![0.0, f32::NAN, f32::NAN, f32::NAN]);
    assert!(
        landing_zones(&four, &arguments("7"), &StopFlag::default()).expect("valid input").features.is_empty()
    );
}
