//! Features as GeoJSON (RFC 7946): one collection, each feature with the name of its layer.

use glam::DVec3;
use serde_json::{Map, Value, json};

use super::{ExportLayer, ExportShape, ExportedFeatures, MadeFile, counted};
use sandtable_geom::polygon::doubled_area;

/// Digits after the point of degrees: a tenth of a millimeter.
const PLACES: i32 = 9;

pub(super) fn file(layers: &[ExportLayer], title: &str) -> MadeFile {
    let mut text = format!("{{\"type\":\"FeatureCollection\",\"name\":{},\"features\":[", Value::from(title));
    let mut first = true;
    for layer in layers {
        for feature in &layer.features {
            let mut properties = Map::new();
            properties.insert("layer".to_owned(), Value::from(layer.name));
            properties.extend(feature.properties.clone());
            let value =
                json!({"type": "Feature", "geometry": geometry(&feature.shape), "properties": properties});
            text.push_str(if first { "\n" } else { ",\n" });
            text.push_str(&value.to_string());
            first = false;
        }
    }
    text.push_str("\n]}\n");
    MadeFile {
        bytes: text.into_bytes(),
        told: ExportedFeatures { layers: counted(layers), notes: Vec::new() },
    }
}

fn geometry(shape: &ExportShape) -> Value {
    match shape {
        ExportShape::Point(at) => json!({"type": "Point", "coordinates": position(at)}),
        ExportShape::Line(line) => {
            json!({"type": "LineString", "coordinates": line.iter().map(position).collect::<Vec<_>>()})
        }
        ExportShape::Polygon(rings) => {
            let rings: Vec<Value> =
                rings.iter().enumerate().map(|(index, ring)| self::ring(ring, index == 0)).collect();
            json!({"type": "Polygon", "coordinates": rings})
        }
    }
}

/// A closed ring: the outer one counter-clockwise, holes clockwise (section 3.1.6).
fn ring(ring: &[DVec3], is_outer: bool) -> Value {
    let flat: Vec<glam::DVec2> = ring.iter().map(|at| at.truncate()).collect();
    let mut positions: Vec<Value> = ring.iter().map(position).collect();
    if (doubled_area(&flat) > 0.0) != is_outer {
        positions.reverse();
    }
    positions.extend(positions.first().cloned());
    Value::from(positions)
}

fn position(at: &DVec3) -> Value {
    let scale = 10f64.powi(PLACES);
    let rounded = |degrees: f64| (degrees * scale).round() / scale;
    match at.z.is_finite() {
        true => json!([rounded(at.x), rounded(at.y), (at.z * 1000.0).round() / 1000.0]),
        false => json!([rounded(at.x), rounded(at.y)]),
    }
}
