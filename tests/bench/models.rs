//! `cargo bench --bench models`: what thousands of models cost.
//!
//! Three sections, each a table: how long and how much memory 1,000, 10,000 and 100,000 trees take to be listed and
//! drawn at 1920×1080, and what the same picture takes with every tree in full; what simplifying costs, model by model;
//! what reading and placing 1,000 models costs. Sections are chosen by name: `cargo bench --bench models -- forest`.

#[path = "common/rounds.rs"]
#[allow(dead_code, reason = "each benchmark uses its own part")]
mod rounds;
#[path = "demo/steps.rs"]
#[allow(dead_code, reason = "each benchmark uses its own part")]
mod steps;
#[path = "../common/mod.rs"]
mod tests_common;

use std::fs;
use std::path::Path;
use std::time::Instant;

use sandtable_draw::list::DrawList;
use sandtable_model::detail::ModelDetail;
use sandtable_model::error::CompanionError;
use sandtable_model::read::read;
use sandtable_model::simplify::levels;
use sandtable_model::{Companions, Model};
use sandtable_picture::{build_draw_list, display, draw_list};
use sandtable_render::cpu::{RenderQuality, render};
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

use crate::steps::{Step, Steps};
use crate::tests_common::forest::{forest, overlook};

/// The models that are simplified and read.
const MODELS: [&str; 6] =
    ["firtree.obj", "truck.3ds", "tent.glb", "farmhouse.obj", "watchtower.3ds", "bridge.glb"];

fn main() {
    rounds::sections(&[("forest", print_forest), ("simplify", print_simplify), ("reading", print_reading)]);
}

fn print_forest() {
    println!(
        "firs at 1920×1080, eight samples a pixel; memory is the whole process's at the step's worst moment"
    );
    println!(
        "{:<9}{:>14}{:>10}{:>8}{:>14}{:>12}{:>14}",
        "trees", "triangles", "items", "runs", "listing", "drawing", "peak memory"
    );
    for count in [1_000, 10_000, 100_000] {
        let scene = forest(count, &["firtree.obj"]);
        let camera = overlook(&scene, (1920, 1080));
        // The first picture makes the simpler forms; what a further one costs is what is told.
        build_draw_list(&scene, &camera, &|_| ());
        row(&count.to_string(), &scene, &camera, |scene, camera| {
            build_draw_list(scene, camera, &|_| ()).list
        });
    }
    let scene = forest(10_000, &["firtree.obj"]);
    let camera = overlook(&scene, (1920, 1080));
    row("10000 full", &scene, &camera, |scene, camera| draw_list(scene, &display(scene, camera), &|_| ()).0);
}

fn row(name: &str, scene: &SceneModel, camera: &Camera, listed: impl Fn(&SceneModel, &Camera) -> DrawList) {
    let steps = Steps::default();
    steps.begin("listing");
    let list = listed(scene, camera);
    steps.begin("drawing");
    render(&list, camera, &RenderQuality::default()).expect("sound");
    let steps: Vec<Step> = steps.finish();
    let peak = steps.iter().filter_map(|step| step.peak_mib).reduce(f64::max);
    let peak = peak.map_or("not measured".into(), |peak| format!("{peak:.0} MiB"));
    println!(
        "{name:<9}{:>14}{:>10}{:>8}{:>11.0} ms{:>9.0} ms{peak:>14}",
        list.triangle_count(),
        list.items.len(),
        list.runs().count(),
        steps[0].seconds * 1e3,
        steps[1].seconds * 1e3,
    );
}

struct Assets;

impl Companions for Assets {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        let folder = Path::new(env!("SANDTABLE_ROOT")).join("assets/models");
        Ok(fs::read(folder.join(name))?)
    }
}

fn asset(name: &str) -> Model {
    read(name, &Assets.load(name).expect("the asset is there"), &Assets).expect("the asset can be read")
}

fn print_simplify() {
    println!(
        "{:<16}{:>11}{:>12}{:>14}   levels: triangles (error in meters)",
        "model", "triangles", "levels", "all forms"
    );
    for name in MODELS {
        let model = asset(name);
        let start = Instant::now();
        let levels = levels(&model);
        let simplified = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        ModelDetail::new(&model);
        let all = start.elapsed().as_secs_f64() * 1e3;
        let each: Vec<String> =
            levels.iter().map(|level| format!("{} ({:.3})", level.triangle_count(), level.error)).collect();
        let count = model.triangle_count();
        println!("{name:<16}{count:>11}{simplified:>9.1} ms{all:>11.1} ms   {}", each.join(", "));
    }
}

fn print_reading() {
    println!("{:<16}{:>20}", "model", "read 1000 times");
    for name in MODELS {
        let start = Instant::now();
        (0..1000).for_each(|_| drop(asset(name)));
        println!("{name:<16}{:>17.0} ms", start.elapsed().as_secs_f64() * 1e3);
    }
    let steps = Steps::default();
    steps.begin("scene of 1,000 models");
    let scene = forest(1000, &MODELS);
    let steps = steps.finish();
    let peak = steps[0].peak_mib.map_or("not measured".into(), |peak| format!("{peak:.0} MiB"));
    println!("a scene with 1,000 placements of them: {:.0} ms, {peak}", steps[0].seconds * 1e3);
    assert_eq!(scene.placements.len(), 1000);
}
