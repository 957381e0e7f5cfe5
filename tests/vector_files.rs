//! Real vector files against what GDAL says is in them, and broken ones.

use std::path::Path;

use sandtable::geom::crs::Crs;
use sandtable::vector::feature::{Geometry, Layer};
use sandtable::vector::read::{Hints, read};
use serde_json::Value;

#[allow(dead_code, reason = "each test uses its own part")]
#[path = "common/data.rs"]
mod common_data;
#[path = "common/skip.rs"]
mod skip;

use crate::common_data::data;

fn layer(path: &Path) -> Layer {
    let bytes = std::fs::read(path).expect("the file is there");
    let name = path.to_string_lossy();
    read(&name, &bytes, &Hints::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
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

#[test]
fn geojson_files_hold_what_gdal_finds_in_them() {
    let Some(oracle) = data("VECTOR_ORACLE.json") else { return };
    let text = std::fs::read_to_string(oracle).expect("readable").replace(": NaN", ": null");
    let oracle: Value = serde_json::from_str(&text).expect("JSON");
    let mut compared = 0;
    for expected in oracle["layers"].as_array().expect("layers") {
        let file = expected["file"].as_str().expect("a file").trim_start_matches("shared/");
        if expected["driver"] != "GeoJSON" {
            continue;
        }
        let Some(path) = data(file) else { continue };
        let layer = layer(&path);
        assert_eq!(layer.crs, Crs::parse(expected["crs"].as_str().expect("a crs")).expect("known"), "{file}");
        assert_eq!(layer.features.len() as u64, expected["features"].as_u64().expect("a count"), "{file}");
        assert_eq!(stored_vertices(&layer) as u64, expected["vertices"].as_u64().expect("a count"), "{file}");
        let bounds = bounds(&layer);
        for (side, found) in bounds.iter().enumerate() {
            let wanted = expected["bbox"][side].as_f64().expect("a number");
            assert!((found - wanted).abs() <= 1e-9 * wanted.abs(), "{file}: {bounds:?}");
        }
        assert!(layer.notes.is_empty(), "{file}: {:?}", layer.notes);
        compared += 1;
    }
    assert!(compared >= 9, "only {compared} files");
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
fn other_formats_are_refused_by_name() {
    for (file, format) in [
        ("vector/poly_landmarks.fgb", "FlatGeobuf"),
        ("vector/garmin-activity.gpx", "GPX"),
        ("vector/sample.kml", "KML"),
        ("vector/river_methow_network.shp", "an ESRI shapefile"),
        ("scenes/swellendam_za/training_data.gpkg", "GeoPackage"),
    ] {
        let Some(path) = data(file) else { continue };
        let bytes = std::fs::read(&path).expect("readable");
        let error = read(file, &bytes, &Hints::default()).expect_err(file).to_string();
        assert!(error.contains(format) && error.contains("ogr2ogr"), "{file}: {error}");
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
