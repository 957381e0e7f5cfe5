//! Analyses in the window: prepared in the form, made beside it, shown, kept, undone and discarded.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::active_tool::ActiveTool;
use crate::app::ViewerApp;
use crate::app_tests::{AppHarness, IN_VIEW, TestScene, app, click, is_changed, key, until, window};
use sandtable_analysis::arguments::{AnalysisArguments, ArgumentValue};
use sandtable_analysis::run::run;
use sandtable_scene::land::land_of;
use sandtable_terrain::stop_flag::StopFlag;

/// A place on the ground of the scene.
const PLACE: &str = "749000,4017500";

fn app_mut(harness: &mut AppHarness) -> &mut ViewerApp {
    harness.state_mut().as_mut().expect("shown")
}

/// Makes an analysis as a script does, and waits for it.
fn analyze(harness: &mut AppHarness, kind: &str, arguments: &[(&str, &str)]) {
    let arguments: Vec<(String, String)> =
        arguments.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
    app_mut(harness).analyze_by_name(kind, &arguments);
    until(harness, |app| !app.is_busy());
    harness.run_steps(2);
}

fn text(harness: &AppHarness) -> String {
    app(harness).session.as_ref().expect("open").editor.text().to_owned()
}

/// Whether the renderer has the tint of an analysis; the scene has no other.
fn is_drawn(app: &ViewerApp) -> bool {
    let list = &app.opened.as_ref().expect("open").list;
    list.materials.iter().any(|material| material.name == "tint" && material.texture.is_some())
}

#[test]
fn an_analysis_is_prepared_in_the_form_made_and_discarded() {
    let scene = TestScene::new("analysis-form");
    let mut harness = window(Some(&scene.file));
    harness.get_by_label("Analyses").click();
    harness.run_steps(3);
    harness.get_by_label("The scene has no analyses.");
    harness.get_by_label("kind").click();
    harness.run_steps(3);
    harness.get_by_label("Time to reach").click();
    harness.run_steps(3);
    harness.get_by_label("Run").click();
    harness.run_steps(3);
    harness.get_by_label("`from`: state it");
    harness.get_by_label("Pick from").click();
    harness.run_steps(2);
    click(&mut harness, IN_VIEW);
    let field = |app: &ViewerApp| {
        let draft = app.analyzing.draft.as_ref().expect("prepared");
        draft.fields.iter().find(|field| field.parameter.name == "from").expect("there").clone()
    };
    assert_eq!(field(app(&harness)).text.split(';').count(), 1);
    assert_eq!(field(app(&harness)).problem, None, "stated now");
    click(&mut harness, IN_VIEW - egui::vec2(60.0, 0.0));
    assert_eq!(field(app(&harness)).text.split(';').count(), 2);
    key(&mut harness, Modifiers::NONE, Key::Backspace);
    assert_eq!(field(app(&harness)).text.split(';').count(), 1, "taken back");
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(app(&harness).tool.is_none());
    harness.get_by_label("Run").click();
    harness.step();
    harness.step();
    assert!(app(&harness).analyzing.is_busy(), "beside the window");
    until(&mut harness, |app| !app.is_busy());
    harness.run_steps(3);
    assert!(is_drawn(app(&harness)));
    harness.check_accessibility();
    harness.get_by_label("Not in the scene yet");
    harness.get_by_label("Show Time to reach");
    harness.get_by_label("Discard").click();
    harness.run_steps(3);
    assert!(app(&harness).analyzing.tried.is_none());
    assert!(harness.query_by_label("Discard").is_none() && !is_changed(&harness));
}

