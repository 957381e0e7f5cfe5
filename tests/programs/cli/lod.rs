//! `lod`: methods side by side.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::cli::{run, run_in};
use crate::common::data::data;
use crate::common::scratch::Scratch;

const VALLEY: &str = "assets/jacksboro/valley.asc";

const KEYS: [&str; 9] = [
    "method",
    "triangles",
    "changed_per_frame",
    "update_ms_median",
    "update_ms_p99",
    "upload_bytes_median",
    "mean_m",
    "rms_m",
    "max_m",
];

fn objects(out: &str) -> Vec<Value> {
    assert_eq!(out.lines().count(), 1, "one array on one line");
    match serde_json::from_str(out).expect("JSON") {
        Value::Array(objects) => objects,
        other => panic!("no array: {other}"),
    }
}

fn number(object: &Value, key: &str) -> f64 {
    object[key].as_f64().unwrap_or_else(|| panic!("{key} of {object}"))
}

/// What `lod` prints of the valley with these arguments and a short flight, by method.
fn flown(arguments: &[&str]) -> BTreeMap<String, Value> {
    let all = [&["lod", VALLEY, "--frames", "6", "--json"], arguments].concat();
    let name = |report: &Value| report["method"].as_str().expect("a name").to_owned();
    objects(&run(&all).ok()).into_iter().map(|report| (name(&report), report)).collect()
}

/// A report without its name and the times that it took.
fn findings(report: &Value) -> BTreeMap<String, Value> {
    let untold =
        |key: &str| ["method", "emit", "criterion", "refine"].contains(&key) || key.starts_with("update_ms");
    let report = report.as_object().expect("an object").clone();
    report.into_iter().filter(|(key, _)| !untold(key)).collect()
}

#[test]
fn every_method_answers_for_every_key_and_its_numbers_hang_together() {
    let mut names = BTreeSet::new();
    for arguments in [&[][..], &["--emit", "bintree"], &["--emit", "quadtree"], &["--emit", "strips"]] {
        for (name, report) in flown(arguments) {
            for key in KEYS {
                assert!(!report[key].is_null(), "{key} in {report}");
            }
            assert!(number(&report, "triangles") > 100.0, "{report}");
            assert!(number(&report, "triangles") <= number(&report, "triangles_max"), "{report}");
            assert!(number(&report, "changed_per_frame") <= number(&report, "triangles"), "{report}");
            assert!(number(&report, "update_ms_median") <= number(&report, "update_ms_p99"), "{report}");
            assert!(number(&report, "mean_m") <= number(&report, "rms_m"), "{report}");
            assert!(number(&report, "rms_m") <= number(&report, "max_m"), "{report}");
            assert_eq!(report["frames"], 5, "the first frame has none before it");
            names.insert(name);
        }
    }
    assert_eq!(
        names.len(),
        2 + 3 * 8 * 3 + 3,
        "full, geomipmap, three lists by three refiners, deferred: {names:?}"
    );
}

#[test]
fn the_selection_is_what_one_would_compare() {
    let reports = flown(&[]);
    assert!((10..=16).contains(&reports.len()), "{}", reports.len());
    let full = &reports["full"];
    assert_eq!((number(full, "max_m"), number(full, "upload_bytes_median")), (0.0, 0.0), "{full}");
    for (name, report) in &reports {
        assert!(number(report, "triangles") <= number(full, "triangles"), "{name}");
    }
}

