//! What is fuzzed: each target takes any bytes, and must end with an answer or an error. Coverage-guided runs and the smoke
//! test of `cargo test` share them.

mod byte_source;
mod http;
mod shapes;
mod walks;

use std::path::PathBuf;
use std::sync::OnceLock;

use sandtable_dem::hints::{DemHints, DemOptions};
use sandtable_dem::points::cloud::PointHints;
use sandtable_dem::{points, read as elevation};
use sandtable_description::expression::Expression;
use sandtable_description::parse::parse_bytes;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::notation::PositionForm;
use sandtable_geom::position::{Position, wgs84};
use sandtable_model::Companions;
use sandtable_model::error::CompanionError;
use sandtable_model::read as models;
use sandtable_scene::scene_file::{OpenSceneError, build_scene_text};
use sandtable_scene::scene_model::SceneModel;
use sandtable_structure::space_polygon;
use sandtable_symbology::code::SymbolCode;
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read::{self as vectors, VectorFile};

/// A target by its name.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
#[allow(dead_code, reason = "each fuzz target is a program that uses one of them")]
pub const TARGETS: [Target; 16] = [
    ("elevation", elevation),
    ("points", points),
    ("vectors", vectors),
    ("city_models", city_models),
    ("drawings", drawings),
    ("land_xml", land_xml),
    ("models", models),
    ("scene_text", scene_text),
    ("scene_build", scene_build),
    ("scene_shapes", scene_shapes),
    ("scene_picture", scene_picture),
    ("walk", walk),
    ("words", words),
    ("tables", tables),
    ("positions", positions),
    ("http_request", http_request),
];

/// The names under which a rasters's bytes are read: some formats are known by the name alone.
const RASTERS: [&str; 14] = [
    "a.tif", "a.asc", "a.hgt", "a.dt1", "a.dem", "a.bt", "a.ter", "a.grd", "a.xyz", "a.png", "a.bil",
    "a.zip", "a.img", "a.gpkg",
];

/// The names of vector files.
const VECTORS: [&str; 13] = [
    "a.geojson",
    "a.shp",
    "a.gpkg",
    "a.fgb",
    "a.gpx",
    "a.kml",
    "a.osm",
    "a.osm.pbf",
    "a.zip",
    "a.msdl",
    "a.nvg",
    "a.milxly",
    "a.cot",
];

/// The names of models.
const MODELS: [&str; 4] = ["a.3ds", "a.obj", "a.glb", "a.gltf"];

/// A name, by the first byte, and the rest of the bytes.
fn named<'a>(names: &[&'static str], bytes: &'a [u8]) -> Option<(&'static str, &'a [u8])> {
    let (first, rest) = bytes.split_first()?;
    Some((names[usize::from(*first) % names.len()], rest))
}

/// Elevation files, with a header beside them that is their own bytes.
pub fn elevation(bytes: &[u8]) {
    let Some((name, bytes)) = named(&RASTERS, bytes) else { return };
    let beside = |name: &str| name.ends_with(".hdr").then(|| bytes.to_vec());
    let hints = DemHints {
        companions: &beside,
        ..DemOptions { height_scale: Some(1.0), ..DemOptions::default() }.into()
    };
    if let Ok(raster) = elevation::read(name, bytes, &hints) {
        assert!(raster.width > 0 && raster.height > 0, "a raster without samples");
        assert!(raster.map_from_grid.is_finite(), "a raster that lies nowhere");
    }
}

/// Scattered points: LAS, LAZ and tables.
pub fn points(bytes: &[u8]) {
    if let Ok(cloud) = points::read(bytes, &PointHints::default()) {
        assert!(cloud.points.iter().all(|point| point.is_finite()), "a point that lies nowhere");
    }
}

/// Vector files.
pub fn vectors(bytes: &[u8]) {
    let Some((name, bytes)) = named(&VECTORS, bytes) else { return };
    let wgs84 = Crs::wgs84();
    let _ = vectors::read(name, bytes, &VectorHints { crs: Some(&wgs84), ..VectorHints::default() });
}

/// CityJSON, whose surfaces are cut into triangles.
pub fn city_models(bytes: &[u8]) {
    let rd_new = Crs::from_epsg(7415).expect("known");
    let hints = VectorHints { crs: Some(&rd_new), ..VectorHints::default() };
    let Ok(VectorFile { model: Some(model), .. }) = vectors::read_file("a.city.json", bytes, &hints) else {
        return;
    };
    for body in model.objects.values().flat_map(|object| &object.bodies) {
        for surface in &body.surfaces {
            let count: usize = surface.rings.iter().map(Vec::len).sum();
            let triangles = space_polygon::triangles(&surface.rings);
            assert!(
                triangles.iter().flatten().all(|&corner| corner < count),
                "a corner beyond the last vertex"
            );
        }
    }
}

/// DXF drawings.
pub fn drawings(bytes: &[u8]) {
    let wgs84 = Crs::wgs84();
    let _ = vectors::read("a.dxf", bytes, &VectorHints { crs: Some(&wgs84), ..VectorHints::default() });
}

/// LandXML, as a surface and as lines.
pub fn land_xml(bytes: &[u8]) {
    let none = |_: &str| None;
    let hints =
        DemHints { companions: &none, ..DemOptions { cell: Some(10.0), ..DemOptions::default() }.into() };
    if let Ok(raster) = elevation::read("a.xml", bytes, &hints) {
        assert!(raster.width > 0 && raster.height > 0, "a raster without samples");
    }
    for layer in [None, Some("alignments"), Some("stations"), Some("points"), Some("plan_features")] {
        let _ = vectors::read("a.xml", bytes, &VectorHints { layer, ..VectorHints::default() });
    }
}

