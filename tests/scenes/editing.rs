//! Edits of scene files: undone to the byte, saved whole, and with the same ground as the scene that is read again.

use std::fs;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use glam::DVec2;
use proptest::prelude::*;
use sandtable_earthworks::earthwork::dig;
use sandtable_editing::edit::{EarthworkDraft, EditPlace, EditValue, NewTable, SceneEdit};
use sandtable_editing::editor::{EditError, OnConflict, SaveError, SceneEditor};
use sandtable_editing::effect::EditEffect;
use sandtable_geom::crs::Crs;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;
use sandtable_walk::Walk;
use sandtable_walk::frame::WalkOptions;

use crate::common::scratch::Scratch;

const ROOT: &str = env!("SANDTABLE_ROOT");

/// The hills, 10 m between posts, with all that earthworks may meet.
const SCENE: &str = r#"# The hills, to be edited.

# The ground.
[terrain]
dem = "hills.png"
height_scale = 0.1   # decimeters
cell = 10

[[road]]
name = "through road"   # follows the ground
profile = "conform"
width = 11
points = [[20, 92], [320, 112], [680, 128], [1260, 92]]

# Falls to the south.
[[river]]
points = [[900, 1200], [840, 700], [880, 100]]
width = 20

[[lake]]
points = [[300, 300], [500, 300], [500, 500], [300, 500]]

[[model]]
file = "conifer"   # one tree
at = [700, 900]   # on the hill
heading = 10

[[label]]
text = "A hill"
at = [640, 640]
"#;

fn scratch(text: &str) -> Scratch {
    let scratch = Scratch::new();
    let hills = Path::new(ROOT).join("assets/jacksboro/hills.png");
    fs::copy(hills, scratch.at("hills.png")).expect("copied");
    scratch.write("scene.toml", text);
    scratch
}

fn opened(scratch: &Scratch) -> (SceneEditor, SceneModel) {
    let path = scratch.at("scene.toml");
    let editor = SceneEditor::open(&path, &[], None).unwrap_or_else(|error| panic!("{error}"));
    (editor, open_scene(&path, &[], &|_| {}).unwrap_or_else(|error| panic!("{error}")))
}

/// The scene of [`SCENE`].
static HILLS: LazyLock<SceneModel> = LazyLock::new(|| opened(&scratch(SCENE)).1);

/// An earthwork of each kind, and in places where water and roads are.
fn earthworks() -> Vec<SceneEdit> {
    let line = vec![[250.0, 60.0], [420.3, 140.0], [520.0, 400.0]];
    let crater = EarthworkDraft::Crater { radius_m: 60.0, depth_m: Some(12.5) };
    vec![
        SceneEdit::add_earthwork(&crater, vec![[500.0, 400.0], [320.0, 112.0]]),
        SceneEdit::add_earthwork(&EarthworkDraft::Trench { width_m: 40.0, depth_m: None }, line.clone()),
        SceneEdit::add_earthwork(
            &EarthworkDraft::Track { gauge_m: 60.0, rut_m: Some(30.0), depth_m: Some(2.0) },
            line.clone(),
        ),
        SceneEdit::add_earthwork(
            &EarthworkDraft::Level { level_m: None },
            vec![[800.0, 80.0], [980.0, 90.0], [900.0, 300.0]],
        ),
        SceneEdit::add_earthwork(&EarthworkDraft::Raise { height_m: 6.0, width_m: Some(20.0) }, line),
        SceneEdit::add_earthwork(
            &EarthworkDraft::Raise { height_m: 9.0, width_m: None },
            vec![[640.0, 640.0]],
        ),
    ]
}

fn is_same(a: &Lattice, b: &Lattice) -> bool {
    a.heights().len() == b.heights().len()
        && a.heights().iter().zip(b.heights()).all(|(a, b)| a.to_bits() == b.to_bits())
}

