//! A small reader of `.shp` files, to bring real layers to the program as GeoJSON.
//!
//! ESRI Shapefile Technical Description, July 1998: a header of 100 bytes, then records of a big-endian number
//! and length and a little-endian shape. Lines and polygons are a box, counts, the parts' first points and the
//! points; points stand alone. Records are read one after another: an index (`.shx`) may be that of an older version
//! of the file. Attributes lie in another file and are not read.

use std::path::Path;

use serde_json::{Value, json};

/// One record's shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A record without a shape.
    Null,
    /// A point.
    Point([f64; 2]),
    /// One line for each part.
    Lines(Vec<Vec<[f64; 2]>>),
    /// Closed rings: clockwise ones around land, counter-clockwise ones around holes in it.
    Rings(Vec<Vec<[f64; 2]>>),
}

/// The shapes in a file.
///
/// # Panics
/// Where the file is not as it should be.
pub fn read(path: &Path) -> Vec<Shape> {
    let bytes = std::fs::read(path).expect("the shapefile is there");
    assert_eq!(bytes[..4], 9994u32.to_be_bytes(), "a shapefile");
    let mut shapes = Vec::new();
    let mut at = 100;
    while at + 12 <= bytes.len() {
        let words = u32::from_be_bytes(bytes[at + 4..at + 8].try_into().expect("four bytes"));
        let content = &bytes[at + 8..at + 8 + 2 * words as usize];
        shapes.push(shape(content));
        at += 8 + content.len();
    }
    shapes
}

fn shape(content: &[u8]) -> Shape {
    let whole = |at: usize| u32::from_le_bytes(content[at..at + 4].try_into().expect("four bytes"));
    let number = |at: usize| f64::from_le_bytes(content[at..at + 8].try_into().expect("eight bytes"));
    let point = |at: usize| [number(at), number(at + 8)];
    // Z and M stand behind what is read here; their types count ten and twenty higher.
    match whole(0) % 10 {
        0 => return Shape::Null,
        1 => return Shape::Point(point(4)),
        _ => {}
    }
    let (parts, points) = (whole(36) as usize, whole(40) as usize);
    let first = |part: usize| if part == parts { points } else { whole(44 + 4 * part) as usize };
    let part = |part: usize| {
        (first(part)..first(part + 1)).map(|index| point(44 + 4 * parts + 16 * index)).collect()
    };
    let parts = (0..parts).map(part).collect();
    match whole(0) % 10 {
        3 => Shape::Lines(parts),
        5 => Shape::Rings(parts),
        other => panic!("shapes of type {other} are not read here"),
    }
}

/// All shapes as a GeoJSON collection, their coordinates as they are.
pub fn geojson(shapes: &[Shape]) -> String {
    let features: Vec<Value> = shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::Null => None,
            Shape::Point(at) => Some(json!({ "type": "Point", "coordinates": at })),
            Shape::Lines(lines) => Some(json!({ "type": "MultiLineString", "coordinates": lines })),
            Shape::Rings(rings) => Some(json!({ "type": "MultiPolygon", "coordinates": polygons(rings) })),
        })
        .enumerate()
        .map(|(id, geometry)| {
            json!({ "type": "Feature", "id": id, "properties": { "number": id }, "geometry": geometry })
        })
        .collect();
    json!({ "type": "FeatureCollection", "features": features }).to_string()
}

/// Rings as polygons: every clockwise one with the counter-clockwise ones that follow it.
fn polygons(rings: &[Vec<[f64; 2]>]) -> Vec<Vec<&Vec<[f64; 2]>>> {
    let mut polygons: Vec<Vec<&Vec<[f64; 2]>>> = Vec::new();
    for ring in rings {
        let doubled_area: f64 =
            ring.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]).sum();
        match polygons.last_mut() {
            Some(polygon) if doubled_area > 0.0 => polygon.push(ring),
            _ => polygons.push(vec![ring]),
        }
    }
    polygons
}
