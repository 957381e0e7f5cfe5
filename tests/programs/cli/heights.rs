//! `height`: points in, heights out.

use std::path::Path;

use glam::DVec2;
use sandtable_dem::hints::DemOptions;
use sandtable_geom::crs::Crs;
use sandtable_geom::geoid::Geoid;
use sandtable_query::dataset::{Dataset, DatasetOptions};
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_terrain::query::{Interpolation, Surface, ground_height};
use serde_json::Value;

use crate::cli::{project, run, run_in, run_with_input};
use crate::common::data::{data, files_below};
use crate::common::scratch::Scratch;

/// Three rows of four samples ten meters apart, the second of the second row a hole. Sample centers stand at
/// 5, 15, 25 and 35 east and 25, 15 and 5 north.
const GRID: &str = "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n\
                    10 20 30 40\n50 -9999 70 80\n90 100 110 120\n";

fn grid() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("grid.asc", GRID);
    scratch
}

const HEIGHT: [&str; 4] = ["height", "grid.asc", "--points", "-"];

#[test]
fn points_inside_in_a_hole_and_outside_are_answered_in_their_order() {
    let scratch = grid();
    let points = "35,25\n5.0,5\n15,15\n-400,1e3\n30,20\n";
    scratch.write("points.csv", points);
    let out = run_in(scratch.folder(), &["height", "grid.asc", "--points", "points.csv"]).ok();
    assert_eq!(
        out,
        "x,y,height,status\n35,25,40,Ok\n5.0,5,90,Ok\n15,15,,NoData\n-400,1e3,,Outside\n30,20,55,Ok\n"
    );
    assert_eq!(run_with_input(scratch.folder(), &HEIGHT, points).ok(), out, "standard input says the same");
}

#[test]
fn heights_are_brought_to_the_ellipsoid_where_it_is_known_what_they_count_from() {
    let scratch = grid();
    scratch.write("grid.prj", "EPSG:32632");
    let height = |more: &[&str]| {
        run_in(
            scratch.folder(),
            &[&["height", "grid.asc", "--at", "10.5,48.1", "--crs", "EPSG:4326"], more].concat(),
        )
    };
    // The grid lies elsewhere; at its own corner the geoid is asked for.
    let outside = height(&[]);
    assert!(outside.code == 0 && outside.out.ends_with(",Outside\n"), "{outside:?}");
    assert!(outside.err.contains("which covers 0 to 40 and 0 to 30 in EPSG:32632"), "{outside:?}");
    let at =
        |more: &[&str]| run_in(scratch.folder(), &[&["height", "grid.asc", "--at", "5,25"], more].concat());
    let stated = at(&["--vertical-datum", "egm96", "--above", "ellipsoid", "--json"]).ok();
    let answer: Value = serde_json::from_str(&stated).expect("JSON");
    let place = Crs::parse("EPSG:32632").and_then(|utm| utm.transform(&Crs::wgs84(), DVec2::new(5.0, 25.0)));
    let undulation = Geoid::default().undulations(&[place.expect("on Earth")], 16).expect("one place")[0];
    assert!(undulation.abs() > 1.0, "{undulation} m would show little");
    assert_eq!(answer[0]["height"].as_f64(), Some(10.0 + undulation));
    assert_eq!(answer[0]["vertical_datum"], "WGS 84 ellipsoid");
    assert_eq!(at(&["--vertical-datum", "egm96", "--above", "egm96"]).ok(), at(&[]).ok());
    for (code, more, message) in [
        (1, &["--above", "ellipsoid"][..], "grid.asc: nothing states what its heights are counted from"),
        (1, &["--above", "egm96", "--vertical-datum", "NAVD88"], "counted from NAVD88, whose distance"),
        (2, &["--above", "sea"], "ellipsoid, egm96"),
    ] {
        let said = at(more).failed(code);
        assert!(said.contains(message), "{said}");
    }
}

