//! `analyze`: kinds of the catalog, and the files that they write.

use std::fs;

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// Ground that rises a meter per ten to the east, posts ten meters apart.
fn tilted() -> Scratch {
    let scratch = Scratch::new();
    let grid =
        format!("ncols 6\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 10\n{}", "0 1 2 3 4 5\n".repeat(4));
    scratch.write("tilt.asc", &grid);
    scratch
}

#[test]
fn the_slope_of_tilted_ground_is_a_raster_in_percent() {
    let scratch = tilted();
    run_in(scratch.folder(), &["analyze", "slope", "tilt.asc", "-o", "slope.asc"]).ok();
    let grid = fs::read_to_string(scratch.folder().join("slope.asc")).expect("written");
    let inner: Vec<&str> = grid.lines().nth(7).expect("the second row").split_whitespace().collect();
    let slope: f64 = inner[2].parse().expect("a number");
    assert!((slope - 10.0).abs() < 1e-4, "{grid}");
}

#[test]
fn the_classes_of_a_raster_are_areas_of_a_geopackage() {
    let scratch = tilted();
    run_in(scratch.folder(), &["analyze", "slope", "tilt.asc", "-o", "slope.gpkg"]).ok();
    assert!(fs::read(scratch.folder().join("slope.gpkg")).expect("written").starts_with(b"SQLite format 3"));
}

#[test]
fn a_word_out_of_its_list_and_an_unknown_kind_are_refused_and_nothing_is_written() {
    let scratch = tilted();
    let wrong = ["analyze", "slope", "tilt.asc", "--unit", "degree", "-o", "slope.asc"];
    let refused = run_in(scratch.folder(), &wrong).failed(1);
    assert!(refused.contains("`unit`") && refused.contains("degrees"), "{refused}");
    assert!(!scratch.folder().join("slope.asc").exists());
    let unknown = run_in(scratch.folder(), &["analyze", "slopes", "tilt.asc"]).failed(2);
    assert!(unknown.contains("slope"), "{unknown}");
}

#[test]
fn a_kind_without_a_raster_says_what_it_can_be_written_as() {
    let scratch = tilted();
    let wrong = ["analyze", "intervisibility", "tilt.asc", "--posts", "15,15;45,15", "-o", "links.tif"];
    let refused = run_in(scratch.folder(), &wrong).failed(2);
    assert!(refused.contains(".geojson"), "{refused}");
}

#[test]
fn an_extent_limits_the_raster_and_one_off_the_land_is_refused() {
    let scratch = tilted();
    let part = ["analyze", "slope", "tilt.asc", "--extent", "15,5,45,35", "-o", "part.asc"];
    run_in(scratch.folder(), &part).ok();
    let grid = fs::read_to_string(scratch.folder().join("part.asc")).expect("written");
    assert!(grid.starts_with("ncols 4\nnrows 4\n"), "{grid}");
    let off =
        run_in(scratch.folder(), &["analyze", "slope", "tilt.asc", "--extent", "500,5,600,35"]).failed(1);
    assert!(off.contains("`extent`") && off.contains("off the land"), "{off}");
}

#[test]
fn a_map_is_a_picture_and_nothing_is_left_of_a_wrong_one() {
    let scratch = tilted();
    scratch.write("scene.toml", "[terrain]\ndem = \"tilt.asc\"\n[[analysis]]\nkind = \"aspect\"\n");
    for (file, map) in [("tilt.asc", "ground.png"), ("scene.toml", "scene.png")] {
        run_in(scratch.folder(), &["analyze", "slope", file, "-o", map]).ok();
        let picture = image::open(scratch.at(map)).expect("a picture").into_rgb8();
        // The tint of 10 to 20 % is yellow: it has less blue than what is beside the land.
        let is_tinted = |pixel: &image::Rgb<u8>| i32::from(pixel.0[0]) - i32::from(pixel.0[2]) > 40;
        assert!(picture.pixels().filter(|pixel| is_tinted(pixel)).count() > 1000, "{map}");
    }
    let wrong = ["analyze", "slope", "tilt.asc", "--extent", "900,900,950,950", "-o", "off.png"];
    run_in(scratch.folder(), &wrong).failed(1);
    assert!(!scratch.at("off.png").exists());
}

#[test]
fn the_ground_of_another_phase_is_compared_with_by_its_name() {
    let scratch = tilted();
    let text = "[[phase]]\nname = \"before\"\n[[phase]]\nname = \"after\"\n[terrain]\ndem = \"tilt.asc\"\n\
                [[earthwork]]\nkind = \"crater\"\npoints = [[30, 20]]\nradius = 12\nphases = [\"after\"]\n";
    scratch.write("scene.toml", text);
    let cut = |phase: &str| {
        let against = format!("phase:{phase}");
        let command = ["analyze", "cut-fill", "scene.toml", "--against", &against, "--json"];
        run_in(scratch.folder(), &command)
    };
    let figures = |said: &str| -> Vec<f64> {
        let said: serde_json::Value = serde_json::from_str(said).expect("JSON");
        let figures = said["figures"].as_array().expect("figures");
        figures.iter().map(|figure| figure["value"].as_f64().expect("a number")).collect()
    };
    assert_eq!(figures(&cut("before").ok())[..2], [0.0, 0.0]);
    let [digging, filling] = figures(&cut("after").ok())[..2] else { panic!("two figures") };
    assert!(digging + filling > 50.0, "{digging} {filling}");
    let missing = cut("befor").failed(1);
    assert!(missing.contains("`against`") && missing.contains("before"), "{missing}");
}
