//! Drop zones against brute force, and by hand.

use super::*;
use crate::arguments::ArgumentValue;
use crate::test_land::{bare, flat, on_pool, paint, plant, run_kind, shaped, values_of};

fn number(value: f64) -> ArgumentValue {
    ArgumentValue::Number(value)
}

#[test]
fn the_length_is_that_of_the_manuals_example() {
    // 90 knots count 46 m/s: 12 jumpers take 11 seconds or 506 m, and 200 m of buffers; 750 m hold no thirteenth.
    let land = flat(3, 3, 10.0);
    let figures = |arguments: &[(&str, ArgumentValue)]| {
        let outcome = run_kind("drop-zones", &land, arguments.iter().cloned()).expect("sound");
        [0, 1].map(|index: usize| outcome.figures[index].value)
    };
    let speed = ("speed_kn", number(90.0));
    assert_eq!(figures(&[speed.clone(), ("jumpers", number(12.0))]), [706.0, 12.0]);
    assert_eq!(figures(&[speed.clone(), ("jumpers", number(13.0))]), [752.0, 13.0]);
    assert_eq!(figures(&[speed.clone(), ("length_m", number(750.0))]), [750.0, 12.0]);
    assert_eq!(figures(&[speed, ("jumpers", number(1.0))]), [275.0, 2.0]);
}

/// Hills with 1 % of random trees and a hole.
fn hills(seed: u64, columns: u32, rows: u32) -> Land {
    let posts = columns * rows;
    let height = |index: u32| {
        let (x, y) = ((index % columns) as f32, (index / columns) as f32);
        9.0 * (x / 11.0).sin() * (y / 9.0).cos() + y * 0.3
    };
    let mut heights: Vec<f32> = (0..posts).map(height).collect();
    heights[200] = f32::NAN;
    let mut land = bare((DVec2::new(500.0, 900.0), DVec2::new(10.0, 8.0)), columns, heights);
    plant(&mut land, seed);
    land
}

/// The code of a post by the definition.
fn brute(land: &Land, headings: &[f64], [length, width]: [f64; 2], index: usize) -> f32 {
    let ground = &land.ground;
    let columns = ground.columns() as i64;
    let rows = i64::from(ground.rows());
    let (column, row) = (index as i64 % columns, index as i64 / columns);
    let mut best = 0.0_f32;
    for heading in headings {
        let (east, north) = (heading.to_radians().sin(), heading.to_radians().cos());
        let mut code = 2.0_f32;
        for r in row - 60..=row + 60 {
            for c in column - 60..=column + 60 {
                let (x, y) = ((c - column) as f64 * 10.0, (r - row) as f64 * 8.0);
                let is_in = (x * east + y * north).abs() <= length / 2.0 * (1.0 + 1e-9)
                    && (x * north - y * east).abs() <= width / 2.0 * (1.0 + 1e-9);
                if !is_in {
                    continue;
                }
                if c < 0 || r < 0 || c >= columns || r >= rows {
                    code = 0.0;
                    continue;
                }
                let slope = ground.slopes_of_row(r as u32)[c as usize].length().atan().to_degrees();
                let is_hole = ground.heights()[(r * columns + c) as usize].is_nan();
                let tree = land.obstacles_m.as_ref().expect("a layer")[(r * columns + c) as usize];
                code = code.min(match slope {
                    slope if is_hole || slope > 15.0 || tree > 0.45 => 0.0,
                    slope if slope > 4.5 => 1.0,
                    _ => 2.0,
                });
            }
        }
        best = best.max(code);
    }
    best
}

