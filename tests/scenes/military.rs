//! Military symbols of a scene: from points and from files, and what is told of those that are not drawn.

use std::fs;
use std::path::PathBuf;

use sandtable_description::parse::parse_bytes;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;

/// On a level grid of 1000 m by 1000 m from (0, 0).
const UNITS: &str = r#"{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:32616"}},
"features": [
 {"type": "Feature", "properties": {"code": "10031000161211020000", "unit": "1-33", "to": 90}, "geometry": {"type": "Point", "coordinates": [200, 300]}},
 {"type": "Feature", "properties": {"code": "SHGPUCA----F---", "unit": "3"}, "geometry": {"type": "Point", "coordinates": [500, 400]}},
 {"type": "Feature", "properties": {"code": "10031500009999000000"}, "geometry": {"type": "Point", "coordinates": [600, 400]}},
 {"type": "Feature", "properties": {"code": "10091000161211020000"}, "geometry": {"type": "Point", "coordinates": [600, 500]}},
 {"type": "Feature", "properties": {"code": "10031000161211020000"}, "geometry": {"type": "Point", "coordinates": [9000, 500]}}
]}"#;

fn scene(test: &str, text: &str) -> Result<SceneModel, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("military").join(test);
    fs::create_dir_all(&folder).expect("a folder");
    let grid = "ncols 21\nnrows 21\nxllcenter 0\nyllcenter 0\ncellsize 50\n".to_owned();
    fs::write(folder.join("level.asc"), grid + &"50 ".repeat(21 * 21)).expect("a file");
    fs::write(folder.join("units.geojson"), UNITS).expect("a file");
    let text = format!("[terrain]\ndem = \"level.asc\"\ncrs = \"EPSG:32616\"\n{text}");
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&folder.join("scene.toml"), &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

#[test]
fn features_of_a_file_are_symbols_and_those_without_one_are_counted() {
    let table = "[[symbol]]\nfile = \"units.geojson\"\nsidc = \"code\"\nunique_designation = \"unit\"\n\
                 higher_formation = \"'2'\"\ndirection = \"to\"\n";
    let scene = scene("file", table).expect("sound");
    let names: Vec<&str> = scene.military.iter().map(|symbol| symbol.name.as_str()).collect();
    assert_eq!(names, ["1-33/2", "3/2", "10031500009999000000"]);
    assert_eq!(scene.military[0].direction_rad, Some(90.0f32.to_radians()));
    assert_eq!(scene.military[1].direction_rad, None);
    assert_eq!(scene.military[0].texts.len(), 2);
    let told = |start: &str, part: &str| {
        assert!(
            scene.notes().iter().any(|note| note.starts_with(start) && note.contains(part)),
            "{:?}",
            scene.notes()
        );
    };
    told("symbol 10031500009999000000", "999900 of the set 15 (land equipment) is not drawn");
    told(
        "features of 'units.geojson' without a symbol: 1 (the first: digit 4",
        "1 lie off the elevation model",
    );
}

#[test]
fn a_wrong_code_is_pointed_at_in_the_scene_file() {
    let message = |code: &str| {
        let table = format!("[[symbol]]\nsidc = \"{code}\"\nat = [500, 500]\n");
        scene("wrong", &table).err().expect("no symbol")
    };
    let wrong = message("10039900161211020000");
    assert!(wrong.contains("scene.toml:5:8") && wrong.contains("digits 5-6"), "{wrong}");
    assert!(message("10032500001403000000").contains("has no symbols with frames"));
    assert!(message("1003").contains("20 or 30 digits, or 15 letters"));
    let both = scene("both", "[[symbol]]\nsidc = \"10031000161211020000\"\n").err().expect("no place");
    assert!(both.contains("add `at = [x, y]`"), "{both}");
}
