//! Checks of scene files and their data: mistakes seeded in small scenes are found, each on its line, and nothing else is.

use glam::{DAffine2, DVec2};
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::write::write;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::source_place::SourcePlace;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_files::png::encode_png;
use sandtable_raster::raster::{Raster, Samples};

use crate::common::findings::{findings, grave};
use crate::common::scratch::Scratch;

/// Posts a side of the hill, and meters between them.
const POSTS: usize = 41;
const CELL_M: f64 = 10.0;
/// The south-west post.
const ORIGIN: [f64; 2] = [750_000.0, 4_018_000.0];
/// The first lines of every scene that does not write its own.
const HEAD: &str = "[terrain]\ndem = \"hill.asc\"\ncrs = \"EPSG:32616\"\n";
/// The first line after them.
const NEXT: usize = 4;

/// The height of the hill at meters east and north of the origin.
fn hill(east: f64, north: f64) -> f64 {
    300.0 + 20.0 * libm::sin(east / 70.0) * libm::cos(north / 90.0)
}

/// An ASCII grid of the hill with `change` applied to each post's column, row from the south and height.
fn grid(origin: [f64; 2], cell: f64, change: impl Fn(usize, usize, f64) -> f64) -> String {
    let [x, y] = origin.map(|at| at - cell / 2.0);
    let mut text = format!(
        "ncols {POSTS}\nnrows {POSTS}\nxllcorner {x}\nyllcorner {y}\ncellsize {cell}\nNODATA_value -32000\n"
    );
    for row in (0..POSTS).rev() {
        let height = |column: usize| {
            let height = hill(column as f64 * CELL_M, row as f64 * CELL_M);
            format!("{:.3} ", change(column, row, height))
        };
        text.extend((0..POSTS).map(height));
        text.push('\n');
    }
    text
}

/// A mistake and where it is found.
struct Seed {
    code: &'static str,
    /// The line of the scene file.
    line: usize,
    /// The scene after [`HEAD`], or the whole of it where it has a `[terrain]`.
    text: String,
    /// The elevation, where it is not the hill.
    dem: Option<String>,
    /// Other files.
    files: Vec<(&'static str, Vec<u8>)>,
}

fn seed(code: &'static str, line: usize, text: impl Into<String>) -> Seed {
    Seed { code, line, text: text.into(), dem: None, files: Vec::new() }
}

impl Seed {
    fn on(self, dem: String) -> Self {
        Self { dem: Some(dem), ..self }
    }

    fn with(mut self, name: &'static str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.push((name, bytes.into()));
        self
    }