#[test]
fn every_interpolation_has_its_own_answer() {
    let scratch = grid();
    let answer = |interpolation: &str, point: &str| {
        let arguments = [&HEIGHT[..], &["--interpolation", interpolation]].concat();
        let out = run_with_input(scratch.folder(), &arguments, point).ok();
        let last = out.lines().last().expect("an answer").to_owned();
        last.strip_prefix(&format!("{point},")).expect("the point as written").to_owned()
    };
    // In the cell of 30, 40, 70 and 80, a quarter from its west and three quarters from its south.
    assert_eq!(answer("bilinear", "27.5,22.5"), "42.5,Ok");
    assert_eq!(answer("planar", "27.5,22.5"), "42.5,Ok");
    assert_eq!(answer("nearest", "27.5,22.5"), "30,Ok");
    let weighted = answer("distance-weighted", "30,20");
    assert_eq!(weighted, "55,Ok", "all corners are equally near");
    // Beside the hole: what fills gaps answers from the others, what does not has no answer.
    assert_eq!(answer("planar", "16,16"), ",NoData");
    assert_eq!(answer("nearest", "16,16"), ",NoData");
    assert!(answer("bilinear", "16,16").ends_with(",Ok"));
    assert!(answer("distance-weighted", "16,16").ends_with(",Ok"));
}

#[test]
fn a_header_names_the_columns_and_other_columns_are_left_alone() {
    let scratch = grid();
    for points in [
        "id;lat;lon\n7;5;35\n",
        "\u{feff}X,Y\r\n35,5\r\n",
        "# two fields\n\n\"x\" , \"y\"\n35 , 5\n",
        "easting northing\n35   5\n",
        "35\t5\n",
    ] {
        let out = run_with_input(scratch.folder(), &HEIGHT, points).ok();
        assert_eq!(out, "x,y,height,status\n35,5,120,Ok\n", "{points:?}");
    }
    assert_eq!(
        run_with_input(scratch.folder(), &HEIGHT, "").ok(),
        "x,y,height,status\n",
        "no points, no answers"
    );
}

#[test]
fn a_bad_line_is_named_by_file_and_line() {
    let scratch = grid();
    for (points, line) in [
        ("x,y\n1,2\n3,north\n", 3),
        ("abc,2\n", 1),
        ("1,2\n\n5\n", 3),
        ("1,2\nNaN,5\n", 2),
        ("1,2\n1e999,5\n", 2),
        ("1,2\n1,2,3\n,\n", 3),
        ("name,code\n1,2\n", 1),
        ("x,code\n1,2\n", 1),
    ] {
        scratch.write("points.csv", points);
        let refused = run_in(scratch.folder(), &["height", "grid.asc", "--points", "points.csv"]).failed(1);
        assert!(refused.contains(&format!("points.csv:{line}:")), "{points:?}: {refused}");
        let refused = run_with_input(scratch.folder(), &HEIGHT, points).failed(1);
        assert!(refused.contains(&format!("standard input:{line}:")), "{points:?}: {refused}");
    }
}

#[test]
fn points_that_are_no_text_are_refused() {
    let scratch = grid();
    scratch.write("points.csv", b"1,2\n3,\xff\n");
    let refused = run_in(scratch.folder(), &["height", "grid.asc", "--points", "points.csv"]).failed(1);
    assert!(refused.contains("points.csv") && refused.contains("byte 6"), "{refused}");
    let refused = run_in(scratch.folder(), &["height", "grid.asc", "--points", "none.csv"]).failed(1);
    assert!(refused.contains("none.csv"), "{refused}");
    run_in(scratch.folder(), &["height", "grid.asc"]).failed(2);
}

#[test]
fn points_of_the_command_line_are_answered_like_those_of_a_file() {
    let scratch = grid();
    let out = run_in(
        scratch.folder(),
        &["height", "grid.asc", "--at", "35,25", "--at", "-400, 1e3", "--at", "15,15"],
    )
    .ok();
    assert_eq!(out, "x,y,height,status\n35,25,40,Ok\n-400,1e3,,Outside\n15,15,,NoData\n");
    for wrong in [&["--at", "35"][..], &["--at", "35,NaN"], &["--at", "35,25", "--points", "-"], &[]] {
        run_in(scratch.folder(), &[&["height", "grid.asc"], wrong].concat()).failed(2);
    }
}

#[test]
fn json_holds_what_csv_holds() {
    let scratch = grid();
    let arguments = ["height", "grid.asc", "--json", "--at=27.5,22.5", "--at=15,15", "--at=-400,1000"];
    let text = run_in(scratch.folder(), &arguments).ok();
    let found: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(
        found,
        serde_json::json!([
            {"x": 27.5, "y": 22.5, "height": 42.5, "status": "Ok"},
            {"x": 15.0, "y": 15.0, "height": null, "status": "NoData"},
            {"x": -400.0, "y": 1000.0, "height": null, "status": "Outside"},
        ])
    );
    let none = run_with_input(scratch.folder(), &[&HEIGHT[..], &["--json"]].concat(), "").ok();
    assert_eq!(serde_json::from_str::<Value>(&none).expect("JSON"), serde_json::json!([]));
}

