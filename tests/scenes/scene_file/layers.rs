//! Scene files made of several: includes and named styles; and features chosen by expressions.

use std::collections::BTreeMap;

use sandtable_description::document::Document;
use sandtable_description::parse::parse_including;
use sandtable_description::scalar::Scalar;
use sandtable_description::selection::Selection;

/// The scene `scenes/hill.toml` with this text, beside files of these names.
fn scene(text: &str, files: &[(&str, &str)]) -> Result<Document, String> {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let load = |name: &str| {
        let text = files.get(name).ok_or_else(|| format!("there is no file {name}").into());
        text.map(|text| text.as_bytes().to_vec())
    };
    parse_including("scenes/hill.toml", text.as_bytes(), &load).map_err(|errors| errors.to_string())
}

#[track_caller]
fn sound(text: &str, files: &[(&str, &str)]) -> Document {
    scene(text, files).unwrap_or_else(|errors| panic!("{errors}"))
}

#[track_caller]
fn refused(text: &str, files: &[(&str, &str)], wanted: &[&str]) {
    let errors = scene(text, files).expect_err("it is broken");
    for wanted in wanted {
        assert!(errors.contains(wanted), "no {wanted:?} in\n{errors}");
    }
}

const LEAST: &str = "[terrain]\ndem = \"a.tif\"\n";

fn width(document: &Document, road: usize) -> Option<f64> {
    document.roads[road].width.stated().and_then(|width| width.value(&|_| None))
}

/// The names of the elevation files.
fn elevation_files(document: &Document) -> Vec<&str> {
    document.terrain.dem.iter().map(|tile| tile.file.as_str()).collect()
}

fn file(document: &Document, road: usize) -> &str {
    document.roads[road].source.file.as_ref().map_or("", |file| file.as_str())
}

#[test]
fn what_is_included_comes_first_and_what_is_stated_counts() {
    let common = "title = \"common\"\nsubtitle = \"kept\"\n[terrain]\ndem = \"low.tif\"\ntolerance_px = 2\n\
                  [style]\nhaze = 5\n[style.light]\nazimuth = 90\naltitude = 20\n[[road]]\nfile = \"first\"\n";
    let text = "include = \"common.toml\"\ntitle = \"own\"\n[terrain]\ndem = \"a.tif\"\n\
                [style.light]\naltitude = 60\n[[road]]\nfile = \"second\"\n";
    let document = sound(text, &[("common.toml", common)]);
    assert_eq!((document.title.as_deref(), document.subtitle.as_deref()), (Some("own"), Some("kept")));
    assert_eq!(elevation_files(&document), ["a.tif"]);
    assert_eq!(*document.terrain.tolerance_px, 2.0);
    let light = &document.style.light;
    assert_eq!(light.azimuth, Some(90.0));
    assert_eq!(light.altitude, Some(60.0));
    assert_eq!((file(&document, 0), file(&document, 1)), ("first", "second"));
}

#[test]
fn of_several_included_files_the_later_wins_and_lists_within_tables_are_replaced() {
    let files = [
        ("one.toml", "title = \"one\"\n[style]\nramp = [[0, \"#000\"], [1, \"#fff\"]]\n"),
        ("two.toml", "title = \"two\"\n[style]\nramp = [[5, \"#000\"], [6, \"#fff\"], [7, \"#fff\"]]\n"),
    ];
    let document = sound(&format!("include = [\"one.toml\", \"two.toml\"]\n{LEAST}"), &files);
    assert_eq!(document.title.as_deref(), Some("two"));
    let ramp = format!("{:?}", *document.style.ramp);
    assert!(ramp.contains("7.0") && !ramp.contains("1.0,"), "{ramp}");
}

#[test]
fn names_in_an_included_file_are_relative_to_it() {
    let files = [
        (
            "../common/base.toml",
            "include = \"deep/roads.toml\"\n[terrain]\ndem = [\"a.tif\", \"/data/b.tif\"]\n",
        ),
        (
            "../common/deep/roads.toml",
            "[[road]]\nfile = \"../roads.geojson\"\n[[scatter]]\nfile = \"w\"\nof = [\"conifer\", \"oak.glb\"]\n\
             [[model]]\nfile = \"m.glb\"\nat = [1, 2]\n",
        ),
    ];
    let document = sound("include = \"../common/base.toml\"\n", &files);
    assert_eq!(elevation_files(&document), ["../common/a.tif", "/data/b.tif"]);
    assert_eq!(file(&document, 0), "../common/roads.geojson");
    assert_eq!(*document.models[0].file, "../common/deep/m.glb");
    assert_eq!(*document.scatters[0].models, ["conifer", "../common/deep/oak.glb"]);
}