#[test]
fn refiners_with_the_same_spheres_show_the_same_triangles_in_every_emitter() {
    for criterion in ["spheres", "constrained", "bounding"] {
        let refined = flown(&["--criterion", criterion]);
        assert_eq!(refined.len(), 4, "{criterion}");
        let told = |refine: &str| {
            let mut found = findings(&refined[&format!("bintree/{criterion}/{refine}")]);
            // What is sent differs: rebuilding sends all, and the deferred's lists hold what is not drawn.
            found.retain(|key, _| !["upload_bytes_median", "vertices_sent"].contains(&key.as_str()));
            found
        };
        for refine in ["coherent", "queues", "deferred"] {
            assert_eq!(told(refine), told("rebuild"), "{criterion}/{refine}");
        }
    }
    for criterion in ["screen", "variance", "roughness", "anisotropic", "block"] {
        let refined = flown(&["--criterion", criterion]);
        let told = |refine: &str| number(&refined[&format!("bintree/{criterion}/{refine}")], "triangles");
        assert_eq!(told("coherent"), told("rebuild"), "{criterion}");
    }
    let of = |emit: &str| {
        let mut reports = flown(&["--emit", emit, "--criterion", "roughness", "--refine", "coherent"]);
        reports.pop_first().expect("one method").1
    };
    let (bintree, quadtree, strips) = (of("bintree"), of("quadtree"), of("strips"));
    assert_eq!(findings(&bintree), findings(&quadtree));
    for key in ["triangles", "changed_per_frame", "mean_m", "rms_m", "max_m"] {
        assert_eq!(bintree[key], strips[key], "{key}");
    }
    assert!(number(&strips, "vertices_sent") < 0.6 * number(&bintree, "vertices_sent"), "{strips} {bintree}");
    assert!(number(&strips, "upload_bytes_median") < number(&bintree, "upload_bytes_median"));
}

#[test]
fn a_budget_is_used_and_never_exceeded_but_by_the_roots() {
    for budget in ["60", "700", "4000"] {
        let reports = flown(&["--budget", budget]);
        assert_eq!(reports.len(), 8, "all criteria by queues");
        for (name, report) in &reports {
            assert!(name.ends_with("/queues"), "{name}");
            let most: f64 = budget.parse().expect("a number");
            assert!(number(report, "triangles_max") <= most, "{report}");
            let has_all = number(report, "max_m") == 0.0;
            assert!(number(report, "triangles") > 0.5 * most || has_all, "{report}");
        }
    }
    let small = ["lod", VALLEY, "--frames", "6", "--criterion", "spheres", "--budget"];
    let out = run(&[&small[..], &["1"]].concat()).ok();
    assert!(out.contains("triangle budget 1\n") && out.contains("note: up to"), "{out}");
    let out = run(&[&small[..], &["700", "--refine", "queues"]].concat()).ok();
    assert!(out.contains("triangle budget 700\n") && !out.contains("note:"), "{out}");
}

#[test]
fn a_budget_is_used_up_on_ground_with_slanted_margins_of_no_data() {
    let flight = ["lod", "assets/jacksboro/dem.tif", "--frames", "4", "--json", "--criterion", "spheres"];
    for budget in [1000.0, 5000.0] {
        let reports = objects(&run(&[&flight[..], &["--budget", &format!("{budget}")]].concat()).ok());
        let (mean, most) = (number(&reports[0], "triangles"), number(&reports[0], "triangles_max"));
        assert!(most <= budget && mean >= 0.98 * budget, "{} of {budget}", reports[0]);
    }
}

#[test]
fn criteria_that_promise_it_keep_the_tolerance_at_every_post_of_the_picture() {
    for tolerance_px in [0.5, 2.0, 9.0] {
        let written = tolerance_px.to_string();
        for criterion in ["screen", "bounding"] {
            for (name, report) in flown(&["--criterion", criterion, "--tolerance-px", &written]) {
                let found = number(&report, "max_px");
                assert!(found > 0.0 && found <= tolerance_px * 1.001, "{name}: {report}");
            }
        }
    }
}

