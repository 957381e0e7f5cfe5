//! `dem convert`: elevation in another format, another system, other cells.

use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// Three rows of four samples ten meters apart, the second of the second row a hole.
const GRID: &str = "ncols 4\nnrows 3\nxllcorner 400000\nyllcorner 200000\ncellsize 10\nNODATA_value -9999\n\
                    10 20 30 40\n50 -9999 70 80\n90 100 110 120\n";

/// A plane of whole meters in degrees, forty samples a side.
fn degrees() -> String {
    let rows = (0..40).map(|row| {
        let row: Vec<String> = (0..40).map(|column| format!("{}", 100 + 2 * row + 3 * column)).collect();
        row.join(" ") + "\n"
    });
    format!("ncols 40\nnrows 40\nxllcorner 7\nyllcorner 44\ncellsize 0.0005\n{}", rows.collect::<String>())
}

fn grid() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("grid.asc", GRID);
    scratch.write("degrees.asc", degrees());
    scratch.write("degrees.prj", "EPSG:4326");
    scratch
}

fn convert(scratch: &Scratch, arguments: &[&str]) -> crate::cli::Ran {
    run_in(scratch.folder(), &[&["dem", "convert"], arguments].concat())
}

#[test]
fn there_and_back_the_heights_are_the_files() {
    let scratch = grid();
    assert_eq!(
        convert(&scratch, &["grid.asc", "out.tif"]).ok(),
        "out.tif\n\
         \x20 format       GeoTIFF, int16\n\
         \x20 size         4 columns, 3 rows\n\
         \x20 crs          none stated\n\
         \x20 cell         10 x 10\n\
         \x20 resampled    no, the samples are the file's\n\
         \x20 valid        11 of 12 samples\n"
    );
    for name in ["again.bt", "again.asc"] {
        convert(&scratch, &["out.tif", name]).ok();
    }
    assert_eq!(std::fs::read_to_string(scratch.at("again.asc")).expect("it was written"), GRID);
    convert(&scratch, &["again.bt", "third.asc"]).ok();
    let third = std::fs::read_to_string(scratch.at("third.asc")).expect("it was written");
    assert_eq!(third.replace("-32768", "-9999"), GRID);
}

#[test]
fn through_binary_grids_and_points_the_heights_stay_the_files() {
    let scratch = grid();
    let out = convert(&scratch, &["grid.asc", "a.flt"]).ok();
    assert!(out.contains("format       ESRI binary grid, float32") && scratch.at("a.hdr").exists(), "{out}");
    assert!(convert(&scratch, &["a.flt", "b.bil"]).ok().contains("ESRI binary grid, int16"));
    let out = convert(&scratch, &["b.bil", "c.xyz"]).ok();
    assert!(out.contains("1 of 12 points have no data, written as nan"), "{out}");
    convert(&scratch, &["c.xyz", "d.asc"]).ok();
    assert_eq!(std::fs::read_to_string(scratch.at("d.asc")).expect("it was written"), GRID);
}

#[test]
fn a_degree_becomes_a_cell_of_dted_of_the_level_of_its_rows() {
    let scratch = Scratch::new();
    let rows =
        (0..121).map(|row| (0..121).map(|column| format!("{}.4 ", row + column)).collect::<String>() + "\n");
    let cell = 1.0 / 120.0;
    let head =
        format!("ncols 121\nnrows 121\nxllcenter 7\nyllcenter 43\ncellsize {cell}\nNODATA_value -9999\n");
    scratch.write("n43.asc", head + &rows.collect::<String>());
    scratch.write("n43.prj", "EPSG:4326");
    let out = convert(&scratch, &["n43.asc", "n43.dt0"]).ok();
    assert!(out.contains("DTED, int16") && out.contains("heights are rounded to whole meters"), "{out}");
    let info = run_in(scratch.folder(), &["dem", "info", "n43.dt0"]).ok();
    assert!(info.contains("121 columns, 121 rows") && info.contains("EPSG:4326"), "{info}");
    let refused = convert(&scratch, &["n43.asc", "n43.dt2"]).failed(1);
    assert!(refused.contains("3601 rows 1″ apart") && refused.contains("rows of a .dt0"), "{refused}");
}

