//! The demonstration's data: the committed files are what their elevation model gives, and make sense; every
//! scene file reads as a description and names files that are there.

use std::path::{Path, PathBuf};

use geojson::{FeatureCollection, GeometryValue};
use glam::DVec2;
use jacksboro::flow::{Flow, NONE};
use jacksboro::ground::Ground;
use jacksboro::{lakes, line, network, samples};

#[path = "../tools/jacksboro/mod.rs"]
mod jacksboro;

fn folder(path: &str) -> PathBuf {
    Path::new(env!("SANDTABLE_ROOT")).join(path)
}

fn text(path: &str) -> String {
    std::fs::read_to_string(folder(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn ground() -> Ground {
    Ground::read(
        &std::fs::read(folder("assets/jacksboro/dem.tif")).expect("the elevation model is committed"),
    )
}

/// The lines of a committed file in the metric frame, each with its property of the given name.
fn lines(ground: &Ground, path: &str, property: &str) -> Vec<(String, Vec<DVec2>)> {
    let collection: FeatureCollection = text(path).parse().expect("a feature collection");
    let features = collection.features.into_iter().map(|feature| {
        let label = feature.property(property).map(ToString::to_string).unwrap_or_default();
        let positions: Vec<Vec<f64>> = match feature.geometry.expect("a geometry").value {
            GeometryValue::LineString { coordinates } => {
                coordinates.iter().map(|p| p.as_slice().to_vec()).collect()
            }
            GeometryValue::Polygon { coordinates } => {
                coordinates[0].iter().map(|p| p.as_slice().to_vec()).collect()
            }
            other => panic!("{path}: {other:?} is neither line nor polygon"),
        };
        let place = |at: &Vec<f64>| ground.locate(at[0], at[1]);
        (label.trim_matches('"').to_string(), positions.iter().map(place).collect())
    });
    features.collect()
}

fn crosses_itself(points: &[DVec2]) -> bool {
    let sides: Vec<(DVec2, DVec2)> = points.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let closed = points[0] == points[points.len() - 1];
    (0..sides.len()).any(|at| {
        (at + 2..sides.len())
            .filter(|&other| !(closed && at == 0 && other + 1 == sides.len()))
            .any(|other| line::crossing(sides[at], sides[other]).is_some())
    })
}

#[test]
fn the_committed_files_are_what_the_elevation_model_gives() {
    let derived = jacksboro::derive(&ground());
    for (name, made) in [
        ("streams.geojson", derived.streams),
        ("lake.geojson", derived.lakes),
        ("roads.geojson", derived.roads),
        ("valley.asc", derived.valley),
    ] {
        let committed = text(&format!("assets/jacksboro/{name}"));
        assert!(committed == made, "{name} differs; run `cargo run --example derive-jacksboro` and look");
    }
    assert!(derived.notes.iter().any(|note| note.starts_with("Powell Valley road over Big Creek")));
    let hills = image::open(folder("assets/jacksboro/hills.png")).expect("hills.png reads").into_luma16();
    assert_eq!(hills.into_raw(), samples::hills());
}

#[test]
fn cross_mountain_stands_where_it_is() {
    let ground = ground();
    let top = (0..ground.z.len()).max_by(|&a, &b| ground.z[a].total_cmp(&ground.z[b])).expect("posts");
    let place = ground.lon_lat(ground.place(top));
    assert_eq!(ground.z[top], 1076.0);
    assert!(place.distance(DVec2::new(-84.23056, 36.19833)) < 0.0005, "{place}");
}

#[test]
fn water_never_runs_uphill() {
    let ground = ground();
    let lakes = lakes::find(&ground);
    let flow = Flow::over(&ground, &lakes.water);
    for post in (0..ground.z.len()).filter(|&post| flow.down[post] != NONE) {
        assert!(flow.filled[flow.down[post]] <= flow.filled[post], "post {post}");
        assert!(flow.area_km2[flow.down[post]] > flow.area_km2[post], "post {post}");
    }
}

#[test]
fn streams_fall_from_end_to_end() {
    let ground = ground();
    for (order, points) in lines(&ground, "assets/jacksboro/streams.geojson", "order") {
        let fall = ground.at(points[0]) - ground.at(points[points.len() - 1]);
        // Where the flood crossed a depression the raw ground rises again: behind the dams by thirty meters.
        assert!(fall > -12.0, "a stream of order {order} rises {:.0} m", -fall);
    }
}

#[test]
fn shores_are_simple_and_lie_at_the_level_but_for_the_dams() {
    let ground = ground();
    for (level, shore) in lines(&ground, "assets/jacksboro/lake.geojson", "level_m") {
        let level: f64 = level.parse().expect("a level");
        assert_eq!(shore[0], shore[shore.len() - 1]);
        assert!(line::signed_area(&shore[1..]) > 1e5);
        assert!(!crosses_itself(&shore));
        let mut off: Vec<f64> = shore.iter().map(|&at| (ground.at(at) - level).abs()).collect();
        off.sort_by(f64::total_cmp);
        assert!(off[off.len() / 2] < 2.0, "half the shore is within {:.1} m", off[off.len() / 2]);
    }
}

#[test]
fn roads_keep_their_grade_and_do_not_cross_themselves() {
    let ground = ground();
    for (class, points) in lines(&ground, "assets/jacksboro/roads.geojson", "class") {
        let limit = match class.as_str() {
            "valley" => 0.10,
            "pass" => 0.20,
            _ => 0.25,
        };
        let steepest = network::steepest_grade(&ground, &points, 200.0);
        assert!(steepest < limit, "{class}: {:.1} %", steepest * 100.0);
        assert!(!crosses_itself(&points), "{class}");
    }
}

#[test]
fn every_branching_road_begins_on_a_vertex_of_another() {
    let ground = ground();
    let roads = lines(&ground, "assets/jacksboro/roads.geojson", "name");
    for (name, points) in &roads[1..] {
        let joins = roads.iter().any(|(other, line)| other != name && line.contains(&points[0]));
        assert!(joins, "{name}");
    }
}

#[test]
fn every_scene_reads_and_names_files_that_are_there() {
    let mut scenes: Vec<PathBuf> = std::fs::read_dir(folder("scenes"))
        .expect("there are scenes")
        .map(|entry| entry.expect("a scene").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    scenes.sort();
    assert!(scenes.len() >= 8);
    for path in scenes {
        let written = std::fs::read_to_string(&path).expect("a scene reads");
        assert!(written.starts_with("# "), "{path:?} opens with what it shows");
        let document: toml::Table = written.parse().unwrap_or_else(|error| panic!("{path:?}: {error}"));
        assert!(document.contains_key("camera"), "{path:?} has a camera");
        let is_built_in = |file: &String| sandtable_model::built_in::NAMES.contains(&file.as_str());
        for file in files(&document).into_iter().filter(|file| !is_built_in(file)) {
            let place = path.parent().expect("a folder").join(&file);
            // The models come from a room of their own; where they are, they must all be.
            let models = place.parent().is_some_and(|folder| folder.ends_with("models") && !folder.exists());
            assert!(models || place.exists(), "{path:?} names {file}, which is not there");
        }
    }
}

/// The value of every `file` and `dem` key.
fn files(document: &toml::Table) -> Vec<String> {
    let within = document.iter().flat_map(|(key, value)| match value {
        toml::Value::String(file) if key == "file" || key == "dem" => vec![file.clone()],
        toml::Value::Table(table) => files(table),
        toml::Value::Array(list) => list.iter().filter_map(toml::Value::as_table).flat_map(files).collect(),
        _ => Vec::new(),
    });
    within.collect()
}