#[test]
fn what_has_no_meaning_together_is_refused_with_what_has() {
    for (wrong, wanted) in [
        (&["--refine", "deferred", "--criterion", "screen"][..], "spheres, constrained and bounding"),
        (&["--refine", "deferred", "--emit", "strips"], "--emit bintree"),
        (&["--emit", "geomipmap", "--refine", "queues"], "geomipmap and full refine nothing"),
        (&["--emit", "full", "--criterion", "block"], "--emit bintree, quadtree and strips have"),
        (&["--emit", "full", "--budget", "900"], "no budget"),
        (&["--refine", "rebuild", "--budget", "900"], "only --refine queues keeps a budget"),
        (&["--budget", "900", "--tolerance-px", "1"], "cannot be used with"),
        (&["--budget", "0"], "0 is not in 1.."),
        (&["--budget", "many"], "invalid"),
    ] {
        let refused = run(&[&["lod", VALLEY], wrong].concat()).failed(2);
        assert!(refused.contains(wanted), "{wrong:?}: {refused}");
    }
}

#[test]
fn the_table_has_a_row_a_method_and_says_what_it_was_measured_on() {
    let out = run(&["lod", VALLEY, "--frames", "3", "--flight", "line", "--tolerance-px", "2.5"]).ok();
    for wanted in ["112 × 112 posts", "a line, 2 frames", "2.5 px", "bintree/screen/rebuild", "max m"] {
        assert!(out.contains(wanted), "{wanted} in\n{out}");
    }
    let rows: Vec<&str> = out.lines().skip(2).take_while(|line| !line.is_empty()).collect();
    assert!(rows.len() > 10 && rows[0].starts_with("method "), "{out}");
    assert!(rows.iter().all(|row| row.chars().count() == rows[0].chars().count()), "aligned\n{out}");
}

#[test]
fn what_is_asked_for_is_what_is_flown() {
    let arguments =
        ["lod", VALLEY, "--frames", "2", "--json", "--criterion", "spheres", "--refine", "rebuild"];
    let reports = objects(&run(&[&arguments[..], &["--emit", "bintree"]].concat()).ok());
    let names: Vec<&Value> = reports.iter().map(|report| &report["method"]).collect();
    assert_eq!(names, ["bintree/spheres/rebuild"]);
}

#[test]
fn everything_but_the_times_is_the_same_again() {
    let once = || {
        let reports: Vec<_> = [&[][..], &["--budget", "900"]].map(flown).into_iter().flatten().collect();
        reports.into_iter().map(|(name, report)| (name, findings(&report))).collect::<Vec<_>>()
    };
    assert_eq!(once(), once());
}

#[test]
fn a_finer_tolerance_takes_more_triangles_and_is_less_off() {
    let at = |tolerance: &str| {
        let arguments =
            ["lod", VALLEY, "--frames", "3", "--json", "--criterion", "spheres", "--tolerance-px"];
        objects(&run(&[&arguments[..], &[tolerance]].concat()).ok()).remove(0)
    };
    let (fine, coarse) = (at("1"), at("8"));
    assert!(number(&fine, "triangles") > number(&coarse, "triangles"), "{fine} {coarse}");
    assert!(number(&fine, "mean_m") < number(&coarse, "mean_m"), "{fine} {coarse}");
}

#[test]
fn a_file_of_stations_is_flown_and_an_eye_that_rests_changes_nothing() {
    let scratch = Scratch::new();
    scratch.write("valley.asc", crate::cli::bytes_of(VALLEY));
    scratch.write("rest.csv", "x,y,z,tx,ty,tz\n50,50,900,4000,4000,300\n50,50,900,4000,4000,300\n");
    let arguments = ["lod", "valley.asc", "--frames", "4", "--json", "--flight", "rest.csv"];
    for report in objects(&run_in(scratch.folder(), &arguments).ok()) {
        assert_eq!(number(&report, "changed_per_frame"), 0.0, "{report}");
        assert!(number(&report, "triangles") > 0.0, "{report}");
        let sends_all = report["refine"] == "rebuild";
        assert_eq!(number(&report, "upload_bytes_median") > 0.0, sends_all, "{report}");
    }
    scratch.write("away.csv", "-500 -500 900 -9000 -9000 900\n-600 -600 900 -9000 -9000 900\n");
    let arguments = ["lod", "valley.asc", "--frames", "4", "--json", "--flight", "away.csv"];
    for report in objects(&run_in(scratch.folder(), &arguments).ok()) {
        assert_eq!(
            (&report["triangles"], &report["mean_m"]),
            (&Value::from(0), &Value::Null),
            "nothing in view"
        );
    }
}