#[test]
fn ground_that_is_dug_is_that_of_the_saved_scene_bit_for_bit() {
    for exaggeration in ["", "vertical_exaggeration = 1.7\n"] {
        let scratch = scratch(&SCENE.replace("cell = 10\n", &format!("cell = 10\n{exaggeration}")));
        let (mut editor, scene) = opened(&scratch);
        let scene = Arc::new(scene);
        let mut walk = Walk::new(Arc::clone(&scene), WalkOptions::default());
        let mut done = Vec::new();
        for edit in earthworks() {
            let EditEffect::Dig(works) = editor.apply(&edit, &scene).expect("sound") else {
                panic!("{edit:?} is not done in place");
            };
            let dug = walk.edit(|lattice| dig(&works, lattice, &scene.held)).expect("in memory");
            let dug = dug.unwrap_or_else(|| panic!("{edit:?} moves no earth"));
            editor.save(OnConflict::Refuse).expect("saved");
            let reopened = open_scene(editor.source().path.as_path(), &[], &|_| {}).expect("sound");
            assert!(is_same(walk.elevations(), &reopened.lattice), "{edit:?}");
            assert!(is_same(walk.lattice(), reopened.ground().lattice()), "{edit:?}");
            let row = reopened.report.earthworks.iter().rev().take(works.len());
            let [cut, fill] = row.fold([0.0; 2], |[cut, fill], row| [cut + row.cut, fill + row.fill]);
            assert!((cut - dug.volumes.cut_m3).abs() < 1e-6 * (1.0 + cut), "{edit:?}");
            assert!((fill - dug.volumes.fill_m3).abs() < 1e-6 * (1.0 + fill), "{edit:?}");
            done.push(dug.pieces);
        }
        while editor.can_undo() {
            assert_eq!(editor.undo(), Some(EditEffect::TakeBack));
            walk.take_back(&done.pop().expect("a digging for each edit")).expect("in memory");
        }
        assert!(done.is_empty() && is_same(walk.elevations(), &scene.lattice));
        assert!(is_same(walk.lattice(), scene.ground().lattice()));
    }
}

#[test]
fn a_preview_foresees_the_earth_and_leaves_everything_as_it_was() {
    let scratch = scratch(SCENE);
    let (mut editor, scene) = opened(&scratch);
    for edit in earthworks() {
        let foreseen = editor.preview(&edit, &scene, &scene.lattice).expect("sound");
        let EditEffect::Dig(works) = editor.apply(&edit, &scene).expect("sound") else { panic!("{edit:?}") };
        let dug = dig(&works, &mut (*scene.lattice).clone(), &scene.held).volumes;
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * (1.0 + b);
        assert!(near(foreseen.cut_m3, dug.cut_m3) && near(foreseen.fill_m3, dug.fill_m3), "{edit:?}");
        assert!(foreseen.area_m2 > 1000.0 && foreseen.is_resolved, "{foreseen:?}");
        editor.undo();
    }
    let narrow = EarthworkDraft::Trench { width_m: 2.0, depth_m: None };
    let narrow = SceneEdit::add_earthwork(&narrow, vec![[600.0, 600.0], [700.0, 650.0]]);
    assert!(!editor.preview(&narrow, &scene, &scene.lattice).expect("sound").is_resolved);
    assert_eq!(editor.text(), SCENE);
}

#[test]
fn ground_that_is_leveled_for_a_model_is_built_anew() {
    let pad = "[[model]]\nfile = \"rock\"\nscale = 20\nat = [640, 640]\nfooting = \"pad\"\n";
    let scratch = scratch(&format!("{SCENE}\n{pad}"));
    let (mut editor, scene) = opened(&scratch);
    let crater = |at: [f64; 2]| {
        SceneEdit::add_earthwork(&EarthworkDraft::Crater { radius_m: 30.0, depth_m: None }, vec![at])
    };
    assert_eq!(editor.apply(&crater([700.0, 640.0]), &scene).expect("sound"), EditEffect::Rebuild);
    let far = editor.apply(&crater([60.0, 1200.0]), &scene);
    assert!(matches!(far, Ok(EditEffect::Rebuild | EditEffect::Dig(_))));
}

