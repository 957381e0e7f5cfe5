//! Real vector files against what GDAL says is in them, and broken ones.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec2;
use sandtable::geom::crs::Crs;
use sandtable::vector::error::VectorError;
use sandtable::vector::feature::{Geometry, Layer};
use sandtable::vector::read::{Hints, read};
use serde_json::Value;

#[allow(dead_code, reason = "each test uses its own part")]
#[path = "common/data.rs"]
mod common_data;
#[path = "common/skip.rs"]
mod skip;

use crate::common_data::data;

/// A file's layer, with what lies beside the file, in the system `stated` or what it says.
fn read_layer(path: &Path, layer: Option<&str>, stated: Option<&Crs>) -> Result<Layer, VectorError> {
    let bytes = std::fs::read(path).expect("the file is there");
    let companions = |name: &str| std::fs::read(name).ok();
    let hints = Hints { crs: stated, layer, companions: &companions };
    read(&path.to_string_lossy(), &bytes, &hints)
}

fn layer(path: &Path) -> Layer {
    read_layer(path, None, None).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Vertices as GDAL counts them: a ring's first vertex twice.
fn stored_vertices(layer: &Layer) -> usize {
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
fn types(layer: &Layer, expected: &Value) -> BTreeMap<String, u64> {
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
        let file = expected["file"].as_str().expect("a file").trim_start_matches("shared/");
        let Some(path) = data(file) else { continue };
        let name = layer_name(&expected);
        let title = format!("{file} {}", name.unwrap_or_default());
        let stated = expected["crs"].as_str().is_none().then(Crs::local);
        let layer =
            read_layer(&path, name, stated.as_ref()).unwrap_or_else(|error| panic!("{title}: {error}"));
        if let Some(crs) = expected["crs"].as_str() {
            assert_same_system(&layer.crs, crs, &expected, &title);
        }
        let features = expected["features"].as_u64().expect("a count");
        let empty = expected["null_geometries"].as_u64().expect("a count") + empty_of(&expected);
        assert_eq!(layer.features.len() as u64, features - empty, "{title}");
        if empty == 0 {
            assert!(layer.notes.is_empty(), "{title}: {:?}", layer.notes);
            let wanted: BTreeMap<String, u64> =
                serde_json::from_value(expected["types"].clone()).expect("counts");
            assert_eq!(types(&layer, &expected), wanted, "{title}");
        } else {
            assert_eq!(
                layer.notes,
                [format!("left out: {empty} features without a usable geometry")],
                "{title}"
            );
        }
        let vertices = expected["vertices"].as_u64().expect("a count");
        assert_eq!(stored_vertices(&layer) as u64, vertices, "{title}");
        let bounds = bounds(&layer);
        for (side, found) in bounds.iter().enumerate().filter(|_| vertices > 0) {
            let wanted = expected["bbox"][side].as_f64().expect("a number");
            assert!((found - wanted).abs() <= 1e-9 * wanted.abs(), "{title}: {bounds:?}");
        }
        compared += 1;
    }
    assert!(compared >= 60, "only {compared} layers");
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
    // What a .prj file says of a datum may leave out the shift that its code implies: hundreds of metres.
    assert!(back.distance(middle) < 200.0, "{title}: {} is not {}", found.name(), wanted.name());
}

fn bounds(layer: &Layer) -> [f64; 4] {
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
            let _ = read("a.geojson", &bytes[..cut], &Hints::default());
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
