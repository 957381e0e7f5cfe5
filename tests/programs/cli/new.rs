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
    assert!(refused.contains("scene/scene.toml: this file exists already"), "{refused}");
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
        (["--dem", "data/notes.txt"], "scene.toml:3:7: error[unreadable-file]: "),
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
        "title = \"Swellendam\"",
        "\nnodata = 0\n",
        "# Places (5).\n[[label]]\nfile = ",
        "\nmost = 15\n",
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
fn a_scene_of_a_web_mercator_model_shows_what_its_cameras_name() {
    let Some(dem) = data("dem/tin_valid_raster_3857.tif") else { return };
    let scratch = Scratch::new();
    let folder = scratch.at("scene");
    let arguments = ["new".as_ref(), folder.as_os_str(), "--dem".as_ref(), dem.as_os_str()];
    let out = run_in(scratch.folder(), &arguments).ok();
    let text = std::fs::read_to_string(scratch.at("scene/scene.toml")).expect("it was written");
    // Inline points stay in the system of the file, whose lengths are not those of the ground.
    assert!(text.contains("in the scene's coordinate system, EPSG:3857,"), "{text}");
    assert!(text.contains("shows = [[-136"), "{text}");
    assert!(out.contains("cameras   overview, relief"), "{out}");
}

#[test]
fn a_scene_is_named_after_its_place_and_cut_to_what_stands_in_it() {
    let scratch = Scratch::new();
    let post =
        |column: i32, row: i32| 300.0 + 50.0 * (f64::from(column) * 0.1).sin() * (f64::from(row) * 0.1).cos();
    let heights = (0..200).flat_map(|row| (0..200).map(move |column| format!("{:.1}", post(column, row))));
    let grid = "ncols 200\nnrows 200\nxllcorner 500000\nyllcorner 4000000\ncellsize 50\n".to_owned();
    let grid = grid + &heights.collect::<Vec<_>>().join(" ");
    scratch.write("project/data/valley.asc", grid);
    let feature = |properties: &str, kind: &str, at: &str| {
        format!(
            r#"{{"type": "Feature", "properties": {properties}, "geometry": {{"type": "{kind}", "coordinates": {at}}}}}"#
        )
    };
    let features = [
        feature(r#"{"place": "hamlet", "name": "Nook"}"#, "Point", "[503900, 4004000]"),
        feature(r#"{"place": "town", "name": "Beyond"}"#, "Point", "[700000, 4004000]"),
        feature(r#"{"natural": "peak", "name": "Horn", "ele": 341}"#, "Point", "[505000, 4005000]"),
        feature(r#"{"highway": "residential"}"#, "LineString", "[[503000, 4003500], [506000, 4006000]]"),
        feature(r#"{"route": "ferry"}"#, "LineString", "[[503000, 4003500], [509900, 4009900]]"),
        feature(
            r#"{"boundary": "administrative", "admin_level": "6", "name": "The Shire"}"#,
            "Polygon",
            "[[[400000, 3900000], [600000, 3900000], [600000, 4100000], [400000, 4100000], [400000, 3900000]]]",
        ),
    ];
    let collection = |features: &[String]| {
        let crs = r#""crs": {"type": "name", "properties": {"name": "EPSG:32616"}}"#;
        format!(r#"{{"type": "FeatureCollection", {crs}, "features": [{}]}}"#, features.join(", "))
    };
    // One kind of shape a file, as most have.
    scratch.write("project/data/points.geojson", collection(&features[..3]));
    scratch.write("project/data/lines.geojson", collection(&features[3..5]));
    scratch.write("project/data/shire.geojson", collection(&features[5..]));
    new(&scratch, &["--vectors", "data/points.geojson", "data/lines.geojson"]).ok();
    let text = text_of(&scratch);
    for wanted in [
        "title = \"Nook\"",
        "# Peaks (1).\n[[label]]",
        "text = \"if(has(ele), '{name}\\n{ele} m', name)\"",
        "most = 10",
        "# where = \"route = 'ferry'\"\n",
        "#   route = \"ferry\"\n",
    ] {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
    std::fs::remove_dir_all(scratch.at("project/scene")).expect("it was written");
    new(&scratch, &["--vectors", "data/points.geojson", "data/shire.geojson"]).ok();
    assert!(
        text_of(&scratch).contains("title = \"The Shire\""),
        "of a hamlet the district\n{}",
        text_of(&scratch)
    );
    std::fs::remove_dir_all(scratch.at("project/scene")).expect("it was written");
    new(&scratch, &[]).ok();
    assert!(
        text_of(&scratch).contains("title = \"36.19° N 86.94° W\""),
        "a file's name is no place\n{}",
        text_of(&scratch)
    );
}

#[test]
fn a_layer_without_properties_is_taken_for_what_its_name_says() {
    let Some(folder) = data("scenes/taunton_uk") else { return };
    let scratch = Scratch::new();
    let vectors = ["buildings.shp", "lines.shp", "trees.shp"].map(|name| folder.join(name));
    let vectors: Vec<&Path> = vectors.iter().map(|path| path.as_path()).collect();
    let (text, _) = of_data(&scratch, &folder.join("dtm.tif"), &vectors);
    for wanted in [
        "title = \"51.06° N 3.12° W\"",
        "# Buildings (401).\n[[building]]",
        "# Lines: of no known kind (4 lines).\n[[overlay]]\nname = \"Lines\"\n",
        "# Trees: of no known kind (52 points).\n[[model]]\n",
        "#   Tree_speci = \"CEDAR OF LEBANON\"",
    ] {
        assert!(text.contains(wanted), "{wanted} in\n{text}");
    }
}

#[test]
fn a_raster_of_land_cover_becomes_an_area_wherever_it_is_named() {
    let cover = bytes_of("tests/features/land_cover/corine.tif");
    for option in ["--vectors", "--dem"] {
        let scratch = valley();
        scratch.write("project/data/cover.tif", &cover);
        // Of elevation the files are one list.
        let files = if option == "--dem" { vec!["data/cover.tif"] } else { vec![option, "data/cover.tif"] };
        let dem = ["new", "scene", "--crs", "EPSG:32616", "--dem", "data/valley.asc"];
        run_in(&scratch.at("project"), &[&dem[..], &files].concat()).ok();
        let text = text_of(&scratch);
        let wanted = "# Land cover by CORINE Land Cover. Its water has no cover: lakes, rivers and coasts draw it.\n[[area]]\n\
                      file = \"../data/cover.tif\"\nwhere = \"cover\"\ncover = \"(cover)\"\n";
        assert!(text.contains(wanted) && text.contains("dem = \"../data/valley.asc\""), "{text}");
    }
    let scratch = valley();
    scratch.write("project/data/cover.tif", &cover);
    let refused = run_in(&scratch.at("project"), &["new", "scene", "--dem", "data/cover.tif"]).failed(1);
    assert!(refused.contains("data/cover.tif: this is land cover and no elevation"), "{refused}");
}

/// Ground that falls from 20 m in the north to −28 m in the south, and a coastline across it.
#[test]
fn a_coastline_through_ground_with_the_depths_of_the_sea_states_its_level() {
    let scratch = Scratch::new();
    let row = |row: u32| format!("{} ", 20.0 - f64::from(row)).repeat(49);
    let rows: Vec<String> = (0..49).map(row).collect();
    let grid = "ncols 49\nnrows 49\nxllcorner 500000\nyllcorner 4000000\ncellsize 10\n";
    scratch.write("project/data/shelf.asc", format!("{grid}{}", rows.join("\n")));
    let line = |kind: &str, north: f64| {
        format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::32616"}}}},
            "features":[{{"type":"Feature","properties":{{"natural":"{kind}"}},"geometry":{{"type":"LineString",
            "coordinates":[[500010,{north}],[500400,{north}]]}}}}]}}"#
        )
    };
    for (kind, north, is_sea) in
        [("coastline", 4_000_285.0, true), ("coastline", 4_900_000.0, false), ("cliff", 4_000_285.0, false)]
    {
        scratch.write("project/data/coast.geojson", line(kind, north));
        let arguments = ["new", "scene", "--dem", "data/shelf.asc", "--crs", "EPSG:32616"];
        let more = ["--vectors", "data/coast.geojson"];
        run_in(&scratch.at("project"), &[&arguments[..], &more].concat()).ok();
        assert_eq!(text_of(&scratch).contains("\nsea_level = 0\n"), is_sea, "{kind} {north}");
        let check = run_in(&scratch.at("project"), &["check", "scene/scene.toml"]);
        // A coast far off the model is an error there, as everything far off it.
        assert_eq!(check.code == 0, north < 4_100_000.0, "{check:?}");
        std::fs::remove_dir_all(scratch.at("project/scene")).expect("removed");
    }
}

#[test]
fn layers_of_the_sea_and_of_land_as_polygons_are_coasts() {
    let scratch = Scratch::new();
    let row = |row: u32| format!("{} ", (30.0 - f64::from(row)).max(0.0)).repeat(49);
    let rows: Vec<String> = (0..49).map(row).collect();
    let grid = "ncols 49\nnrows 49\nxllcorner 500000\nyllcorner 4000000\ncellsize 10\n";
    scratch.write("project/data/bay.asc", format!("{grid}{}", rows.join("\n")));
    let polygon = |properties: &str, south: f64, north: f64| {
        format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::32616"}}}},
            "features":[{{"type":"Feature","properties":{properties},"geometry":{{"type":"Polygon","coordinates":
            [[[499000,{south}],[501000,{south}],[501000,{north}],[499000,{north}],[499000,{south}]]]}}}}]}}"#
        )
    };
    for (file, properties, inside) in [
        ("water_polygons", r#"{"x": 3, "y": 7}"#, "sea"),
        ("ne_10m_ocean", r#"{"featurecla": "Ocean"}"#, "sea"),
        ("land_polygons", r#"{"FID": 7}"#, "land"),
        ("land", r#"{"featurecla": "Land"}"#, "land"),
    ] {
        let [south, north] = if inside == "sea" { [3.999e6, 4.000_203e6] } else { [4.000_203e6, 4.001e6] };
        let vectors = format!("data/{file}.geojson");
        scratch.write(&format!("project/{vectors}"), polygon(properties, south, north));
        let arguments = ["new", "scene", "--dem", "data/bay.asc", "--crs", "EPSG:32616", "--vectors"];
        run_in(&scratch.at("project"), &[&arguments[..], &[&vectors]].concat()).ok();
        let text = text_of(&scratch);
        assert!(text.contains("[[coast]]") && text.contains(&format!("inside = \"{inside}\"\n")), "{text}");
        let check = run_in(&scratch.at("project"), &["check", "scene/scene.toml"]);
        assert_eq!(check.code, 0, "{file}: {check:?}");
        std::fs::remove_dir_all(scratch.at("project/scene")).expect("removed");
    }
}