#[test]
fn an_analysis_is_kept_with_the_same_bits_undone_and_made_again() {
    let scene = TestScene::new("analysis-kept");
    let mut harness = window(Some(&scene.file));
    analyze(&mut harness, "time", &[("from", PLACE), ("vehicle", "wheeled"), ("name", "From the pass")]);
    let before = text(&harness);
    let tried = app(&harness).analyzing.tried.as_ref().expect("made").listing.clone();
    assert_eq!(tried.name, "From the pass");
    assert!(!tried.classes.is_empty());
    app_mut(&mut harness).keep_analysis();
    assert!(is_changed(&harness), "an edit");
    until(&mut harness, |app| !app.is_busy());
    harness.run_steps(3);
    assert!(app(&harness).analyzing.tried.is_none(), "the scene's own now");
    let opened = app(&harness).opened.as_ref().expect("open");
    let [kept] = &opened.scene.analyses[..] else { panic!("one analysis") };
    assert_eq!((kept.name.as_str(), opened.analyses.len()), ("From the pass", 1));
    assert_eq!(opened.analyses[0].figures, tried.figures);
    let wanted = of_kind(&opened.scene, "time");
    let found = kept.outcome.raster.as_ref().expect("a raster");
    for (index, wanted) in wanted.iter().enumerate() {
        assert_eq!(found.values.value(index).to_bits(), *wanted, "post {index}");
    }
    harness.get_by_label("Analyses").click();
    harness.run_steps(3);
    harness.get_by_label("Show From the pass");
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    until(&mut harness, |app| !app.is_busy());
    assert_eq!(text(&harness), before, "undone");
    assert!(app(&harness).opened.as_ref().expect("open").scene.analyses.is_empty());
    key(&mut harness, Modifiers::COMMAND, Key::Y);
    until(&mut harness, |app| !app.is_busy());
    key(&mut harness, Modifiers::COMMAND, Key::S);
    let saved = fs::read_to_string(&scene.file).expect("there");
    assert!(saved.contains("[[analysis]]\nname = \"From the pass\"\nkind = \"time\"\n"), "{saved}");
}

/// The bits of the values of the kind from [`PLACE`] for wheels, by the library.
fn of_kind(scene: &sandtable_scene::scene_model::SceneModel, name: &str) -> Vec<u32> {
    let kind = sandtable_catalog::kind(name).expect("a kind");
    let from = ArgumentValue::Points(vec![glam::DVec2::new(749_000.0, 4_017_500.0)]);
    let wheels = ArgumentValue::Word("wheeled".to_owned());
    let arguments = AnalysisArguments::new(kind).with("from", from).with("vehicle", wheels);
    let outcome = run(&land_of(scene, kind.layers), &arguments, &StopFlag::default()).expect("an outcome");
    let values = outcome.raster.expect("a raster").values;
    (0..values.len()).map(|index| values.value(index).to_bits()).collect()
}

#[test]
fn a_hidden_analysis_is_shown_again_and_digging_outdates_it() {
    let scene = TestScene::new("analysis-hidden");
    let mut harness = window(Some(&scene.file));
    analyze(&mut harness, "slope", &[]);
    harness.get_by_label("Analyses").click();
    harness.run_steps(3);
    let feature = app(&harness).analyzing.tried.as_ref().expect("made").listing.feature;
    harness.get_by_label("Show Slope").click();
    harness.run_steps(3);
    until(&mut harness, |app| !app.is_busy());
    assert!(app(&harness).opened.as_ref().expect("open").hidden.contains(&feature));
    harness.get_by_label("Show Slope").click();
    harness.run_steps(3);
    until(&mut harness, |app| !app.is_busy());
    assert!(!app(&harness).opened.as_ref().expect("open").hidden.contains(&feature));
    assert!(harness.query_by_label_contains("The ground has changed").is_none());
    key(&mut harness, Modifiers::NONE, Key::K);
    click(&mut harness, IN_VIEW);
    harness.run_steps(2);
    assert!(is_changed(&harness), "dug");
    harness.get_by_label_contains("The ground has changed");
    let dug = Arc::clone(app(&harness).opened.as_ref().expect("open").walk.elevations());
    app_mut(&mut harness).run_analysis();
    until(&mut harness, |app| !app.is_busy());
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("The ground has changed").is_none());
    assert!(Arc::strong_count(&dug) > 1, "the walk still has that ground");
}

