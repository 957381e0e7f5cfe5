//! `view --offscreen`: the frames of the window, without a window.
//!
//! `gpu_backend` is in the names of the tests that need an adapter.

use std::fs;

use serde_json::Value;

use crate::cli::{Ran, project, run_in};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

const SCRIPT: &str = "wait 2\nsnapshot scene.png\nresize 320x200\nkey T\nwait 2\nsnapshot panels.png\nquit\n";

fn view(scratch: &Scratch, scene: &str, script: &str, more: &[&str]) -> Ran {
    fs::write(scratch.at("script.txt"), script).expect("writable");
    let words = ["view", scene, "--offscreen", "--script", "script.txt", "--json"];
    run_in(scratch.folder(), &[&words, more].concat())
}

/// What a program with a window and an adapter printed; `None` where there is neither.
fn printed(ran: Ran) -> Option<String> {
    if cfg!(feature = "viewer") && ran.code == 0 {
        // Drivers may say something of their own.
        return Some(ran.out);
    }
    let refused = ran.failed(if cfg!(feature = "viewer") { 1 } else { 2 });
    if cfg!(feature = "viewer") {
        assert!(refused.contains("sandtable render"), "{refused}");
        assert!(std::env::var_os("SANDTABLE_REQUIRE_GPU").is_none(), "{refused}");
        skipped(&format!("no GPU adapter: {refused}"));
    } else {
        assert!(refused.contains("cargo build --features viewer"), "{refused}");
    }
    None
}

#[test]
fn the_gpu_backend_shows_the_phases_of_a_scene_by_name_and_by_key() {
    let scratch = Scratch::new();
    // Shadows of the scene that is opened first are those of its opening, or finer ones that are made when it rests; those of a phase
    // are always made with it.
    let script = "wait 60\nphase noon\nwait 2\nsnapshot noon.png\nkey ,\nwait 2\nsnapshot morning.png\nphase noon\nwait 2\nkey ,\n\
                  wait 2\nsnapshot back.png\nkey .\nkey .\nwait 2\nsnapshot dusk.png\nphase night\nquit\n";
    let ran = view(&scratch, &project("scenes/phases.toml"), script, &["--size", "256x144"]);
    let Some(printed) = printed(ran) else { return };
    let bytes = |name: &str| image::open(scratch.at(name)).expect("a picture").into_rgb8().into_raw();
    let [morning, noon, back, dusk] =
        ["morning", "noon", "back", "dusk"].map(|name| bytes(&format!("{name}.png")));
    assert!(morning != noon && noon != dusk && morning != dusk, "each phase has a picture of its own");
    assert!(morning == back, "the phase before is the same again");
    assert!(printed.contains("night"), "a phase that the scene does not have is named: {printed}");
}

#[test]
fn the_gpu_backend_draws_frames_without_a_display() {
    let scratch = Scratch::new();
    let ran = view(&scratch, &project("scenes/road.toml"), SCRIPT, &["--size", "256x144"]);
    let Some(printed) = printed(ran) else { return };
    let report: Value = serde_json::from_str(&printed).expect("JSON");
    assert!(report["frames"].as_u64().is_some_and(|frames| frames > 4), "{report}");
    assert!(report["ground_triangles"].as_u64().is_some_and(|count| count > 100), "{report}");
    assert!(report["pipelines"].as_u64().is_some_and(|count| count > 0), "{report}");
    for part in ["frame", "update", "upload", "draw", "panels", "wait"] {
        assert!(report["milliseconds"][part]["median"].is_number(), "{part}: {report}");
    }
    let colors = |name: &str, size: (u32, u32)| {
        let picture = image::open(scratch.at(name)).expect("a picture").into_rgb8();
        assert_eq!(picture.dimensions(), size);
        picture.pixels().map(|pixel| pixel.0).collect::<std::collections::BTreeSet<_>>()
    };
    let scene = colors("scene.png", (256, 144));
    assert!(scene.len() > 500, "{} colors", scene.len());
    // The panels' background, which no scene has.
    assert!(!scene.contains(&[27, 27, 27]) && colors("panels.png", (320, 200)).contains(&[27, 27, 27]));
}

/// A flight on which a picture is kept, and one at rest.
const FLIGHT: &str = "wait 2\nfly 751500,4014500,1200 749500,4018000,400 1\nwait 2\nfly 752500,4015500,1300 749500,4018000,400 8\n\
                      snapshot way.png\nwait 6\nsnapshot rest.png\nquit\n";

#[test]
fn the_gpu_backend_keeps_whole_pictures_of_a_flight_that_is_drawn_in_fewer_pixels() {
    let scene = project("scenes/road.toml");
    let fly = |script: &str| {
        let scratch = Scratch::new();
        let ran = view(&scratch, &scene, script, &["--size", "480x270"]);
        let report: Value = serde_json::from_str(&printed(ran)?).expect("JSON");
        let read = |name: &str| fs::read(scratch.at(name)).expect("a picture");
        Some((report, ["way.png", "rest.png"].map(read)))
    };
    let Some((report, pictures)) = fly(FLIGHT) else { return };
    // What was drawn before a picture, and how fast, does not show in it.
    let hasty = FLIGHT.replacen("wait 2", "fly 751000,4014000,1500 749500,4018000,400 4", 1);
    let (_, others) = fly(&hasty).expect("an adapter");
    assert!(pictures == others, "the pictures depend on the frames before");
    let is_software = report["adapter"].as_str().is_some_and(|name| name.contains("llvmpipe"));
    let shares = &report["side_share"];
    let least = shares["least"].as_f64().expect("a number");
    assert!((0.25..=1.0).contains(&least) && (is_software || least == 1.0), "{report}");
    assert_eq!(shares["last"], 1.0, "{report}");
}

#[test]
fn the_gpu_backend_says_why_frames_are_not_drawn() {
    let scratch = Scratch::new();
    let road = project("scenes/road.toml");
    if printed(view(&scratch, &road, "quit\n", &[])).is_none() {
        return;
    }
    let refused = view(&scratch, "none.toml", SCRIPT, &[]).failed(1);
    assert!(refused.contains("none.toml"), "{refused}");
    let refused = view(&scratch, &road, "jump\n", &[]).failed(1);
    assert!(refused.contains("line 1: 'jump' is not a command"), "{refused}");
    for words in [&["view", &road, "--offscreen"][..], &["view", &road, "--size", "64x64"]] {
        let refused = run_in(scratch.folder(), words).failed(2);
        assert!(refused.contains("--script") || refused.contains("--offscreen"), "{refused}");
    }
}
