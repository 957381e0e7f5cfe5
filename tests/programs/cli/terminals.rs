//! What a terminal shows while a command works: how far it is and the time that is left; and what it says after Ctrl-C.
//!
//! `tests/tools/in_terminal.py` is the terminal; without Python the tests say so and pass.

use std::process::{Command, Stdio};

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

/// What a terminal got from the program, which is interrupted where a text appears.
fn in_terminal(scratch: &Scratch, interrupt_at: Option<&str>, arguments: &[&str]) -> Option<String> {
    if Command::new("python3").arg("--version").output().is_err() {
        skipped("no terminal: python3 is not on the path");
        return None;
    }
    let mut command = Command::new("python3");
    command.arg(project("tests/tools/in_terminal.py")).current_dir(scratch.folder());
    command.args(interrupt_at.into_iter().flat_map(|text| ["--interrupt-at", text]));
    command.arg(env!("CARGO_BIN_EXE_sandtable")).args(arguments).env("TERM", "xterm");
    let ran = command.stdin(Stdio::null()).output().expect("python3 runs");
    Some(String::from_utf8_lossy(&ran.stdout).into_owned())
}

/// The end of what a terminal got.
fn end(shown: &str) -> String {
    let from = shown.char_indices().rev().nth(600).map_or(0, |(at, _)| at);
    shown[from..].to_owned()
}

#[test]
fn a_flight_shows_its_frames_and_the_time_left_and_says_what_ctrl_c_keeps() {
    let (scratch, scene) = (Scratch::new(), project("scenes/river.toml"));
    let arguments = ["fly", &scene, "--size", "320x180", "--seconds", "40", "-o", "frames"];
    let Some(shown) = in_terminal(&scratch, Some(" left "), &arguments) else { return };
    assert!(shown.contains("frame ") && shown.contains(" of 1000, "), "{}", end(&shown));
    assert!(shown.contains(" left ["), "{}", end(&shown));
    assert!(shown.contains("interrupted: frames that are drawn are kept"), "{}", end(&shown));
    assert!(std::fs::read_dir(scratch.at("frames")).expect("a folder").count() > 1);
}

#[test]
fn work_shows_its_shards_and_the_time_left_and_goes_on_after_ctrl_c() {
    let scratch = Scratch::new();
    let dem = project("assets/jacksboro/dem.tif");
    let points: String =
        (0..1500).map(|index| format!("{},36.3\n", -84.4 + 0.0002 * f64::from(index))).collect();
    scratch.write("points.csv", &points);
    let Some(planned) = in_terminal(
        &scratch,
        None,
        &["plan", "viewsheds", &dem, "--points", "points.csv", "--shards", "1500", "-o", "plan"],
    ) else {
        return;
    };
    let work = ["work", "plan", "--shards", "0..1500"];
    let Some(shown) = in_terminal(&scratch, Some(" left "), &work) else { return };
    assert!(shown.contains("shard "), "{planned}{}", end(&shown));
    assert!(shown.contains(" of 1500, "), "{}", end(&shown));
    assert!(shown.contains("interrupted: shards that are done are kept"), "{}", end(&shown));
    assert!(shown.contains("0 done"), "{}", end(&shown));
    let Some(quiet) = in_terminal(&scratch, None, &["work", "plan", "--shards", "0..1", "--quiet"]) else {
        return;
    };
    assert_eq!(quiet, "");
}

#[test]
fn pictures_of_several_cameras_show_how_far_all_are() {
    let (scratch, scene) = (Scratch::new(), project("scenes/jacksboro.toml"));
    let arguments = ["render", &scene, "--all-cameras", "--size", "640x360", "-o", "a.png"];
    let Some(shown) = in_terminal(&scratch, None, &arguments) else { return };
    assert!(shown.contains("drawing, all "), "{}", end(&shown));
    let quiet: Vec<&str> = arguments.into_iter().chain(["--quiet"]).collect();
    assert_eq!(in_terminal(&scratch, None, &quiet).as_deref(), Some(""));
}

#[test]
fn one_picture_shows_how_much_is_drawn_and_ctrl_c_keeps_the_old_one() {
    let (scratch, scene) = (Scratch::new(), project("scenes/jacksboro.toml"));
    scratch.write("a.png", "old");
    let arguments = ["render", &scene, "--size", "6000x6000", "-o", "a.png"];
    let Some(shown) = in_terminal(&scratch, Some(" left "), &arguments) else { return };
    assert!(shown.contains("drawing ") && shown.contains(" %, "), "{}", end(&shown));
    assert!(shown.contains("interrupted: "), "{}", end(&shown));
    assert_eq!(std::fs::read(scratch.at("a.png")).expect("a file"), b"old");
}

#[test]
fn a_page_shows_how_much_of_it_is_packed() {
    let (scratch, scene) = (Scratch::new(), project("scenes/jacksboro.toml"));
    let arguments = ["export", &scene, "-o", "a.html"];
    let Some(shown) = in_terminal(&scratch, None, &arguments) else { return };
    let said =
        shown.split("writing ").skip(1).any(|rest| rest.split('[').next().unwrap_or("").contains(" %"));
    assert!(said, "{}", end(&shown));
}

#[test]
fn gathering_shows_how_much_is_joined() {
    let scratch = Scratch::new();
    let dem = project("assets/jacksboro/dem.tif");
    let points: String =
        (0..300_000).map(|index| format!("{:.6},36.3\n", -84.4 + 1e-6 * f64::from(index))).collect();
    scratch.write("points.csv", &points);
    run_in(
        scratch.folder(),
        &["plan", "heights", &dem, "--points", "points.csv", "--shards", "4", "-o", "plan"],
    )
    .ok();
    run_in(scratch.folder(), &["work", "plan", "--shards", "0..4"]).ok();
    let Some(shown) = in_terminal(&scratch, None, &["gather", "plan"]) else { return };
    let said = shown
        .split("joining the shards")
        .skip(1)
        .any(|rest| rest.split('[').next().unwrap_or("").contains(" %"));
    assert!(said, "{}", end(&shown));
}