    /// What is found in it.
    fn findings(&self) -> Vec<Finding> {
        let scratch = Scratch::new();
        let dem = self.dem.clone().unwrap_or_else(|| grid(ORIGIN, CELL_M, |_, _, height| height));
        scratch.write("p/s/hill.asc", dem);
        for (name, bytes) in &self.files {
            scratch.write(&format!("p/s/{name}"), bytes);
        }
        let head = if self.text.contains("[terrain]") { "" } else { HEAD };
        findings(&scratch.write("p/s/scene.toml", format!("{head}{}", self.text)), &[])
    }
}

/// A road of the scene file; its points are on the second line.
fn road(points: &str) -> String {
    format!("[[road]]\npoints = {points}\n")
}

const ON_HILL: &str = "[[750100, 4018100], [750300, 4018200]]";

/// A GeoJSON file of one line.
fn line_file(points: &[[f64; 2]]) -> String {
    let points: Vec<String> = points.iter().map(|[x, y]| format!("[{x}, {y}]")).collect();
    format!("{{\"type\": \"LineString\", \"coordinates\": [{}]}}", points.join(", "))
}

/// Mistakes in the scene file itself.
fn of_text() -> Vec<Seed> {
    vec![
        seed("syntax", NEXT, "title = \n"),
        seed("unknown-key", NEXT + 2, road(ON_HILL) + "widht = 4\n"),
        seed("missing-key", NEXT, "[[label]]\nat = [750100, 4018100]\n"),
        seed("wrong-type", NEXT + 1, "[style]\nwireframe = 3\n"),
        seed("wrong-type", NEXT + 2, road(ON_HILL) + "width = \"20 ft\"\n"),
        seed("wrong-value", NEXT + 2, road(ON_HILL) + "width = 1e-9\n"),
        seed("no-effect", NEXT + 2, road(ON_HILL) + "max_grade = 5\n"),
        seed("duplicate-name", NEXT + 3, "[[camera]]\nname = \"a\"\n[[camera]]\nname = \"a\"\n"),
        seed("unknown-name", NEXT + 2, road(ON_HILL) + "style = \"lane\"\n"),
        seed("unused-style", NEXT, "[styles.lane]\nwidth = 3\n"),
        seed("unused-phase", NEXT + 1, "[[phase]]\nname = \"one\"\n"),
        seed("unused-include", 1, format!("include = \"more.toml\"\n{HEAD}")).with("more.toml", "# to do\n"),
        seed("unused-include", 1, format!("include = \"more.toml\"\n{HEAD}"))
            .with("more.toml", "[terrain]\ndem = \"other.asc\"\n"),
        seed(
            "repeated-name",
            NEXT + 4,
            "[[road]]\nname = \"A1\"\npoints = [[750100, 4018100], [750300, 4018200]]\n[[road]]\n\
             points = [[750100, 4018300], [750300, 4018350]]\nname = \"A1\"\n",
        ),
    ]
}

/// Files that are not there, or are not what they should be.
fn of_files() -> Vec<Seed> {
    let file = "[[road]]\nfile = \"road.geojson\"\n";
    vec![
        seed("missing-file", NEXT + 1, file),
        seed("file-outside", NEXT + 1, "[[road]]\nfile = \"../../road.geojson\"\n"),
        seed("wrong-format", NEXT + 1, file).with("road.geojson", "<!DOCTYPE html><html></html>"),
        seed("unreadable-file", NEXT + 1, file).with("road.geojson", "{\"type\": \"LineString\", \"coor"),
        seed("records-broken", NEXT + 1, file).with("road.geojson", with_an_odd_feature()),
        seed("texture-missing", NEXT + 1, "[[model]]\nfile = \"box.obj\"\nat = [750110, 4018283]\n")
            .with("box.obj", "mtllib box.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nf 1/1 2/1 3/1\nf 1/1 2/1 4/1\nf 2/1 3/1 4/1\nf 1/1 3/1 4/1\n")
            .with("box.mtl", "newmtl a\nmap_Kd bricks.png\n"),
        seed("model-read", NEXT + 1, "[[model]]\nfile = \"box.obj\"\nat = [750110, 4018283]\n")
            .with("box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\nf 1 2\n"),
        seed("symbol-incomplete", NEXT + 2, "[[symbol]]\nat = [750110, 4018283]\nsidc = \"10031500001205000000\"\n"),
    ]
}

/// A GeoJSON file of a road on the hill and a feature that is none.
fn with_an_odd_feature() -> &'static str {
    r#"{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:32616"}}, "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": "Blob", "coordinates": []}},
        {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[750100, 4018100], [750300, 4018200]]}}]}"#
}