#[test]
fn a_model_is_moved_and_turned_and_comes_back() {
    let scratch = scratch(SCENE);
    let (mut editor, scene) = opened(&scratch);
    let place = editor.place_of_model(0, &scene).expect("its table");
    assert_eq!(place, EditPlace::table("model", 0));
    let effect = editor.apply(&SceneEdit::move_model(0, [710.5, 890.25]), &scene).expect("sound");
    let EditEffect::Move(moved) = effect else { panic!("{effect:?}") };
    assert_eq!((moved.placement, moved.at.to_array()), (0, [710.5, 890.25]));
    let effect = editor.apply(&SceneEdit::turn_model(0, 90.0), &scene).expect("sound");
    let EditEffect::Move(turned) = effect else { panic!("{effect:?}") };
    assert!((turned.heading_rad - 90f32.to_radians()).abs() < 1e-6 && turned.at == moved.at);
    let built = editor.source().build(&|_| ()).expect("sound");
    assert_eq!((built.placements[0].at, built.placements[0].heading_rad), (turned.at, turned.heading_rad));
    let text = SCENE.replace("at = [700, 900]", "at = [710.5, 890.25]");
    assert_eq!(editor.text(), text.replace("heading = 10", "heading = 90"));
    editor.undo();
    let Some(EditEffect::Move(back)) = editor.undo() else { panic!("a model comes back") };
    assert_eq!((back.at, back.heading_rad), (scene.placements[0].at, scene.placements[0].heading_rad));
    assert_eq!(editor.place_of_label(0, &scene), Some(EditPlace::table("label", 0)));
    assert_eq!(editor.text(), SCENE);
}

#[test]
fn an_edit_that_would_spoil_the_scene_is_refused_with_its_reason() {
    let scratch = scratch(SCENE);
    let (mut editor, scene) = opened(&scratch);
    let few = SceneEdit::add_road(vec![[1.0, 2.0]], 6.0);
    let error = editor.apply(&few, &scene).expect_err("a road needs two points");
    let EditError::Wrong(diagnostics) = &error else { panic!("{error:?}") };
    assert!(diagnostics.to_string().contains("has 1 of the 2 points"), "{diagnostics}");
    let removed = editor.apply(&SceneEdit::Remove(EditPlace::table("road", 1)), &scene);
    assert!(removed.expect_err("there is one").to_string().contains("no [[road]] number 2"));
    let infinite = editor.apply(&SceneEdit::move_model(0, [f64::NAN, 0.0]), &scene);
    assert!(infinite.is_err());
    assert!(!editor.is_changed() && !editor.can_undo() && editor.text() == SCENE);
}

#[test]
fn places_are_written_in_the_system_of_the_file() {
    let text = "points_crs = \"EPSG:4326\"\n\n[terrain]\ndem = \"dem.tif\"\n\n[[model]]\nfile = \"rock\"\n\
        at = [750000, 4018000]\ncrs = \"EPSG:32616\"\n";
    let scratch = scratch(text);
    fs::copy(Path::new(ROOT).join("assets/jacksboro/dem.tif"), scratch.at("dem.tif")).expect("copied");
    let (mut editor, scene) = opened(&scratch);
    let at = DVec2::new(750_123.0, 4_017_500.5);
    editor.apply(&SceneEdit::add_label("Here", at.to_array(), "point"), &scene).expect("sound");
    let stated = **editor.document().labels[0].at.as_ref().expect("stated");
    let degrees = stated.numbers().expect("two numbers");
    assert!((-85.0..-83.0).contains(&degrees.x) && (36.0..37.0).contains(&degrees.y), "{stated:?}");
    let built = editor.source().build(&|_| ()).expect("sound");
    let label = built.labels[0].ground.truncate().as_dvec2() + built.lattice.origin();
    assert!(label.distance(at) < 0.1, "{label} for {at}");
    editor.apply(&SceneEdit::move_model(0, at.to_array()), &scene).expect("sound");
    assert!(editor.text().contains("at = [750123, 4017500.5]\n"), "{}", editor.text());
}

#[test]
fn saving_is_whole_and_refused_where_the_file_changed_meanwhile() {
    let scratch = scratch(SCENE);
    let (mut editor, scene) = opened(&scratch);
    let path = scratch.at("scene.toml");
    editor.apply(&SceneEdit::set_value("title", EditValue::Text("Hills".into())), &scene).expect("sound");
    assert!(editor.is_changed());
    fs::write(&path, format!("{SCENE}# another editor\n")).expect("written");
    assert!(matches!(editor.save(OnConflict::Refuse), Err(SaveError::ChangedOnDisk(_))));
    assert!(fs::read_to_string(&path).expect("readable").ends_with("# another editor\n"));
    editor.save(OnConflict::Overwrite).expect("saved");
    assert_eq!(fs::read_to_string(&path).expect("readable"), editor.text());
    assert!(!editor.is_changed());
    assert_eq!(scratch.names(), ["hills.png", "scene.toml"]);
    editor.undo();
    assert!(editor.is_changed() && editor.text() == SCENE);
}

