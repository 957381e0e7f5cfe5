//! Every fuzz target on seeds and on mutants of them, the same in every run.

mod bodies;
mod mutants;

use std::path::Path;

use bodies::TARGETS;
use mutants::Mutants;

/// The files that a target starts from, relative to the repository; those of `tests/fuzz/seeds/TARGET` come besides.
const SEEDS: &[(&str, &[&str])] = &[
    (
        "elevation",
        &["assets/jacksboro/dem.tif", "tests/fuzz/ground/ground.asc", "assets/jacksboro/hills.png"],
    ),
    ("points", &["assets/jacksboro/points.csv", "assets/jacksboro/survey.csv"]),
    ("vectors", &["assets/jacksboro/roads.geojson", "assets/jacksboro/lake.geojson"]),
    ("models_3ds", &["assets/models/truck.3ds"]),
    ("models_obj", &["assets/models/firtree.obj", "assets/models/firtree.mtl"]),
    ("models_gltf", &["assets/models/tent.glb"]),
    ("scene_text", &["scenes/jacksboro.toml", "scenes/road.toml", "scenes/symbols.toml"]),
];

/// Bytes of seeds that are looked at: mutants of large files cost more than they find.
const LONGEST_SEED: usize = 24 << 10;

fn seeds(target: &str) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let own = root.join("tests/fuzz/seeds").join(target);
    let listed =
        std::fs::read_dir(own).into_iter().flatten().map(|entry| entry.expect("a readable folder").path());
    let named = SEEDS.iter().filter(|(of, _)| *of == target).flat_map(|(_, files)| files.iter());
    let mut paths: Vec<_> = listed.chain(named.map(|file| root.join(file))).collect();
    paths.sort();
    let read = |path: &std::path::PathBuf| {
        std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    paths
        .iter()
        .map(read)
        .map(|mut bytes| {
            bytes.truncate(LONGEST_SEED);
            bytes
        })
        .collect()
}

/// Runs a target on its seeds and on `count` mutants.
fn run(target: &str, count: usize) {
    let (_, body) = TARGETS.iter().find(|(name, _)| *name == target).expect("a target of that name");
    let seeds = seeds(target);
    seeds.iter().for_each(|seed| body(seed));
    Mutants::of(seeds).take(count).for_each(|mutant| body(&mutant));
}

#[test]
fn every_target_is_run_here_and_has_a_binary() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz");
    let manifest = std::fs::read_to_string(root.join("Cargo.toml")).expect("the manifest");
    let own = include_str!("main.rs");
    for (name, _) in TARGETS {
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name} has no binary");
        assert!(root.join(format!("targets/{name}.rs")).is_file(), "{name} has no file");
        assert!(own.contains(&format!("run(\"{name}\"")), "{name} is not run");
    }
}

#[test]
fn mutants_of_rasters_and_points_are_read_or_refused() {
    run("elevation", 300);
    run("points", 300);
}

#[test]
fn mutants_of_vectors_are_read_or_refused() {
    run("vectors", 300);
}

#[test]
fn mutants_of_models_are_read_or_refused() {
    run("models_3ds", 300);
    run("models_obj", 300);
    run("models_gltf", 200);
}

#[test]
fn mutants_of_scene_files_are_read_or_refused() {
    run("scene_text", 200);
    run("expressions", 2000);
}

#[test]
fn scenes_of_any_features_are_built_or_refused() {
    run("scene_build", 150);
}

#[test]
fn scenes_of_any_features_are_drawn() {
    run("scene_picture", 40);
}

#[test]
fn the_invariants_hold_after_any_walk_and_edits() {
    run("walk", 30);
}