/// Coordinates that are in another system than stated.
fn of_systems() -> Vec<Seed> {
    let file = "[[road]]\nfile = \"road.geojson\"\n";
    let zone = |code| sandtable_geom::crs::Crs::from_epsg(code).expect("a system");
    let at = |to: u32| {
        let place = zone(32616).transform(&zone(to), [750_200.0, 4_018_200.0].into()).expect("on Earth");
        (place.x, place.y)
    };
    let ((x_17, y_17), (x_deg, y_deg)) = (at(32617), at(4326));
    let in_17 = format!("[[{x_17}, {y_17}], [{}, {y_17}]]", x_17 + 50.0);
    vec![
        seed("crs-unknown", 1, format!("crs = \"EPSG:1\"\n{HEAD}")),
        seed("crs-in-degrees", 1, format!("crs = \"EPSG:4326\"\n{HEAD}")),
        seed("crs-missing", 2, "[terrain]\ndem = \"hill.asc\"\n").on(grid([-84.0, 36.0], 0.001, |_, _, height| height)),
        seed("axes-swapped", NEXT + 1, road("[[4018100, 750100], [4018200, 750300]]")),
        seed("axes-swapped", NEXT + 1, file).with("road.geojson", line_file(&[[y_deg, x_deg], [y_deg + 0.001, x_deg]])),
        seed("wrong-zone", NEXT + 1, road(&in_17)),
        seed("crs-mismatch", NEXT + 1, road(&format!("[[{x_deg}, {y_deg}], [{x_deg}, {}]]", y_deg + 0.001))),
        seed("off-terrain", NEXT + 1, road("[[850100, 4018100], [850300, 4018200]]")),
        seed("off-terrain", NEXT + 1, file).with("road.geojson", line_file(&[[10.0, 50.0], [10.1, 50.0]])),
        seed("off-terrain", NEXT + 2, "[[label]]\ntext = \"a\"\nat = [850100, 4018100]\n"),
        seed("partly-off-terrain", NEXT + 1, road("[[750100, 4018100], [750700, 4018100]]")),
        seed("crs-overridden", 2, HEAD).with("hill.prj", "EPSG:32617"),
        seed("crs-overridden", NEXT + 1, format!("{file}crs = \"EPSG:32616\"\n")).with("road.geojson", in_nad27()),
        seed("no-place-on-earth", 2, "[terrain]\ndem = \"hill.asc\"\n[furniture]\ngrid = \"utm\"\n"),
        seed("lengths-not-true", 2, "[terrain]\ndem = \"hill.asc\"\ncrs = \"EPSG:3857\"\n")
            .on(grid([-9_370_000.0, 4_330_000.0], CELL_M, |_, _, height| height)),
        seed("partly-off-terrain", NEXT + 1, file).with("road.geojson", half_off()),
        seed("far-from-zone", 2, HEAD).on(grid([1_200_000.0, 4_018_000.0], CELL_M, |_, _, height| height)),
        seed("datum-shifted", 5, "crs = \"EPSG:32632\"\n[terrain]\ndem = \"hill.asc\"\n[[road]]\nfile = \"road.geojson\"\ncrs = \"EPSG:31467\"\n")
            .on(grid([500_000.0, 5_400_000.0], CELL_M, |_, _, height| height))
            .with("road.geojson", line_file(&[[3_500_150.0, 5_402_000.0], [3_500_250.0, 5_402_050.0]])),
    ]
}

/// A GeoJSON file that states a system of another datum than the hill's.
fn in_nad27() -> &'static str {
    r#"{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:26716"}}, "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[750100, 4018100], [750300, 4018200]]}}]}"#
}

/// A GeoJSON file of a road on the hill and one beside it.
fn half_off() -> String {
    let (from, to) =
        (sandtable_geom::crs::Crs::from_epsg(32616).expect("a zone"), sandtable_geom::crs::Crs::wgs84());
    let line = |east: f64| {
        let points = [[east, 4_018_100.0], [east + 100.0, 4_018_150.0]];
        line_file(&points.map(|at| from.transform(&to, at.into()).expect("on Earth").into()))
    };
    let feature =
        |shape: String| format!("{{\"type\": \"Feature\", \"properties\": {{}}, \"geometry\": {shape}}}");
    let features = [750_100.0, 750_900.0].map(|east| feature(line(east))).join(", ");
    format!("{{\"type\": \"FeatureCollection\", \"features\": [{features}]}}")
}

/// The hill's system with heights in feet above it.
const IN_FEET: &str = r#"COMPD_CS["WGS 84 / UTM zone 16N + NAVD88 height (ftUS)",PROJCS["WGS 84 / UTM zone 16N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",-87],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]],VERT_CS["NAVD88 height (ftUS)",VERT_DATUM["North American Vertical Datum 1988",2005],UNIT["US survey foot",0.304800609601219]]]"#;