#[test]
fn points_may_be_in_another_system_and_one_that_cannot_be_reached_is_refused() {
    let scratch = grid();
    scratch
        .write("utm.asc", "ncols 2\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n1 2\n3 4\n");
    scratch.write("utm.prj", "PROJCS[\"WGS 84 / UTM zone 12N\",AUTHORITY[\"EPSG\",\"32612\"]]");
    let utm = Crs::from_epsg(32612).expect("a zone");
    let degrees = utm.transform(&Crs::wgs84(), DVec2::new(500_016.0, 4_000_044.0)).expect("inside");
    let at = format!("{},{}", degrees.x, degrees.y);
    let ask = |crs: &str| {
        run_in(
            scratch.folder(),
            &["height", "utm.asc", "--at", &at, "--crs", crs, "--interpolation", "nearest"],
        )
    };
    assert!(ask("EPSG:4326").ok().ends_with(",1,Ok\n"));
    let taken_for_meters = ask("EPSG:32612");
    assert!(
        taken_for_meters.code == 0 && taken_for_meters.out.ends_with(",,Outside\n"),
        "{taken_for_meters:?}"
    );
    assert!(
        taken_for_meters.err.ends_with("in EPSG:4326 it is on it: say --crs EPSG:4326\n"),
        "{taken_for_meters:?}"
    );
    let refused = ask("EPSG:26712").failed(1);
    assert!(refused.contains("utm.asc") && refused.contains("datum"), "{refused}");
    let refused = ask("somewhere").failed(2);
    assert!(refused.contains("--crs"), "{refused}");
}

#[test]
fn a_scene_is_asked_for_its_ground_and_a_file_for_what_it_holds() {
    let scene = project("scenes/lake.toml");
    let ask = |more: &[&str]| run(&[&["height", scene.as_str(), "--json"], more].concat()).ok();
    let dataset = open(Path::new(&scene));
    let reach = GroundReach { crs: &dataset.crs(), at: &[], around_m: 0.0 };
    let lattice = dataset.ground(&reach).expect("a ground").lattice;
    let middle = lattice.origin() + lattice.extent().center();
    let at = format!("{},{}", middle.x, middle.y);
    let usual = ask(&["--at", &at]);
    assert_eq!(usual, ask(&["--at", &at, "--surface", "ground"]));
    assert_eq!(usual, ask(&["--at", &at, "--surface", "scene"]), "no decks yet");
    let found: Value = serde_json::from_str(&usual).expect("JSON");
    let library = ground_height(&lattice, Interpolation::Bilinear, middle);
    assert_eq!(found[0]["height"].as_f64(), library.height_m());
    run(&["height", &scene, "--at", &at, "--surface", "displayed"]).failed(2);
    let scratch = grid();
    // Beyond the outer samples' centers the raster goes on, the ground does not.
    let edge = |surface: &str| {
        run_in(scratch.folder(), &["height", "grid.asc", "--at", "38,12", "--surface", surface]).ok()
    };
    assert!(edge("source").ends_with("Ok\n") && edge("ground").ends_with("Outside\n"));
}

fn open(path: &Path) -> Dataset {
    let dem = DemOptions { height_scale: Some(1.0), ..DemOptions::default() };
    Dataset::open(path, &DatasetOptions { dem, ..DatasetOptions::default() })
        .unwrap_or_else(|error| panic!("{error:?}"))
}

