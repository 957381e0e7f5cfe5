//! `render`: a scene file in, a picture out.

use std::fs;

use crate::cli::{bytes_of, project, run_in};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

const SMALL: [&str; 2] = ["--size", "192x108"];

fn render(scratch: &Scratch, more: &[&str]) -> crate::cli::Ran {
    run_in(scratch.folder(), &[&["render"], more, &SMALL[..]].concat())
}

#[test]
fn the_picture_takes_the_scene_s_name_and_lies_in_the_current_folder() {
    let scratch = Scratch::new();
    let out = render(&scratch, &[&project("scenes/road.toml")]).ok();
    assert_eq!(out.lines().next(), Some("road.png"));
    for wanted in ["EPSG:32616", "2 roads", "cameras   front", "of them ground", "drawing"] {
        assert!(out.contains(wanted), "{wanted} in\n{out}");
    }
    assert_eq!(scratch.names(), ["road.png"]);
    let picture = image::open(scratch.at("road.png")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (192, 108));
    assert_eq!(picture.color(), image::ColorType::Rgb8);
    let colors: std::collections::BTreeSet<_> = picture.into_rgb8().pixels().map(|pixel| pixel.0).collect();
    assert!(colors.len() > 500, "{} colors", colors.len());
}

#[test]
fn every_scene_of_the_project_renders() {
    let scratch = Scratch::new();
    let mut scenes: Vec<_> = fs::read_dir(project("scenes")).expect("scenes").flatten().collect();
    scenes.sort_by_key(fs::DirEntry::file_name);
    for scene in
        scenes.iter().map(fs::DirEntry::path).filter(|path| path.extension().is_some_and(|it| it == "toml"))
    {
        let scene = scene.to_string_lossy().into_owned();
        render(&scratch, &[&scene, "-o", "out.png"]).ok();
        assert_eq!(scratch.names(), ["out.png"], "{scene}");
    }
}

#[test]
fn one_thread_and_two_make_the_same_picture() {
    let scratch = Scratch::new();
    let scene = project("scenes/jacksboro.toml");
    render(&scratch, &[&scene, "-o", "one.png", "--threads", "1"]).ok();
    render(&scratch, &[&scene, "-o", "two.png", "--threads", "2", "--backend", "cpu"]).ok();
    let bytes = |name: &str| fs::read(scratch.at(name)).expect("a picture");
    assert!(bytes("one.png") == bytes("two.png"));
}

#[test]
fn a_camera_is_taken_by_its_name() {
    let scratch = Scratch::new();
    let scene = project("scenes/jacksboro.toml");
    render(&scratch, &[&scene, "-o", "first.png"]).ok();
    let out = render(&scratch, &[&scene, "-o", "lake.png", "--camera", "lake"]).ok();
    assert!(out.contains("camera    lake:"), "{out}");
    let bytes = |name: &str| fs::read(scratch.at(name)).expect("a picture");
    assert!(bytes("first.png") != bytes("lake.png"));

    let refused = render(&scratch, &[&scene, "-o", "no.png", "--camera", "overveiw"]).failed(2);
    for wanted in ["overveiw", "main", "lake", "caryville", "did you mean 'overview'?"] {
        assert!(refused.contains(wanted), "{wanted} in {refused}");
    }
    let refused = render(&scratch, &[&scene, "-o", "no.png", "--camera", "xyz"]).failed(2);
    assert!(!refused.contains("did you mean"), "{refused}");
    assert_eq!(scratch.names(), ["first.png", "lake.png"]);
}

#[test]
fn a_picture_that_cannot_be_made_leaves_nothing_behind() {
    let scratch = Scratch::new();
    scratch.write("scenes/a.toml", "[terrain]\ndem = \"a.tif\"\n");
    scratch.write("scenes/a.tif", b"II*\0 and no more");
    scratch.write("old.png", "what was there before");
    render(&scratch, &["scenes/a.toml"]).failed(1);
    render(&scratch, &["scenes/a.toml", "-o", "old.png"]).failed(1);
    render(&scratch, &["scenes/none.toml"]).failed(1);
    assert_eq!(scratch.names(), ["old.png", "scenes"]);
    assert_eq!(fs::read(scratch.at("old.png")).expect("still there"), b"what was there before");
}

#[test]
fn a_place_that_cannot_be_written_is_told() {
    let scratch = Scratch::new();
    scratch.write("data/valley.asc", bytes_of("assets/jacksboro/valley.asc"));
    let text = "[terrain]\ndem = \"../data/valley.asc\"\ncrs = \"EPSG:32616\"\n";
    scratch.write("scenes/a.png", text);
    let scene = project("scenes/road.toml");
    for (place, wanted) in [
        ("nowhere/a.png", "no such folder"),
        ("scenes", "this is a folder"),
        ("..", "folder"),
        ("a.jpg", "PNG"),
    ] {
        let refused = render(&scratch, &[&scene, "-o", place]).failed(1);
        assert!(refused.contains(wanted), "{place}: {refused}");
    }
    // A scene whose own name ends in .png would be overwritten by its picture.
    let refused = run_in(&scratch.at("scenes"), &["render", "a.png"]).failed(1);
    assert!(refused.contains("-o"), "{refused}");
    assert_eq!(fs::read_to_string(scratch.at("scenes/a.png")).expect("still there"), text);
    assert_eq!(scratch.names(), ["data", "scenes"]);
    // Nor may a picture take the place of what its scene is made of.
    scratch.write("data/hills.png", bytes_of("assets/jacksboro/hills.png"));
    scratch.write("scenes/b.toml", "[terrain]\ndem = \"../data/hills.png\"\nheight_scale = 0.1\ncell = 10\n");
    let refused = render(&scratch, &["scenes/b.toml", "-o", "data/hills.png"]).failed(1);
    assert!(refused.contains("made of this file"), "{refused}");
    #[cfg(unix)]
    assert!(render(&scratch, &[&scene, "-o", "/dev/null"]).failed(1).contains("device"));
}

#[test]
fn an_existing_picture_is_replaced_whole() {
    let scratch = Scratch::new();
    let scene = project("scenes/heightmap.toml");
    scratch.write("heightmap.png", vec![7; 4 << 20]);
    render(&scratch, &[&scene]).ok();
    assert_eq!(scratch.names(), ["heightmap.png"]);
    assert!(image::open(scratch.at("heightmap.png")).is_ok());
}

#[test]
fn the_gpu_backend_draws_or_says_what_it_lacks() {
    let scratch = Scratch::new();
    let ran = render(&scratch, &[&project("scenes/road.toml"), "--backend", "gpu"]);
    if cfg!(feature = "gpu") && ran.code == 0 {
        assert_eq!(scratch.names(), ["road.png"]);
        return;
    }
    let refused = ran.failed(1);
    if cfg!(feature = "gpu") {
        skipped(&format!("no GPU adapter: {refused}"));
        assert!(std::env::var_os("SANDTABLE_REQUIRE_GPU").is_none(), "{refused}");
    } else {
        assert!(refused.contains("cargo run --features gpu -- "), "{refused}");
    }
    assert!(refused.contains("--backend cpu"), "{refused}");
    assert!(scratch.names().is_empty());
}