/// Samples that no ground has.
fn of_elevation() -> Vec<Seed> {
    let block = |column: usize, row: usize| (15..20).contains(&column) && (15..20).contains(&row);
    let one = |column: usize, row: usize| (column, row) == (20, 20);
    let on = |code, change: &dyn Fn(usize, usize, f64) -> f64| {
        seed(code, 2, HEAD).on(grid(ORIGIN, CELL_M, change))
    };
    let void = grid(ORIGIN, CELL_M, |column, _, height| if column > 30 { -32000.0 } else { height });
    vec![
        on("spike", &|column, row, height| if one(column, row) { 900.0 } else { height }),
        on("pit", &|column, row, height| if one(column, row) { 100.0 } else { height }),
        on("unmarked-void", &|column, row, height| if block(column, row) { 0.0 } else { height }),
        on("undeclared-nodata", &|column, row, height| if block(column, row) { -9999.0 } else { height }),
        on("flat-margin", &|column, _, height| if column < 4 { 0.0 } else { height }),
        seed("over-void", NEXT + 1, road("[[750100, 4018100], [750390, 4018150]]")).on(void.clone()),
        seed("nodata-under", NEXT + 2, "[[label]]\ntext = \"a\"\nat = [750380, 4018100]\n").on(void),
        seed("geoid-offset", NEXT + 1, "[[fence]]\nfile = \"track.geojson\"\n")
            .with("track.geojson", track(|ground| ground + 33.0)),
        seed("heights-in-feet", NEXT + 1, "[[fence]]\nfile = \"track.geojson\"\n")
            .with("track.geojson", track(|ground| ground / 0.3048)),
        seed("heights-in-feet", 2, "[terrain]\ndem = \"hill_feet.asc\"\ncrs = \"EPSG:32616\"\n")
            .with("hill_feet.asc", grid(ORIGIN, CELL_M, |_, _, height| height)),
    ]
}

/// A GeoTIFF of level ground that counts its heights from `datum`, from some meters east of the hill's origin on.
fn dated(datum: Option<&str>, east_m: f64) -> Vec<u8> {
    tile(datum, east_m, |_, _| 300.0)
}

/// The same of heights by column and row.
fn tile(datum: Option<&str>, east_m: f64, height: impl Fn(f64, f64) -> f64) -> Vec<u8> {
    let height = |index: u32| height(f64::from(index % 20), f64::from(index / 20)) as f32;
    let corner = DVec2::new(ORIGIN[0] + east_m, ORIGIN[1] + 400.0);
    let raster = Raster {
        crs: Some(sandtable_geom::crs::Crs::from_epsg(32616).expect("a zone")),
        map_from_grid: DAffine2::from_cols(DVec2::new(CELL_M, 0.0), DVec2::new(0.0, -CELL_M), corner),
        georeferenced: true,
        vertical_datum: datum.map(str::to_owned),
        ..Raster::new(20, Samples::F32((0..400).map(height).collect()))
    };
    write(&raster, DemFormat::to_write("tif").expect("a GeoTIFF"), "a").expect("written").bytes
}

#[test]
fn heights_from_different_zeros_are_found() {
    let tiles = "[terrain]\ndem = [\"a.tif\", \"b.tif\"]\n";
    each_is_found(vec![
        seed("vertical-datums-mixed", 2, "[terrain]\ndem = \"a.tif\"\nvertical_datum = \"NAVD88\"\n")
            .with("a.tif", dated(Some("EGM96 geoid"), 0.0)),
        seed("vertical-datums-mixed", 2, tiles)
            .with("a.tif", dated(Some("EGM96 geoid"), 0.0))
            .with("b.tif", dated(None, 200.0)),
        seed("heights-in-feet", 2, tiles)
            .with("a.tif", tile(None, 0.0, |column, row| hill(column * CELL_M, row * CELL_M)))
            .with(
                "b.tif",
                tile(None, 190.0, |column, row| hill(190.0 + column * CELL_M, row * CELL_M) / 0.3048),
            ),
        seed("tiles-differ", 2, tiles)
            .with("a.tif", dated(Some("EGM96 geoid"), 0.0))
            .with("b.tif", dated(Some("NAVD88"), 200.0)),
    ]);
}

/// Philadelphia in US survey feet, and Arizona in feet.
const IN_SURVEY_FEET: (u32, [f64; 2]) = (2272, [2_700_000.0, 250_000.0]);
const IN_INTERNATIONAL_FEET: (u32, [f64; 2]) = (2223, [700_000.0, 900_000.0]);

