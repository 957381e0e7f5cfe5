//! `dem grid`: points in, a grid out.

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// Four corners of a slope of 1 in 10 eastward and a point in its middle, one of them twice.
const POINTS: &str = "x,y,z\n0,0,10\n100,0,20\n0,100,10\n100,100,20\n50,50,15\n50,50,15\n";

/// A line along the slope's middle, ten meters above it.
const LINE: &str = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32633"}},"features":[
 {"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[50,0,25],[50,100,25]]}}]}"#;

fn points() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("points.csv", POINTS);
    scratch
}

#[test]
fn a_grid_is_written_and_its_counts_are_told() {
    let scratch = points();
    let arguments = ["dem", "grid", "points.csv", "out.asc", "--cell", "20", "--crs", "EPSG:32633"];
    let out = run_in(scratch.folder(), &arguments).ok();
    for wanted in ["points           6", "duplicates       1", "5 x 5 cells", "25 of 25", "EPSG:32633", "tin"]
    {
        assert!(out.contains(wanted), "{wanted} in:\n{out}");
    }
    let info = run_in(scratch.folder(), &["dem", "info", "out.asc", "--json"]).ok();
    let info: serde_json::Value = serde_json::from_str(&info).expect("JSON");
    assert_eq!(
        (info["width"].as_u64(), info["min"].as_f64(), info["max"].as_f64()),
        (Some(5), Some(11.0), Some(19.0))
    );
    assert_eq!(info["crs"].as_str(), Some("EPSG:32633"));
    assert_eq!(scratch.names(), ["out.asc", "out.prj", "points.csv"]);
}

#[test]
fn every_method_makes_a_grid() {
    let scratch = points();
    for (method, more) in [
        ("tin", &[][..]),
        ("natural", &[]),
        ("idw", &["--k", "3", "--power", "1.5"]),
        ("quadrant", &["--power", "2"]),
        ("nearest", &[]),
    ] {
        let arguments = ["dem", "grid", "points.csv", "out.asc", "--cell", "10", "--method", method];
        let out = run_in(scratch.folder(), &[&arguments[..], more].concat()).ok();
        assert!(out.contains("100 of 100") && out.contains(method), "{out}");
    }
}

#[test]
fn an_extent_reaches_beyond_the_hull() {
    let scratch = points();
    let arguments = ["dem", "grid", "points.csv", "out.asc", "--cell", "50", "--extent", "-100,0,100,100"];
    assert!(run_in(scratch.folder(), &arguments).ok().contains("4 of 8"));
    let filled = [&arguments[..], &["--beyond-hull", "nearest"]].concat();
    assert!(run_in(scratch.folder(), &filled).ok().contains("8 of 8"));
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_written() {
    let scratch = points();
    scratch.write("bad.csv", "1,2,3\n4,5,six\n");
    scratch.write("line.geojson", LINE);
    scratch.write("plane.geojson", LINE.replace(",25]", "]"));
    let grid = |more: &[&str]| run_in(scratch.folder(), &[&["dem", "grid"], more].concat()).failed(1);
    scratch.write("points.tif", "1,2,3");
    for name in ["out.las", "points.csv"] {
        let arguments = ["dem", "grid", "points.csv", name, "--cell", "1"];
        assert!(
            run_in(scratch.folder(), &arguments).failed(2).contains("name a file that ends so"),
            "{name}"
        );
    }
    for (arguments, wanted) in [
        (&["points.tif", "points.tif", "--cell", "1"][..], "this is an input file"),
        (&["bad.csv", "out.asc", "--cell", "1"], "bad.csv: line 2: found '4,5,six'"),
        (&["points.csv", "out.asc", "--cell", "0"], "the cell size is 0"),
        (&["points.csv", "out.asc", "--cell", "1", "--k", "3"], "--k goes with --method idw"),
        (&["points.csv", "out.asc", "--cell", "1", "--power", "3"], "--power goes with"),
        (&["points.csv", "out.asc", "--cell", "1", "--method", "idw", "--power", "0"], "power is 0"),
        (&["points.csv", "out.asc", "--cell", "1", "--crs", "mars"], "--crs"),
        (&["points.csv", "out.asc", "--cell", "1e-9"], "cells are more than"),
        (
            &["points.csv", "out.asc", "--cell", "1", "--breaklines", "plane.geojson"],
            "no line in it has an elevation",
        ),
        (&["none.csv", "out.asc", "--cell", "1"], "none.csv: there is no such file"),
    ] {
        let said = grid(arguments);
        assert!(said.contains(wanted), "{arguments:?}: {said}");
    }
    // The last file may be meant as points.
    scratch.write("more.xyz", "1 2 3\n");
    assert!(grid(&["points.csv", "more.xyz", "--cell", "1"]).contains("may be points to read"));
    std::fs::remove_file(scratch.at("more.xyz")).expect("it is there");
    assert_eq!(run_in(scratch.folder(), &["dem", "grid", "points.csv", "--cell", "1"]).code, 2);
    assert_eq!(run_in(scratch.folder(), &["dem", "grid", "points.csv", "out.asc"]).code, 2);
    assert_eq!(scratch.names(), ["bad.csv", "line.geojson", "plane.geojson", "points.csv", "points.tif"]);
}
