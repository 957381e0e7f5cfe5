//! The window without a surface: panels, keys and clicks act on a scene, and no edit is lost without a question.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{env, fs, thread};

use egui::{Key, Modifiers, PointerButton, Pos2, Ui, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::app::{ViewerApp, ViewerStage, WindowRequest};
use crate::picked_part::DragTarget;
use crate::recent::RecentFiles;
use sandtable_editing::viewing::ViewerOptions;
use sandtable_view::camera::Camera;

/// A place in the view, right of the panels.
pub(super) const IN_VIEW: Pos2 = pos2(800.0, 520.0);

pub(super) type AppHarness = Harness<'static, Option<ViewerApp>>;

/// A scene of its own in a folder of its own.
pub(super) struct TestScene {
    folder: PathBuf,
    pub file: PathBuf,
}

impl TestScene {
    pub fn new(name: &str) -> Self {
        let folder = env::temp_dir().join(format!("sandtable-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("scenes")).expect("a folder");
        fs::create_dir_all(folder.join("assets/jacksboro")).expect("a folder");
        let file = folder.join("scenes/road.toml");
        fs::copy(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"), &file).expect("copied");
        fs::copy(
            concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/valley.asc"),
            folder.join("assets/jacksboro/valley.asc"),
        )
        .expect("copied");
        Self { folder, file }
    }
}

impl Drop for TestScene {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.folder).ok();
    }
}

pub(super) fn window(file: Option<&Path>) -> AppHarness {
    let options = ViewerOptions { file: file.map(Path::to_owned), ..ViewerOptions::default() };
    let draw = move |ui: &mut Ui, app: &mut Option<ViewerApp>| {
        let app =
            app.get_or_insert_with(|| ViewerApp::with_recent(&options, ui.ctx(), RecentFiles::default()));
        app.show(ui);
        // What a renderer would take over.
        drop(app.scene_frame(Camera::size));
    };
    let builder = Harness::builder().with_size([1200.0, 800.0]).with_max_steps(1_000);
    let mut harness = builder.build_ui_state(draw, None);
    until(&mut harness, |app| app.stage() != ViewerStage::Loading && !app.is_busy());
    harness.run_steps(3);
    harness
}

pub(super) fn app(harness: &AppHarness) -> &ViewerApp {
    harness.state().as_ref().expect("shown")
}

pub(super) fn until(harness: &mut AppHarness, is_done: impl Fn(&ViewerApp) -> bool) {
    let end = Instant::now() + Duration::from_secs(60);
    loop {
        harness.step();
        if is_done(app(harness)) {
            return;
        }
        assert!(Instant::now() < end, "nothing came of it in a minute");
        thread::sleep(Duration::from_millis(5));
    }
}

pub(super) fn click(harness: &mut AppHarness, at: Pos2) {
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.step();
    }
    harness.run_steps(2);
}

pub(super) fn key(harness: &mut AppHarness, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

pub(super) fn is_changed(harness: &AppHarness) -> bool {
    app(harness).session.as_ref().is_some_and(|session| session.editor.is_changed())
}

#[test]
fn every_widget_of_an_open_scene_has_a_name() {
    let harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    assert_eq!(app(&harness).stage(), ViewerStage::Ready);
    harness.check_accessibility();
    for name in ["Open", "Orbit", "Fly", "Walk", "Picture", "crater", "Find", "View of the scene"] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
}

#[test]
fn without_a_file_there_is_a_list_and_a_wrong_file_is_named_with_its_line() {
    let harness = window(None);
    assert_eq!(app(&harness).stage(), ViewerStage::Empty);
    harness.get_by_label("Path");
    let scene = TestScene::new("wrong");
    fs::write(&scene.file, "[terrain]\ndme = \"a.tif\"\n").expect("written");
    let harness = window(Some(&scene.file));
    assert_eq!(app(&harness).stage(), ViewerStage::Failed);
    assert!(app(&harness).failure_text().contains("road.toml:2"), "{}", app(&harness).failure_text());
}

#[test]
fn a_click_says_what_is_there() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    assert_eq!(app(&harness).picked, None);
    click(&mut harness, IN_VIEW);
    let picked = app(&harness).picked.clone().expect("picked");
    let place = picked.place.expect("ground");
    assert!(place.grid.starts_with("16S") && place.height.ends_with("m (ground)"), "{place:?}");
}

#[test]
fn keys_and_the_wheel_move_the_camera_and_typing_does_not() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    let eye = |harness: &AppHarness| app(harness).opened.as_ref().expect("open").navigator.pose().eye;
    let start = eye(&harness);
    harness.key_down(Key::W);
    harness.run_steps(10);
    harness.key_up(Key::W);
    harness.run_steps(2);
    let forward = eye(&harness);
    assert!(forward.distance(start) > 5.0, "{forward}");
    harness.get_by_label("Find").focus();
    harness.run_steps(2);
    harness.key_down(Key::S);
    harness.run_steps(10);
    harness.key_up(Key::S);
    harness.run_steps(2);
    assert_eq!(eye(&harness), forward);
}

