//! `profile`: a line in, the ground along it out.

use crate::cli::{run_in, run_with_input};
use crate::common::scratch::Scratch;

/// Three rows of four samples ten meters apart, a hole in the north-east. Posts stand at 5, 15, 25 and 35 east and at 5, 15
/// and 25 north.
const GRID: &str = "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n\
                    10 20 30 -9999\n10 20 30 40\n10 20 30 40\n";

fn grid() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("grid.asc", GRID);
    scratch
}

#[test]
fn a_line_along_a_row_of_posts_has_a_station_at_each() {
    let out = run_in(grid().folder(), &["profile", "grid.asc", "--line", "5,15", "35,15"]).ok();
    assert_eq!(
        out,
        "station,x,y,height,status\n0,5,15,10,Ok\n10,15,15,20,Ok\n20,25,15,30,Ok\n30,35,15,40,Ok\n"
    );
}

#[test]
fn beyond_the_model_and_over_a_hole_the_status_says_so() {
    let out = run_in(grid().folder(), &["profile", "grid.asc", "--line", "-5,15 25,15", "35,25"]).ok();
    let statuses: Vec<&str> = out.lines().skip(1).filter_map(|line| line.rsplit(',').next()).collect();
    assert_eq!(statuses.first(), Some(&"Outside"), "{out}");
    assert_eq!(statuses.last(), Some(&"NoData"), "{out}");
    assert!(out.contains("\n10,5,15,10,Ok\n"), "a station on the border: {out}");
}

#[test]
fn lines_come_from_csv_and_from_geojson() {
    let scratch = grid();
    let lines = |out: String| out.lines().count();
    let csv =
        run_with_input(scratch.folder(), &["profile", "grid.asc", "--points", "-"], "x,y\n5,15\n35,15\n");
    assert_eq!(lines(csv.ok()), 5);
    scratch.write("grid.prj", "EPSG:32611");
    scratch.write("line.geojson", r#"{"type": "LineString", "coordinates": [[5, 15], [35, 15]]}"#);
    let arguments = ["profile", "grid.asc", "--points", "line.geojson", "--crs", "EPSG:32611"];
    assert_eq!(lines(run_in(scratch.folder(), &arguments).ok()), 5);
}

#[test]
fn json_says_what_the_profile_comes_to() {
    let out = run_in(grid().folder(), &["profile", "grid.asc", "--line", "5,15", "35,15", "--json"]).ok();
    let found: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((found["ascent_m"].as_f64(), found["descent_m"].as_f64()), (Some(30.0), Some(0.0)));
    assert_eq!(found["stations"].as_array().map(Vec::len), Some(4));
    assert_eq!(found["highest"]["station"].as_f64(), Some(30.0));
}

#[test]
fn a_chart_is_written_beside_the_table() {
    let scratch = grid();
    let arguments =
        ["profile", "grid.asc", "--line", "5,15", "35,20", "-o", "chart.png", "--size", "640x320"];
    assert!(run_in(scratch.folder(), &arguments).ok().starts_with("station,"));
    let chart = image::open(scratch.at("chart.png")).expect("a PNG");
    assert_eq!((chart.width(), chart.height()), (640, 320));
    assert_eq!(scratch.names(), ["chart.png", "grid.asc"], "nothing else is left behind");
}

#[test]
fn what_is_no_line_is_refused_with_what_to_write() {
    let scratch = grid();
    let wrong = |arguments: &[&str], code: i32| {
        run_in(scratch.folder(), &[&["profile", "grid.asc"], arguments].concat()).failed(code)
    };
    assert!(wrong(&["--line", "5,15"], 2).contains("at least two"));
    assert!(wrong(&["--line", "5,15", "5;16"], 2).contains("X,Y"));
    assert!(wrong(&["--line", "5,15", "35,15", "--step", "0"], 2).contains("above 0"));
    assert!(wrong(&["--line", "5,15", "35,15", "--step", "1e-9"], 2).contains("longer"));
    assert!(wrong(&["--line", "5,15", "35,15", "-o", "grid.asc"], 1).contains("grid.asc"));
    assert!(wrong(&["--line", "5,15", "35,15", "-o", "chart.jpg"], 1).contains("PNG"));
    assert!(wrong(&[], 2).contains("--line"));
}