/// Every file with samples, asked through the program and through the library: the same bits, and GDAL's heights.
#[test]
fn the_program_says_to_the_last_bit_what_the_library_says_and_what_gdal_says() {
    let Some(oracle) = data("DEM_ORACLE.json") else { return };
    let folder = oracle.parent().expect("a folder").to_owned();
    let text = std::fs::read_to_string(&oracle).expect("readable");
    let root: Value = serde_json::from_str(&text).expect("JSON");
    let samples =
        files_below(&folder).into_iter().filter(|path| path.to_string_lossy().ends_with(".samples.csv"));
    let (mut files, mut points) = (0, 0);
    for csv in samples {
        let name = csv.file_name().expect("a file").to_string_lossy().replace(".samples.csv", "");
        let file = csv.parent().and_then(Path::parent).expect("beside the file").join(&name);
        let stated = file.strip_prefix(&folder).expect("below").to_string_lossy().into_owned();
        let entry = root["dems"].as_array().expect("a list").iter().find(|entry| {
            entry["file"].as_str().is_some_and(|file| file.trim_start_matches("shared/") == stated)
        });
        // What cannot be read, or has no place, is other tests' matter; so is VTP's reading of where posts lie.
        let Some(entry) = entry.filter(|entry| !entry["geotransform"].is_null()) else { continue };
        let asked = [
            &["height", file.to_str().expect("UTF-8"), "--points", csv.to_str().expect("UTF-8")][..],
            &["--height-scale", "1", "--interpolation"],
        ]
        .concat();
        let rows = rows(&csv);
        let at: Vec<DVec2> = rows.iter().map(|row| DVec2::new(row[0], row[1])).collect();
        let ran = run(&[&asked[..], &["bilinear"]].concat());
        if ran.code != 0 {
            continue;
        }
        let dataset = open(&file);
        for (choice, interpolation, column) in
            [("bilinear", Interpolation::Bilinear, 3), ("nearest", Interpolation::Nearest, 2)]
        {
            let crs = dataset.crs();
            let answers = dataset.heights(Surface::Source, interpolation, &crs, &at).expect("answers");
            let ran = run(&[&asked[..], &[choice]].concat());
            // Coordinates in feet beside elevations without a unit are told, and what reading guessed.
            let warning = dataset.warning().map(|warning| format!("warning: {warning}\n"));
            let notes = dataset.reading_notes().into_iter().map(|note| format!("note: {note}\n"));
            let told: String = warning.into_iter().chain(notes).collect();
            assert!(ran.code == 0 && ran.err == told, "{ran:?}");
            let out = ran.out;
            for ((line, answer), row) in out.lines().skip(1).zip(&answers).zip(&rows) {
                let cells: Vec<&str> = line.split(',').collect();
                let printed: Option<f64> = cells[2].parse().ok();
                assert_eq!(printed.map(f64::to_bits), answer.height_m().map(f64::to_bits), "{name}: {line}");
                assert_eq!(cells[3], answer.status(), "{name}: {line}");
                if entry["driver"] != "BT" {
                    check_with_oracle(&name, entry, answer.height_m(), row[column]);
                }
                points += 1;
            }
        }
        files += 1;
    }
    assert!(files > 50 && points > 12_000, "{files} files, {points} points");
}

