//! What programs that run this one read: `catalog`, the classes of `analyze --json`, lines of progress.

use std::process::Command;

use serde_json::Value;

use crate::cli::{run, run_in};
use crate::common::scratch::Scratch;

#[test]
fn the_catalog_is_printed_as_a_json_list_of_the_kinds() {
    let catalog: Value = serde_json::from_str(&run(&["catalog"]).ok()).expect("JSON");
    let names = catalog.as_array().expect("a list").iter().map(|kind| kind["name"].as_str().expect("a name"));
    let help = run(&["analyze", "--help"]).ok();
    let mut count = 0;
    for name in names {
        assert!(help.contains(&format!("  {name}")), "{name} is a command");
        count += 1;
    }
    assert!(count > 30, "{count} kinds");
}

/// Ground that rises a meter per ten to the east.
fn tilted() -> Scratch {
    let scratch = Scratch::new();
    let head = "ncols 6\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
    scratch.write("tilt.asc", format!("{head}{}", "0 1 2 3 4 5\n".repeat(4)));
    scratch
}

#[test]
fn json_of_an_analysis_states_the_classes_of_its_raster() {
    let scratch = tilted();
    let line = ["analyze", "slope", "tilt.asc", "-o", "slope.tif", "--json"];
    let answer: Value = serde_json::from_str(&run_in(scratch.folder(), &line).ok()).expect("JSON");
    let classes = answer["classes"].as_array().expect("classes");
    assert!(classes.iter().any(|class| class["from"] == 10.0), "{classes:?}");
    assert!(classes.iter().all(|class| class["color"].as_str().is_some_and(|color| color.len() == 7)));
}

#[test]
fn steps_are_lines_where_a_program_asks_for_them() {
    let scratch = tilted();
    let said = |value: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sandtable"));
        command.current_dir(scratch.folder()).env("SANDTABLE_PROGRESS", value);
        let ran = command.args(["analyze", "slope", "tilt.asc"]).output().expect("it runs");
        String::from_utf8(ran.stderr).expect("text")
    };
    assert!(said("lines").contains("progress: analyzing\n"), "{}", said("lines"));
    assert!(!said("").contains("progress"), "{}", said(""));
}
