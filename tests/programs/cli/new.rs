//! `sandtable new`: a first scene that renders at once.

use std::path::Path;

use crate::cli::{bytes_of, run_in};
use crate::common::data::data;
use crate::common::scratch::Scratch;

/// The valley's elevation and its streams, in `project/data`.
fn valley() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("project/data/valley.asc", bytes_of("assets/jacksboro/valley.asc"));
    scratch.write("project/data/streams.geojson", bytes_of("assets/jacksboro/streams.geojson"));
    scratch
}

fn new(scratch: &Scratch, more: &[&str]) -> crate::cli::Ran {
    let arguments = ["new", "scene", "--dem", "data/valley.asc", "--crs", "EPSG:32616"];
    run_in(&scratch.at("project"), &[&arguments, more].concat())
}

fn text_of(scratch: &Scratch) -> String {
    std::fs::read_to_string(scratch.at("project/scene/scene.toml")).expect("it was written")
}

#[test]
fn a_new_scene_is_sound_says_how_to_render_it_and_renders() {
    let scratch = valley();
    let out = new(&scratch, &["--vectors", "data/streams.geojson", "--title", "The \"valley\""]).ok();
    assert!(out.starts_with("scene/scene.toml\n  ground "), "{out}");
    assert!(out.ends_with("to render it:\n  sandtable render scene/scene.toml\n"), "{out}");
    let text = text_of(&scratch);
    for wanted in [
        "title = \"The \\\"valley\\\"\"",
        "dem = \"../data/valley.asc\"",
        "crs = \"EPSG:32616\"",
        "interval = 50",
        "file = \"../data/streams.geojson\"",
        "\nwidth = 3\n",
        "[[camera]]",
    ] {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
    let rendered =
        run_in(&scratch.at("project"), &["render", "scene/scene.toml", "-o", "out.png", "--size", "96x64"]);
    assert!(rendered.ok().starts_with("out.png\n"));
}

#[test]
fn a_scene_that_is_there_is_not_written_over() {
    let scratch = valley();
    scratch.write("project/scene/scene.toml", "mine");
    let refused = new(&scratch, &[]).failed(1);
    assert!(refused.contains("scene/scene.toml: there is such a file already"), "{refused}");
    assert_eq!(text_of(&scratch), "mine");
}

#[test]
fn data_elsewhere_is_allowed_by_the_command_that_is_told() {
    let scratch = valley();
    let folder = scratch.at("project/data");
    let folder = folder.to_str().expect("text");
    let dem = format!("{folder}/valley.asc");
    let out =
        run_in(&scratch.at("project"), &["new", "far/off/scene", "--dem", &dem, "--crs", "EPSG:32616"]).ok();
    let told = format!("  sandtable render far/off/scene/scene.toml --allow {folder}\n");
    assert!(out.ends_with(&told), "{told} in\n{out}");
    let checked = run_in(&scratch.at("project"), &["check", "far/off/scene/scene.toml", "--allow", folder]);
    assert!(checked.ok().contains("is sound"));
    let refused = run_in(&scratch.at("project"), &["check", "far/off/scene/scene.toml"]).failed(1);
    assert!(refused.contains("--allow"), "{refused}");
}

#[test]
fn what_cannot_be_read_leaves_no_folder_behind() {
    let scratch = valley();
    scratch.write("project/data/notes.txt", "no elevation");
    let folder = scratch.at("project");
    for (arguments, wanted) in [
        (["--dem", "data/none.tif"], "data/none.tif: there is no such file"),
        (["--dem", "data/notes.txt"], "scene.toml:3:7: error: "),
        (["--dem", "data"], "data: this is not a file"),
    ] {
        let refused = run_in(&folder, &[["new", "scene"], arguments].concat()).failed(1);
        assert!(refused.contains(wanted), "{wanted} in\n{refused}");
        assert!(!scratch.at("project/scene").exists(), "{wanted}");
    }
    let refused = run_in(&folder, &["new", "data/notes.txt", "--dem", "data/valley.asc"]).failed(1);
    assert!(refused.contains("this is not a folder"), "{refused}");
    assert!(run_in(&folder, &["new", "scene"]).failed(2).contains("--dem"));
}

/// A new scene of shared data; returns its text and what was printed.
fn of_data(scratch: &Scratch, dem: &Path, vectors: &[&Path]) -> (String, String) {
    let mut arguments = vec!["new".into(), scratch.at("scene").into_os_string(), "--dem".into(), dem.into()];
    arguments.push("--vectors".into());
    arguments.extend(vectors.iter().map(|file| file.as_os_str().to_owned()));
    let out = run_in(scratch.folder(), &arguments).ok();
    (std::fs::read_to_string(scratch.at("scene/scene.toml")).expect("it was written"), out)
}

#[test]
fn swellendam_becomes_roads_rivers_lakes_and_buildings() {
    let Some(folder) = data("scenes/swellendam_za") else { return };
    let scratch = Scratch::new();
    let vectors =
        ["training_data.gpkg", "rivers.shp", "water.shp", "places.shp"].map(|name| folder.join(name));
    let vectors: Vec<&Path> = vectors.iter().map(|path| path.as_path()).collect();
    let (text, out) = of_data(&scratch, &folder.join("dem_srtm_wgs84_f32.tif"), &vectors);
    for wanted in [
        "# Rivers (20).",
        "# Lakes (37).",
        "# Main roads (74).",
        "# Country roads (36).",
        "# Buildings (4708).",
        "layer = \"roads\"",
        "# In no table of this file (5 points)",
    ] {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
    assert!(!text.contains("restaurants"), "they are among the buildings\n{text}");
    assert!(out.contains(" roads") && out.contains("--allow"), "{out}");
}

#[test]
fn the_layers_of_an_openstreetmap_extract_are_told_apart() {
    let Some(folder) = data("scenes/porto_alegre_br") else { return };
    let scratch = Scratch::new();
    let (text, out) = of_data(&scratch, &folder.join("poa_elevation.tif"), &[&folder.join("poa_osm.pbf")]);
    for wanted in ["layer = \"lines\"", "where = \"highway in (", "# Main roads (", "# Streets ("] {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
    assert!(!text.contains("layer = \"roads\""), "excerpts of other layers are not taken\n{text}");
    assert!(out.contains(" roads"), "{out}");
}

#[test]
fn a_layer_without_properties_is_taken_for_what_its_name_says() {
    let Some(folder) = data("scenes/taunton_uk") else { return };
    let scratch = Scratch::new();
    let vectors = ["buildings.shp", "lines.shp", "trees.shp"].map(|name| folder.join(name));
    let vectors: Vec<&Path> = vectors.iter().map(|path| path.as_path()).collect();
    let (text, _) = of_data(&scratch, &folder.join("dtm.tif"), &vectors);
    for wanted in ["# Buildings (401).\n[[building]]", "# In no table of this file (4 lines)", "# [[model]]"]
    {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
}