#[test]
fn elevations_of_a_system_in_feet_whose_unit_nothing_states_are_found() {
    for (epsg, corner) in [IN_SURVEY_FEET, IN_INTERNATIONAL_FEET] {
        let heights = grid(corner, 33.0, |_, _, height| height);
        let text = format!("[terrain]\ndem = \"state.asc\"\ncrs = \"EPSG:{epsg}\"\n");
        each_is_found(vec![seed("heights-in-feet", 2, text).with("state.asc", heights)]);
    }
    let (epsg, corner) = IN_SURVEY_FEET;
    // With the same place in meters nothing is wrong, and neither is it where the file states its unit.
    let raster = |meters_per_z: f64, states_z_unit: bool| {
        let height = |index: u32| 300.0 + f64::from(index % 20 + index / 20) * 3.0;
        let samples = (0..400).map(|index| (height(index) / meters_per_z) as f32).collect();
        Raster {
            crs: Some(sandtable_geom::crs::Crs::from_epsg(epsg).expect("a zone")),
            map_from_grid: DAffine2::from_cols(
                DVec2::new(33.0, 0.0),
                DVec2::new(0.0, -33.0),
                DVec2::from(corner),
            ),
            georeferenced: true,
            meters_per_z,
            states_z_unit,
            ..Raster::new(20, Samples::F32(samples))
        }
    };
    let found = |raster: &Raster| {
        let bytes =
            write(raster, DemFormat::to_write("tif").expect("a GeoTIFF"), "a").expect("written").bytes;
        let findings = seed("", 0, "[terrain]\ndem = \"state.tif\"\n").with("state.tif", bytes).findings();
        grave(&findings).into_iter().map(|finding| finding.code.word()).collect::<Vec<_>>()
    };
    assert_eq!(found(&raster(1.0, false)), ["heights-in-feet"]);
    assert_eq!(found(&raster(1.0, true)), Vec::<&str>::new(), "meters are stated, and written");
    assert_eq!(found(&raster(1200.0 / 3937.0, true)), Vec::<&str>::new(), "feet are stated");
}

#[test]
fn a_picture_of_few_pixels_is_found_where_it_is_stretched() {
    let pixels = Pixels::from_data(2, 2, vec![Srgba([90, 120, 80, 255]); 4]).expect("four pixels");
    let [x, y] = ORIGIN;
    let world = format!("300\n0\n0\n-300\n{}\n{}\n", x + 50.0, y + 350.0);
    let text = "[style.imagery]\nfile = \"photo.png\"\ncrs = \"EPSG:32616\"\n";
    each_is_found(vec![
        seed("texture-stretched", NEXT + 1, text)
            .with("photo.png", encode_png(&pixels))
            .with("photo.pgw", world),
    ]);
}

/// A GeoJSON line over the hill, with heights that follow from the ground's.
fn track(height: fn(f64) -> f64) -> String {
    let [x, y] = ORIGIN;
    let (from, to) =
        (sandtable_geom::crs::Crs::from_epsg(32616).expect("a zone"), sandtable_geom::crs::Crs::wgs84());
    let points = (0..30).map(|at| {
        let (east, north) = (60.0 + 9.0 * f64::from(at), 80.0 + 5.0 * f64::from(at));
        let place = from.transform(&to, [x + east, y + north].into()).expect("on Earth");
        format!("[{}, {}, {:.2}]", place.x, place.y, height(hill(east, north)))
    });
    format!("{{\"type\": \"LineString\", \"coordinates\": [{}]}}", points.collect::<Vec<_>>().join(", "))
}

