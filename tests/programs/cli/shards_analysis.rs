//! `plan analysis`: the shards of an analysis make the bytes that `analyze` writes, and the figures that it prints.

use std::fs;
use std::path::Path;

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
    let said = run_in(folder, &["gather", "plan"]);
    let whole = run_in(folder, &[&["analyze"], analysis, &["-o", "whole.tif"]].concat());
    assert_eq!((said.code, whole.code), (0, 0), "{} {}", said.err, whole.err);
    assert_eq!(said.out, whole.out.replacen("whole.tif", "plan/analysis.tif", 1), "{analysis:?}");
    assert_eq!(notes(&said.err), notes(&whole.err), "{analysis:?}");
    let json = |arguments: &[&str]| -> Value {
        let ran = run_in(folder, &[arguments, &["--json"]].concat());
        serde_json::from_str(&ran.out).unwrap_or_else(|error| panic!("{error}: {} {}", ran.out, ran.err))
    };
    let (mut said, mut whole) =
        (json(&["gather", "plan"])["analysis"].take(), json(&[&["analyze"], analysis].concat()));
    [&mut said, &mut whole].into_iter().for_each(|said| drop(said["output"].take()));
    // The classes of a picture follow from all values, which a gathering does not hold at once.
    whole.as_object_mut().expect("an object").remove("classes");
    assert_eq!(said, whole, "{analysis:?}");
    let (gathered, whole) = (fs::read(scratch.at("plan/analysis.tif")), fs::read(scratch.at("whole.tif")));
    assert!(gathered.expect("written") == whole.expect("written"), "{analysis:?}");
    check_features(folder, analysis);
    lines
}

/// Compares the features of a plan whose shards are done with those that `analyze` writes, and both refusals where there are
/// none.
fn check_features(folder: &Path, analysis: &[&str]) {
    for extension in ["gpkg", "geojson"] {
        let (of_shards, of_whole) = (format!("gathered.{extension}"), format!("whole.{extension}"));
        let said = run_in(folder, &["gather", "plan", "-o", &of_shards]);
        let whole = run_in(folder, &[&["analyze"], analysis, &["-o", &of_whole]].concat());
        assert_eq!(said.code, whole.code, "{analysis:?}: {} {}", said.err, whole.err);
        assert_eq!(said.out, whole.out.replacen(&of_whole, &of_shards, 1), "{analysis:?}");
        if whole.code != 0 {
            let refused = "the analysis found no features, and its raster has no classes";
            assert!(said.err.contains(refused) && whole.err.contains(refused), "{} {}", said.err, whole.err);
            continue;
        }
        let files = [of_shards, of_whole].map(|name| fs::read(folder.join(name)).expect("written"));
        assert!(files[0] == files[1], "{analysis:?} as .{extension}");
    }
}

/// The notes among what was warned of.
fn notes(err: &str) -> Vec<&str> {
    err.lines().filter(|line| line.starts_with("note: ") && !line.contains("kept in memory")).collect()
}

/// Positions on the demo's elevation, in degrees.
const POSTS: &str = "-84.2,36.3;-84.13,36.34;-84.29,36.21";

#[test]
fn viewsheds_with_a_range_are_cut_and_shards_beyond_it_cost_nothing() {
    let scratch = surveyed();
    let lines = check(&scratch, &["viewsheds", "dem.tif", "--posts", POSTS, "--range", "2500"], "24");
    let idle = lines.iter().filter(|line| line["cost"] == 1.0).count();
    assert!(idle > 3 && lines.len() - idle > 3, "{idle} of {}", lines.len());
    let dead = ["viewsheds", "dem.tif", "--posts", POSTS, "--show", "dead", "--target-height", "2"];
    check(&scratch, &dead, "5");
    let fire = ["fields-of-fire", "dem.tif", "--weapons", POSTS, "--max-range", "3000", "--arc", "200"];
    check(&scratch, &[&fire[..], &["--min-range", "300", "--direction", "45"]].concat(), "9");
    check(&scratch, &["masking", "dem.tif", "--radars", POSTS, "--range", "4000"], "6");
    check(
        &scratch,
        &["masking", "dem.tif", "--radars", POSTS, "--range", "9000", "--seen-by", "nearest"],
        "4",
    );
}

#[test]
fn viewsheds_of_an_extent_and_of_ground_on_disk_are_cut_alike() {
    let scratch = surveyed();
    let crs = ["--crs", "EPSG:32616", "--posts", "745031.3,4014022.7;748500,4012100", "--range", "3000"];
    for extent in ["740013,4010000,750000,4016000", "740000,4010000;752000,4011000;746000,4018000"] {
        check(&scratch, &[&["viewsheds", "dem.tif", "--extent", extent], &crs[..]].concat(), "7");
    }
    let convert = ["dem", "convert", "dem.tif", "large.tif", "--crs", "EPSG:32616", "--cell", "25"];
    assert_eq!(run_in(scratch.folder(), &convert).code, 0);
    let seen = ["--posts", "745031.3,4014022.7;748500,4012100", "--range", "3000"];
    check(&scratch, &[&["viewsheds", "large.tif"], &seen[..]].concat(), "12");
}

#[test]
fn places_without_ground_and_a_missing_range_are_refused_by_their_names() {
    let scratch = surveyed();
    let plan = |analysis: &[&str]| {
        let ran = run_in(scratch.folder(), &[&["plan", "analysis"], analysis, &["-o", "plan"]].concat());
        ran.failed(1)
    };
    let off = plan(&["viewsheds", "dem.tif", "--posts", "-84.2,36.3;-80,36.3", "--range", "900"]);
    assert!(off.contains("`posts` ") && off.contains("lies off the land"), "{off}");
    let everywhere = plan(&["masking", "dem.tif", "--radars", POSTS]);
    assert!(everywhere.contains("`range`") && everywhere.contains("analyze masking"), "{everywhere}");
    assert!(!scratch.at("plan/plan.json").exists());
}

#[test]
fn a_tally_that_is_not_the_shards_own_is_stale() {
    let scratch = surveyed();
    let plan = ["plan", "analysis", "obstacles", "dem.tif", "--shards", "2", "-o", "plan"];
    run_in(scratch.folder(), &plan).ok();
    run_in(scratch.folder(), &["work", "plan", "--shards", "0..2"]).ok();
    let tally = scratch.at("plan/shards/000001.tally.json");
    let text = fs::read_to_string(&tally).expect("written");
    fs::write(&tally, text.replace("\"tally\":[", "\"tally\":[9")).expect("written");
    let refused = run_in(scratch.folder(), &["gather", "plan"]).failed(1);
    assert!(refused.contains("1 stale (1)"), "{refused}");
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
    check(&scratch, &["hillshade", "dem.tif"], "3");
    check(&scratch, &["curvature", "dem.tif"], "3");
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