#[test]
fn a_cell_in_meters_for_a_raster_in_degrees_is_refused_with_its_zone() {
    let scratch = grid();
    let refused = convert(&scratch, &["degrees.asc", "out.tif", "--cell", "30"]).failed(1);
    assert!(refused.contains("--crs EPSG:32632"), "{refused}");
    assert!(!scratch.at("out.tif").exists());
    let out = convert(&scratch, &["degrees.asc", "out.tif", "--cell", "30", "--crs", "EPSG:32632"]).ok();
    for wanted in ["crs          EPSG:32632", "cell         30 x 30", "bilinear", "datum shift  none needed"]
    {
        assert!(out.contains(wanted), "{wanted}: {out}");
    }
    let out = convert(&scratch, &["degrees.asc", "coarse.tif", "--cell", "0.002"]).ok();
    assert!(out.contains("10 columns, 10 rows") && out.contains("average"), "{out}");
}

#[test]
fn a_shift_between_datums_is_told_and_one_that_needs_a_grid_refused() {
    let scratch = grid();
    let to = |source: &str, target: &str| {
        convert(&scratch, &["grid.asc", "-o", "out.tif", "--source-crs", source, "--crs", target])
    };
    let out = to("EPSG:27700", "EPSG:4326").ok();
    assert!(out.contains("datum shift  towgs84 446.448,-125.157,542.06"), "{out}");
    let refused = to("EPSG:26711", "EPSG:32611").failed(1);
    assert!(refused.contains("NAD27") && refused.contains("grid.asc"), "{refused}");
}

#[test]
fn a_raster_without_a_system_is_not_taken_to_be_in_the_wanted_one() {
    let scratch = grid();
    let refused = convert(&scratch, &["grid.asc", "out.tif", "--crs", "EPSG:32632"]).failed(1);
    assert!(refused.contains("--source-crs"), "{refused}");
    let out = convert(&scratch, &["grid.asc", "out.tif", "--cell", "20"]).ok();
    assert!(out.contains("2 columns, 2 rows") && out.contains("average"), "{out}");
}

#[test]
fn no_input_is_written_over_and_nothing_is_left_of_what_fails() {
    let scratch = grid();
    let before = scratch.names();
    for (arguments, code) in [
        (&["grid.asc", "grid.asc"][..], 1),
        (&["grid.asc", "none/out.tif"], 1),
        (&["grid.asc", "out.dem"], 2),
        (&["grid.asc", "out.dt1"], 1),
        (&["grid.asc", "out"], 2),
        (&["grid.asc"], 2),
        (&["grid.asc", "degrees.asc", "out.tif"], 1),
        (&["grid.asc", "out.tif", "--cell", "0"], 2),
        (&["grid.asc", "out.tif", "--crs", "EPSG:0"], 2),
        (&["grid.asc", "out.hgt"], 1),
        // degrees.prj is the input's own, and holds another text.
        (&["degrees.asc", "degrees.bt"], 1),
    ] {
        let refused = convert(&scratch, arguments).failed(code);
        assert!(!refused.is_empty());
        assert_eq!(scratch.names(), before, "{arguments:?}");
    }
}

#[test]
fn a_picture_says_how_it_is_to_be_read() {
    let scratch = grid();
    let out = convert(&scratch, &["grid.asc", "out.png"]).ok();
    assert!(out.contains("read it with --height-scale 1 --height-offset 9"), "{out}");
    convert(&scratch, &["out.png", "again.asc", "--height-scale", "1", "--height-offset", "9"]).ok();
    let again = std::fs::read_to_string(scratch.at("again.asc")).expect("it was written");
    // Gray value 0 stood for no data, and no height is 0.
    assert!(again.ends_with("NODATA_value 0\n10 20 30 40\n50 0 70 80\n90 100 110 120\n"), "{again}");
}

#[test]
fn a_file_that_may_be_an_input_is_not_written_over_unasked() {
    let scratch = grid();
    scratch.write("second.asc", GRID);
    let before = std::fs::read(scratch.at("second.asc")).expect("there");
    let refused = convert(&scratch, &["grid.asc", "second.asc"]).failed(1);
    assert!(
        refused.contains("second.asc") && refused.contains("-o") && refused.contains("--force"),
        "{refused}"
    );
    assert!(std::fs::read(scratch.at("second.asc")).expect("there") == before);
    for arguments in [&["grid.asc", "second.asc", "--force"][..], &["grid.asc", "-o", "second.asc"]] {
        convert(&scratch, &[arguments, &["--cell", "5"]].concat()).ok();
        assert!(std::fs::read(scratch.at("second.asc")).expect("there") != before);
        scratch.write("second.asc", &before);
    }
    // What is no elevation is nobody's input.
    scratch.write("notes.asc", "not a grid");
    convert(&scratch, &["grid.asc", "notes.asc"]).ok();
    let refused = convert(&scratch, &["grid.asc"]).failed(2);
    assert!(refused.contains("the file to write"), "{refused}");
}