#[test]
fn backspace_takes_back_the_last_point_of_what_is_measured() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    let points = |harness: &AppHarness| match &app(harness).tool {
        Some(crate::active_tool::ActiveTool::Measure(measuring)) => measuring.points.len(),
        _ => usize::MAX,
    };
    key(&mut harness, Modifiers::NONE, Key::M);
    click(&mut harness, IN_VIEW);
    click(&mut harness, IN_VIEW - egui::vec2(60.0, 0.0));
    assert_eq!(points(&harness), 2);
    key(&mut harness, Modifiers::NONE, Key::Backspace);
    assert_eq!(points(&harness), 1);
    key(&mut harness, Modifiers::NONE, Key::Backspace);
    key(&mut harness, Modifiers::NONE, Key::Backspace);
    assert_eq!(points(&harness), 0, "the tool stays");
}

#[test]
fn an_edit_is_undone_redone_saved_and_closing_with_one_asks() {
    let scene = TestScene::new("edits");
    let mut harness = window(Some(&scene.file));
    key(&mut harness, Modifiers::NONE, Key::K);
    click(&mut harness, IN_VIEW);
    assert!(is_changed(&harness), "dug");
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(!is_changed(&harness), "undone");
    key(&mut harness, Modifiers::COMMAND, Key::Y);
    assert!(is_changed(&harness), "redone");
    key(&mut harness, Modifiers::COMMAND, Key::S);
    assert!(!is_changed(&harness), "saved");
    assert!(fs::read_to_string(&scene.file).expect("there").contains("[[earthwork]]"));
    click(&mut harness, IN_VIEW - egui::vec2(60.0, 0.0));
    assert!(is_changed(&harness), "dug again");
    key(&mut harness, Modifiers::COMMAND, Key::Q);
    let closes = |harness: &mut AppHarness| {
        let requests = harness.state_mut().as_mut().expect("shown").take_requests();
        requests.contains(&WindowRequest::Close)
    };
    assert!(!closes(&mut harness), "asks");
    harness.get_by_label("Close without saving").click();
    harness.run_steps(3);
    assert!(closes(&mut harness));
}