#[test]
fn flights_that_cannot_be_flown_are_refused_by_file_and_line() {
    let scratch = Scratch::new();
    scratch.write("valley.asc", crate::cli::bytes_of(VALLEY));
    for (text, wanted) in [
        ("1,2,3,4,5,6\n1,2,3\n", "way.csv:2: found '1,2,3'"),
        ("1,2,3,4,5,6\n", "way.csv: found 1 stations"),
        ("1,2,3,1,2,3\n1,2,3,4,5,6\n", "way.csv:1: the eye is its own target"),
        ("1,2,3,4,5,inf\n1,2,3,4,5,6\n", "way.csv:1: coordinates"),
        // The eye and its target change places and meet on the way.
        ("0,0,0,2,0,0\n2,0,0,0,0,0\n", "frame 2: the camera's eye and target are the same point"),
    ] {
        scratch.write("way.csv", text);
        let arguments = ["lod", "valley.asc", "--flight", "way.csv", "--frames", "3"];
        let refused = run_in(scratch.folder(), &arguments).failed(1);
        assert!(refused.contains(wanted), "{text:?}: {refused}");
    }
    let refused = run_in(scratch.folder(), &["lod", "valley.asc", "--flight", "spiral"]).failed(1);
    assert!(refused.contains("spiral: there is no such file"), "{refused}");
    scratch.write("way.csv", b"1,2,3,4,5,\xff\n");
    let refused = run_in(scratch.folder(), &["lod", "valley.asc", "--flight", "way.csv"]).failed(1);
    assert!(refused.contains("byte 10 is not UTF-8"), "{refused}");
}

#[test]
fn wrong_usage_and_wrong_files_are_told_apart() {
    for wrong in [
        &["--frames", "1"][..],
        &["--frames", "100001"],
        &["--tolerance-px", "0"],
        &["--tolerance-px", "NaN"],
        &["--tolerance-px", "-1"],
        &["--emit", "fans"],
        &["--criterion", "beauty"],
        &["--refine", "never"],
    ] {
        run(&[&["lod", VALLEY], wrong].concat()).failed(2);
    }
    let refused = run(&["lod", "nowhere.tif"]).failed(1);
    assert!(refused.contains("nowhere.tif: there is no such file"), "{refused}");
    let refused = run(&["lod", "assets/jacksboro/hills.png", "--height-scale", "0.1"]).failed(1);
    assert!(refused.contains("hills.png") && refused.contains("world file"), "{refused}");
}

#[test]
fn a_model_in_degrees_is_flown_over_in_meters() {
    let out = run(&["lod", "assets/jacksboro/dem.tif", "--frames", "2"]).ok();
    assert!(out.contains("83.22 × 83.22 m apart"), "{out}");
}

#[test]
#[ignore = "slow: flies over several real models"]
fn real_models_with_holes_are_flown_over() {
    for path in ["scenes/swellendam_za/dem_srtm_wgs84_f32.tif", "scenes/taunton_uk/dtm.tif"] {
        let Some(at) = data(path) else { continue };
        let file = at.to_string_lossy().into_owned();
        for report in objects(&run(&["lod", &file, "--frames", "3", "--json", "--tolerance-px", "4"]).ok()) {
            assert!(number(&report, "triangles") > 0.0, "{path}: {report}");
            assert!(number(&report, "mean_m").is_finite(), "{path}: {report}");
        }
    }
}