#[test]
fn codes_are_those_of_the_definition_post_by_post_among_random_trees() {
    let mut seen = [0; 3];
    for (seed, size) in [(1, [130.0, 60.0]), (2, [90.0, 30.0]), (3, [200.0, 25.0])] {
        for heading in [None, Some(0.0), Some(37.0), Some(90.0), Some(212.0)] {
            let land = hills(seed, 31, 27);
            let mut arguments = vec![
                ("length_m", number(size[0])),
                ("width_m", number(size[1])),
                ("free_slope", number(4.5)),
                ("greatest_slope", number(15.0)),
            ];
            arguments.extend(heading.map(|heading| ("heading", number(heading))));
            let found = run_kind("drop-zones", &land, arguments).expect("sound").raster.expect("a raster");
            let headings: Vec<f64> =
                heading.map_or((0..18).map(|step| f64::from(step) * 10.0).collect(), |heading| vec![heading]);
            for (index, code) in values_of(&found).into_iter().enumerate() {
                if land.ground.heights()[index].is_nan() {
                    assert!(code.is_nan());
                    continue;
                }
                let wanted = brute(&land, &headings, size, index);
                assert_eq!(code, wanted, "seed {seed} heading {heading:?} post {index}");
                seen[wanted as usize] += 1;
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn a_zone_lies_along_the_level_strip_between_woods() {
    // Open posts up to 50 m from the axis, woods from 60 m on; the ground rises 1 % to the north.
    let mut land = shaped(61, 61, 10.0, |_, row| row as f32 * 0.1);
    paint(&mut land, |column, _| if (25..=35).contains(&column) { LandCover::Open } else { LandCover::Wood });
    let arguments = [("length_m", number(400.0)), ("width_m", number(100.0)), ("count", number(5.0))];
    let outcome = run_kind("drop-zones", &land, arguments).expect("sound");
    assert_eq!(outcome.features.len(), 1, "there is one place for a zone and its separation");
    let corner = |x: f64, y: f64| DVec2::new(x, y);
    let OutcomeShape::Area(rings) = &outcome.features[0].shape else { panic!("an area") };
    let low = rings[0].iter().copied().fold(corner(1e9, 1e9), DVec2::min);
    let high = rings[0].iter().copied().fold(corner(-1e9, -1e9), DVec2::max);
    assert!(
        (low.x - 250.0).abs() < 1e-6 && (high.x - 350.0).abs() < 1e-6 && high.y - low.y > 399.9,
        "{low} {high}"
    );
    assert_eq!(outcome.tables[0].rows[0][5], PropertyValue::Number(0.0));
    assert_eq!(outcome.tables[0].rows[0][9], PropertyValue::Text("open ground".into()));
    let PropertyValue::Number(slope) = outcome.tables[0].rows[0][8] else { panic!("a number") };
    assert!((slope - 0.573).abs() < 1e-3, "{slope}");
    let across = [("length_m", number(400.0)), ("width_m", number(120.0))];
    assert!(run_kind("drop-zones", &land, across).expect("sound").features.is_empty());
}

#[test]
fn a_width_above_the_length_and_slopes_out_of_order_name_their_key() {
    let key = |arguments: [(&str, ArgumentValue); 1]| {
        run_kind("drop-zones", &flat(3, 3, 10.0), arguments).expect_err("at fault").key()
    };
    assert_eq!(key([("width_m", number(20_000.0))]), Some("width_m"));
    assert_eq!(key([("free_slope", number(40.0))]), Some("free_slope"));
}

#[test]
fn zones_are_the_same_bits_with_one_thread_and_with_three() {
    let land = hills(5, 40, 30);
    let arguments = || [("length_m", number(90.0)), ("width_m", number(30.0))];
    let text = |threads| on_pool(threads, || format!("{:?}", run_kind("drop-zones", &land, arguments())));
    assert_eq!(text(1), text(3));
}

#[test]
fn numbers_at_both_ends_of_their_ranges_give_an_outcome_or_name_a_key() {
    use sandtable_catalog::parameter::ParameterForm;
    let lands = [
        flat(2, 2, 10.0),
        shaped(2, 2, 10.0, |column, _| if column == 0 { f32::NAN } else { 1.0 }),
        shaped(9, 7, 1e-3, |_, _| 0.0),
        shaped(9, 9, 1e4, |column, row| ((column * 31 + row * 17) % 7) as f32 * 1e6),
    ];
    let kind = sandtable_catalog::kind("drop-zones").expect("a kind");
    for land in &lands {
        for ends in 0..32 {
            let arguments =
                kind.parameters.iter().enumerate().filter_map(|(place, parameter)| match parameter.form {
                    ParameterForm::Number { least, greatest } => Some((
                        parameter.name,
                        number(if ends >> (place % 5) & 1 == 0 { least } else { greatest }),
                    )),
                    _ => None,
                });
            match run_kind("drop-zones", land, arguments) {
                Ok(outcome) => assert!(outcome.raster.is_some()),
                Err(error) => assert!(error.key().is_some(), "{error}"),
            }
        }
    }
}
