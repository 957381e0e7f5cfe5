//! The window without a window: panels, keys and clicks act on a scene, and nothing is lost unasked.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{env, fs, thread};

use egui::{Key, Modifiers, PointerButton, Pos2, Ui, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::pipeline::viewing::ViewerOptions;
use crate::viewer::app::{ViewerApp, ViewerStage, WindowRequest};
use crate::viewer::recent::RecentFiles;

/// A place in the view, right of the panels.
const IN_VIEW: Pos2 = pos2(800.0, 520.0);

type AppHarness = Harness<'static, Option<ViewerApp>>;

/// A scene of its own in a folder of its own.
struct TestScene {
    folder: PathBuf,
    file: PathBuf,
}

impl TestScene {
    fn new(name: &str) -> Self {
        let folder = env::temp_dir().join(format!("sandtable-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("scenes")).expect("a folder");
        fs::create_dir_all(folder.join("assets/jacksboro")).expect("a folder");
        let file = folder.join("scenes/road.toml");
        fs::copy("scenes/road.toml", &file).expect("copied");
        fs::copy("assets/jacksboro/valley.asc", folder.join("assets/jacksboro/valley.asc")).expect("copied");
        Self { folder, file }
    }
}

impl Drop for TestScene {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.folder).ok();
    }
}

fn window(file: Option<&Path>) -> AppHarness {
    let options = ViewerOptions { file: file.map(Path::to_owned), ..ViewerOptions::default() };
    let draw = move |ui: &mut Ui, app: &mut Option<ViewerApp>| {
        let app =
            app.get_or_insert_with(|| ViewerApp::with_recent(&options, ui.ctx(), RecentFiles::default()));
        app.show(ui, None);
        // What a renderer would take over.
        drop(app.scene_frame());
    };
    let builder = Harness::builder().with_size([1200.0, 800.0]).with_max_steps(1_000);
    let mut harness = builder.build_ui_state(draw, None);
    until(&mut harness, |app| app.stage() != ViewerStage::Loading && !app.is_busy());
    harness.run_steps(3);
    harness
}

fn app(harness: &AppHarness) -> &ViewerApp {
    harness.state().as_ref().expect("shown")
}

fn until(harness: &mut AppHarness, is_done: impl Fn(&ViewerApp) -> bool) {
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

fn click(harness: &mut AppHarness, at: Pos2) {
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.step();
    }
    harness.run_steps(2);
}

fn key(harness: &mut AppHarness, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

fn is_changed(harness: &AppHarness) -> bool {
    app(harness).session.as_ref().is_some_and(|session| session.editor.is_changed())
}

#[test]
fn every_widget_of_an_open_scene_has_a_name() {
    let harness = window(Some(Path::new("scenes/road.toml")));
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
    let mut harness = window(Some(Path::new("scenes/road.toml")));
    assert_eq!(app(&harness).picked, None);
    click(&mut harness, IN_VIEW);
    let picked = app(&harness).picked.clone().expect("picked");
    let place = picked.place.expect("ground");
    assert!(place.grid.starts_with("16S") && place.height.ends_with("m (ground)"), "{place:?}");
}

#[test]
fn keys_and_the_wheel_move_the_camera_and_typing_does_not() {
    let mut harness = window(Some(Path::new("scenes/road.toml")));
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
