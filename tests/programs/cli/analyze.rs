//! `analyze`: kinds of the catalog, and the files that they write.

use std::fs;

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// Ground that rises a meter per ten to the east, posts ten meters apart.
fn tilted() -> Scratch {
    let scratch = Scratch::new();
    let grid =
        format!("ncols 6\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 10\n{}", "0 1 2 3 4 5\n".repeat(4));
    scratch.write("tilt.asc", &grid);
    scratch
}

#[test]
fn the_slope_of_tilted_ground_is_a_raster_in_percent() {
    let scratch = tilted();
    run_in(scratch.folder(), &["analyze", "slope", "tilt.asc", "-o", "slope.asc"]).ok();
    let grid = fs::read_to_string(scratch.folder().join("slope.asc")).expect("written");
    let inner: Vec<&str> = grid.lines().nth(7).expect("the second row").split_whitespace().collect();
    let slope: f64 = inner[2].parse().expect("a number");
    assert!((slope - 10.0).abs() < 1e-4, "{grid}");
}

#[test]
fn the_classes_of_a_raster_are_areas_of_a_geopackage() {
    let scratch = tilted();
    run_in(scratch.folder(), &["analyze", "slope", "tilt.asc", "-o", "slope.gpkg"]).ok();
    assert!(fs::read(scratch.folder().join("slope.gpkg")).expect("written").starts_with(b"SQLite format 3"));
}

#[test]
fn a_word_out_of_its_list_and_an_unknown_kind_are_refused_and_nothing_is_written() {
    let scratch = tilted();
    let wrong = ["analyze", "slope", "tilt.asc", "--unit", "degree", "-o", "slope.asc"];
    let refused = run_in(scratch.folder(), &wrong).failed(1);
    assert!(refused.contains("`unit`") && refused.contains("degrees"), "{refused}");
    assert!(!scratch.folder().join("slope.asc").exists());
    let unknown = run_in(scratch.folder(), &["analyze", "slopes", "tilt.asc"]).failed(2);
    assert!(unknown.contains("slope"), "{unknown}");
}

#[test]
fn a_kind_without_a_raster_says_what_it_can_be_written_as() {
    let scratch = tilted();
    let wrong = ["analyze", "intervisibility", "tilt.asc", "--posts", "15,15;45,15", "-o", "links.tif"];
    let refused = run_in(scratch.folder(), &wrong).failed(2);
    assert!(refused.contains(".geojson"), "{refused}");
}

#[test]
fn an_extent_limits_the_raster_and_one_off_the_land_is_refused() {
    let scratch = tilted();
    let part = ["analyze", "slope", "tilt.asc", "--extent", "15,5,45,35", "-o", "part.asc"];
    run_in(scratch.folder(), &part).ok();
    let grid = fs::read_to_string(scratch.folder().join("part.asc")).expect("written");
    assert!(grid.starts_with("ncols 4\nnrows 4\n"), "{grid}");
    let off =
        run_in(scratch.folder(), &["analyze", "slope", "tilt.asc", "--extent", "500,5,600,35"]).failed(1);
    assert!(off.contains("`extent`") && off.contains("off the land"), "{off}");
}
