//! `report`: what building a scene found out about single features.

use serde_json::Value;

use crate::cli::{project, run, run_in};
use crate::common::scratch::Scratch;

#[test]
fn the_earth_moved_for_a_road_is_told_and_is_the_same_in_every_form() {
    let scene = project("scenes/earthworks.toml");
    let text = run(&["report", "scenes/earthworks.toml"]).ok();
    assert!(text.contains("conformed roads (") && text.contains("cut [m3]"), "{text}");
    let json: Value =
        serde_json::from_str(&run(&["report", "scenes/earthworks.toml", "--json"]).ok()).expect("JSON");
    let roads = json["tables"]["conformed_roads"].as_array().expect("a table").clone();
    assert!(roads.iter().any(|road| road["cut_m3"].as_f64().is_some_and(|cut| cut > 1000.0)), "{roads:?}");
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.at("out")).expect("a folder");
    let written = run_in(scratch.folder(), &["report", &scene, "--csv", "out"]).ok();
    assert_eq!(written.lines().count(), scratch_names(&scratch).len());
    let table = std::fs::read_to_string(scratch.at("out/conformed_roads.csv")).expect("written");
    assert_eq!(table.lines().count(), roads.len() + 1);
    let profiles = scratch_names(&scratch).into_iter().filter(|name| name.starts_with("profile_"));
    assert_eq!(profiles.count(), roads.len(), "a profile for each road that the ground follows");
}

fn scratch_names(scratch: &Scratch) -> Vec<String> {
    let entries = std::fs::read_dir(scratch.at("out")).expect("a folder").flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

#[test]
fn a_scene_with_nothing_to_tell_says_so() {
    let text = run(&["report", "scenes/contours.toml"]).ok();
    assert!(text.contains("nothing to report of single features"), "{text}");
}

#[test]
fn a_folder_that_is_not_there_is_made_and_a_file_in_its_place_is_told() {
    let scratch = Scratch::new();
    let scene = project("scenes/earthworks.toml");
    let said = run_in(scratch.folder(), &["report", &scene, "--csv", "new/of_scene"]).ok();
    assert!(said.lines().count() > 1 && said.lines().all(|path| scratch.at(path).is_file()), "{said}");
    scratch.write("taken", "a file");
    let said = run_in(scratch.folder(), &["report", &scene, "--csv", "taken"]).failed(1);
    assert!(said.contains("taken"), "{said}");
}
