//! Labels from vector files: where they stand, what they say, and which are left out.

use std::fs;
use std::path::PathBuf;

use sandtable_description::parse::parse_bytes;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::label_course::LabelCourse;
use sandtable_scene::scene_model::SceneModel;

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
    let at = |label: &sandtable_scene::scene_label::SceneLabel| {
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
    assert!(all.notes().contains(&note), "{:?}", all.notes());
    let one = scene("most", &format!("{table}most = 1\n")).expect("sound");
    assert_eq!(labels(&one), [("Town", [500.0, 400.0])]);
    assert!(
        one.notes().iter().any(|told| told.ends_with("2 come after the 1 that `most` allows")),
        "{:?}",
        one.notes()
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

#[test]
fn names_follow_lines_and_areas_and_pieces_of_one_name_are_one_line() {
    let table =
        "[[label]]\nfile = \"places.geojson\"\nwhere = \"has(kind)\"\ntext = \"name\"\nkind = \"water\"\n";
    let built = scene("course", table).expect("sound");
    let course = |name: &str| &built.labels.iter().find(|label| label.text == name).expect("named").course;
    let LabelCourse::Along(lines) = course("Brook") else { panic!("a line") };
    assert_eq!(lines.len(), 1, "two pieces that meet");
    let ends = [lines[0][0].x, lines[0][lines[0].len() - 1].x];
    assert_eq!((ends[0], ends[1]), (100.0, 1000.0), "up to the border of the ground");
    assert!(matches!(course("Ring"), LabelCourse::Across(rings) if rings.len() == 1));
    let led = scene("led", &format!("{table}height = 20\n")).expect("sound");
    assert!(led.labels.iter().all(|label| label.course == LabelCourse::Place), "they are wished above");
}

#[test]
fn a_font_is_read_and_what_is_none_is_refused_by_name() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("labels").join("font");
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("han.ttf"), include_bytes!("../fonts/han.ttf")).expect("a file");
    fs::write(folder.join("web.woff2"), b"wOF2\0\x01\0\0").expect("a file");
    fs::write(folder.join("notes.ttf"), b"not a font").expect("a file");
    assert!(scene("font", "").expect("sound").font.is_none());
    let with = |font: &str| {
        let grid = "ncols 21\nnrows 21\nxllcenter 0\nyllcenter 0\ncellsize 50\n".to_owned();
        fs::write(folder.join("level.asc"), grid + &"50 ".repeat(21 * 21)).expect("a file");
        let text = format!("font = \"{font}\"\n[terrain]\ndem = \"level.asc\"\ncrs = \"EPSG:32616\"\n");
        let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
        let assets = Assets::new(&folder.join("scene.toml"), &[]).expect("the folder is there");
        build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
    };
    assert!(with("han.ttf").expect("sound").font.is_some());
    for (font, cause) in [
        ("web.woff2", "'web.woff2' is not used as a font: it is a web font"),
        ("notes.ttf", "'notes.ttf' is not used as a font: it is no TrueType"),
        ("gone.ttf", "there is no file"),
    ] {
        let error = with(font).err().expect("no font");
        assert!(error.contains(cause), "{error}");
    }
}

#[test]
fn spot_heights_are_those_of_summits_saddles_and_lakes_without_a_label() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("labels").join("spots");
    fs::create_dir_all(&folder).expect("a folder");
    // Two hills of 200 m and 160 m with a saddle of 80 m between them.
    let height = |n: usize| {
        let (x, y) = ((n % 41) as f64, (n / 41) as f64);
        let cone = |cx: f64, top: f64| top - 10.0 * (x - cx).hypot(y - 20.0);
        cone(12.0, 200.0).max(cone(28.0, 160.0)).max(0.0)
    };
    let heights: Vec<String> = (0..41 * 41).map(|n| height(n).to_string()).collect();
    let grid = "ncols 41\nnrows 41\nxllcenter 0\nyllcenter 0\ncellsize 50\n".to_owned();
    fs::write(folder.join("hills.asc"), grid + &heights.join(" ")).expect("a file");
    let built = |more: &str| {
        let text = format!(
            "[terrain]\ndem = \"hills.asc\"\ncrs = \"EPSG:32616\"\n[style]\nspot_heights = 9\n{more}"
        );
        let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
        let assets = Assets::new(&folder.join("scene.toml"), &[]).expect("the folder is there");
        build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
    };
    let texts = |scene: &SceneModel| scene.labels.iter().map(|label| label.text.clone()).collect::<Vec<_>>();
    assert_eq!(texts(&built("").expect("sound")), ["200", "160", "100"]);
    let named = "[[label]]\ntext = \"Big Hill\"\nat = [600, 1000]\nkind = \"summit\"\n";
    assert_eq!(texts(&built(named).expect("sound")), ["Big Hill", "160", "100"]);
}
