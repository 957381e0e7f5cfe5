//! Scene files with something wrong: a place, a sentence, a remedy.

use crate::cli::{bytes_of, project, run_in};
use crate::common::scratch::Scratch;

/// A scene file over the valley, in `project/scenes`.
fn valley(more: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("project/data/valley.asc", bytes_of("assets/jacksboro/valley.asc"));
    let head = "[terrain]\ndem = \"../data/valley.asc\"\ncrs = \"EPSG:32616\"\n";
    scratch.write("project/scenes/a.toml", format!("{head}{more}"));
    scratch
}

fn check(scratch: &Scratch) -> crate::cli::Ran {
    run_in(&scratch.at("project"), &["check", "scenes/a.toml"])
}

#[test]
fn a_sound_scene_is_told_with_what_is_in_it() {
    let scratch = valley("[[label]]\ntext = \"here\"\nat = [750500, 4018883]\n");
    let out = check(&scratch).ok();
    assert!(out.starts_with("scenes/a.toml is sound\n"), "{out}");
    for wanted in ["112×112 posts", "1 label", "cameras   overview"] {
        assert!(out.contains(wanted), "{wanted} in\n{out}");
    }
}

#[test]
fn a_wrong_key_is_shown_where_it_stands_with_what_was_meant() {
    let scratch = valley("\n[[road]]\npoints = [[750500, 4018883], [751000, 4019000]]\nwdith = 8\n");
    let refused = check(&scratch).failed(1);
    for wanted in ["scenes/a.toml:7:1: error[unknown-key]: ", "wdith = 8", "^", "did you mean `width`?"] {
        assert!(refused.contains(wanted), "{wanted} in\n{refused}");
    }
    assert!(refused.starts_with("scenes/a.toml:7:1"), "nothing stands before the place:\n{refused}");
}

#[test]
fn what_turns_out_wrong_while_building_points_into_the_file_too() {
    for (more, place, wanted) in [
        ("[[label]]\ntext = \"off\"\nat = [1, 2]\n", "a.toml:6:6: error[off-terrain]: ", "points_crs"),
        (
            "[[model]]\nfile = \"none.glb\"\nat = [750500, 4018883]\n",
            "a.toml:5:8: error[missing-file]: ",
            "no file",
        ),
        ("[[road]]\nfile = \"../data/valley.asc\"\n", "a.toml:5:8: error[wrong-format]: ", "GeoJSON"),
        (
            "[[lake]]\npoints = [[750500, 4018883], [751000, 4019000]]\n",
            "a.toml:5:10: error[wrong-value]: ",
            "3 points",
        ),
        (
            "[[camera]]\nname = \"a\"\neye = [0, 0]\nlook_at = [750500, 4018883]\n",
            "a.toml:6:7: error[off-terrain]: ",
            "eye_elevation",
        ),
    ] {
        let refused = check(&valley(more)).failed(1);
        assert!(refused.contains(place) && refused.contains(wanted), "{place} and {wanted} in\n{refused}");
    }
}

