//! `los`: two points in, whether one is seen from the other out.

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// A wall 10 m high in the middle of level ground: eleven columns and three rows of posts, 100 m apart, the first at 50, 50.
fn wall() -> Scratch {
    let row = "0 0 0 0 0 10 0 0 0 0 0\n";
    let scratch = Scratch::new();
    scratch.write(
        "wall.asc",
        format!(
            "ncols 11\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 100\nNODATA_value -1\n{row}{row}{row}"
        ),
    );
    scratch
}

const LOOK: [&str; 5] = ["los", "wall.asc", "--flat", "--from", "50,150,2"];

fn look(more: &[&str]) -> crate::cli::Ran {
    run_in(wall().folder(), &[&LOOK[..], more].concat())
}

#[test]
fn behind_a_wall_the_blocker_and_the_mast_that_is_missing_are_told() {
    let out = look(&["--to", "1050,150", "--json"]).ok();
    let found: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(found["visible"].as_bool(), Some(false));
    // The line falls from 2 m to the ground; 10 m of wall half-way ask for 18 m at either end.
    assert_eq!(found["target_rise_m"].as_f64(), Some(18.0));
    assert_eq!(found["observer_rise_m"].as_f64(), Some(18.0));
    assert_eq!(found["grazing"]["distance_m"].as_f64(), Some(500.0));
    let told = look(&["--to", "1050,150"]).ok();
    assert!(told.starts_with("blocked at ") && told.contains("the target must rise 18.00 m"), "{told}");
}

#[test]
fn a_target_high_enough_is_visible() {
    let told = look(&["--to", "1050,150", "--target-height", "18.1"]).ok();
    assert!(told.starts_with("visible\n") && told.contains("clearance  0.05 m"), "{told}");
    assert_eq!(look(&["--to", "1050,150,18.1"]).ok(), told, "the height may stand with the position");
}

#[test]
fn a_chart_is_written() {
    let scratch = wall();
    let arguments = [&LOOK[..], &["--to", "1050,150", "-o", "sight.png", "--size", "640x320"]].concat();
    run_in(scratch.folder(), &arguments).ok();
    let chart = image::open(scratch.at("sight.png")).expect("a PNG");
    assert_eq!((chart.width(), chart.height()), (640, 320));
}

#[test]
fn an_end_without_ground_is_wrong_input_and_no_position_is_wrong_usage() {
    assert!(look(&["--to", "5000,150"]).failed(1).contains("outside"));
    assert!(look(&["--to", "here"]).failed(2).contains("X,Y"));
    assert!(look(&["--to", "1050,150", "--refraction", "0.1"]).failed(2).contains("--flat"));
}
