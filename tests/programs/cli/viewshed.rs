//! `viewshed`: a point in, a map or a raster out.

use std::fs;

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// A wall from north to south in the middle of level ground, posts ten meters apart from (5, 5) on.
fn walled() -> Scratch {
    let scratch = Scratch::new();
    let row = "0 0 0 0 9 0 0 0 0\n";
    let grid = format!("ncols 9\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\n{}", row.repeat(5));
    scratch.write("wall.asc", &grid);
    scratch
}

const LOOK: [&str; 4] = ["viewshed", "wall.asc", "--at", "5,25"];

#[test]
fn what_stands_behind_a_wall_is_hidden_and_a_tall_target_looks_over_it() {
    let scratch = walled();
    let row = |arguments: &[&str]| {
        run_in(scratch.folder(), &[&LOOK[..], &["-o", "seen.asc"], arguments].concat()).ok();
        let grid = fs::read_to_string(scratch.folder().join("seen.asc")).expect("written");
        let header = "ncols 9\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value 255\n";
        assert!(grid.starts_with(header), "{grid}");
        grid.lines().nth(8).expect("the observer's row").to_owned()
    };
    assert_eq!(row(&[]), "1 1 1 1 1 0 0 0 0");
    assert_eq!(row(&["--target-height", "30"]), "1 1 1 1 1 1 1 1 1");
    assert_eq!(row(&["--observer-height", "13"]), "1 1 1 1 1 0 0 0 0");
    assert_eq!(row(&["--range", "25"]), "1 1 1 255 255 255 255 255 255");
    assert_eq!(row(&["--sector", "180,360"]), "1 255 255 255 255 255 255 255 255");
}

#[test]
fn the_figures_are_told_in_words_and_as_json() {
    let scratch = walled();
    let out = run_in(scratch.folder(), &LOOK).ok();
    assert_eq!(
        out,
        "  in sight  0.003 km², 55.56 % of what was looked at\n  posts     25 visible, 20 hidden, 0 without data, 0 beyond\n"
    );
    let out = run_in(scratch.folder(), &[&LOOK[..], &["--json", "--flat"]].concat()).ok();
    let json: serde_json::Value = serde_json::from_str(&out).expect("one object");
    assert_eq!(json["posts"]["visible"], 25);
    assert_eq!(json["visible_m2"], 2500.0);
    assert!(json["refraction"].is_null());
}

#[test]
fn a_map_is_a_png_and_the_same_every_time() {
    let scratch = walled();
    let map = |name: &str| {
        run_in(scratch.folder(), &[&LOOK[..], &["-o", name, "--range", "60"]].concat()).ok();
        fs::read(scratch.folder().join(name)).expect("written")
    };
    let first = map("a.png");
    assert!(first.starts_with(b"\x89PNG"));
    assert_eq!(first, map("b.png"));
}

#[test]
fn what_cannot_be_looked_at_is_refused_with_a_reason_and_nothing_is_written() {
    let scratch = walled();
    let look =
        |arguments: &[&str]| run_in(scratch.folder(), &[&["viewshed", "wall.asc"], arguments].concat());
    assert!(look(&["--at", "500,25", "-o", "x.png"]).failed(1).contains("outside the elevation model"));
    assert!(look(&["--at", "5,25", "-o", "x.jpg"]).failed(2).contains("name a file that ends so"));
    assert!(look(&["--at", "5,25", "-o", "wall.asc"]).failed(1).contains("an input file"));
    assert!(look(&["--at", "5;25"]).failed(2).contains("two numbers with a comma between"));
    assert!(look(&["--at", "5,25", "--range", "0"]).failed(2).contains("above 0"));
    assert!(look(&["--at", "5,25", "--crs", "EPSG:99999"]).failed(2).contains("'EPSG:99999' for '--crs"));
    assert!(!scratch.folder().join("x.png").exists());
}