#[test]
fn a_mistake_in_an_included_file_is_shown_there() {
    let files = [("more/roads.toml", "\n[[road]]\nfile = \"r\"\nwidht = 3\n")];
    refused(
        &format!("include = \"more/roads.toml\"\n{LEAST}"),
        &files,
        &[
            "scenes/more/roads.toml:4:1: error[unknown-key]: unknown key `widht` in [[road]]",
            "4 | widht = 3\n  | ^^^^^",
        ],
    );
    let syntax = [("more/roads.toml", "[[road]]\nfile = roads\n")];
    refused(
        &format!("include = \"more/roads.toml\"\n{LEAST}"),
        &syntax,
        &["scenes/more/roads.toml:2:8: error[syntax]: text must be in quotes"],
    );
    let document =
        sound(&format!("include = \"b.toml\"\n{LEAST}"), &[("b.toml", "[[road]]\nfile = \"r\"\n")]);
    let place = document.roads[0].source.file.as_ref().expect("stated");
    let shown = document.error(place, "no such file").to_string();
    assert!(shown.starts_with("scenes/b.toml:2:8: error[wrong-value]: no such file"), "{shown}");
}

#[test]
fn what_cannot_be_included_is_told_where_it_is_named() {
    refused(
        &format!("include = [\"gone.toml\"]\n{LEAST}"),
        &[],
        &[
            "scenes/hill.toml:1:12: error[missing-file]: 'gone.toml' cannot be included: there is no file gone.toml",
        ],
    );
    refused(&format!("include = 3\n{LEAST}"), &[], &["hill.toml:1:11:", "`include` must be text"]);
    let cycle = [("a.toml", "include = \"b.toml\"\n"), ("b.toml", "include = \"a.toml\"\n")];
    refused(
        &format!("include = \"a.toml\"\n{LEAST}"),
        &cycle,
        &["scenes/b.toml:1:11: error[wrong-value]: 'a.toml' includes itself"],
    );
    refused(
        &format!("include = \"hill.toml\"\n{LEAST}"),
        &[],
        &["hill.toml:1:11: error[wrong-value]: 'hill.toml' includes itself"],
    );
    let names: Vec<String> = (0..12).map(|index| format!("{index}.toml")).collect();
    let texts: Vec<String> = (1..13).map(|index| format!("include = \"{index}.toml\"\n")).collect();
    let chain: Vec<(&str, &str)> =
        names.iter().zip(&texts).map(|(name, text)| (name.as_str(), text.as_str())).collect();
    refused(&format!("include = \"0.toml\"\n{LEAST}"), &chain, &["scenes/7.toml:1:11:", "8 deep"]);
    let huge = " ".repeat(4 << 20);
    refused(&format!("include = \"h.toml\"\n{LEAST}"), &[("h.toml", &huge)], &["more than 4194304 bytes"]);
}

#[test]
fn a_file_that_is_included_twice_counts_once() {
    let files = [
        ("a.toml", "include = \"c.toml\"\n"),
        ("b.toml", "include = \"./c.toml\"\n"),
        ("c.toml", "[[road]]\nfile = \"r\"\n"),
    ];
    let document = sound(&format!("include = [\"a.toml\", \"b.toml\", \"c.toml\"]\n{LEAST}"), &files);
    assert_eq!(document.roads.len(), 1);
}

#[test]
fn a_table_takes_the_keys_of_its_style_that_it_does_not_state() {
    let text = format!(
        "{LEAST}[styles.lane]\nwidth = 3.5\nsurface = \"gravel\"\nfile = \"lanes\"\n\
         [[road]]\nstyle = \"lane\"\n[[road]]\nstyle = \"lane\"\nwidth = 4\nfile = \"more\"\n[[road]]\nfile = \"r\"\n"
    );
    let document = sound(&text, &[]);
    assert_eq!([0, 1, 2].map(|road| width(&document, road)), [Some(3.5), Some(4.0), None]);
    assert_eq!([0, 1, 2].map(|road| file(&document, road)), ["lanes", "more", "r"]);
}

#[test]
fn what_a_table_states_drives_out_what_the_style_says_instead() {
    let text = format!(
        "{LEAST}[styles.a]\nfile = \"f\"\nwhere = \"x\"\nwidth = 9\n[[road]]\nstyle = \"a\"\npoints = [[0, 0], [1, 1]]\n\
         widths = [3, 4]\n[styles.l]\nlevel_rule = \"mean\"\n[[lake]]\nstyle = \"l\"\nfile = \"g\"\nlevel = 5\n"
    );
    let document = sound(&text, &[]);
    assert!(document.roads[0].width.stated().is_none() && document.roads[0].source.file.is_none());
}

