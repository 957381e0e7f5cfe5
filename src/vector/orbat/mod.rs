//! Scenarios of ORBAT Mapper (JSON, `"type": "ORBAT-mapper"`): the units of its sides where they are from state to state, and
//! the features and control measures of its layers, on WGS 84.
//!
//! A unit is a feature for each state in which it has a place, with the moments `begin` and `end`. Its code has the identity of
//! its side. A unit without a place of its own is where the unit above it is, and a note says of how many that holds. Places
//! between two states (`via`) are not read.
//!
//! Layers of the file are `units` and the names of its layers. Formats: versions 1 to 3 (orbat-mapper.app, `scenario.ts`).

mod drawn;
#[cfg(test)]
mod tests;
mod units;

use serde_json::{Map, Value};

use crate::builder::LayerBuilder;
use crate::error::VectorError;
use crate::feature::VectorLayer;
use crate::hints::VectorHints;
use crate::moment::Moment;
use sandtable_base::limits::GEOJSON_BYTES;
use sandtable_geom::crs::Crs;

const FORMAT: &str = "scenario of ORBAT Mapper";
/// Bytes at the start of a text in which its type is searched.
const HEAD_BYTES: usize = 4096;
/// The layer of the units.
const UNITS: &str = "units";

/// Returns whether a JSON text says early that it is such a scenario.
pub(super) fn is_orbat(text: &[u8]) -> bool {
    let head = &text[..text.len().min(HEAD_BYTES)];
    let kind: &[u8] = b"\"ORBAT-mapper\"";
    head.first() == Some(&b'{') && head.windows(kind.len()).any(|window| window == kind)
}

/// Reads the units and the layers of a scenario, or the layer that is asked for.
///
/// # Errors
/// [`VectorError`], also where no feature is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    if bytes.len() > GEOJSON_BYTES.count() {
        return Err(VectorError::TooLarge { bytes: bytes.len() });
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let scenario: Value = serde_json::from_slice(text).map_err(|error| {
        let place = format!("line {}, column {}", error.line().max(1), error.column().max(1));
        VectorError::broken(FORMAT, place, error)
    })?;
    let mut layers: Vec<(&str, &Value)> = Vec::new();
    // Versions 1 and 2 have `layers` of `features`, version 3 a `layerStack` of `items`.
    for layer in ["layerStack", "layers"].into_iter().flat_map(|key| list(&scenario, key)) {
        layers.push((text_of(layer, "name").unwrap_or("layer"), layer));
    }
    if let Some(wanted) = hints.layer {
        let mut names = vec![UNITS];
        names.extend(layers.iter().map(|(name, _)| *name));
        names.dedup();
        if !names.contains(&wanted) {
            return Err(VectorError::no_such_layer(wanted, &names));
        }
    }
    let is_wanted = |name: &str| hints.layer.is_none_or(|wanted| wanted == name);
    // Positions are on WGS 84 whatever is stated for them.
    let mut builder = LayerBuilder::new(hints.crs.cloned().unwrap_or_else(Crs::wgs84));
    if is_wanted(UNITS) {
        units::add(&scenario, &mut builder);
    }
    for (name, layer) in layers.into_iter().filter(|(name, _)| is_wanted(name)) {
        drawn::add(name, layer, &mut builder);
    }
    builder.finish()
}

/// The items of a list; none where it is absent or no list.
fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// A text that is not empty.
fn text_of<'a>(value: &'a Value, key: &str) -> Option<&'a str> {
    value.get(key)?.as_str().filter(|text| !text.trim().is_empty())
}

/// A moment, as text or in milliseconds.
fn moment_of(value: &Value, key: &str) -> Option<Moment> {
    match value.get(key)? {
        Value::String(text) => Moment::parse(text),
        Value::Number(number) => Moment::from_milliseconds(number.as_f64()?),
        _ => None,
    }
}

/// Longitude, latitude and perhaps an elevation.
fn place_of(value: &Value) -> Option<[f64; 3]> {
    let numbers = value.as_array()?;
    let number = |index: usize| numbers.get(index).and_then(Value::as_f64);
    Some([number(0)?, number(1)?, number(2).unwrap_or(f64::NAN)])
}

/// The states of a thing in order of time, each with its moment and the one after it. Those without a moment are left out.
fn states(thing: &Value) -> Vec<(Moment, &Map<String, Value>)> {
    let moments =
        list(thing, "state").iter().filter_map(|state| Some((moment_of(state, "t")?, state.as_object()?)));
    let mut states: Vec<(Moment, &Map<String, Value>)> = moments.collect();
    states.sort_by_key(|(moment, _)| *moment);
    states
}