#[test]
fn an_analysis_that_is_stopped_or_wrong_says_so_and_shows_nothing() {
    let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))));
    harness.get_by_label("Analyses").click();
    harness.run_steps(3);
    analyze(&mut harness, "time", &[("from", "0,0")]);
    harness.get_by_label_contains("`from` 0,0");
    assert!(app(&harness).analyzing.tried.is_none());
    app_mut(&mut harness).analyze_by_name("geomorphons", &[("radius".to_owned(), "50".to_owned())]);
    app_mut(&mut harness).stop_analysis();
    until(&mut harness, |app| !app.is_busy());
    harness.run_steps(2);
    let is_stopped = harness.query_by_label("The analysis was stopped.").is_some();
    assert!(is_stopped && app(&harness).analyzing.tried.is_none());
    app_mut(&mut harness).analyze_by_name("no-such-kind", &[]);
    app_mut(&mut harness).analyze_by_name("slope", &[("units".to_owned(), "degrees".to_owned())]);
    let said: Vec<&str> = app(&harness).notice_texts().collect();
    assert!(said.iter().any(|text| text.contains("no-such-kind")), "{said:?}");
    assert!(said.iter().any(|text| text.contains("'units'")), "{said:?}");
}

#[test]
fn another_edit_that_builds_the_scene_anew_leaves_what_is_tried() {
    let scene = TestScene::new("analysis-anew");
    let mut harness = window(Some(&scene.file));
    analyze(&mut harness, "slope", &[("unit", "degrees")]);
    app_mut(&mut harness).exaggerate(2.0);
    until(&mut harness, |app| !app.is_busy());
    harness.run_steps(2);
    assert!(app(&harness).analyzing.tried.is_some() && is_drawn(app(&harness)), "made again");
    app_mut(&mut harness).open(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/lake.toml")));
    until(&mut harness, |app| !app.is_busy() && app.question.is_none());
    let opened = app(&harness).opened.as_ref().expect("open").path.clone();
    if opened.ends_with("lake.toml") {
        assert!(app(&harness).analyzing.tried.is_none(), "it was of another file");
    }
}

#[test]
fn a_script_analyzes_keeps_and_reports_the_figures() {
    let scene = TestScene::new("analysis-script");
    let mut harness = window(Some(&scene.file));
    let script = "analyze obstacles vehicle=wheeled\ndiscard\nanalyze route from=749000,4017500 to=16S GF 50000 18000\n\
                  keep\nsave\nquit\n";
    let commands = crate::script::parse_script(script).expect("commands");
    let mut run = crate::script_run::ScriptRun::new(commands, None, std::time::Instant::now());
    let end = std::time::Instant::now() + std::time::Duration::from_secs(120);
    loop {
        harness.step();
        let app = app_mut(&mut harness);
        run.step(app);
        if app.take_requests().contains(&crate::app::WindowRequest::Close) {
            break;
        }
        assert!(std::time::Instant::now() < end, "the script does not end");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let report = run.report("none");
    let done = report["commands"].as_array().expect("a list");
    let figures = &done[0]["analysis"]["figures"];
    assert!(figures.as_object().is_some_and(|figures| figures.len() >= 3), "{report}");
    assert_eq!(done[2]["analysis"]["kind"], "route", "{report}");
    assert!(done[2]["analysis"]["tables"].as_u64().is_some_and(|tables| tables > 0), "{report}");
    let saved = fs::read_to_string(&scene.file).expect("there");
    assert!(saved.contains("kind = \"route\"") && !saved.contains("obstacles"), "{saved}");
    assert!(matches!(app(&harness).tool, None | Some(ActiveTool::Draw(_))));
}
