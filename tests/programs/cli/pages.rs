//! `export` to a page: a scene in, one HTML file out that a browser opens, draws and asks.
//!
//! The browser is driven by `tests/tools/page_test.mjs`; without one the tests that need it say so and pass.

use std::path::Path;
use std::process::Command;

use image::RgbImage;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_sheet::picture::{PictureSize, draw_view};
use serde_json::Value;

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

/// The greatest mean difference of a channel between the page and the CPU renderer, of 255. The page has one shadow map
/// where the renderer has several, and no contact shade; 1.3 was measured on a part of the demo that
/// has ground alone.
const MOST_MEAN_DIFFERENCE: f64 = 2.5;

/// What happened in the browser; `None` with a loud line where there is none.
fn in_browser(page: &Path, picture: &Path) -> Option<Value> {
    if std::env::var_os("SANDTABLE_BROWSER").is_none() {
        skipped("no browser: SANDTABLE_BROWSER is not set");
        assert!(std::env::var_os("SANDTABLE_REQUIRE_BROWSER").is_none(), "SANDTABLE_REQUIRE_BROWSER is set");
        return None;
    }
    let script = project("tests/tools/page_test.mjs");
    let ran = Command::new("node").arg(script).args([page, picture]).output().expect("node runs");
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(ran.status.success(), "{said}{}", String::from_utf8_lossy(&ran.stderr));
    Some(serde_json::from_str(&said).expect("one line of JSON"))
}

/// What `height` answers at the coordinates that the page shows.
fn height_at(scene: &str, picked: &Value) -> String {
    let at = picked["EPSG:32616"].as_str().expect("coordinates").replace(' ', "");
    let answers = run_in(Path::new("."), &["height", scene, "--at", &at]).ok();
    let answer = answers.lines().nth(1).expect("a line under the heading");
    answer.split(',').nth(2).expect("the third column").to_owned()
}

fn cpu_picture(scene: &str) -> RgbImage {
    let scene = open_scene(Path::new(scene), &[], &|_| {}).expect("sound");
    let size = PictureSize { width: 1280, height: 720 };
    let drawn = draw_view(&scene, &scene.cameras[0], size, RenderBackend::Cpu, &|_| {}).expect("drawn");
    let bytes = drawn.picture.pixels.data().iter().flat_map(|color| color.0[..3].to_vec()).collect();
    RgbImage::from_raw(1280, 720, bytes).expect("as many as the size says")
}

fn mean_difference(a: &RgbImage, b: &RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let sum: u64 = a.iter().zip(b.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len() as f64
}

#[test]
fn a_browser_opens_the_demo_s_page_without_a_network_and_answers_as_height_does() {
    let scratch = Scratch::new();
    let scene = project("scenes/jacksboro.toml");
    let said = run_in(scratch.folder(), &["export", &scene, "-o", "page.html"]).ok();
    assert!(said.contains("MB") && said.contains("triangles, off by at most 0.5 m"), "{said}");
    let (page, picture) = (scratch.at("page.html"), scratch.at("page.png"));
    assert!(std::fs::metadata(&page).expect("written").len() < 18_000_000);
    let Some(told) = in_browser(&page, &picture) else { return };
    assert_eq!(told["complaints"], Value::Array(Vec::new()), "{told:#}");
    let requests = told["requests"].as_array().expect("a list");
    assert!(requests.iter().all(|url| url.as_str().is_some_and(|url| url.starts_with("file:"))), "{told:#}");
    assert_eq!(requests.len(), 1, "the page itself: {told:#}");
    assert_eq!(told["title"], "The Jacksboro Fault");
    for way in ["click", "tap"] {
        let picked = &told[way];
        assert_eq!(picked["height"], format!("{} m", height_at(&scene, picked)), "{told:#}");
        assert!(picked["WGS 84"].as_str().is_some_and(|at| at.contains("° N") && at.contains("° W")));
    }
    assert_ne!(told["click"]["height"], told["tap"]["height"]);
    assert_eq!(told["closed"], true);
    for way in ["drag", "wheel", "key"] {
        assert_eq!(told["moves"][way], true, "{way}: {told:#}");
    }
    assert_eq!(told["isBack"], true, "{told:#}");
    assert_eq!((&told["canvas"][0], &told["canvas"][1]), (&Value::from(420), &Value::from(700)));
    assert_eq!(told["message"], "", "after the adapter came back");
    let shown = image::open(&picture).expect("a picture").into_rgb8();
    let difference = mean_difference(&shown, &cpu_picture(&scene));
    println!("mean difference {difference:.2}, first frame after {} ms", told["firstFrame_ms"]);
    assert!(difference < MOST_MEAN_DIFFERENCE, "{difference}");
}

#[test]
fn scenes_of_all_kinds_become_pages_and_the_size_of_a_print_is_refused() {
    let scratch = Scratch::new();
    for scene in ["models", "sheet", "sight", "operation"] {
        let scene = project(&format!("scenes/{scene}.toml"));
        run_in(scratch.folder(), &["export", &scene, "-o", "page.HTML", "--max-error", "5"]).ok();
        let text = std::fs::read_to_string(scratch.at("page.HTML")).expect("written");
        assert!(
            text.starts_with("<!doctype html>") && text.ends_with("</html>\n") && text.len() < 64_000_000
        );
    }
    let scene = project("scenes/models.toml");
    let said = run_in(scratch.folder(), &["export", &scene, "-o", "a.html", "--side", "90"]).failed(2);
    assert!(said.contains("--side has no effect on a page; remove it"), "{said}");
}