#[test]
fn an_elevation_file_gets_a_scene_file_beside_it_once_it_is_edited() {
    let scratch = scratch(SCENE);
    fs::copy(Path::new(ROOT).join("assets/jacksboro/dem.tif"), scratch.at("dem.tif")).expect("copied");
    scratch.write("dem.toml", "title = \"another\"\n");
    let mut editor = SceneEditor::of_elevation(&scratch.at("dem.tif"), &[]).expect("sound");
    assert!(!editor.is_changed());
    let scene = editor.source().build(&|_| ()).expect("sound");
    let at = scene.lattice.map_extent().center();
    let crater = EarthworkDraft::Crater { radius_m: 300.0, depth_m: None };
    editor.apply(&SceneEdit::add_earthwork(&crater, vec![at.to_array()]), &scene).expect("sound");
    assert!(editor.is_changed());
    editor.save(OnConflict::Refuse).expect("saved");
    let saved = open_scene(&scratch.at("dem-2.toml"), &[], &|_| {}).expect("sound");
    assert_eq!((saved.title.as_deref(), saved.report.earthworks.len()), (Some("dem"), 1));
    assert_eq!(fs::read_to_string(scratch.at("dem.toml")).expect("readable"), "title = \"another\"\n");
}

#[test]
fn every_scene_of_the_gallery_is_edited_and_undone_to_the_byte() {
    let mut edited = 0;
    for entry in fs::read_dir(Path::new(ROOT).join("scenes")).expect("readable") {
        let path = entry.expect("readable").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let mut editor = SceneEditor::open(&path, &[], None).unwrap_or_else(|error| panic!("{error}"));
        let original = editor.text().to_owned();
        for edit in [
            SceneEdit::add_model("rock", [1.0, 2.0], 0.0),
            SceneEdit::add_area(vec![[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]], "meadow"),
            SceneEdit::set_value("style.light.azimuth", EditValue::Number(77.0)),
            SceneEdit::set_value("terrain.vertical_exaggeration", EditValue::Number(1.5)),
            SceneEdit::set_value("title", EditValue::Text("\"Ä\" \\".into())),
        ] {
            match editor.apply(&edit, &HILLS) {
                Ok(_) => edited += 1,
                // A light by the hour has no azimuth, and the hills have no place on Earth.
                Err(EditError::Wrong(_) | EditError::Place(_)) => {}
                Err(error) => panic!("{}: {error}", path.display()),
            }
        }
        while editor.undo().is_some() {}
        assert_eq!(editor.text(), original, "{}", path.display());
    }
    assert!(edited > 100, "{edited}");
}

