//! Elevation in Web Mercator, whose lengths are not those of the ground: distances and areas are computed in true meters, and
//! positions stay in the file's own system.

use std::f64::consts::PI;

use glam::DVec2;
use sandtable_geom::crs::Crs;
use sandtable_geom::geodesic::Geodesic;

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// A slope in Web Mercator at 47 degrees north, where its lengths are half as long again as on the ground.
fn web_mercator(scratch: &Scratch) {
    let rows: Vec<String> = (0..80)
        .map(|row| (0..80).map(|column| (200 + column + 2 * row).to_string()).collect::<Vec<_>>().join(" "))
        .collect();
    let head = "ncols 80\nnrows 80\nxllcorner -8999000\nyllcorner 5994000\ncellsize 100\n";
    scratch.write("merc.asc", format!("{head}{}\n", rows.join("\n")));
    scratch.write("merc.prj", "EPSG:3857");
}

/// Meters on the ellipsoid between two places in Web Mercator.
fn ellipsoid_m(from: [f64; 2], to: [f64; 2]) -> f64 {
    let mercator = Crs::from_epsg(3857).expect("known");
    let [from, to] = [from, to].map(|at| mercator.transform(&Crs::wgs84(), DVec2::from(at)).expect("inside"));
    Geodesic::between(from, to).length_m()
}

#[test]
fn distances_over_a_raster_in_web_mercator_are_those_of_the_ellipsoid() {
    let scratch = Scratch::new();
    web_mercator(&scratch);
    let run = |arguments: &[&str]| run_in(scratch.folder(), arguments);
    let wanted_m = ellipsoid_m([-8_998_000.0, 5_998_000.0], [-8_996_000.0, 5_996_000.0]);
    assert!((wanted_m - 1917.0).abs() < 2.0, "{wanted_m}");

    let ends = ["--from", "-8998000,5998000", "--to", "-8996000,5996000"];
    let sight = run(&[&["los", "merc.asc", "--json"], &ends[..]].concat());
    let report: serde_json::Value = serde_json::from_str(&sight.out).expect("JSON");
    let found_m = report["distance_m"].as_f64().expect("a number");
    assert!((found_m / wanted_m - 1.0).abs() < 1e-3, "{found_m}, {wanted_m}");
    assert_eq!(report["crs"], "EPSG:3857", "positions stay in the file's system");
    assert!(sight.err.contains("EPSG:32617"), "{}", sight.err);

    let profile = run(&["profile", "merc.asc", "--json", "--line", "-8998000,5998000 -8996000,5996000"]);
    let report: serde_json::Value = serde_json::from_str(&profile.out).expect("JSON");
    let found_m = report["length_m"].as_f64().expect("a number");
    assert!((found_m / wanted_m - 1.0).abs() < 1e-3, "{found_m}, {wanted_m}");

    // A circle of 1 km on the ground holds pi square kilometers of posts, all of them in sight on a slope.
    let seen = run(&[
        "viewshed",
        "merc.asc",
        "--json",
        "--at",
        "-8995000,5998000",
        "--range",
        "1000",
        "--observer-height",
        "200",
    ]);
    let report: serde_json::Value = serde_json::from_str(&seen.out).expect("JSON");
    let share = report["visible_m2"].as_f64().expect("a number") / (PI * 1e6);
    assert!((0.97..1.03).contains(&share), "{share} of {report}");
}

#[test]
fn heights_in_web_mercator_are_those_of_the_files_own_samples() {
    let scratch = Scratch::new();
    web_mercator(&scratch);
    let output = run_in(scratch.folder(), &["height", "merc.asc", "--at", "-8998950,5994150"]);
    // The second row from the south: 200 + 0 + 2 * 78.
    assert!(output.out.contains("-8998950,5994150,356,Ok"), "{}", output.out);
    assert_eq!(output.err, "");
}

#[test]
fn a_scene_over_web_mercator_keeps_its_points_and_has_true_lengths() {
    let scratch = Scratch::new();
    web_mercator(&scratch);
    let road = "[[road]]\nname = \"way\"\nwidth = 8\npoints = [[-8998000, 5998000], [-8996000, 5996000]]\n";
    let camera = "[[camera]]\nname = \"c\"\neye = [-8996000, 5995000]\nlook_at = [-8996000, 5996000]\n";
    for (name, head) in [("own.toml", ""), ("stated.toml", "crs = \"EPSG:3857\"\n")] {
        scratch.write(name, format!("{head}[terrain]\ndem = \"merc.asc\"\n{road}{camera}"));
        let run = |arguments: &[&str]| run_in(scratch.folder(), arguments);
        let checked = run(&["check", name]);
        assert!(checked.err.contains("EPSG:32617") || checked.out.contains("EPSG:32617"), "{name}");
        let at = "-8997000,5997000";
        let ground = run(&["height", name, "--at", at]).out;
        assert!(ground.trim_end().ends_with("Ok"), "{name}: {ground}");
        let sight = run(&["los", name, "--json", "--from", "-8998000,5998000", "--to", "-8996000,5996000"]);
        let report: serde_json::Value = serde_json::from_str(&sight.out).expect("JSON");
        let found_m = report["distance_m"].as_f64().expect("a number");
        assert!((found_m - 1917.0).abs() < 3.0, "{name}: {found_m}");
    }
}
