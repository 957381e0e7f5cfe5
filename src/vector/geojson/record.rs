//! Features one by one, for texts in which some do not keep to the standard.
//!
//! The `geojson` crate refuses a text with its first odd feature. Here the text is only taken apart at its features, and
//! each is read by itself: empty coordinates are no shape (RFC 7946, section 3.1), a height that is no number is no
//! height, and what remains odd is left out and reported.

use glam::DVec3;
use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::error::{VectorError, shorten};
use crate::feature::Properties;
use crate::geojson::{FORMAT, TYPES};

/// A text that is JSON and may hold odd features.
pub(super) struct OddText<'a> {
    features: Vec<&'a RawValue>,
    /// The `crs` member of the text.
    pub crs: Option<Value>,
}

#[derive(Deserialize)]
struct TextHead<'a> {
    #[serde(rename = "type")]
    kind: String,
    #[serde(borrow)]
    features: Option<Vec<&'a RawValue>>,
    crs: Option<Value>,
}

/// Why a feature cannot be read.
type OddFeature = String;

impl<'a> OddText<'a> {
    /// Takes the text apart; `None` where it is not JSON, or no text of GeoJSON.
    pub fn parse(text: &'a [u8]) -> Option<Self> {
        let head: TextHead<'a> = serde_json::from_slice(text).ok()?;
        if !TYPES.contains(&&*head.kind) {
            return None;
        }
        let features = match head.kind.as_str() {
            "FeatureCollection" => head.features?,
            _ => vec![serde_json::from_slice(text).ok()?],
        };
        Some(Self { features, crs: head.crs })
    }

    /// Adds the features; `place` gives the place of one by its number.
    pub fn add_to(&self, layer: &mut LayerBuilder, place: impl Fn(usize) -> String) {
        for (index, text) in self.features.iter().enumerate() {
            let place = || place(index + 1);
            let value =
                serde_json::from_str(text.get()).map_err(|error| super::text_without_position(&error));
            match value.and_then(feature) {
                Ok((parts, properties)) => layer.add_at(parts, properties, place),
                Err(reason) => layer.add_broken(place(), VectorError::broken(FORMAT, place(), reason)),
            }
        }
    }
}

/// Reads a feature or a geometry.
fn feature(value: Value) -> Result<(FeatureParts, Properties), OddFeature> {
    let mut parts = FeatureParts::default();
    let Value::Object(mut members) = value else {
        return Err(format!("{} stands in place of a feature", shorten(&value.to_string())));
    };
    let is_feature =
        members.get("type").and_then(Value::as_str) == Some("Feature") || members.contains_key("geometry");
    if !is_feature {
        add_shape(&mut parts, &Value::Object(members))?;
        return Ok((parts, Properties::new()));
    }
    add_shape(&mut parts, members.get("geometry").unwrap_or(&Value::Null))?;
    // Some writers put an empty list for no properties.
    let properties = match members.remove("properties") {
        Some(Value::Object(properties)) => properties.into_iter().collect(),
        _ => Properties::new(),
    };
    Ok((parts, properties))
}

/// Adds the shape of a geometry; nothing for null.
///
/// # Errors
/// What is odd about it.
pub(crate) fn add_shape(parts: &mut FeatureParts, geometry: &Value) -> Result<(), OddFeature> {
    let members = match geometry {
        Value::Null => return Ok(()),
        Value::Object(members) if members.is_empty() => return Ok(()),
        Value::Object(members) => members,
        other => return Err(format!("{} stands in place of a geometry", shorten(&other.to_string()))),
    };
    let kind = members.get("type").and_then(Value::as_str).ok_or("a geometry has no type")?;
    let member = |name: &str| {
        let found = members.get(name);
        found.ok_or_else(|| format!("a geometry of the type {} has no {name}", shorten(kind)))
    };
    match kind {
        "GeometryCollection" => {
            return items(member("geometries")?)?.iter().try_for_each(|inner| add_shape(parts, inner));
        }
        "Point" => match items(member("coordinates")?)? {
            [] => {}
            [_] => return Err("a point has one number only".into()),
            _ => {
                let points = vertices(std::slice::from_ref(member("coordinates")?), parts)?;
                parts.add_points(points);
            }
        },
        "MultiPoint" => {
            let points = vertices(items(member("coordinates")?)?, parts)?;
            parts.add_points(points);
        }
        "LineString" => add_line(parts, member("coordinates")?)?,
        "MultiLineString" => {
            items(member("coordinates")?)?.iter().try_for_each(|line| add_line(parts, line))?;
        }
        "Polygon" => add_polygon(parts, member("coordinates")?)?,
        "MultiPolygon" => {
            items(member("coordinates")?)?.iter().try_for_each(|rings| add_polygon(parts, rings))?;
        }
        other => return Err(format!("a geometry has the unknown type {}", shorten(other))),
    }
    Ok(())
}

fn add_line(parts: &mut FeatureParts, line: &Value) -> Result<(), OddFeature> {
    let vertices = vertices(items(line)?, parts)?;
    if !vertices.is_empty() {
        parts.add_line(vertices);
    }
    Ok(())
}

fn add_polygon(parts: &mut FeatureParts, rings: &Value) -> Result<(), OddFeature> {
    let rings = items(rings)?.iter();
    let rings: Vec<Vertices> =
        rings.map(|ring| vertices(items(ring)?, parts)).collect::<Result<_, OddFeature>>()?;
    if !rings.is_empty() {
        parts.add_polygon(rings);
    }
    Ok(())
}

/// Returns the items of a list; null is a list of none.
fn items(list: &Value) -> Result<&[Value], OddFeature> {
    match list {
        Value::Null => Ok(&[]),
        Value::Array(items) => Ok(items),
        other => Err(format!("{} stands in place of a list of coordinates", shorten(&other.to_string()))),
    }
}

/// Returns the positions that have at least two numbers.
fn vertices(positions: &[Value], parts: &mut FeatureParts) -> Result<Vertices, OddFeature> {
    let mut vertices = Vertices::with_capacity(positions.len());
    for numbers in positions {
        match items(numbers)? {
            [x, y, rest @ ..] => vertices.push(vertex([x, y], rest.first(), parts)?),
            _ => parts.count_short_position(),
        }
    }
    Ok(vertices)
}

/// Returns a position; null is no number, as of a fix that was lost.
fn vertex(plan: [&Value; 2], height: Option<&Value>, parts: &mut FeatureParts) -> Result<DVec3, OddFeature> {
    let number = |value: &Value| match value {
        Value::Null => Ok(f64::NAN),
        Value::Number(number) => Ok(number.as_f64().unwrap_or(f64::NAN)),
        other => Err(format!("a coordinate is {}, not a number", shorten(&other.to_string()))),
    };
    let elevation = height.and_then(Value::as_f64);
    if height.is_some() && elevation.is_none() {
        parts.count_elevation();
    }
    Ok(position(number(plan[0])?, number(plan[1])?, elevation))
}
