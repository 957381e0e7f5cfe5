//! `dem info` and `model info`.

use serde_json::Value;

use crate::cli::{project, run, run_in};
use crate::common::scratch::Scratch;

fn json(arguments: &[&str]) -> Value {
    let out = run(arguments).ok();
    assert_eq!(out.lines().count(), 1, "one object on one line");
    serde_json::from_str(&out).expect("JSON")
}

#[test]
fn dem_info_tells_what_is_in_a_file_in_json() {
    let about = json(&["dem", "info", "assets/jacksboro/dem.tif", "--json"]);
    assert_eq!(about["driver"], "GTiff");
    assert_eq!((about["width"].as_u64(), about["height"].as_u64()), (Some(403), Some(344)));
    assert_eq!(about["crs"], "EPSG:4326");
    assert_eq!(about["nodata"], Value::Null);
    assert_eq!((about["min"].as_f64(), about["max"].as_f64()), (Some(236.0), Some(1076.0)));
    assert!((about["mean"].as_f64().expect("a mean") - 531.0311688499048).abs() < 1e-9);
    assert_eq!(about["transform"].as_array().map(Vec::len), Some(6));
}

#[test]
fn dem_info_tells_the_same_in_a_table() {
    let out = run(&["dem", "info", "assets/jacksboro/valley.asc"]).ok();
    for wanted in ["driver   AAIGrid", "112 columns, 112 rows", "crs      none stated", "heights  "] {
        assert!(out.contains(wanted), "{wanted} in\n{out}");
    }
}

#[test]
fn a_png_needs_a_scale_and_may_have_an_offset() {
    let refused = run(&["dem", "info", "assets/jacksboro/hills.png"]).failed(1);
    assert!(refused.contains("--height-scale") && refused.contains("--height-offset"), "{refused}");
    assert_eq!(refused.matches("hills.png").count(), 1, "the file is named once: {refused}");

    let hills = ["dem", "info", "assets/jacksboro/hills.png", "--json", "--height-scale", "0.1"];
    let about = json(&hills);
    assert_eq!(about["driver"], "PNG");
    let raised = json(&[&hills[..], &["--height-offset", "-100"]].concat());
    let lowest = |about: &Value| about["min"].as_f64().expect("a number");
    assert!((lowest(&about) - 100.0 - lowest(&raised)).abs() < 1e-4, "{raised}");

    let zero = run(&["dem", "info", "assets/jacksboro/hills.png", "--height-scale", "NaN"]).failed(1);
    assert!(zero.contains("NaN"), "{zero}");
}

#[test]
fn a_stated_value_means_no_data_besides_the_file_s() {
    let valley = ["dem", "info", "assets/jacksboro/valley.asc", "--json"];
    let lowest = |about: &Value| about["min"].as_f64().expect("a number");
    let declared = json(&valley);
    let low = lowest(&declared).to_string();
    let stated = json(&[&valley[..], &["--nodata", &low]].concat());
    assert!(lowest(&stated) > lowest(&declared), "{stated}");
    let valid = |about: &Value| about["valid"].as_u64().expect("a count");
    assert!(valid(&stated) < valid(&declared), "{stated}");
}

#[test]
fn a_grid_without_a_single_height_has_no_statistics() {
    let scratch = Scratch::new();
    scratch.write(
        "a.asc",
        "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9\n-9 -9\n-9 -9\n",
    );
    let out = run_in(scratch.folder(), &["dem", "info", "a.asc", "--json"]).ok();
    let about: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(
        (&about["min"], &about["mean"], &about["valid"]),
        (&Value::Null, &Value::Null, &Value::from(0))
    );
    assert!(run_in(scratch.folder(), &["dem", "info", "a.asc"]).ok().contains("heights  none"));
}

#[test]
fn model_info_counts_and_bounds_in_json() {
    for (file, meshes) in [("bridge.glb", 8), ("watchtower.3ds", 0), ("farmhouse.obj", 0)] {
        let about = json(&["model", "info", &project(&format!("assets/models/{file}")), "--json"]);
        for key in ["meshes", "vertices", "faces", "materials"] {
            assert!(about[key].as_u64().is_some_and(|count| count > 0), "{file}: {key} in {about}");
        }
        assert!(meshes == 0 || about["meshes"] == meshes, "{file}");
        let bound = |end: &str| -> Vec<f64> {
            about["bounds"][end].as_array().expect("a corner").iter().filter_map(Value::as_f64).collect()
        };
        let (min, max) = (bound("min"), bound("max"));
        assert_eq!((min.len(), max.len()), (3, 3), "{about}");
        assert!(min.iter().zip(&max).all(|(min, max)| min < max), "{file}: {about}");
    }
    let table = run(&["model", "info", "assets/models/tent.glb"]).ok();
    assert!(table.contains("vertices") && table.contains("Z up"), "{table}");
}