/// Checks that each seed gives its own finding, on its line, and no other.
fn each_is_found(seeds: Vec<Seed>) {
    let mut wrong = Vec::new();
    for seed in seeds {
        let findings = seed.findings();
        let found: Vec<_> = grave(&findings)
            .into_iter()
            .map(|it| (it.code.word(), it.place.as_ref().map_or(0, |place| place.position().line)))
            .collect();
        if found != [(seed.code, seed.line)] {
            let shown: Vec<String> = findings.iter().map(ToString::to_string).collect();
            wrong.push(format!(
                "wanted {} on line {}, found {found:?}:\n{}",
                seed.code,
                seed.line,
                shown.join("\n")
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_length_with_a_unit_is_told_in_meters() {
    let findings = seed("", 0, road(ON_HILL) + "width = \"20 ft\"\n").findings();
    assert_eq!(findings[0].help.as_deref(), Some("lengths are numbers in meters: write 6.096"));
}

#[test]
fn variants_and_points_that_do_not_name_each_other_are_found() {
    let [x, y] = ORIGIN;
    let point = |kind: &str, east: f64| {
        format!(
            "{{\"type\": \"Feature\", \"properties\": {{\"kind\": \"{kind}\"}}, \"geometry\": \
             {{\"type\": \"Point\", \"coordinates\": [{}, {}]}}}}",
            x + east,
            y + 283.0
        )
    };
    let (oak, elm) = (point("oak", 110.0), point("elm", 140.0));
    let text = "[[model]]\nfile = \"conifer\"\nvariant = \"kind\"\nvariants = { oak = \"broadleaf\", elm = \"poplar\" }\n\
                [model.instances]\nfile = \"trees.geojson\"\ncrs = \"EPSG:32616\"\n";
    let of_oaks = text.replace(", elm = \"poplar\"", "");
    each_is_found(vec![
        seed("unused-variant", NEXT + 3, text).with("trees.geojson", oak.clone()),
        seed("unknown-variant", NEXT + 5, of_oaks).with("trees.geojson", format!("{oak}\n{elm}\n")),
    ]);
}

#[test]
fn mistakes_in_the_scene_file_are_found_on_their_lines() {
    each_is_found(of_text());
}

#[test]
fn files_that_are_not_what_they_should_be_are_found() {
    each_is_found(of_files());
}

#[test]
fn wrong_systems_are_found_and_what_would_fit_is_named() {
    each_is_found(of_systems());
    let help = |code: &str| {
        let seed = of_systems().into_iter().find(|seed| seed.code == code).expect("a seed");
        seed.findings().into_iter().find_map(|finding| finding.help).unwrap_or_default()
    };
    assert!(help("wrong-zone").contains("EPSG:32617"), "{}", help("wrong-zone"));
    assert!(help("crs-mismatch").contains("EPSG:4326"));
    assert!(help("far-from-zone").contains("EPSG:32617"), "{}", help("far-from-zone"));
}

#[test]
fn odd_elevations_and_heights_are_found() {
    each_is_found(of_elevation());
}

#[test]
fn sound_data_give_no_warning() {
    let sound = [
        seed("", 0, road(ON_HILL)),
        seed("", 0, "[[fence]]\nfile = \"track.geojson\"\n")
            .with("track.geojson", track(|ground| ground + 0.4)),
        seed(
            "",
            0,
            "[styles.lane]\nwidth = 3\n[[road]]\nstyle = \"lane\"\npoints = [[750100, 4018100], [750300, 4018200]]\n",
        ),
        seed("", 0, format!("include = \"more.toml\"\n{HEAD}"))
            .with("more.toml", "[styles.lane]\nwidth = 3\n"),
        // One of two keys is stated again.
        seed("", 0, format!("include = \"more.toml\"\n{HEAD}"))
            .with("more.toml", "title = \"Hill\"\n[terrain]\ndem = \"other.asc\"\n"),
        // The system that the file states, and one of the same datum.
        seed("", 0, HEAD).with("hill.prj", "EPSG:32616"),
        seed("", 0, HEAD).with("hill.prj", "EPSG:26916"),
        // A vertical part in meters.
        // A vertical part in feet, which the heights are read in, and a unit that is stated.
        seed("", 0, HEAD).with("hill.prj", IN_FEET),
        seed("", 0, "[terrain]\ndem = \"hill_feet.asc\"\ncrs = \"EPSG:32616\"\nvertical_unit = \"us-ft\"\n")
            .with("hill_feet.asc", grid(ORIGIN, CELL_M, |_, _, height| height)),
        seed("", 0, HEAD).with("hill.prj", IN_FEET.replace("0.304800609601219", "1").replace("(ftUS)", "")),
    ];
    for seed in sound {
        let findings = seed.findings();
        assert!(grave(&findings).is_empty(), "{}:\n{findings:#?}", seed.text);
    }
}

#[test]
fn every_finding_points_into_a_file_of_the_scene() {
    for seed in of_text().into_iter().chain(of_systems()) {
        for finding in seed.findings() {
            assert!(FindingCode::from_word(finding.code.word()) == Some(finding.code));
            let file = finding.place.as_ref().map(SourcePlace::file);
            assert!(file.is_none_or(|file| file.ends_with(".toml")), "{file:?}");
        }
    }
}
