//! `plan analysis`: the shards of an analysis make the bytes that `analyze` writes.

use std::fs;

use serde_json::Value;

use crate::cli::{bytes_of, project, run_in};
use crate::common::scratch::Scratch;

/// A copy of the demo's elevation.
fn surveyed() -> Scratch {
    let scratch = Scratch::new();
    fs::write(scratch.at("dem.tif"), bytes_of("assets/jacksboro/dem.tif")).expect("written");
    scratch
}

/// Compares what the shards of a plan make with the file that `analyze` writes, and returns the lines of the shards.
fn check(scratch: &Scratch, analysis: &[&str], shards: &str) -> Vec<Value> {
    let (folder, plan) = (scratch.folder(), ["--shards", shards, "-o", "plan"]);
    run_in(folder, &[&["plan", "analysis"], analysis, &plan].concat()).ok();
    let lines = fs::read_to_string(scratch.at("plan/shards.jsonl")).expect("written");
    let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).expect("a shard")).collect();
    // In any order.
    for id in (0..lines.len()).rev() {
        let done = run_in(folder, &["work", "plan", "--shard", &id.to_string()]).ok();
        assert_eq!(done, format!("{id} done\n"));
    }
    assert_eq!(run_in(folder, &["gather", "plan"]).ok(), "plan/analysis.tif\n");
    let whole = run_in(folder, &[&["analyze"], analysis, &["-o", "whole.tif"]].concat());
    assert_eq!(whole.code, 0, "{}", whole.err);
    let (gathered, whole) = (fs::read(scratch.at("plan/analysis.tif")), fs::read(scratch.at("whole.tif")));
    assert!(gathered.expect("written") == whole.expect("written"), "{analysis:?}");
    lines
}

#[test]
fn an_analysis_in_shards_has_the_bytes_of_the_whole() {
    let scratch = surveyed();
    let lines = check(&scratch, &["slope", "dem.tif", "--unit", "degrees"], "6");
    assert!((4..=9).contains(&lines.len()), "{}", lines.len());
    assert!(lines.iter().all(|line| line["halo"] == 1), "{lines:?}");
    let lines = check(&scratch, &["geomorphons", "dem.tif", "--radius", "12"], "5");
    assert!(lines.iter().all(|line| line["halo"].as_u64() >= Some(12)), "{lines:?}");
    check(&scratch, &["ruggedness", "dem.tif", "--measure", "vrm", "--radius", "4"], "4");
}

#[test]
fn an_extent_is_planned_in_shards_and_its_area_cut() {
    let scratch = surveyed();
    let part = ["obstacles", "dem.tif", "--crs", "EPSG:32616", "--extent", "740000,4010000,750000,4016000"];
    check(&scratch, &part, "4");
    let area = ["slope", "dem.tif", "--extent", "-84.3,36.2;-84.15,36.22;-84.2,36.4"];
    check(&scratch, &area, "7");
}

#[test]
fn an_analysis_of_elevation_on_disk_is_read_by_windows_and_equal() {
    let scratch = surveyed();
    let convert = ["dem", "convert", "dem.tif", "large.tif", "--crs", "EPSG:32616", "--cell", "25"];
    assert_eq!(run_in(scratch.folder(), &convert).code, 0);
    let lines = check(&scratch, &["aspect", "large.tif"], "5");
    assert!(lines.len() > 3, "{lines:?}");
}

#[test]
fn an_analysis_of_a_scene_knows_its_roads_in_every_shard() {
    let scratch = Scratch::new();
    let scene = project("scenes/road.toml");
    let lines = check(&scratch, &["speed", &scene, "--vehicle", "truck"], "3");
    assert!(lines.len() > 1, "{lines:?}");
}

#[test]
fn a_kind_that_reaches_everywhere_is_refused_with_a_reason() {
    let scratch = surveyed();
    let plan = ["plan", "analysis", "contours", "dem.tif", "--interval", "20", "-o", "plan"];
    let refused = run_in(scratch.folder(), &plan).failed(1);
    assert!(
        refused.contains("contours cannot be cut into parts") && refused.contains("analyze"),
        "{refused}"
    );
    assert!(!scratch.at("plan").exists());
}

#[test]
fn a_shard_off_the_ground_is_wrong_and_nothing_panics() {
    let scratch = surveyed();
    let plan = ["plan", "analysis", "slope", "dem.tif", "--shards", "1", "-o", "plan"];
    run_in(scratch.folder(), &plan).ok();
    let (head, list) = (scratch.at("plan/plan.json"), scratch.at("plan/shards.jsonl"));
    let text = fs::read_to_string(&head).expect("written");
    for (old, new) in [("\"kind\": \"slope\"", "\"kind\": \"peaks\""), ("\"slope\"", "\"nothing\"")] {
        fs::write(&head, text.replace(old, new)).expect("written");
        let wrong = run_in(scratch.folder(), &["work", "plan", "--shard", "0"]).failed(1);
        assert!(wrong.contains("cannot be cut") || wrong.contains("which is no analysis"), "{wrong}");
    }
    assert!(fs::read_to_string(list).expect("written").contains("\"halo\":1"));
}
