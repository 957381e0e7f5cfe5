//! Real vector files against what GDAL says is in them, and broken ones.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec2;
use sandtable_geom::crs::Crs;
use sandtable_vector::error::VectorError;
use sandtable_vector::feature::{Geometry, VectorLayer};
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read::read;
use serde_json::Value;

use crate::common::data::{data, files_below};

/// A file's layer, with what lies beside the file, in the system `stated` or what it says.
fn read_layer(path: &Path, layer: Option<&str>, stated: Option<&Crs>) -> Result<VectorLayer, VectorError> {
    let bytes = std::fs::read(path).expect("the file is there");
    let companions = |name: &str| std::fs::read(name).ok();
    let hints = VectorHints { crs: stated, layer, companions: &companions, ..VectorHints::default() };
    read(&path.to_string_lossy(), &bytes, &hints)
}

fn layer(path: &Path) -> VectorLayer {
    read_layer(path, None, None).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Vertices as GDAL counts them: a ring's first vertex twice.
fn stored_vertices(layer: &VectorLayer) -> usize {
    let closing = |geometry: &Geometry| match geometry {
        Geometry::Polygons(polygons) => polygons.iter().map(|polygon| 1 + polygon.holes.len()).sum(),
        Geometry::Points(_) | Geometry::Lines(_) => 0,
    };
    layer
        .features
        .iter()
        .map(|feature| feature.geometry.vertices().count() + closing(&feature.geometry))
        .sum()
}

/// Every layer that GDAL was asked about.
fn oracle() -> Option<Vec<Value>> {
    let text =
        std::fs::read_to_string(data("VECTOR_ORACLE.json")?).expect("readable").replace(": NaN", ": null");
    let oracle: Value = serde_json::from_str(&text).expect("JSON");
    Some(oracle["layers"].as_array().expect("layers").clone())
}

/// The name of the layer to ask for, where the oracle's name is not one that GDAL made up.
fn layer_name(expected: &Value) -> Option<&str> {
    let several = matches!(expected["driver"].as_str(), Some("GPKG" | "GPX" | "KML"));
    expected["layer"].as_str().filter(|&name| several && name != "Layer #0")
}

/// How many features of each of GDAL's types there are; a shape of one part counts as single where the oracle has
/// singles, since files say nothing of it that is kept.
fn types(layer: &VectorLayer, expected: &Value) -> BTreeMap<String, u64> {
    let mut types = BTreeMap::new();
    for feature in &layer.features {
        let (kind, parts) = match &feature.geometry {
            Geometry::Points(points) => ("Point", points.len()),
            Geometry::Lines(lines) => ("LineString", lines.len()),
            Geometry::Polygons(polygons) => ("Polygon", polygons.len()),
        };
        let multiple = parts > 1 || expected["types"].get(kind).is_none();
        *types.entry(if multiple { format!("Multi{kind}") } else { kind.into() }).or_default() += 1;
    }
    types
}

#[test]
fn every_layer_holds_what_gdal_finds_in_it() {
    let Some(oracle) = oracle() else { return };
    let mut compared = 0;
    for expected in oracle {
        let mut apart = WITH_OLD_INDEX.iter().map(|(file, ..)| *file).chain([WITH_RINGS]);
        let is_apart = apart.any(|file| expected["file"] == format!("shared/{file}"));
        compared += usize::from(!is_apart && compare(&expected).is_some());
    }
    assert!(compared >= 60, "only {compared} layers");
}

/// Shapefiles whose index is that of another version of them, and what they hold: features and vertices. GDAL follows
/// the index and finds 31 features with 471 vertices and 12 with 1938.
const WITH_OLD_INDEX: [(&str, usize, usize); 2] =
    [("scenes/swellendam_za/water.shp", 37, 554), ("scenes/swellendam_za/rivers.shp", 20, 4404)];

/// A KML file with rings that are shapes of their own, which the oracle's reader leaves out (`ogrinfo` finds them).
const WITH_RINGS: &str = "vector/DatelineSpanners.kml";

#[test]
fn rings_that_stand_alone_are_lines() {
    let Some(path) = data(WITH_RINGS) else { return };
    let layer = layer(&path);
    let kinds = layer.features.iter().map(|feature| feature.geometry.kind());
    assert_eq!((kinds.clone().count(), kinds.filter(|&kind| kind == "polygons").count()), (22, 4));
}

#[test]
fn an_index_of_another_version_loses_no_shapes() {
    for (file, features, vertices) in WITH_OLD_INDEX {
        let Some(path) = data(file) else { return };
        let layer = layer(&path);
        assert_eq!((layer.features.len(), stored_vertices(&layer)), (features, vertices), "{file}");
        assert!(layer.notes[0].contains(".shx"), "{file}: {:?}", layer.notes);
    }
}

/// Holds one layer against the oracle; `None` where its file is not there.
fn compare(expected: &Value) -> Option<()> {
    let file = expected["file"].as_str().expect("a file").trim_start_matches("shared/");
    let path = data(file)?;
    let name = layer_name(expected);
    let title = format!("{file} {}", name.unwrap_or_default());
    let stated = expected["crs"].as_str().is_none().then(Crs::local);
    let layer = read_layer(&path, name, stated.as_ref()).unwrap_or_else(|error| panic!("{title}: {error}"));
    if let Some(crs) = expected["crs"].as_str() {
        assert_same_system(&layer.crs, crs, expected, &title);
    }
    let features = expected["features"].as_u64().expect("a count");
    let empty = expected["null_geometries"].as_u64().expect("a count") + empty_of(expected);
    assert_eq!(layer.features.len() as u64, features - empty, "{title}");
    assert!(layer.faults.is_empty(), "{title}: {:?}", layer.faults);
    if empty == 0 {
        assert!(layer.notes.is_empty(), "{title}: {:?}", layer.notes);
        let wanted: BTreeMap<String, u64> =
            serde_json::from_value(expected["types"].clone()).expect("counts");
        assert_eq!(types(&layer, expected), wanted, "{title}");
    } else {
        let noun = if empty == 1 { "feature" } else { "features" };
        let wanted = format!("left out: {empty} {noun} without a usable geometry (");
        assert!(layer.notes.len() == 1 && layer.notes[0].starts_with(&wanted), "{title}: {:?}", layer.notes);
    }
    let vertices = expected["vertices"].as_u64().expect("a count");
    assert_eq!(stored_vertices(&layer) as u64, vertices, "{title}");
    let bounds = bounds(&layer);
    for (side, found) in bounds.iter().enumerate().filter(|_| vertices > 0) {
        let wanted = expected["bbox"][side].as_f64().expect("a number");
        assert!((found - wanted).abs() <= 1e-9 * wanted.abs(), "{title}: {bounds:?}");
    }
    Some(())
}

/// Features that have a type but not one vertex, which the oracle counts: routes of no points.
fn empty_of(expected: &Value) -> u64 {
    let empty = expected["vertices"] == 0;
    if empty { expected["features"].as_u64().expect("a count") } else { 0 }
}

/// The system itself or, where the file gives no code but parameters, one that agrees with it.
fn assert_same_system(found: &Crs, wanted: &str, expected: &Value, title: &str) {
    let Ok(wanted) = Crs::parse(wanted) else { return };
    if *found == wanted {
        return;
    }
    let at = |side: usize| expected["bbox"][side].as_f64().expect("a number");
    let middle = DVec2::new(at(0) + at(2), at(1) + at(3)) / 2.0;
    let back = found.transform(&wanted, middle).unwrap_or_else(|error| panic!("{title}: {error}"));
    // What a .prj file says of a datum may leave out the shift that its code implies: hundreds of meters.
    assert!(back.distance(middle) < 200.0, "{title}: {} is not {}", found.name(), wanted.name());
}

fn bounds(layer: &VectorLayer) -> [f64; 4] {
    let mut bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for vertex in layer.features.iter().flat_map(|feature| feature.geometry.vertices()) {
        bounds = [
            bounds[0].min(vertex.x),
            bounds[1].min(vertex.y),
            bounds[2].max(vertex.x),
            bounds[3].max(vertex.y),
        ];
    }
    bounds
}

#[test]
fn odd_geojson_is_read_or_refused_but_never_a_panic() {
    let Some(folder) = data("broken/geojson_gdal") else { return };
    let read_features = |name: &str| layer(&folder.join(name)).features.len();
    assert_eq!(read_features("feature_with_type_Topology_property.json"), 0);
    assert_eq!(read_features("featuretype.json"), 1);
    assert_eq!(read_features("ids_0_1_null_1_null.json"), 0);
    assert_eq!(read_features("sparse_fields.geojson"), 0);
    for entry in std::fs::read_dir(&folder).expect("readable").flatten() {
        let bytes = std::fs::read(entry.path()).expect("readable");
        for cut in 0..bytes.len() {
            let _ = read("a.geojson", &bytes[..cut], &VectorHints::default());
        }
    }
}

/// A layer's count of features, of vertices as GDAL counts them, and of features that have the properties.
fn census(path: &Path, name: &str, properties: [&str; 2]) -> (usize, usize, [usize; 2]) {
    let layer = read_layer(path, Some(name), None).unwrap_or_else(|error| panic!("{name}: {error}"));
    let having =
        |key: &str| layer.features.iter().filter(|feature| feature.properties.contains_key(key)).count();
    (layer.features.len(), stored_vertices(&layer), properties.map(having))
}

#[test]
fn openstreetmap_as_xml_has_the_features_that_gdal_makes_of_it() {
    let Some(monaco) = data("scenes/monaco/monaco.osm.gz") else { return };
    let census = |name: &str| census(&monaco, name, ["tunnel", "bridge"]);
    assert_eq!(census("lines"), (913, 6997, [67, 20]));
    assert_eq!(census("points").0, 758);
    let (roads, vertices, _) = census("roads");
    assert_eq!((roads, vertices), (860, 5954));
    assert_eq!((census("waterways").0, census("waterways").1), (3, 9));
    assert_eq!((census("water").0, census("water").1), (6, 88));
    // One more than GDAL, which drops the prince's palace: its tags are on the outer way of a relation that only
    // has a name.
    assert_eq!(census("buildings").0, 965 + 1);
}

#[test]
fn openstreetmap_as_protocol_buffers_has_the_features_that_gdal_makes_of_it() {
    let Some(porto_alegre) = data("scenes/porto_alegre_br/poa_osm.pbf") else { return };
    let census = |name: &str| census(&porto_alegre, name, ["tunnel", "bridge"]);
    let (lines, _, [tunnels, bridges]) = census("lines");
    // GDAL has three more lines, which say nothing but their source.
    assert_eq!((lines, tunnels, bridges), (15_904 - 3, 196, 209));
    assert_eq!(census("roads").0, 15_852);
    assert_eq!((census("water").0, census("water").1), (2, 43));
    assert_eq!((census("points").0, census("buildings").0), (6_139, 19));
}

#[test]
fn what_is_beside_a_shape_comes_with_it() {
    let Some(rivers) = data("scenes/swellendam_za/rivers.shp") else { return };
    let rivers = layer(&rivers);
    assert!(rivers.features.iter().all(|feature| feature.properties.contains_key("waterway")));
    let Some(roads) = data("scenes/swellendam_za/training_data.gpkg") else { return };
    let error = read_layer(&roads, None, None).expect_err("four layers").to_string();
    assert!(error.contains("4 layers") && error.contains("roads"), "{error}");
    let roads = read_layer(&roads, Some("roads"), None).expect("there");
    assert!(roads.features.iter().any(|feature| feature.properties["highway"] == "primary"));
    let Some(track) = data("vector/garmin-activity.gpx") else { return };
    let track = layer(&track);
    assert!(
        track.features[0].elevations.as_ref().is_some_and(|all| all.iter().all(|height| height.is_finite()))
    );
}

/// The folders of broken files, and of those the ones that are refused, with a word of the reason.
const BROKEN: [(&str, &[(&str, &str)]); 7] = [
    (
        "shp_gdal",
        &[
            ("bigoffset.shp", "no coordinate of a map"),
            ("buggymultipoly.shp", "record 1"),
            ("multipatch.shp", "multipatch"),
        ],
    ),
    ("fgb", &[("flatgeobuf-invalid.fgb", "properties")]),
    (
        "fgb_gdal",
        &[
            ("invalid_compoundcurve_non_contiguous_curves.fgb", "FlatGeobuf"),
            ("invalid_curvepolygon_linestring_three_points.fgb", "FlatGeobuf"),
            ("invalid_polyhedralsurface_of_curvepolygon.fgb", "FlatGeobuf"),
        ],
    ),
    ("geojson_gdal", &[]),
    ("gpkg_gdal", &[]),
    ("kml_gpx_gdal", &[("junk_content_after_valid_doc.kml", "follows after")]),
    ("osm_gdal", &[("billionlaugh.osm", "document type")]),
];

/// What reads `bytes`, as each layer that it may have, the errors for the caller to look at.
fn read_all(path: &Path, bytes: &[u8]) -> Result<(), VectorError> {
    let companions = |name: &str| std::fs::read(name).ok();
    let local = Crs::local();
    let read = |layer| {
        let hints =
            VectorHints { crs: Some(&local), layer, companions: &companions, ..VectorHints::default() };
        read(&path.to_string_lossy(), bytes, &hints).map(drop)
    };
    match read(None) {
        Err(VectorError::WhichLayer { names }) => names.iter().try_for_each(|name| read(Some(name))),
        other => other,
    }
}

fn is_vector(path: &Path) -> bool {
    let part_of_one = ["dbf", "shx", "sbn", "sbx"];
    !path.extension().is_some_and(|extension| part_of_one.iter().any(|part| extension == *part))
}

#[test]
fn broken_files_are_read_or_refused_with_the_reason() {
    let mut wrong = Vec::new();
    for (folder, refused) in BROKEN {
        let Some(folder) = data(&format!("broken/{folder}")) else { return };
        for path in files_below(&folder).into_iter().filter(|path| is_vector(path)) {
            let name = path.file_name().expect("a file").to_string_lossy().into_owned();
            let bytes = std::fs::read(&path).expect("readable");
            let read = read_all(&path, &bytes).map_err(|error| error.to_string());
            let reason = refused.iter().find(|(refused, _)| *refused == name).map(|(_, reason)| *reason);
            match (read, reason) {
                (Ok(()), None) => {}
                (Err(error), Some(reason)) if error.contains(reason) => {}
                (read, reason) => wrong.push(format!("{name}: {read:?}, not {reason:?}")),
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn files_cut_anywhere_or_with_bytes_turned_never_panic_or_run_on() {
    /// Cuts and turned bytes for each file: more find nothing new and take minutes.
    const TRIES: usize = 150;
    for folder in BROKEN.map(|(folder, _)| format!("broken/{folder}")).into_iter().chain(["vector".into()]) {
        let Some(folder) = data(&folder) else { return };
        for path in files_below(&folder).into_iter().filter(|path| is_vector(path)) {
            let bytes = std::fs::read(&path).expect("readable");
            // Of large files the start, where their structure is told.
            let looked_at = if bytes.len() > 150_000 { 8192 } else { bytes.len() };
            for at in (0..looked_at).step_by((looked_at / TRIES).max(1)) {
                let _ = read_all(&path, &bytes[..at]);
                let mut turned = bytes.clone();
                turned[at] ^= 0xff;
                let _ = read_all(&path, &turned);
            }
        }
    }
}

#[test]
fn a_projected_file_comes_to_degrees_and_back() {
    let Some(path) = data("scenes/redbutte_us/red_butte_road.geojson") else { return };
    let projected = layer(&path);
    let degrees = projected.clone().transformed(&Crs::wgs84()).expect("on earth");
    let [west, south, east, north] = bounds(&degrees);
    assert!(west > -111.9 && east < -111.7 && south > 40.7 && north < 40.9, "{:?}", bounds(&degrees));
    let back = degrees.transformed(&projected.crs).expect("on earth");
    for (there, here) in bounds(&back).iter().zip(bounds(&projected)) {
        assert!((there - here).abs() < 1e-4, "{there} {here}");
    }
}

#[test]
fn a_broken_feature_of_a_flatgeobuf_file_is_left_out_and_the_others_are_read() {
    let Some(path) = data("vector/poly_landmarks.fgb") else { return };
    let bytes = std::fs::read(&path).expect("readable");
    let local = Crs::local();
    let hints = || VectorHints { crs: Some(&local), ..VectorHints::default() };
    let count = read("a.fgb", &bytes, &hints()).expect("sound").features.len();
    // Features are at the end, each with properties at its own end: a turned byte somewhere there breaks one.
    let broken = (bytes.len() / 2..bytes.len()).step_by(11).find_map(|at| {
        let mut turned = bytes.clone();
        turned[at] ^= 0xff;
        read("a.fgb", &turned, &hints()).ok().filter(|layer| !layer.faults.is_empty())
    });
    let layer = broken.expect("some byte breaks one feature");
    assert_eq!(layer.features.len(), count - 1);
    assert!(
        layer.faults[0].starts_with("left out: 1 record that cannot be read: feature "),
        "{:?}",
        layer.faults
    );
}