#[test]
fn what_is_no_elevation_or_no_model_is_refused_with_what_is_read() {
    let refused = run(&["dem", "info", "assets/models/tent.glb"]).failed(1);
    assert!(refused.contains("tent.glb") && refused.contains("GeoTIFF"), "{refused}");
    let refused = run(&["model", "info", "assets/jacksboro/dem.tif"]).failed(1);
    assert!(refused.contains("dem.tif") && refused.to_lowercase().contains("obj"), "{refused}");
    assert_eq!(refused.matches("dem.tif").count(), 1, "the file is named once: {refused}");
}

#[test]
fn missing_empty_and_strange_files_are_refused() {
    let scratch = Scratch::new();
    scratch.write("empty.tif", "");
    scratch.write("empty.obj", "");
    scratch.write("empty", "");
    for (arguments, wanted) in [
        (["dem", "info", "nowhere.tif"], "no such file"),
        (["dem", "info", "empty.tif"], "empty.tif"),
        (["dem", "info", "empty"], "empty"),
        (["dem", "info", "."], "empty.tif"),
        (["model", "info", "nowhere.obj"], "no such file"),
        (["model", "info", "empty.obj"], "empty.obj"),
        (["model", "info", "."], "not a file"),
        (["check", ".", "--allow=."], "a folder, not a scene file"),
    ] {
        let refused = run_in(scratch.folder(), &arguments).failed(1);
        assert!(refused.contains(wanted), "{arguments:?}: {refused}");
    }
}

#[test]
fn a_folder_of_tiles_is_one_raster() {
    let scratch = Scratch::new();
    let tile = |west: u32, heights: &str| {
        format!("ncols 2\nnrows 1\nxllcorner {west}\nyllcorner 0\ncellsize 10\n{heights}\n")
    };
    scratch.write("tiles/a.asc", tile(0, "1 2"));
    scratch.write("tiles/b.asc", tile(10, "2.5 3"));
    scratch.write("tiles/readme.txt", "not a tile");
    let out = run_in(scratch.folder(), &["dem", "info", "tiles", "--json"]).ok();
    let about: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((&about["width"], &about["max"]), (&Value::from(3), &Value::from(3.0)));
    assert!(
        about["notes"][0].as_str().expect("a note").contains("1 of them differs, by up to 0.5"),
        "{about}"
    );

    scratch.write("tiles/c.asc", tile(23, "4 5"));
    let refused = run_in(scratch.folder(), &["dem", "info", "tiles"]).failed(1);
    assert!(refused.contains("a.asc and c.asc") && refused.contains("(0.3000, 0.0000)"), "{refused}");
    scratch.write("empty/readme.txt", "nothing");
    let refused = run_in(scratch.folder(), &["dem", "info", "empty"]).failed(1);
    assert!(refused.contains("no elevation file"), "{refused}");
}

#[test]
fn dem_info_tells_type_datum_unit_and_voids() {
    let scratch = Scratch::new();
    let heights = "1 1 1\n1 -9999 1\n1 1 1\n";
    scratch.write("a.asc", format!("ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n{heights}"));
    let out = run_in(scratch.folder(), &["dem", "info", "a.asc", "--json"]).ok();
    let about: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((&about["type"], &about["enclosed_voids"]), (&Value::from("Int32"), &Value::from(1)));
    assert_eq!((&about["vertical_datum"], &about["meters_per_z"]), (&Value::Null, &Value::from(1.0)));
    let table = run_in(scratch.folder(), &["dem", "info", "a.asc"]).ok();
    for wanted in
        ["type     Int32", "1 sample, 1 of them enclosed, in 1 void", "datum    none stated", "unit     1 m"]
    {
        assert!(table.contains(wanted), "{wanted} in\n{table}");
    }
}

#[test]
fn elevations_beside_coordinates_in_feet_are_told_to_be_taken_for_meters() {
    let scratch = Scratch::new();
    let at = "ncols 2\nnrows 2\nxllcorner 2700000\nyllcorner 250000\ncellsize 10\n";
    scratch.write("a.asc", format!("{at}1053 1100\n1200 1664\n"));
    scratch.write("a.prj", "EPSG:2272");
    let info = run_in(scratch.folder(), &["dem", "info", "a.asc"]).ok();
    let told = "coordinates are in US survey feet, and nothing states the unit of elevations";
    assert!(info.contains(told), "{info}");
    let heights = run_in(scratch.folder(), &["height", "a.asc", "--at", "2700010,250010"]);
    assert!(heights.err.contains(told), "{}", heights.err);
    let in_feet = ["height", "a.asc", "--at", "2700005,250005", "--vertical-unit", "us-ft"];
    let heights = run_in(scratch.folder(), &in_feet);
    let out = heights.out.clone();
    assert!(
        heights.err.is_empty() && out.contains(&format!("{},Ok", 1200.0 * (1200.0 / 3937.0))),
        "{heights:?}"
    );
    let refused = run_in(scratch.folder(), &["height", "a.asc", "--at", "0,0", "--vertical-unit", "ell"]);
    assert!(refused.code == 2 && refused.err.contains("m, ft or us-ft"), "{refused:?}");
}