#[test]
fn one_check_tells_every_table_that_keeps_the_scene_from_being_built() {
    let tables = [
        ("[[symbol]]\nsidc = \"nonsense\"\nat = [750500, 4018883]\n", "wrong-value"),
        ("[[symbol]]\nsidc = \"10031000161211020000\"\nat = [1, 2]\n", "off-terrain"),
        ("[[graphic]]\nkind = \"boundry\"\npoints = [[750500, 4018883], [751000, 4019000]]\n", "wrong-value"),
        ("[[graphic]]\nkind = \"boundary\"\npoints = [[750500, 4018883]]\n", "wrong-value"),
        ("[[label]]\ntext = \"off\"\nat = [1, 2]\n", "off-terrain"),
        ("[[label]]\ntext = \"off too\"\nat = [3, 4]\n", "off-terrain"),
        ("[[model]]\nfile = \"none.glb\"\nat = [750500, 4018883]\n", "missing-file"),
        ("[[model]]\nfile = \"conifer\"\nat = [1, 2]\n", "off-terrain"),
        ("[[sight]]\nobserver = [1, 2]\ntargets = [[750500, 4018883]]\n", "off-terrain"),
        ("[[road]]\nfile = \"none.geojson\"\n", "missing-file"),
        ("[[area]]\ncover = \"forest\"\nfile = \"none.geojson\"\n", "missing-file"),
        ("[[camera]]\nname = \"a\"\neye = [0, 0]\nlook_at = [750500, 4018883]\n", "off-terrain"),
        ("[[camera]]\nname = \"b\"\neye = [750500, 4018883]\nlook_at = [0, 0]\n", "off-terrain"),
    ];
    let text: String = tables.iter().map(|(table, _)| *table).collect();
    let scratch = valley(&text);
    let refused = check(&scratch).failed(1);
    // Each in its own lines of the file, which has three before.
    let mut line = 4;
    for (table, code) in tables {
        let lines = line..line + table.lines().count();
        let is_told = refused.lines().any(|told| {
            let place = told.strip_prefix("scenes/a.toml:").or_else(|| told.split("a.toml:").nth(1));
            let at = place.and_then(|place| place.split(':').next()?.parse::<usize>().ok());
            at.is_some_and(|at| lines.contains(&at)) && told.contains(&format!("error[{code}]"))
        });
        assert!(is_told, "{code} in lines {lines:?} of\n{text}\nin\n{refused}");
        line = lines.end;
    }
    let json = run_in(&scratch.at("project"), &["check", "scenes/a.toml", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(told["errors"], 13, "{told:#}");
}

#[test]
fn labels_over_voids_are_all_told() {
    let scratch = Scratch::new();
    let grid = "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 10\nnodata_value -9\n";
    let rows = "1 2 3 -9\n1 2 3 -9\n1 2 3 -9\n1 2 3 -9\n";
    scratch.write("project/data/valley.asc", format!("{grid}{rows}"));
    let label = |y: f64| format!("[[label]]\ntext = \"void\"\nat = [35, {y}]\n");
    let head = "[terrain]\ndem = \"../data/valley.asc\"\ncrs = \"EPSG:32616\"\nfill_voids = false\n";
    scratch.write("project/scenes/a.toml", format!("{head}{}{}", label(15.0), label(25.0)));
    let refused = check(&scratch).failed(1);
    for line in [7, 10] {
        assert!(refused.contains(&format!("a.toml:{line}:6: error[nodata-under]")), "{line} in\n{refused}");
    }
}

#[test]
fn a_missing_elevation_file_is_told_with_the_name_that_is_there() {
    let scratch = Scratch::new();
    scratch.write("project/data/valley.asc", "");
    scratch.write("project/scenes/a.toml", "[terrain]\ndem = \"../data/vally.asc\"\n");
    let refused = check(&scratch).failed(1);
    assert!(
        refused.contains("a.toml:2:7: error[missing-file]: ")
            && refused.contains("did you mean 'valley.asc'?"),
        "{refused}"
    );
}

#[test]
fn a_scene_reads_only_where_it_may_unless_it_is_allowed() {
    let scratch = Scratch::new();
    scratch.write(
        "project/scenes/a.toml",
        "[terrain]\ndem = \"../../elsewhere/valley.asc\"\ncrs = \"EPSG:32616\"\n",
    );
    scratch.write("elsewhere/valley.asc", bytes_of("assets/jacksboro/valley.asc"));
    let refused = check(&scratch).failed(1);
    let remedy = format!("--allow {}", scratch.at("elsewhere").display());
    assert!(refused.contains("a.toml:2:7: error[file-outside]: ") && refused.contains(&remedy), "{refused}");
    for command in [&["check"][..], &["render", "--size", "64x48"]] {
        let arguments = [command, &["scenes/a.toml", "--allow", "../elsewhere"]].concat();
        run_in(&scratch.at("project"), &arguments).ok();
    }
    let refused = run_in(&scratch.at("project"), &["check", "scenes/a.toml", "--allow", "none"]).failed(1);
    assert!(refused.contains("none"), "{refused}");
}

#[test]
fn an_absolute_path_needs_to_be_allowed() {
    let scratch = Scratch::new();
    let dem = project("assets/jacksboro/dem.tif");
    scratch.write("project/scenes/a.toml", format!("[terrain]\ndem = '{dem}'\n"));
    assert!(check(&scratch).failed(1).contains("--allow"));
    let allowed = project("assets/jacksboro");
    run_in(&scratch.at("project"), &["check", "scenes/a.toml", "--allow", &allowed]).ok();
}

#[test]
fn files_that_are_no_scene_are_refused_with_a_place() {
    for (bytes, wanted) in [
        (&b""[..], "terrain"),
        (b"\n\n", "terrain"),
        (b"title = \"a\xff\"\n", "UTF-8"),
        (b"\xff\xfet\0i\0", "UTF-8"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "UTF-8"),
        (b"[terrain\n", "a.toml:1:"),
        (b"<?xml version=\"1.0\"?>", "a.toml:1:1"),
        (b"\0\0\0\0", "a.toml:1:1"),
    ] {
        let scratch = Scratch::new();
        scratch.write("project/scenes/a.toml", bytes);
        let refused = check(&scratch).failed(1);
        assert!(refused.contains("a.toml") && refused.contains(wanted), "{wanted} in\n{refused}");
    }
}

#[test]
fn a_png_as_the_ground_asks_for_its_scale() {
    let scratch = Scratch::new();
    scratch.write("project/scenes/hills.png", bytes_of("assets/jacksboro/hills.png"));
    scratch.write("project/scenes/a.toml", "[terrain]\ndem = \"hills.png\"\n");
    let refused = check(&scratch).failed(1);
    assert!(refused.contains("a.toml:2:7") && refused.contains("height_scale"), "{refused}");
}
