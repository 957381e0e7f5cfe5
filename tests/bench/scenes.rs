//! `cargo bench --bench scenes`: what it costs to build what lies and stands on the ground.
//!
//! Sections, chosen by name: `growth` builds whole towns of 1, 4 and 16 times as many streets and houses; `roads` lays
//! streets alone, with what a real city of them takes; `recut` says what one dirty patch costs; `cities` builds real
//! places where their data is at hand; `tangles` builds thousands of roads that all cross, stars, and rings of a hundred
//! thousand vertices.

#[path = "scenes/cities.rs"]
mod cities;
#[path = "scenes/growth.rs"]
mod growth;
#[path = "scenes/recut.rs"]
mod recut;
#[path = "scenes/roads.rs"]
mod roads;
#[path = "common/rounds.rs"]
#[allow(dead_code, reason = "each benchmark uses its own part")]
mod rounds;
#[path = "demo/steps.rs"]
#[allow(dead_code, reason = "each benchmark uses its own part")]
mod steps;
#[path = "scenes/tangles.rs"]
mod tangles;
#[path = "../common/mod.rs"]
mod tests_common;

fn main() {
    rounds::sections(&[
        ("growth", growth::print),
        ("roads", roads::print),
        ("recut", recut::print),
        ("cities", cities::print),
        ("tangles", tangles::print),
    ]);
}

/// A scene built from a text, with the time and the peak memory of every step.
fn built(
    folder: &tests_common::scratch::Scratch,
    text: &str,
    allowed: &[std::path::PathBuf],
) -> (sandtable_scene::scene_model::SceneModel, Vec<steps::Step>) {
    let path = folder.write("scene.toml", text);
    let steps = steps::Steps::default();
    let scene = sandtable_scene::scene_file::open_scene(&path, allowed, &|step| steps.begin(step))
        .expect("a sound scene");
    (scene, steps.finish())
}

/// The seconds of the step called `name`.
fn seconds(steps: &[steps::Step], name: &str) -> f64 {
    steps.iter().filter(|step| step.name == name).map(|step| step.seconds).sum()
}

/// The worst moment's memory over all steps, in MiB.
fn peak_mib(steps: &[steps::Step]) -> f64 {
    steps.iter().filter_map(|step| step.peak_mib).fold(0.0, f64::max)
}