#[test]
fn an_edit_made_while_a_file_is_read_is_kept() {
    let scene = TestScene::new("reading");
    let mut harness = window(Some(&scene.file));
    let opens =
        |harness: &mut AppHarness, file: &Path| harness.state_mut().as_mut().expect("shown").open(file);
    let waits = |app: &ViewerApp| app.loading.is_none();
    opens(&mut harness, &scene.file);
    key(&mut harness, Modifiers::NONE, Key::K);
    click(&mut harness, IN_VIEW);
    assert!(is_changed(&harness), "dug");
    until(&mut harness, waits);
    assert!(is_changed(&harness), "the file as it was does not replace the edit");
    assert!(app(&harness).notice_texts().any(|text| text.contains("edits that are not saved")));
    opens(&mut harness, Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/lake.toml")));
    click(&mut harness, IN_VIEW - egui::vec2(60.0, 0.0));
    until(&mut harness, waits);
    let opened = |harness: &AppHarness| app(harness).opened.as_ref().expect("open").path.clone();
    assert!(is_changed(&harness) && opened(&harness) == scene.file, "asks before another file is shown");
    harness.run_steps(2);
    harness.get_by_label("Go on without saving").click();
    until(&mut harness, |app| app.question.is_none() && app.loading.is_none());
    assert_eq!(opened(&harness), Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/lake.toml")));
}

#[test]
fn the_sun_and_what_is_hidden_wait_for_a_thread_and_the_picture_stays() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    let low = glam::Vec3::new(0.8, 0.0, 0.6);
    let app_mut = |harness: &mut AppHarness, act: &dyn Fn(&mut ViewerApp)| {
        act(harness.state_mut().as_mut().expect("shown"));
    };
    let sun = |app: &ViewerApp| app.opened.as_ref().expect("open").walk.to_sun();
    let before = sun(app(&harness));
    app_mut(&mut harness, &|app| app.opened.as_mut().expect("open").set_sun(low));
    harness.step();
    assert!(app(&harness).is_busy(), "it is being lit");
    assert_eq!(sun(app(&harness)), before, "as it was");
    until(&mut harness, |app| !app.is_busy());
    assert_eq!(sun(app(&harness)), low);
    let items = |app: &ViewerApp| app.opened.as_ref().expect("open").list.items.len();
    let (all, plinth) = (items(app(&harness)), sandtable_draw::list::FeatureId::PLINTH);
    app_mut(&mut harness, &|app| app.opened.as_mut().expect("open").hide(&[plinth].into()));
    assert_eq!(items(app(&harness)), all, "as it was");
    until(&mut harness, |app| !app.is_busy());
    assert!(items(app(&harness)) < all, "hidden");
}

#[test]
fn a_view_is_kept_as_a_camera_and_undone() {
    let scene = TestScene::new("camera");
    let mut harness = window(Some(&scene.file));
    let names = |app: &ViewerApp| -> Vec<String> {
        let cameras = &app.opened.as_ref().expect("open").scene.cameras;
        cameras.iter().map(|view| view.name.clone()).collect()
    };
    let before = names(app(&harness));
    key(&mut harness, Modifiers::SHIFT, Key::P);
    until(&mut harness, |app| !app.is_busy());
    assert!(names(app(&harness)).contains(&"view-1".to_owned()), "{:?}", names(app(&harness)));
    assert!(is_changed(&harness), "an edit");
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    until(&mut harness, |app| !app.is_busy());
    assert_eq!(names(app(&harness)), before);
    assert!(!is_changed(&harness), "undone");
}

#[test]
fn a_position_is_flown_to_and_its_height_is_told() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    let go = |harness: &mut AppHarness, text: &str| {
        let position = sandtable_geom::position::Position::parse(text).expect(text);
        let opened = harness.state_mut().as_mut().expect("shown").opened.as_mut().expect("open");
        opened.go_to_position(&position)
    };
    let scene = std::sync::Arc::clone(&app(&harness).opened.as_ref().expect("open").scene);
    let at = glam::DVec2::new(750_000.5, 4_018_000.5);
    let height = scene.heights.height(
        sandtable_terrain::query::Surface::Ground,
        sandtable_terrain::query::Interpolation::Planar,
        at,
    );
    let expected = format!("750000, 4018000 (EPSG:32616): {:.1} m", height.height_m().expect("ground"));
    for text in ["16SGF5000018000", "16S GF 50000 18000"] {
        assert_eq!(go(&mut harness, text), Ok(expected.clone()), "{text}");
    }
    let coarse = go(&mut harness, "16SGF500180").expect("on the ground");
    assert!(coarse.ends_with("the middle of a square of 100 m"), "{coarse}");
    go(&mut harness, "750000.5, 4018000.5").expect("numbers of the scene's system");
    harness.run_steps(400);
    let camera = app(&harness).opened.as_ref().expect("open").camera((1280, 800)).expect("a camera");
    let seen =
        app(&harness).opened.as_ref().expect("open").focus(&camera).truncate() + scene.lattice.origin();
    assert!(seen.distance(at) < 60.0, "the middle of the picture is {seen}");
    let off = go(&mut harness, "33N 500000 5200000").expect_err("in Austria");
    assert!(off.contains("off the ground") || off.contains("no such place"), "{off}");
}