/// Tables of text, and sheets of the two kinds of spreadsheets as the only or the first one of a workbook.
pub fn tables(bytes: &[u8]) {
    let Some((kind, bytes)) = bytes.split_first() else { return };
    let member = |name: &'static str| (name, bytes);
    let workbook = |members: &[(&str, &[u8])]| sandtable_base::archive::zip(members).unwrap_or_default();
    let file = match kind % 4 {
        0 | 1 => bytes.to_vec(),
        2 => workbook(&[
            ("mimetype", b"application/vnd.oasis.opendocument.spreadsheet"),
            member("content.xml"),
        ]),
        _ => {
            let [root, relations, book] = WORKBOOK_PARTS;
            workbook(&[
                ("_rels/.rels", root.as_bytes()),
                ("xl/workbook.xml", book.as_bytes()),
                ("xl/_rels/workbook.xml.rels", relations.as_bytes()),
                member("xl/worksheets/sheet1.xml"),
            ])
        }
    };
    for columns in [Vec::new(), vec![("position".to_owned(), "a".to_owned())]] {
        let hints = VectorHints { columns: &columns, ..VectorHints::default() };
        if let Ok(layer) = vectors::read("a.csv", &file, &hints) {
            let mut vertices = layer.features.iter().flat_map(|feature| feature.geometry.vertices());
            assert!(vertices.all(|vertex| vertex.is_finite()), "a row that lies nowhere");
        }
    }
}

/// The root, the relations and the list of sheets of a workbook with one sheet.
const WORKBOOK_PARTS: [&str; 3] = [
    r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="a" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>"#,
    r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="a" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet1.xml"/></Relationships>"#,
    r#"<workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships"><sheets><sheet name="a" sheetId="1" r:id="a"/></sheets></workbook>"#,
];

/// Models with whatever they name beside them.
pub fn models(bytes: &[u8]) {
    struct Itself<'a>(&'a [u8]);
    impl Companions for Itself<'_> {
        fn load(&self, _: &str) -> Result<Vec<u8>, CompanionError> {
            Ok(self.0.to_vec())
        }
    }
    let Some((name, bytes)) = named(&MODELS, bytes) else { return };
    let Ok(model) = models::read(name, bytes, &Itself(bytes)) else { return };
    for part in &model.parts {
        let count = part.mesh.vertices.len();
        let corners = part.mesh.triangles.iter().flatten();
        assert!(corners.clone().all(|corner| corner.index() < count), "a corner beyond the last vertex");
        assert!((part.material.0 as usize) < model.materials.len(), "a material beyond the last");
    }
}

/// The decoder of scene files.
pub fn scene_text(bytes: &[u8]) {
    let _ = parse_bytes("a.toml", bytes);
}

/// Scenes on a small hill: the tables that follow `[terrain]`.
pub fn scene_build(bytes: &[u8]) {
    let Ok(tables) = std::str::from_utf8(bytes) else { return };
    let _ = on_hill(tables);
}

/// The scene of the hill with the tables `tables`.
pub fn on_hill(tables: &str) -> Result<SceneModel, OpenSceneError> {
    let text = format!("crs = \"EPSG:32616\"\n[terrain]\ndem = \"hill.asc\"\n{tables}");
    build_scene_text(&hill().join("a.toml"), &text, &[], &|_| ())
}

/// Scenes of features in any shape, whose draw lists are sound.
pub fn scene_shapes(bytes: &[u8]) {
    shapes::listed(bytes);
}

/// Scenes of features in any shape, drawn with their labels.
pub fn scene_picture(bytes: &[u8]) {
    shapes::drawn(bytes);
}

/// Walks over such scenes, by cameras and edits in any order, after each of which the invariants hold.
pub fn walk(bytes: &[u8]) {
    walks::walk(bytes);
}

/// Texts that a user writes on the command line or in a key: expressions, systems, symbol codes.
pub fn words(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = (Expression::parse(text), Crs::parse(text), SymbolCode::parse(text));
}

/// Positions that a user writes: what is read lies on Earth, and is read again from every form in which it is written.
pub fn positions(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(position) = Position::parse(text) else { return };
    assert!(position.side_m().is_none_or(|side_m| side_m > 0.0), "a square without a side");
    if position.numbers().is_some() {
        return;
    }
    let Ok(place) = position.in_system(wgs84()) else { return };
    assert!(
        place.x.abs() <= 180.0 + 1e-9 && place.y.abs() <= 90.0 + 1e-9,
        "{text:?} is off the Earth: {place}"
    );
    for (form, word, _) in PositionForm::WORDS {
        let Ok(written) = form.write(wgs84(), place) else { continue };
        let again = Position::parse(&written).unwrap_or_else(|error| panic!("{text:?} as {word}: {error}"));
        let again = again.in_system(wgs84()).unwrap_or_else(|error| panic!("{text:?} as {word}: {error}"));
        assert!((again.y - place.y).abs() < 2e-5, "{text:?} as {word} is {written:?}, at {again}");
    }
}

/// Requests to the service.
pub fn http_request(bytes: &[u8]) {
    http::ask(&hill().join("hill.asc"), bytes);
}

/// A folder with a hill of 17 by 17 posts, 30 m apart, from (500000, 4000000) on; left behind, a kilobyte.
fn hill() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("sandtable-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a writable temporary folder");
        let post = |index: i32| (100 - (index % 17 - 8).pow(2) - (index / 17 - 8).pow(2)).to_string();
        let heights = (0..17 * 17).map(post).collect::<Vec<_>>().join(" ");
        let head = "ncols 17\nnrows 17\nxllcenter 500000\nyllcenter 4000000\ncellsize 30\n";
        std::fs::write(folder.join("hill.asc"), format!("{head}{heights}\n")).expect("writable");
        folder
    })
}
