//! Hauls by hand, and their bound.

use std::sync::Arc;

use super::*;
use crate::arguments::ArgumentValue;
use crate::test_land::{bare, flat, on_pool, run_kind};

/// Level ground 10 m apart, with these heights above the ground before at (column, row).
fn changed(columns: u32, rows: u32, changes: &[(u32, u32, f32)]) -> Land {
    let mut heights = vec![50.0; (columns * rows) as usize];
    for &(column, row, height) in changes {
        heights[(row * columns + column) as usize] += height;
    }
    let cell = DVec2::splat(10.0);
    let origin = DVec2::new(1000.0, 2000.0);
    let before = bare((origin, cell), columns, vec![50.0; (columns * rows) as usize]).ground;
    Land { other_ground: Some(before), ..bare((origin, cell), columns, heights) }
}

fn figures(outcome: &Outcome) -> Vec<f64> {
    outcome.figures.iter().map(|figure| figure.value).collect()
}

#[test]
fn earth_goes_to_the_nearest_fill_unless_another_needs_it_more() {
    // Cuts of 100 m³ at 10 and 50 m, fills at 40 and 120 m along a row: 30 + 70 m beats 10 + 110 m.
    let land = changed(20, 3, &[(1, 1, -1.0), (5, 1, -1.0), (4, 1, 1.0), (12, 1, 1.0)]);
    let outcome = run_kind("haul", &land, [("block_m", ArgumentValue::Number(10.0))]).expect("sound");
    assert_eq!(figures(&outcome), [200.0, 10.0, 50.0, 0.0, 0.0, 10.0, 0.0]);
    let number = |value: f64| PropertyValue::Number(value);
    let rows = &outcome.tables[0].rows;
    assert_eq!(rows[0], [1050.0, 2010.0, 1120.0, 2010.0, 100.0, 70.0, 7.0].map(number));
    assert_eq!(rows[1], [1010.0, 2010.0, 1040.0, 2010.0, 100.0, 30.0, 3.0].map(number));
    let line = OutcomeShape::Line(vec![DVec2::new(1050.0, 2010.0), DVec2::new(1120.0, 2010.0)]);
    assert_eq!(outcome.features[0].shape, line);
}

#[test]
fn what_nobody_needs_is_waste_and_what_is_missing_is_borrow() {
    let land = changed(20, 3, &[(1, 1, -3.0), (5, 1, 1.0)]);
    let outcome = run_kind("haul", &land, [("block_m", ArgumentValue::Number(10.0))]).expect("sound");
    assert_eq!(figures(&outcome)[..5], [100.0, 4.0, 40.0, 200.0, 0.0]);
    assert_eq!(outcome.features[1].name, "waste 200 m³");
    let land = changed(20, 3, &[(1, 1, -1.0), (5, 1, 3.0)]);
    let outcome = run_kind("haul", &land, [("block_m", ArgumentValue::Number(10.0))]).expect("sound");
    assert_eq!(figures(&outcome)[..5], [100.0, 4.0, 40.0, 0.0, 200.0]);
    assert_eq!(outcome.features[1].name, "borrow 200 m³");
}

#[test]
fn swollen_cut_fills_more() {
    let land = changed(20, 3, &[(1, 1, -1.0), (5, 1, 1.25)]);
    let swell = ("swell", ArgumentValue::Number(1.25));
    let outcome = run_kind("haul", &land, [("block_m", ArgumentValue::Number(10.0)), swell]).expect("sound");
    assert_eq!(figures(&outcome)[..5], [100.0, 4.0, 40.0, 0.0, 0.0]);
}

#[test]
fn coarse_blocks_are_wrong_by_no_more_than_is_said() {
    let mut changes = Vec::new();
    for column in 0..30_u32 {
        for row in 0..12_u32 {
            let change = ((column * 31 + row * 17 + column * row) % 23) as f32 - 11.0;
            changes.push((column, row, change * if column < 15 { 0.1 } else { 0.3 }));
        }
    }
    let land = changed(30, 12, &changes);
    let haul = |block_m: f64| {
        let outcome = run_kind("haul", &land, [("block_m", ArgumentValue::Number(block_m))]).expect("sound");
        (figures(&outcome)[1], figures(&outcome)[6])
    };
    let (exact, spread) = haul(10.0);
    assert_eq!(spread, 0.0);
    for block_m in [20.0, 50.0, 100.0, 1000.0] {
        let (found, spread) = haul(block_m);
        assert!((found - exact).abs() <= spread && spread > 0.0, "{block_m}: {found} {exact} {spread}");
    }
    let outcome = run_kind("haul", &land, []).expect("sound");
    assert_eq!(figures(&outcome)[5], 10.0, "the smallest blocks that are few enough");
}

#[test]
fn an_area_limits_hauls_and_too_many_blocks_name_their_key() {
    let land = changed(20, 3, &[(1, 1, -1.0), (5, 1, 1.0), (15, 1, 1.0)]);
    let corner = |x: f64, y: f64| DVec2::new(1000.0 + x, 2000.0 + y);
    let area = vec![corner(0.0, 0.0), corner(20.0, 0.0), corner(20.0, 20.0), corner(0.0, 20.0)];
    let outcome = run_kind("haul", &land, [("area", ArgumentValue::Points(area))]).expect("sound");
    assert_eq!((figures(&outcome)[0], figures(&outcome)[3]), (0.0, 100.0));
    let many: Vec<(u32, u32, f32)> =
        (0..60 * 60).map(|index| (index % 60, index / 60, if index % 2 == 0 { 1.0 } else { -1.0 })).collect();
    let land = changed(60, 60, &many);
    let error = run_kind("haul", &land, [("block_m", ArgumentValue::Number(10.0))]).expect_err("too many");
    assert_eq!(error.key(), Some("block_m"));
    assert_eq!(figures(&run_kind("haul", &land, []).expect("sound"))[5], 50.0);
    let error = run_kind("haul", &flat(3, 3, 10.0), []).expect_err("nothing to compare with");
    assert_eq!(error.key(), Some("against"));
}

#[test]
fn hauls_are_the_same_with_one_thread_and_with_three_and_need_no_data() {
    let land = changed(20, 3, &[(1, 1, -1.0), (5, 1, 1.0), (15, 1, 1.0), (2, 2, f32::NAN), (3, 0, 1e6)]);
    let text = |threads| on_pool(threads, || format!("{:?}", run_kind("haul", &land, [])));
    assert_eq!(text(1), text(3));
    for size in [0.1, 100_000.0] {
        let found = run_kind("haul", &land, [("block_m", ArgumentValue::Number(size))]);
        assert!(found.is_ok_and(|outcome| figures(&outcome).iter().all(|value| value.is_finite())));
    }
    let nothing = bare((DVec2::ZERO, DVec2::splat(10.0)), 2, vec![f32::NAN; 4]);
    let nothing = Land { other_ground: Some(Arc::clone(&nothing.ground)), ..nothing };
    assert_eq!(figures(&run_kind("haul", &nothing, []).expect("sound"))[0], 0.0);
}