/// x, y, nearest and bilinear of every line of a samples file.
fn rows(csv: &Path) -> Vec<[f64; 4]> {
    let text = std::fs::read_to_string(csv).expect("readable");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let columns = ["x", "y", "nearest", "bilinear"]
        .map(|name| header.iter().position(|known| *known == name).expect("a column"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        columns.map(|column| cells[column].parse().unwrap_or(f64::NAN))
    };
    text.lines().skip(1).map(row).collect()
}

/// The oracle's values are raw: scale, offset and no data are the file's, the unit is whatever it is.
fn check_with_oracle(name: &str, entry: &Value, ours: Option<f64>, raw: f64) {
    let number = |key: &str| {
        entry[key].as_f64().or_else(|| entry[key].as_str().and_then(|text| text.parse::<f64>().ok()))
    };
    let hole =
        raw.is_nan() || number("nodata").is_some_and(|nodata| (raw - nodata).abs() <= 1e-15 * nodata.abs());
    if hole {
        assert_eq!(ours, None, "{name}");
        return;
    }
    let wanted = raw * number("scale").unwrap_or(1.0) + number("offset").unwrap_or(0.0);
    let ours = ours.unwrap_or(f64::NAN);
    let in_feet = [0.3048, 1200.0 / 3937.0].iter().any(|meters| (ours - wanted * meters).abs() <= 1e-4);
    assert!((ours - wanted).abs() <= 1e-4 || in_feet, "{name}: {ours} for {wanted}");
}

#[test]
fn a_png_is_asked_with_its_scale_and_offset() {
    let hills = project("assets/jacksboro/hills.png");
    let scratch = Scratch::new();
    let at = |more: &[&str]| {
        let arguments = [&["height", hills.as_str(), "--points", "-"], more].concat();
        run_with_input(scratch.folder(), &arguments, "64,64\n")
    };
    let refused = at(&[]).failed(1);
    assert!(refused.contains("--height-scale"), "{refused}");
    let height = |out: &str| -> f64 {
        let line = out.lines().nth(1).expect("an answer");
        line.split(',').nth(2).and_then(|height| height.parse().ok()).expect("a height")
    };
    let plain = height(&at(&["--height-scale", "0.1"]).ok());
    let moved = height(&at(&["--height-scale", "0.1", "--height-offset", "1000"]).ok());
    assert!((moved - plain - 1000.0).abs() < 1e-3, "{plain} and {moved}");
}

#[test]
fn an_approximate_datum_shift_is_reported_with_its_meters() {
    let scratch = Scratch::new();
    let grid = "ncols 2\nnrows 2\nxllcorner 600000\nyllcorner 200000\ncellsize 1000\n1 2\n3 4\n";
    scratch.write("bern.asc", grid);
    scratch.write(
        "bern.prj",
        "+proj=somerc +lat_0=46.95240555555556 +lon_0=7.439583333333333 +k_0=1 +x_0=600000 \
                  +y_0=200000 +ellps=bessel +towgs84=674.374,15.056,405.346",
    );
    let shifted =
        run_in(scratch.folder(), &["height", "bern.asc", "--crs", "EPSG:4326", "--at", "7.445,46.955"]);
    assert!(shifted.out.contains("Ok"), "{shifted:?}");
    assert!(shifted.err.contains("674.374") && shifted.err.contains("25 m"), "{shifted:?}");
    let own = run_in(scratch.folder(), &["height", "bern.asc", "--at", "600500,200500"]).ok();
    assert!(own.ends_with(",3,Ok\n"), "{own}");
}

#[test]
fn cubic_heights_run_smoothly_through_the_samples() {
    let scratch = Scratch::new();
    let squares = (0..6).map(|column: i32| (column * column).to_string()).collect::<Vec<_>>().join(" ");
    let head = "ncols 6\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
    scratch.write("a.asc", format!("{head}{}", format!("{squares}\n").repeat(4)));
    let heights = |interpolation: &str| {
        run_in(scratch.folder(), &["height", "a.asc", "--at", "20,15", "--interpolation", interpolation]).ok()
    };
    // Midway between 1 and 4 the parabola has 2.25, the straight line 2.5.
    assert!(heights("cubic").ends_with("20,15,2.25,Ok\n"), "{}", heights("cubic"));
    assert!(heights("bilinear").ends_with("20,15,2.5,Ok\n"), "{}", heights("bilinear"));
}

#[test]
fn positions_in_words_are_answered_as_numbers_and_printed_in_the_same_forms() {
    let dem = "assets/jacksboro/dem.tif";
    let numbers = run(&["height", dem, "--at", "750050,4018050", "--crs", "EPSG:32616"]).ok();
    let height =
        |out: &str| out.lines().nth(1).and_then(|line| line.split(',').nth_back(1).map(str::to_owned));
    let expected: f64 = height(&numbers).expect("a row").parse().expect("a height");
    let degrees =
        run(&["height", dem, "--at", "750050,4018050", "--crs", "EPSG:32616", "--positions", "dms"]).ok();
    let degrees = degrees.lines().nth(1).and_then(|row| row.split(',').next()).expect("a position");
    assert!(degrees.starts_with("36°16′") && degrees.ends_with("″W"), "{degrees}");
    for text in ["16S GF 500 180", "16N 750050 4018050", degrees] {
        for form in ["mgrs", "usng", "utm", "dd", "dm", "dms"] {
            let out = run(&["height", dem, "--at", text, "--positions", form]).out;
            assert!(out.starts_with("position,height,status\n"), "{out}");
            let row = out.lines().nth(1).expect("a row");
            let printed = row.split(',').next().expect("a position");
            let again = run(&["height", dem, "--at", printed, "--positions", form]).out;
            for out in [&out, &again] {
                let found: f64 = height(out).expect("a row").parse().expect("a height");
                assert!((found - expected).abs() < 3.0, "{text} {form}: {out}, {numbers}");
            }
        }
    }
    let reference = run(&["height", dem, "--at", "16S GF 500 180", "--positions", "mgrs"]);
    assert!(reference.err.contains("squares of 100 m"), "{}", reference.err);
    assert!(reference.out.contains("\n16SGF5005018050,"));
    let refused = run(&["height", dem, "--at", "16S 755447 4024162"]);
    assert!(refused.err.contains("band S") && refused.err.contains("southern hemisphere"), "{}", refused.err);
    let scratch = grid();
    let nowhere = run_in(scratch.folder(), &["height", "grid.asc", "--at", "16S GF 500 180"]);
    assert!(nowhere.err.contains("state no coordinate system"), "{}", nowhere.err);
}
