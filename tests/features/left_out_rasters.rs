//! Whatever a reader of elevation leaves out or guesses is told twice: each format with something odd in it, by a check of a scene
//! of it and by the dataset that height queries, profiles and the service open.

use glam::{DAffine2, DVec2};
use sandtable_base::archive::zip;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::write::write;
use sandtable_description::finding_code::FindingCode;
use sandtable_query::dataset::{Dataset, DatasetOptions};
use sandtable_raster::raster::{Raster, Samples};

use crate::common::findings::findings;
use crate::common::scratch::Scratch;

/// Samples on a side.
const SIDE: u32 = 12;

/// The height of a sample in meters.
fn height(column: u32, row: u32) -> f64 {
    100.0 + f64::from(column) + 2.0 * f64::from(row)
}

/// A grid of text whose sample in column 3 of row 2 is `odd`.
fn ascii(odd: &str) -> String {
    let head = format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 500000\nyllcorner 4500000\ncellsize 10\n");
    let cell = |column: u32, row: u32| match (column, row) {
        (3, 2) => odd.to_owned(),
        _ => height(column, row).to_string(),
    };
    let row = |row: u32| (0..SIDE).map(|column| cell(column, row) + " ").collect::<String>() + "\n";
    head + &(0..SIDE).map(row).collect::<String>()
}

/// A point a line; the line of column 3 of row 2 is `odd`.
fn xyz(odd: &str) -> String {
    let line = |column: u32, row: u32| match (column, row) {
        (3, 2) => format!("{odd}\n"),
        _ => format!("{} {} {}\n", 500_000 + 10 * column, 4_500_000 + 10 * (SIDE - row), height(column, row)),
    };
    (0..SIDE * SIDE).map(|index| line(index % SIDE, index / SIDE)).collect()
}

/// Samples of 16 bits, each line once for each of `bands`.
fn lines(bands: u32) -> Vec<u8> {
    let sample = |column, row| (height(column, row) as i16).to_le_bytes();
    let line = |row: u32| (0..SIDE).flat_map(move |column| sample(column, row));
    (0..SIDE).flat_map(|row| (0..bands).flat_map(move |_| line(row))).collect()
}

/// A GeoTIFF that says `odd`, of five letters, where its value for no data should be.
fn tiff(odd: &str) -> Vec<u8> {
    let heights = (0..SIDE * SIDE).map(|index| height(index % SIDE, index / SIDE) as f32).collect();
    let (cell, corner) = (DVec2::new(10.0, -10.0), DVec2::new(500_000.0, 4_500_120.0));
    let raster = Raster {
        map_from_grid: DAffine2::from_scale_angle_translation(cell, 0.0, corner),
        georeferenced: true,
        nodata: Some(-9999.0),
        ..Raster::new(SIDE, Samples::F32(heights))
    };
    let format = DemFormat::to_write("tif").expect("a GeoTIFF");
    let mut bytes = write(&raster, format, "a.tif").expect("written").bytes;
    let places: Vec<usize> = (0..bytes.len() - 5).filter(|&at| &bytes[at..at + 5] == b"-9999").collect();
    let [at] = places[..] else { panic!("one value for no data: {places:?}") };
    bytes[at..at + 5].copy_from_slice(odd.as_bytes());
    bytes
}

/// Checks that the elevation file `name`, with others beside it, is read, and that `told` is said of it once.
fn reports(name: &str, files: &[(&str, Vec<u8>)], told: &str) {
    let scratch = Scratch::new();
    for (name, bytes) in files {
        scratch.write(name, bytes);
    }
    let scene = format!("[terrain]\ndem = \"{name}\"\ncrs = \"EPSG:32633\"\n");
    let scene = scratch.write("scene.toml", scene);
    let found = findings(&scene, &[]);
    let of_reading: Vec<&str> = found
        .iter()
        .filter(|finding| finding.code == FindingCode::ElevationGuessed)
        .map(|finding| finding.message.as_str())
        .collect();
    assert!(matches!(of_reading[..], [one] if one.contains(told)), "'{told}' of {name}: {found:#?}");
    for file in [scratch.at(name), scene] {
        let dataset = Dataset::open(&file, &DatasetOptions::default()).expect("elevation");
        let notes = dataset.reading_notes();
        assert!(
            matches!(&notes[..], [one] if one.contains(told)),
            "'{told}' of {}: {notes:?}",
            file.display()
        );
        assert!(notes[0].contains(name), "{notes:?}");
    }
}

#[test]
fn text_with_an_odd_sample_or_line() {
    reports("a.asc", &[("a.asc", ascii("null").into())], "1 value is no number ('null')");
    let told = "left out: 1 line that is no point: line 28 is '500030 north 107'";
    reports("a.xyz", &[("a.xyz", xyz("500030 north 107").into())], told);
    reports("a.csv", &[("a.csv", format!("x y z\n{}", xyz("500030 north 107")).into())], "line 29 is");
    let told = "1 of its points have no height";
    reports("a.xyz", &[("a.xyz", xyz("500030 4500100 null").into())], told);
}

#[test]
fn packed_text_with_an_odd_sample() {
    let archive = zip(&[("a.asc", ascii("null").as_bytes())]).expect("memory");
    reports("a.asc.zip", &[("a.asc.zip", archive)], "1 value is no number ('null')");
}