fn edits() -> impl Strategy<Value = SceneEdit> {
    let at = || (0.0f64..1280.0, 0.0f64..1280.0).prop_map(|(x, y)| [x, y]);
    let list =
        prop_oneof![Just("model"), Just("label"), Just("road"), Just("lake"), Just("river"), Just("area")];
    prop_oneof![
        (at(), -180.0f64..180.0).prop_map(|(at, heading)| SceneEdit::add_model("rock", at, heading)),
        (0usize..3, at()).prop_map(|(number, at)| SceneEdit::move_model(number, at)),
        (0usize..3, 0.0f64..360.0).prop_map(|(number, heading)| SceneEdit::turn_model(number, heading)),
        ("[a-zÄ\"\\\\\n# ]{1,9}", at()).prop_map(|(text, at)| SceneEdit::add_label(&text, at, "place")),
        proptest::collection::vec(at(), 1..20).prop_map(|points| SceneEdit::add_road(points, 5.5)),
        proptest::collection::vec(at(), 2..20).prop_map(|points| SceneEdit::add_area(points, "forest")),
        (list, 0usize..3).prop_map(|(name, number)| SceneEdit::Remove(EditPlace::table(name, number))),
        (0.0f64..400.0).prop_map(|deg| SceneEdit::set_value("style.light.azimuth", EditValue::Number(deg))),
        ("[a-z ]{0,6}").prop_map(|text| SceneEdit::set_value("title", EditValue::Text(text))),
        (at(), 1.0f64..50.0).prop_map(|(at, radius_m)| SceneEdit::Together(vec![
            SceneEdit::add_earthwork(&EarthworkDraft::Crater { radius_m, depth_m: None }, vec![at]),
            SceneEdit::Add(
                NewTable::new("label").with_text("text", "crater").with("at", EditValue::Point(at))
            ),
        ])),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn random_edits_are_undone_to_the_byte_redone_and_reopened_as_they_were(
        edits in proptest::collection::vec(edits(), 1..12),
        windows in any::<bool>(),
        undone in 0usize..12,
    ) {
        let text = if windows { SCENE.replace('\n', "\r\n") } else { SCENE.to_owned() };
        let scratch = scratch(&text);
        let path = scratch.at("scene.toml");
        let mut editor = SceneEditor::open(&path, &[], None).expect("sound");
        let mut texts = vec![text.clone()];
        for edit in &edits {
            if editor.apply(edit, &HILLS).is_ok() {
                texts.push(editor.text().to_owned());
            }
            prop_assert_eq!(editor.text(), texts.last().expect("one").as_str());
        }
        prop_assert!(!windows || editor.text().lines().count() == editor.text().matches("\r\n").count());
        let end = texts.len() - 1;
        for back in 0..undone.min(end) {
            prop_assert!(editor.undo().is_some());
            prop_assert_eq!(editor.text(), texts[end - 1 - back].as_str());
        }
        while editor.redo().is_some() {}
        prop_assert_eq!(editor.text(), texts[end].as_str());
        editor.save(OnConflict::Refuse).expect("saved");
        let reopened = SceneEditor::open(&path, &[], None).expect("sound");
        prop_assert_eq!(reopened.text(), editor.text());
        let (a, b) = (format!("{:?}", reopened.document()), format!("{:?}", editor.document()));
        prop_assert_eq!(a, b);
        while editor.undo().is_some() {}
        prop_assert_eq!(editor.text(), text.as_str());
    }
}

#[test]
fn points_in_words_are_the_places_of_points_in_numbers() {
    let scene = |at: &str, line: &str| {
        let text = format!(
            "points_crs = \"EPSG:4326\"\n\n[terrain]\ndem = \"dem.tif\"\n\n[[label]]\ntext = \"Here\"\nat = {at}\n\n[[road]]\nwidth = 9\npoints = {line}\n\n\
             [[camera]]\nname = \"one\"\neye = {at}\neye_height = 300\nlook_at = [-84.2, 36.25]\n"
        );
        let scratch = Scratch::new();
        fs::copy(Path::new(ROOT).join("assets/jacksboro/dem.tif"), scratch.at("dem.tif")).expect("copied");
        scratch.write("scene.toml", text);
        open_scene(&scratch.at("scene.toml"), &[], &|_| ()).unwrap_or_else(|error| panic!("{error:?}"))
    };
    let words = scene(
        "\"16S GF 500 180\"",
        "[\"36.27N 84.22W\", \"16N 751000 4019000\", \"84°12'W 36°18'N\", [-84.19, 36.31]]",
    );
    let geographic = |x: f64, y: f64| {
        let zone = Crs::from_epsg(32616).expect("a zone");
        zone.transform(&Crs::wgs84(), DVec2::new(x, y)).expect("in it").to_array()
    };
    let at = format!("{:?}", geographic(750_050.0, 4_018_050.0));
    let second = geographic(751_000.0, 4_019_000.0);
    let line = format!("{:?}", [[-84.22, 36.27], second, [-84.2, 36.3], [-84.19, 36.31]]);
    let numbers = scene(&at, &line);
    let off_m = words.labels[0].ground.distance(numbers.labels[0].ground);
    assert!(off_m < 0.01, "{off_m}");
    assert_eq!(words.cameras.len(), 1);
}