#[test]
fn a_large_file_is_copied_with_the_bytes_of_one_that_is_held() {
    let scratch = Scratch::new();
    let (columns, rows) = (1100u32, 1000u32);
    let height = |at: u32| if at % 4001 == 7 { -9999 } else { (at / columns * 3 + at % columns * 2) as i16 };
    let bytes: Vec<u8> = (0..columns * rows).flat_map(|at| height(at).to_le_bytes()).collect();
    scratch.write("big.bil", bytes);
    scratch.write(
        "big.hdr",
        format!(
            "ncols {columns}\nnrows {rows}\nnbits 16\npixeltype SIGNEDINT\nbyteorder I\nulxmap 500000\n\
             ulymap 4600000\nxdim 30\nydim 30\nnodata -9999\n"
        ),
    );
    let said = convert(&scratch, &["big.bil", "copied.tif"]).ok();
    // A raster and itself are joined in memory.
    let joined = convert(&scratch, &["big.bil", "big.bil", "-o", "held.tif"]).ok();
    let facts = |said: &str| said.lines().skip(1).take(6).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(facts(&said), facts(&joined));
    let holes = (0..columns * rows).filter(|at| at % 4001 == 7).count();
    assert!(said.contains(&format!("valid        {} of 1100000 samples", 1_100_000 - holes)), "{said}");
    let bytes = |name: &str| std::fs::read(scratch.at(name)).expect("it was written");
    assert!(bytes("copied.tif") == bytes("held.tif"));
    convert(&scratch, &["copied.tif", "again.tif"]).ok();
    assert!(bytes("again.tif") == bytes("held.tif"), "in tiles as in rows");
    // A file that breaks off is found while it is copied, and leaves nothing.
    scratch.write("cut.tif", &bytes("held.tif")[..bytes("held.tif").len() / 2]);
    let refused = convert(&scratch, &["cut.tif", "of_cut.tif"]).failed(1);
    assert!(refused.contains("cut.tif") && !scratch.at("of_cut.tif").exists(), "{refused}");
    let names = std::fs::read_dir(scratch.folder()).expect("a folder").flatten();
    assert!(names.into_iter().all(|entry| !entry.file_name().to_string_lossy().contains(".part")));
}

#[test]
fn tiles_of_several_cells_are_joined_where_they_nest_or_in_a_stated_cell() {
    let scratch = Scratch::new();
    let tile = |west: u32, cell: u32, value: u32| {
        let rows = format!("{value} {value}\n{value} {value}\n");
        format!("ncols 2\nnrows 2\nxllcorner {west}\nyllcorner 0\ncellsize {cell}\n{rows}")
    };
    scratch.write("fine.asc", tile(500_000, 10, 1));
    scratch.write("wide.asc", tile(500_000, 30, 5));
    scratch.write("odd.asc", tile(500_020, 25, 9));
    let out = run_in(scratch.folder(), &["dem", "convert", "wide.asc", "fine.asc", "-o", "nested.asc"]).ok();
    assert!(out.contains("6 columns, 6 rows") && out.contains("tiles of other cells"), "{out}");
    assert!(out.contains("1 of 2 tiles have cells 3 times as large as the finest, 10 by -10"), "{out}");
    let grid = std::fs::read_to_string(scratch.at("nested.asc")).expect("written");
    assert!(grid.ends_with("5 5 5 5 5 5\n1 1 5 5 5 5\n1 1 5 5 5 5\n"), "{grid}");

    let both = ["dem", "convert", "fine.asc", "odd.asc", "-o", "odd_out.asc"];
    let refused = run_in(scratch.folder(), &both).failed(1);
    assert!(refused.contains("do not nest") && refused.contains("--cell"), "{refused}");
    let out = run_in(scratch.folder(), &[&both[..], &["--cell", "5"]].concat()).ok();
    assert!(out.contains("14 columns, 10 rows") && out.contains("resampled to cells of 5"), "{out}");
}