#[test]
fn plain_samples_of_two_bands() {
    let size = format!(
        "NROWS {SIDE}\nNCOLS {SIDE}\nNBANDS 2\nNBITS 16\nPIXELTYPE SIGNEDINT\nBYTEORDER I\nLAYOUT BIL\n"
    );
    let place = "ULXMAP 500005\nULYMAP 4500115\nXDIM 10\nYDIM 10\n";
    let files = [("a.bil", lines(2)), ("a.hdr", format!("{size}{place}").into())];
    reports("a.bil", &files, "the first of its 2 bands");
    let header = format!(
        "ENVI\nsamples = {SIDE}\nlines = {SIDE}\nbands = 2\nheader offset = 0\ndata type = 2\ninterleave = bil\n\
         byte order = 0\nmap info = {{UTM, 1, 1, 500000, 4500120, 10, 10, 33, North, WGS-84}}\n"
    );
    reports("a.img", &[("a.img", lines(2)), ("a.hdr", header.into())], "the first of its 2 bands");
}

#[test]
fn a_geotiff_whose_value_for_no_data_is_a_word() {
    reports("a.tif", &[("a.tif", tiff("none!"))], "'none!' is no number");
}

#[test]
fn landxml_of_several_surfaces() {
    let surface = |name: &str| {
        format!(
            "<Surface name=\"{name}\"><Definition surfType=\"TIN\"><Pnts><P id=\"1\">4500000 500000 100</P>\
             <P id=\"2\">4500000 500120 104</P><P id=\"3\">4500120 500120 104</P><P id=\"4\">4500120 500000 100</P></Pnts>\
             <Faces><F>1 2 3</F><F>1 3 4</F></Faces></Definition></Surface>"
        )
    };
    let text = format!(
        "<?xml version=\"1.0\"?><LandXML version=\"1.2\"><Units><Metric linearUnit=\"meter\" elevationUnit=\"meter\"/></Units>\
         <Surfaces>{}{}</Surfaces></LandXML>",
        surface("EG"),
        surface("FG")
    );
    let scratch = Scratch::new();
    scratch.write("a.xml", text);
    let scene = "[terrain]\ndem = \"a.xml\"\ncrs = \"EPSG:32633\"\ncell = 10\n";
    let found = findings(&scratch.write("scene.toml", scene), &[]);
    let told = |message: &str| message.contains("'EG', 'FG', the first is taken");
    assert!(found.iter().any(|finding| told(&finding.message)), "{found:#?}");
}

#[test]
fn tiles_of_which_one_has_an_odd_sample_name_it() {
    let scratch = Scratch::new();
    scratch.write("a.asc", ascii("null"));
    scratch.write("b.asc", ascii("105").replace("xllcorner 500000", "xllcorner 500120"));
    let scene = "[terrain]\ndem = [\"a.asc\", \"b.asc\"]\ncrs = \"EPSG:32633\"\n";
    let scene = scratch.write("scene.toml", scene);
    let told = |message: &str| message.contains("1 value is no number ('null')") && message.contains("a.asc");
    let found = findings(&scene, &[]);
    assert_eq!(found.iter().filter(|finding| told(&finding.message)).count(), 1, "{found:#?}");
    let dataset = Dataset::open(&scene, &DatasetOptions::default()).expect("two tiles");
    assert_eq!(dataset.reading_notes().iter().filter(|note| told(note)).count(), 1);
}

/// GeoJSON of two lines, of which the second has a coordinate that is no number.
fn two_lines() -> String {
    let line = |coordinates: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":{coordinates}}}}}"
        )
    };
    let lines = [line("[[500010,4500050],[500110,4500060]]"), line("[[\"a\",1],[2,3]]")].join(",");
    format!("{{\"type\":\"FeatureCollection\",\"features\":[{lines}]}}")
}

#[test]
fn lines_that_shape_the_ground_tell_heights_what_was_left_out() {
    let scratch = Scratch::new();
    scratch.write("a.asc", ascii("105"));
    scratch.write("roads.geojson", two_lines());
    let road = "[[road]]\nfile = \"roads.geojson\"\ncrs = \"EPSG:32633\"\nprofile = \"conform\"\nwidth = 4\n";
    let scene = format!("[terrain]\ndem = \"a.asc\"\ncrs = \"EPSG:32633\"\n{road}");
    let dataset = Dataset::open(&scratch.write("scene.toml", scene), &DatasetOptions::default());
    let notes = dataset.expect("a scene").reading_notes();
    assert!(matches!(&notes[..], [one] if one.contains("'roads.geojson': left out: 1 record")), "{notes:?}");
}

#[test]
fn a_file_of_a_flight_is_told_of_by_the_check_and_by_the_flight() {
    let scratch = Scratch::new();
    scratch.write("a.asc", ascii("105"));
    scratch.write("way.geojson", two_lines());
    let flight = "[[flight]]\nname = \"over\"\nfile = \"way.geojson\"\ncrs = \"EPSG:32633\"\nheight = 50\n";
    let scene = format!("[terrain]\ndem = \"a.asc\"\ncrs = \"EPSG:32633\"\n{flight}");
    let scene = scratch.write("scene.toml", scene);
    let told = |message: &str| message.contains("'way.geojson': left out: 1 record");
    let found = findings(&scene, &[]);
    assert_eq!(found.iter().filter(|finding| told(&finding.message)).count(), 1, "{found:#?}");
    let flown = sandtable_walk::flown_scene::open_scene_with_flight(&scene, &[], None, &|_| ());
    let (flown, _) = flown.expect("a flight");
    assert_eq!(flown.notes().into_iter().filter(|note| told(note)).count(), 1);
}
