//! Labels from vector files: where they stand, what they say, and which are left out.

use std::fs;
use std::path::PathBuf;

use sandtable::description::parse::parse_bytes;
use sandtable::scene::SceneModel;
use sandtable::scene::assets::Assets;
use sandtable::scene::build::build;

/// A level grid of 1000 m by 1000 m at 50 m from (0, 0), and what is named on it and around it.
const PLACES: &str = r#"{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:32616"}},
"features": [
 {"type": "Feature", "properties": {"name": "Hamlet", "place": "hamlet"}, "geometry": {"type": "Point", "coordinates": [200, 300]}},
 {"type": "Feature", "properties": {"name": "Town", "place": "town", "people": 9000}, "geometry": {"type": "Point", "coordinates": [500, 400]}},
 {"type": "Feature", "properties": {"place": "town"}, "geometry": {"type": "Point", "coordinates": [600, 400]}},
 {"type": "Feature", "properties": {"name": "Far", "place": "city"}, "geometry": {"type": "Point", "coordinates": [5000, 400]}},
 {"type": "Feature", "properties": {"name": "Brook", "kind": "water"}, "geometry": {"type": "LineString", "coordinates": [[100, 100], [300, 100]]}},
 {"type": "Feature", "properties": {"name": "Brook", "kind": "water"}, "geometry": {"type": "LineString", "coordinates": [[300, 100], [9000, 100]]}},
 {"type": "Feature", "properties": {"name": "Ring", "kind": "wood"}, "geometry": {"type": "Polygon", "coordinates": [
   [[700, 700], [900, 700], [900, 900], [700, 900], [700, 700]], [[720, 720], [880, 720], [880, 880], [720, 880], [720, 720]]]}}
]}"#;

fn scene(test: &str, text: &str) -> Result<SceneModel, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("labels").join(test);
    fs::create_dir_all(&folder).expect("a folder");
    let grid = "ncols 21\nnrows 21\nxllcenter 0\nyllcenter 0\ncellsize 50\n".to_owned();
    fs::write(folder.join("level.asc"), grid + &"50 ".repeat(21 * 21)).expect("a file");
    fs::write(folder.join("places.geojson"), PLACES).expect("a file");
    let text = format!("[terrain]\ndem = \"level.asc\"\ncrs = \"EPSG:32616\"\n{text}");
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&folder.join("scene.toml"), &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

/// The texts of the labels with their places in map coordinates.
fn labels(scene: &SceneModel) -> Vec<(&str, [f32; 2])> {
    let at = |label: &sandtable::scene::SceneLabel| {
        (label.ground.truncate() + scene.lattice.origin().as_vec2()).to_array()
    };
    scene.labels.iter().map(|label| (label.text.as_str(), at(label))).collect()
}

#[test]
fn features_are_labeled_by_rank_and_what_has_no_label_is_counted() {
    let table = "[[label]]\nfile = \"places.geojson\"\nwhere = \"has(place)\"\ntext = \"name\"\n\
                 rank = \"match(place, 'city', 1, 'town', 2, 'hamlet', 5)\"\n";
    let all = scene("rank", table).expect("sound");
    assert_eq!(labels(&all), [("Town", [500.0, 400.0]), ("Hamlet", [200.0, 300.0])]);
    assert_eq!(all.labels.iter().map(|label| label.rank).collect::<Vec<_>>(), [2.0, 5.0]);
    let note = "features of 'places.geojson' without a label: 1 give no text, 1 lie off the elevation model";
    assert!(all.notes.iter().any(|told| told == note), "{:?}", all.notes);
    let one = scene("most", &format!("{table}most = 1\n")).expect("sound");
    assert_eq!(labels(&one), [("Town", [500.0, 400.0])]);
    assert!(
        one.notes.iter().any(|told| told.ends_with("2 come after the 1 that `most` allows")),
        "{:?}",
        one.notes
    );
}

#[test]
fn a_line_is_labeled_at_the_middle_of_its_longest_piece_and_a_polygon_inside() {
    let table =
        "[[label]]\nfile = \"places.geojson\"\nwhere = \"has(kind)\"\ntext = \"name\"\nkind = \"water\"\n";
    let scene = scene("shapes", table).expect("sound");
    // On the model the second piece of the brook is 700 m long; the wood is a ring of 20 m around a clearing.
    let [ring, brook] = labels(&scene)[..] else { panic!("{:?}", labels(&scene)) };
    assert_eq!(brook, ("Brook", [650.0, 100.0]));
    let inside = |at: [f32; 2]| at.iter().all(|at| (700.0..=900.0).contains(at));
    let in_clearing = ring.1.iter().all(|at| (720.0..=880.0).contains(at));
    assert!(ring.0 == "Ring" && inside(ring.1) && !in_clearing, "{ring:?}");
}

#[test]
fn a_text_may_name_properties_and_the_height() {
    let table = "[[label]]\nfile = \"places.geojson\"\nwhere = { place = [\"town\", \"hamlet\"] }\n\
                 text = \"'{name}: {people} at {height} m {'\"\nrank = 3\n";
    let scene = scene("text", table).expect("sound");
    assert_eq!(labels(&scene), [("Town: 9000 at 50 m {", [500.0, 400.0])], "the hamlet has no `people`");
}

#[test]
fn a_label_has_either_a_place_or_a_file() {
    for (keys, wanted) in [
        ("text = \"a\"\nat = [0, 0]\nfile = \"places.geojson\"\n", "[[label]] has both `at` and `file`"),
        ("text = \"a\"\n", "[[label]] has neither `at` nor `file`"),
        ("text = \"a\"\nat = [0, 0]\nmost = 3\n", "`most` has no effect on a label without a `file`"),
        ("text = \"a b\"\nfile = \"places.geojson\"\n", "scene.toml:5:11"),
        (
            "text = \"a\"\nfile = \"places.geojson\"\nwhere = \"place = 'x'\"\n",
            "no feature of 'places.geojson' matches",
        ),
        (
            "text = \"a\"\nfile = \"places.geojson\"\nmost = 0\n",
            "`most` must be a whole number from 1 to 4096",
        ),
    ] {
        let refused = scene("refused", &format!("[[label]]\n{keys}")).map(|_| ()).expect_err("it is refused");
        assert!(refused.contains(wanted), "{wanted} in\n{refused}");
    }
}