#[test]
fn styles_may_come_from_an_include_key_by_key() {
    let common = "[styles.lane]\nwidth = 3\nsurface = \"gravel\"\n";
    let text = format!(
        "include = \"s.toml\"\n{LEAST}[styles.lane]\nwidth = 5\n[[road]]\nstyle = \"lane\"\nfile = \"r\"\n"
    );
    let document = sound(&text, &[("s.toml", common)]);
    assert_eq!(width(&document, 0), Some(5.0));
    assert!(document.roads[0].surface.stated().is_some());
}

#[test]
fn wrong_styles_are_told_where_they_stand() {
    refused(
        &format!("{LEAST}[styles.lane]\nwidth = 3\n[[road]]\nstyle = \"lame\"\nfile = \"r\"\n"),
        &[],
        &["hill.toml:6:9: error[unknown-name]: there is no style \"lame\"", "did you mean `lane`?"],
    );
    refused(
        &format!("{LEAST}[[road]]\nstyle = \"lane\"\nfile = \"r\"\n"),
        &[],
        &["add a table [styles.lane]"],
    );
    let twice = format!(
        "{LEAST}[styles.lane]\nroof = \"flat\"\n[[road]]\nstyle = \"lane\"\nfile = \"r\"\n[[road]]\nstyle = \"lane\"\nfile = \"r\"\n"
    );
    refused(&twice, &[], &["hill.toml:4:1: error[unknown-key]: unknown key `roof` in [[road]]"]);
    let errors = scene(&twice, &[]).expect_err("broken");
    assert_eq!(errors.matches("error[").count(), 1, "told once:\n{errors}");
    refused(
        &format!("{LEAST}[styles]\nlane = 3\n"),
        &[],
        &["hill.toml:4:1:", "must hold tables", "[styles.NAME]"],
    );
    refused(&format!("{LEAST}[styles.a]\nstyle = \"b\"\n"), &[], &["hill.toml:4:1:", "another one"]);
    refused(&format!("{LEAST}styles = 3\n"), &[], &["hill.toml:3:1:"]);
}

#[test]
fn a_style_cannot_fill_the_memory() {
    let points = "[1, 2], ".repeat(50_000);
    let roads = "[[road]]\nstyle = \"a\"\n".repeat(200);
    refused(
        &format!("{LEAST}[styles.a]\npoints = [{points}]\n{roads}"),
        &[],
        &["styles add more than 16777216 bytes in all"],
    );
}

#[test]
fn where_may_be_an_expression() {
    let text = format!("{LEAST}[[road]]\nfile = \"r\"\nwhere = \"highway = 'primary' and lanes >= 2\"\n");
    let document = sound(&text, &[]);
    let Some(Selection::Holding(condition)) = document.roads[0].source.selection.as_deref() else {
        panic!("an expression")
    };
    let with = |lanes: &'static str| {
        condition.holds(&move |name| match name {
            "highway" => Some(Scalar::Text("primary".into())),
            _ => Some(Scalar::Text(lanes.into())),
        })
    };
    assert!(with("2") && !with("1"));
}

#[test]
fn a_mistake_in_an_expression_is_underlined_in_it() {
    refused(
        &format!("{LEAST}[[road]]\nfile = \"r\"\nwidth = \"lanes * * 3\"\n"),
        &[],
        &[
            "scenes/hill.toml:5:18: error[wrong-value]: `width`: expected a number, a text or a property, but found `*`",
            "5 | width = \"lanes * * 3\"\n  |                  ^",
        ],
    );
    refused(
        &format!("{LEAST}[[road]]\nfile = \"r\"\nwidth = \"lanes \\u002a * 3\"\n"),
        &[],
        &["scenes/hill.toml:5:9: error[wrong-value]:", "at column 9"],
    );
    refused(
        &format!("{LEAST}[[road]]\nfile = \"r\"\nsurface = \"if(paved, asphalt, 'gravel')\"\n"),
        &[],
        &["hill.toml:5:22:", "the word asphalt must be in quotes"],
    );
    refused(
        &format!("{LEAST}[[area]]\nfile = \"r\"\ncover = \"match(landuse, 'forest', 'forrest')\"\n"),
        &[],
        &["hill.toml:5:35:", "cannot be \"forrest\"", "did you mean `forest`?"],
    );
}