#[test]
fn a_viewshed_is_tinted_until_it_is_cleared() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    harness.get_by_label("Viewshed").click();
    harness.run_steps(2);
    click(&mut harness, IN_VIEW);
    until(&mut harness, |app| !app.is_busy());
    harness.get_by_label_contains("are seen");
    let is_tinted = |app: &ViewerApp| {
        let list = &app.opened.as_ref().expect("open").list;
        list.materials.iter().any(|material| material.name == "tint" && material.texture.is_some())
    };
    assert!(is_tinted(app(&harness)));
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    harness.get_by_label("Clear viewshed").click();
    harness.run_steps(2);
    assert!(app(&harness).viewshed.is_none() && harness.query_by_label("Clear viewshed").is_none());
}

#[test]
fn a_model_is_dragged_and_turned_and_a_road_is_widened_and_removed() {
    let scene = TestScene::new("parts");
    let mut text = fs::read_to_string(&scene.file).expect("there");
    text.push_str("\n[[model]]\nfile = \"conifer\"\nat = [749300, 4017800]\n");
    text.push_str(
        "\n[[road]]\nname = \"lane\"\npoints = [[748900, 4017500], [749200, 4017600]]\nwidth = 5\n",
    );
    fs::write(&scene.file, text).expect("written");
    let mut harness = window(Some(&scene.file));
    let feature = |app: &ViewerApp, name: &str| {
        let scene = &app.opened.as_ref().expect("open").scene;
        let is_named = |feature: &sandtable_scene::feature::SceneFeature| {
            if name.is_empty() {
                feature.kind == sandtable_scene::feature::FeatureKind::Model
            } else {
                feature.name == name
            }
        };
        let index = scene.features.iter().position(is_named).expect("there");
        sandtable_draw::list::FeatureId::of_index(index)
    };
    let take = |harness: &mut AppHarness, name: &str| {
        let app = harness.state_mut().as_mut().expect("shown");
        let part = app.part_of_feature(feature(app, name));
        assert!(part.is_some(), "'{name}' has a table");
        app.picked = Some(crate::app::PickedText { feature: name.to_owned(), place: None, part });
    };
    let text = |harness: &AppHarness| app(harness).session.as_ref().expect("open").editor.text().to_owned();
    take(&mut harness, "");
    let to = glam::DVec2::new(749_350.0, 4_017_820.0);
    let ghost = |harness: &AppHarness, turns: bool| -> Vec<[glam::Vec3; 2]> {
        let app = app(harness);
        let part = app.picked.as_ref().and_then(|picked| picked.part.as_ref()).expect("a table");
        let target = if turns { to + glam::DVec2::X * 10.0 } else { to };
        app.opened.as_ref().expect("open").ghost_edges(part, DragTarget { to: target, turns })
    };
    let moved = ghost(&harness, false);
    assert_eq!(moved.len(), 12);
    harness.state_mut().as_mut().expect("shown").move_part(to, false);
    assert_eq!(ghost(&harness, false), moved, "it stands where its ghost was");
    let turned = ghost(&harness, true);
    assert_ne!(turned, moved);
    harness.state_mut().as_mut().expect("shown").move_part(to + glam::DVec2::X * 10.0, true);
    assert_eq!(ghost(&harness, true), turned);
    assert!(text(&harness).contains("at = [749350, 4017820]"), "{}", text(&harness));
    assert!(text(&harness).contains("heading = 90"), "{}", text(&harness));
    assert!(app(&harness).loading.is_none(), "the scene is not built anew");
    let opened = app(&harness).opened.as_ref().expect("open");
    let at = opened.walk.model_pose(0).at.as_dvec2() + opened.scene.lattice.origin();
    assert!(at.distance(to) < 0.1, "{at}");
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(!is_changed(&harness), "undone");
    until(&mut harness, |app| !app.is_busy());
    take(&mut harness, "lane");
    harness.run_steps(2);
    assert_eq!(app(&harness).picked.as_ref().and_then(|picked| picked.part.as_ref()?.width_m), Some(5.0));
    harness.get_by_label("Remove").click();
    harness.run_steps(2);
    assert!(!text(&harness).contains("lane"), "{}", text(&harness));
    until(&mut harness, |app| !app.is_busy());
    assert!(text(&harness).contains("conifer"));
}

