//! `check` and `explain`: findings for people and for programs, and how they end.

use serde_json::Value;

use crate::cli::{bytes_of, run, run_in};
use crate::common::scratch::Scratch;

/// The commands run in `project`, the scene is `scenes/a.toml`.
fn scene(more: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("project/data/valley.asc", bytes_of("assets/jacksboro/valley.asc"));
    let head = "[terrain]\ndem = \"../data/valley.asc\"\ncrs = \"EPSG:32616\"\n";
    scratch.write("project/scenes/a.toml", format!("{head}{more}"));
    scratch
}

const UNUSED: &str = "[styles.lane]\nwidth = 3\n";
const SWAPPED: &str = "[[road]]\npoints = [[4018883, 750500], [4019000, 751000]]\n";

fn json(scratch: &Scratch, code: i32) -> Value {
    let ran = run_in(&scratch.at("project"), &["check", "scenes/a.toml", "--json"]);
    assert_eq!((ran.code, ran.err.as_str()), (code, ""), "{ran:?}");
    serde_json::from_str(&ran.out).expect("JSON")
}

#[test]
fn a_warning_is_shown_with_its_line_and_fails_only_where_it_is_denied() {
    let scratch = scene(UNUSED);
    let check = |more: &[&str]| run_in(&scratch.at("project"), &[&["check", "scenes/a.toml"], more].concat());
    let out = check(&[]).ok();
    for wanted in [
        "scenes/a.toml:4:9: warning[unused-style]: no table names the style 'lane'\n",
        "4 | [styles.lane]\n  |         ^^^^\n",
        "= help: add `style = \"lane\"` to a table, or remove it",
        "scenes/a.toml is sound\n",
        "findings  1 warning; `sandtable explain CODE` explains a code\n",
        "112×112 posts",
    ] {
        assert!(out.contains(wanted), "{wanted} in\n{out}");
    }
    let denied = check(&["--deny", "warnings"]);
    assert_eq!((denied.code, denied.err.as_str(), denied.out), (1, "", out));
    assert!(check(&["--deny", "notes"]).failed(2).contains("warnings"));
}

#[test]
fn an_error_fails_the_check_and_render_shows_it_beside_its_picture() {
    let scratch = scene(SWAPPED);
    let ran = run_in(&scratch.at("project"), &["check", "scenes/a.toml"]);
    assert_eq!((ran.code, ran.err.as_str()), (1, ""));
    assert!(
        ran.out.contains("a.toml:5:10: error[axes-swapped]: ") && ran.out.contains("[northing, easting]")
    );
    assert!(ran.out.contains("scenes/a.toml is wrong\n") && !ran.out.contains("is sound"), "{}", ran.out);
    let drawn = run_in(&scratch.at("project"), &["render", "scenes/a.toml", "--size", "64x48"]);
    assert!(drawn.code == 0 && drawn.err.contains("error[axes-swapped]"), "{drawn:?}");
}

#[test]
fn the_findings_are_json_for_sound_scenes_and_for_broken_ones() {
    let warned = json(&scene(UNUSED), 0);
    assert_eq!((&warned["errors"], &warned["warnings"]), (&0.into(), &1.into()));
    let finding = &warned["findings"][0];
    assert_eq!((&finding["code"], &finding["severity"]), (&"unused-style".into(), &"warning".into()));
    assert_eq!((&finding["line"], &finding["column"]), (&4.into(), &9.into()));
    assert_eq!((&finding["file"], &finding["more"]), (&"scenes/a.toml".into(), &0.into()));
    assert_eq!(
        (&warned["codes"]["unused-style"], &warned["codes"]["unused-phase"]),
        (&1.into(), &Value::Null)
    );
    assert!(finding["help"].as_str().expect("a remedy").contains("or remove it"));
    let unread = json(&scene("[[road]]\nwdith = 3\n[style]\nwireframe = 2\n"), 1);
    let codes = unread["findings"].as_array().expect("a list").iter().map(|finding| finding["code"].clone());
    assert_eq!(codes.collect::<Vec<_>>(), ["missing-key", "unknown-key", "wrong-type"]);
    let unbuilt = json(&scene("[[road]]\nfile = \"gone.geojson\"\n"), 1);
    assert_eq!(
        (&unbuilt["findings"][0]["code"], &unbuilt["findings"][0]["line"]),
        (&"missing-file".into(), &5.into())
    );
}

#[test]
fn a_scene_that_is_not_there_is_a_finding_too() {
    let scratch = Scratch::new();
    let ran = run_in(scratch.folder(), &["check", "none.toml", "--json"]);
    let value: Value = serde_json::from_str(&ran.out).expect("JSON");
    assert_eq!((ran.code, &value["findings"][0]["code"]), (1, &"unreadable-file".into()));
    assert!(value["findings"][0]["line"].is_null());
}

#[test]
fn every_code_is_explained_and_an_unknown_one_is_refused_with_what_was_meant() {
    let list = run(&["explain"]).ok();
    assert!(list.lines().count() > 40 && list.contains("axes-swapped"), "{list}");
    for line in list.lines() {
        let code = line.split_whitespace().next().expect("a code");
        assert!(run(&["explain", code]).ok().contains(&format!("[{code}]")), "{code}");
    }
    assert!(run(&["explain", "axis-swaped"]).failed(2).contains("did you mean 'axes-swapped'?"));
}

/// Lines that cross each other `count` × `count` times, as points of the scene file.
fn web(count: u32) -> String {
    let line = |index: u32| {
        let [near, far, at] = [0, 10 * (count + 1), 10 * (index / 2 + 1)];
        let ends = if index.is_multiple_of(2) { [[near, at], [far, at]] } else { [[at, near], [at, far]] };
        let [from, to] = ends.map(|[east, north]| [750_400 + east, 4_018_800 + north]);
        // As wide as it takes for the ground to need no more posts.
        format!("[[road]]\nprofile = \"conform\"\npoints = [{from:?}, {to:?}]\nwidth = 400\n")
    };
    (0..2 * count).map(line).collect()
}

#[test]
fn what_exceeds_a_limit_is_found_on_the_line_of_its_table() {
    let at = |east: u32| {
        format!("[[symbol]]\nsidc = \"10031000001211000000\"\nat = [{}, 4018900]\n", 750_400 + east)
    };
    for (limit, features, code, line, wanted) in [
        (
            "scene-symbols=2",
            (0..5).map(|index| at(40 * index)).collect(),
            "too-many",
            12,
            "3 symbols beyond the first 2",
        ),
        ("road-crossings=5", web(3), "tangled", 6, "--limit road-crossings=…"),
        ("road-pairs=5", format!("{UNUSED}{}", web(3)), "tangled", 8, "--limit road-pairs=…"),
    ] {
        let scratch = scene(&features);
        let ran = run_in(&scratch.at("project"), &["check", "scenes/a.toml", "--json", "--limit", limit]);
        assert_eq!((ran.code, ran.err.as_str()), (0, ""), "{ran:?}");
        let found: Value = serde_json::from_str(&ran.out).expect("JSON");
        let findings = found["findings"].as_array().expect("a list");
        let finding = findings.iter().find(|finding| finding["code"] == code);
        let finding = finding.unwrap_or_else(|| panic!("{code}: {}", ran.out));
        assert_eq!(finding["line"], line, "{}", ran.out);
        assert!(finding["message"].as_str().expect("text").contains(wanted), "{}", ran.out);
        // Within the limits as they are, there is no such finding.
        let whole = json(&scratch, 0);
        assert_eq!(whole["codes"][code], Value::Null, "{whole}");
    }
}
