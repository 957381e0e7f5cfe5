//! `cargo bench --bench demo`: what the demonstration picture costs, step by step, and what threads save.
//!
//! One run, printed as tables. First the scene is loaded and drawn once, with the time and the peak memory of
//! every step. Then whole pictures are made with one thread, with two, and on by doubling up to the machine's
//! cores; every round takes all numbers of threads in turn, so that another program's load falls on all of them
//! alike, and medians over the rounds are compared. All pictures must be the same bytes. A framework that
//! repeats small pieces would say nothing of memory, nor of the whole.

#[path = "demo/steps.rs"]
mod steps;

use std::path::Path;

use sandtable_draw::list::{DepthLayer, DrawItem};
use sandtable_files::png::encode_png;
use sandtable_picture::ViewDraw;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::SceneView;
use sandtable_sheet::picture::{PictureSize, RenderedView, render_view};

use crate::steps::{Step, Steps};

const SIZE: PictureSize = PictureSize { width: 1920, height: 1080 };

/// Rounds whose medians are compared; odd, so that a median is a time that was measured.
const ROUNDS: usize = 7;

fn main() {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!("scenes/jacksboro.toml, first camera, {}×{}; {cores} cores", SIZE.width, SIZE.height);
    if cfg!(debug_assertions) {
        println!("This is a build for debugging: its times say nothing about a release.");
    }
    let run = pool(cores).install(run_once);
    print_steps(&run.steps);
    print_triangles(&run.finished.drawn);
    println!("PNG: {:.2} MB", run.png_bytes as f64 / 1e6);
    print_threads(&run, cores);
}

/// Everything from the scene file to the PNG, once.
struct Run {
    scene: SceneModel,
    view: SceneView,
    finished: RenderedView,
    steps: Vec<Step>,
    png_bytes: usize,
}

fn run_once() -> Run {
    let steps = Steps::default();
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/jacksboro.toml");
    let scene = open_scene(&path, &[], &|step| steps.begin(step)).expect("the demonstration is sound");
    let view = scene.view(None).expect("a scene has a camera").clone();
    let finished = picture(&scene, &view, &steps);
    steps.begin("encoding");
    let png_bytes = encode_png(&finished.pixels).len();
    Run { scene, view, finished, steps: steps.finish(), png_bytes }
}

fn picture(scene: &SceneModel, view: &SceneView, steps: &Steps) -> RenderedView {
    render_view(scene, view, SIZE, RenderBackend::Cpu, &|step| steps.begin(step))
        .expect("the camera is sound")
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had")
}

fn print_steps(steps: &[Step]) {
    println!("\n{:<26}{:>10}{:>18}", "step", "time", "peak memory");
    for step in steps {
        let peak = step.peak_mib.map_or("not measured".into(), |peak| format!("{peak:.1} MiB"));
        println!("{:<26}{:>7.1} ms{:>18}", step.name, step.seconds * 1e3, peak);
    }
    let total: f64 = steps.iter().map(|step| step.seconds).sum();
    let peak = steps.iter().filter_map(|step| step.peak_mib).reduce(f64::max);
    let peak = peak.map_or("not measured".into(), |peak| format!("{peak:.1} MiB"));
    println!("{:<26}{:>7.1} ms{peak:>18}", "all", total * 1e3);
    println!("Memory: {}.", steps::memory_method());
}

fn print_triangles(shot: &ViewDraw) {
    let count = |wanted: fn(&DrawItem) -> bool| -> usize {
        shot.list.items.iter().filter(|item| wanted(item)).map(|item| item.triangles.len()).sum()
    };
    let ground = shot.ground_triangles;
    let draped = count(|item| matches!(item.layer, DepthLayer::Draped(_)));
    let models = count(|item| item.layer == DepthLayer::Solid && item.feature.index().is_some());
    let all = shot.list.triangle_count();
    let rest = all - ground - draped - models;
    println!("\nTriangles: {ground} ground, {draped} draped, {models} models, {rest} others, {all} in all");
}

/// One round's times in seconds: the whole picture, and the drawing alone.
type Times = [f64; 2];

fn print_threads(run: &Run, cores: usize) {
    let counts: Vec<usize> =
        (0..).map(|power| 1 << power).take_while(|&count| count <= cores.max(2)).collect();
    let pools: Vec<_> = counts.iter().map(|&count| pool(count)).collect();
    let mut times: Vec<Vec<Times>> = vec![Vec::new(); counts.len()];
    for _ in 0..ROUNDS {
        for (pool, times) in pools.iter().zip(&mut times) {
            times.push(pool.install(|| time_picture(run)));
        }
    }
    println!("\nMedian of {ROUNDS} rounds, thread counts in turn:");
    println!(
        "{:<10}{:>16}{:>14}{:>14}{:>14}",
        "threads", "whole picture", "against 1", "drawing", "against 1"
    );
    let medians: Vec<Times> = times.iter().map(|times| [0, 1].map(|part| median(times, part))).collect();
    for (count, [whole, drawing]) in counts.iter().zip(&medians) {
        let [whole_1, drawing_1] = medians[0];
        let [faster, faster_drawing] = [whole_1 / whole, drawing_1 / drawing];
        let [whole, drawing] = [whole * 1e3, drawing * 1e3];
        println!("{count:<10}{whole:>13.1} ms{faster:>13.2}×{drawing:>11.1} ms{faster_drawing:>13.2}×");
    }
    println!("Every picture was the same bytes.");
}

fn time_picture(run: &Run) -> Times {
    let steps = Steps::default();
    let finished = picture(&run.scene, &run.view, &steps);
    let steps = steps.finish();
    assert!(finished.pixels == run.finished.pixels, "two pictures of one view differ");
    let drawing = steps.iter().filter(|step| step.name == "drawing").map(|step| step.seconds).sum();
    [steps.iter().map(|step| step.seconds).sum(), drawing]
}

fn median(times: &[Times], part: usize) -> f64 {
    let mut times: Vec<f64> = times.iter().map(|times| times[part]).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