#[test]
fn a_file_that_breaks_leaves_the_scene_and_one_that_is_mended_is_read_again() {
    let scene = TestScene::new("reload");
    let mut harness = window(Some(&scene.file));
    let sound = fs::read_to_string(&scene.file).expect("there");
    fs::write(&scene.file, sound.replace("[terrain]", "[terain]")).expect("written");
    until(&mut harness, |app| app.notice_texts().any(|text| text.contains("road.toml:")));
    assert_eq!(app(&harness).stage(), ViewerStage::Ready);
    fs::write(&scene.file, sound.replace("Two roads", "Three roads")).expect("written");
    until(&mut harness, |app| {
        let opened = app.opened.as_ref().expect("the last good scene");
        opened.scene.title.as_deref() == Some("Three roads")
    });
}

#[test]
fn a_script_that_moves_the_sun_ends_without_a_question() {
    let scene = TestScene::new("script");
    let mut harness = window(Some(&scene.file));
    let commands = crate::script::parse_script("sun 120,30\nquit\n").expect("commands");
    let mut run = crate::script_run::ScriptRun::new(commands, None, std::time::Instant::now());
    let mut closes = false;
    for _ in 0..600 {
        harness.step();
        let app = harness.state_mut().as_mut().expect("shown");
        run.step(app);
        closes |= app.take_requests().contains(&WindowRequest::Close);
        if closes {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(closes, "the window is closed");
    let report = run.report("none");
    let quit = report["commands"].as_array().and_then(|done| done.last()).expect("told");
    assert_eq!((&quit["command"], &quit["unsaved"]), (&"quit".into(), &true.into()));
    assert!(!fs::read_to_string(&scene.file).expect("there").contains("azimuth = 120"), "not saved");
}

#[test]
fn fewer_pixels_have_ground_for_these_and_the_whole_picture_its_own_at_once() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    let context = harness.ctx.clone();
    let opened = harness.state_mut().as_mut().and_then(|app| app.opened.as_mut()).expect("open");
    let size = opened.size;
    let few = |_: &Camera| (size.0 / 8, size.1 / 8);
    let mut triangles = |lowers: bool| {
        let drawn_size = |camera: &Camera| if lowers { few(camera) } else { camera.size() };
        opened.follow_reach(&context).expect("no fault");
        let frame = opened.frame(size, drawn_size).expect("in sight");
        assert!(lowers || !frame.wants_ground, "the whole ground is there");
        frame.statistics.triangles
    };
    let whole = triangles(false);
    let end = Instant::now() + Duration::from_secs(60);
    while triangles(true) == whole {
        assert!(Instant::now() < end, "no coarser ground in a minute");
        thread::sleep(Duration::from_millis(5));
    }
    let coarse = triangles(true);
    assert!(coarse < whole / 2, "{coarse} and {whole} triangles");
    assert_eq!([false, true, false].map(triangles), [whole, coarse, whole], "neither is made again");
    opened.frame(size, few).expect("in sight");
    opened.leave_one_ground();
    let camera = opened.camera(size).expect("sound");
    assert!(opened.walk.suits(&camera) && opened.aside.is_none(), "an edit is of the whole ground");
}
