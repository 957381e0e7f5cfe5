//! `height`: points in, heights out.

use crate::common::scratch::Scratch;
use crate::{run_in, run_with_input};

/// Three rows of four samples ten metres apart, the second of the second row a hole. Sample centres stand at
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
fn a_png_is_asked_with_its_scale_and_offset() {
    let hills = crate::project("assets/jacksboro/hills.png");
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