#[test]
fn every_command_on_elevation_tells_what_reading_the_file_left_out() {
    let scratch = Scratch::new();
    let point = |index: u32| match (index % 4, index / 4) {
        (2, 2) => "10 deep\n".to_owned(),
        (column, row) => format!("{} {} {}\n", 5 * column, 5 * row, column + row),
    };
    scratch.write("a.xyz", (0..16).map(point).collect::<String>());
    for arguments in [
        &["height", "a.xyz", "--at", "0,10"][..],
        &["profile", "a.xyz", "--line", "0,0", "5,5"],
        &["los", "a.xyz", "--from", "0,0", "--to", "5,5"],
        &["viewshed", "a.xyz", "--at", "5,5", "-o", "seen.tif"],
        &["mesh", "a.xyz", "--max-error", "1", "-o", "a.obj"],
        &["lod", "a.xyz", "--frames", "2"],
    ] {
        let ran = run_in(scratch.folder(), arguments);
        let told = "note: a.xyz: left out: 1 line that is no point: line 11 is '10 deep'\n";
        assert!(ran.code == 0 && ran.err.contains(told), "{arguments:?}: {ran:?}");
    }
}

#[test]
fn a_raw_file_is_what_the_command_line_says() {
    let scratch = Scratch::new();
    scratch.write("a.raw", "AB");
    let refused = run_in(scratch.folder(), &["dem", "info", "a.raw"]).failed(1);
    assert!(refused.contains("--raw 1201x1201:i16be"), "{refused}");
    let stated = ["dem", "info", "a.raw", "--json", "--raw", "2x1:u8", "--height-scale", "2"];
    let about: Value = serde_json::from_str(&run_in(scratch.folder(), &stated).ok()).expect("JSON");
    assert_eq!((&about["driver"], &about["max"]), (&Value::from("RAW"), &Value::from(132.0)));
    let wrong = run_in(scratch.folder(), &["dem", "info", "a.raw", "--raw", "2x1"]).failed(2);
    assert!(wrong.contains("1201x1201:i16be"), "{wrong}");
}

#[test]
fn dem_info_tells_what_was_guessed_of_a_file() {
    let scratch = Scratch::new();
    let head = "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
    scratch.write("word.asc", format!("{head}NODATA_value -9999\n1 2 null 4\n5 6 7 8\n9 10 11 -9999\n"));
    let out = run_in(scratch.folder(), &["dem", "info", "word.asc", "--json"]).ok();
    let about: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((about["valid"].as_u64(), about["bands"].as_u64()), (Some(10), Some(1)));
    assert_eq!(about["mask_band"], Value::Null);
    assert!(about["notes"][0].as_str().is_some_and(|note| note.contains("'null'")), "{about}");

    scratch
        .write("usual.asc", format!("{head}NODATA_value -1\n1 2 32767 32767\n5 6 32767 32767\n9 10 11 12\n"));
    let table = run_in(scratch.folder(), &["dem", "info", "usual.asc"]).ok();
    assert!(table.contains("4 samples (33.3 %) are 32767; the others are from 1 to 12"), "{table}");
    assert!(table.contains("say --nodata 32767") && table.contains("bands    1: elevation"), "{table}");
    let stated = run_in(scratch.folder(), &["dem", "info", "usual.asc", "--nodata", "32767"]).ok();
    assert!(stated.contains("8 of 12 samples") && !stated.contains("if that means"), "{stated}");

    // Two bands of bytes by pixel.
    scratch.write("two.bip", [5u8, 0, 6, 1, 7, 0, 8, 1]);
    scratch.write("two.hdr", "NROWS 2\nNCOLS 2\nNBANDS 2\nNBITS 8\nLAYOUT BIP\nNODATA none\n");
    let table = run_in(scratch.folder(), &["dem", "info", "two.bip"]).ok();
    assert!(table.contains("bands    2: elevation, and one that is not read"), "{table}");
    assert!(
        table.contains("the first of its 2 bands is read") && table.contains("'none' is no number"),
        "{table}"
    );
}
