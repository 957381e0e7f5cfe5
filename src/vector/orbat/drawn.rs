//! What the layers of a scenario draw: shapes with a style, control measures, and texts.

use glam::{DVec2, DVec3};
use serde_json::{Map, Value};

use super::units::amplifier;
use super::{FORMAT, list, moment_of, place_of, states, text_of};
use crate::builder::{FeatureParts, LayerBuilder, Vertices};
use crate::error::VectorError;
use crate::feature::Properties;
use crate::geojson::record::add_shape;
use crate::moment::Moment;
use crate::overlay_schema::{
    BEGIN, DESCRIPTION, END, FILL, FILL_OPACITY, ID, IDENTITY, KIND, LABEL, LAYER, MARKER_COLOR, NAME, SIDC,
    STATUS, STROKE, STROKE_DASHES, STROKE_OPACITY, STROKE_WIDTH, field_property, set,
};
use crate::tally::RecordTally;
use sandtable_geom::ground_shape::GroundEllipse;

/// Adds what a layer holds.
pub(super) fn add(layer_name: &str, layer: &Value, builder: &mut LayerBuilder) {
    let [mut hidden, mut unread] = [const { RecordTally::new() }; 2];
    let is_hidden = |value: &Value| value.get("isHidden").and_then(Value::as_bool) == Some(true);
    let items = list(layer, "items").iter().chain(list(layer, "features"));
    for (index, item) in items.enumerate() {
        let place = || {
            let name = text_of(item, "name").or_else(|| text_of(item, "id"));
            name.map_or_else(|| format!("item {} of '{layer_name}'", index + 1), |name| format!("'{name}'"))
        };
        if is_hidden(layer) || is_hidden(item) {
            hidden.add(place);
            continue;
        }
        let kind = text_of(item, "kind").unwrap_or("geometry");
        if !matches!(kind, "geometry" | "tacticalGraphic" | "annotation") {
            unread.add(place);
            continue;
        }
        for moment in moments(item, [layer, item]) {
            let mut properties = Properties::new();
            set(&mut properties, LAYER, layer_name);
            moment.begin.into_iter().for_each(|begin| set(&mut properties, BEGIN, begin.to_string()));
            moment.end.into_iter().for_each(|end| set(&mut properties, END, end.to_string()));
            match read_item(kind, &Value::Object(moment.item), &mut properties) {
                Ok(parts) => builder.add_at(parts, properties, place),
                Err(reason) => builder.add_broken(place(), VectorError::broken(FORMAT, place(), reason)),
            }
        }
    }
    builder.note_omitted(&hidden, "hidden item", "hidden items");
    builder.note_omitted(&unread, "item that is no feature", "items that are no features");
}

/// An item as it is for a time.
struct ItemMoment {
    begin: Option<Moment>,
    end: Option<Moment>,
    item: Map<String, Value>,
}

/// An item from state to state, as long as it and its layer are there.
fn moments(item: &Value, shown: [&Value; 2]) -> Vec<ItemMoment> {
    let Some(members) = item.as_object() else { return Vec::new() };
    let from = shown.iter().filter_map(|value| moment_of(value, "visibleFromT")).max();
    let until = shown.iter().filter_map(|value| moment_of(value, "visibleUntilT")).min();
    let mut current = members.clone();
    current.remove("state");
    let (mut begin, mut moments) = (from, Vec::new());
    for (moment, state) in states(item) {
        let patch = state.get("patch").and_then(Value::as_object).unwrap_or(state);
        if begin.is_none_or(|begin| begin < moment) {
            moments.push(ItemMoment { begin, end: Some(moment), item: current.clone() });
            begin = Some(moment);
        }
        for (key, value) in patch.iter().filter(|(key, _)| !matches!(key.as_str(), "t" | "id")) {
            current.insert(key.clone(), value.clone());
        }
    }
    moments.push(ItemMoment { begin, end: None, item: current });
    for moment in &mut moments {
        moment.end = [moment.end, until].into_iter().flatten().min();
    }
    moments.retain(|moment| moment.end.is_none_or(|end| moment.begin.is_none_or(|begin| begin < end)));
    moments
}

fn read_item(kind: &str, item: &Value, properties: &mut Properties) -> Result<FeatureParts, String> {
    let nested = item.get("properties").unwrap_or(&Value::Null);
    for (property, key) in [(ID, "id"), (NAME, "name"), (DESCRIPTION, "description"), (LABEL, "label")] {
        let text = text_of(item, key).or_else(|| text_of(nested, key));
        text.into_iter().for_each(|text| set(properties, property, text));
    }
    add_style(item.get("style").unwrap_or(nested), properties);
    let mut parts = FeatureParts::default();
    match kind {
        "annotation" => {
            let content = item.get("content").unwrap_or(&Value::Null);
            let text = text_of(content, "text").or_else(|| text_of(item, "text"));
            text.into_iter().for_each(|text| set(properties, LABEL, text));
            let anchor = item.get("anchor").and_then(|anchor| anchor.get("position")).and_then(place_of);
            let at = anchor.ok_or("the text has no place")?;
            parts.add_points(vec![DVec3::from(at)]);
        }
        "tacticalGraphic" => {
            add_control_measure(item, properties);
            let points: Vertices =
                list(item, "controlPoints").iter().filter_map(place_of).map(DVec3::from).collect();
            match points.len() {
                0 => return Err("the control measure has no points".into()),
                1 => parts.add_points(points),
                _ => parts.add_line(points),
            }
        }
        _ => add_geometry(item, &mut parts)?,
    }
    Ok(parts)
}

/// Adds a shape; a point with a radius is a circle.
fn add_geometry(item: &Value, parts: &mut FeatureParts) -> Result<(), String> {
    let geometry = item.get("geometry").unwrap_or(&Value::Null);
    let meta = item.get("geometryMeta").or_else(|| item.get("meta")).unwrap_or(&Value::Null);
    let is_circle = ["geometryKind", "type"].iter().any(|key| text_of(meta, key) == Some("Circle"));
    let center = geometry.get("coordinates").and_then(place_of);
    match (is_circle, center, meta.get("radius").and_then(Value::as_f64)) {
        (true, Some([x, y, _]), Some(radius_m)) => {
            let circle = GroundEllipse::circle(DVec2::new(x, y), radius_m);
            let ring = circle.ring().map_err(|error| format!("the circle has no outline: {error}"))?;
            parts.add_polygon([ring.into_iter().map(|at| at.extend(f64::NAN)).collect()]);
            Ok(())
        }
        _ => add_shape(parts, geometry),
    }
}

/// The kind, the identity and the texts of a control measure.
fn add_control_measure(item: &Value, properties: &mut Properties) {
    text_of(item, "sidc").into_iter().for_each(|code| set(properties, SIDC, code));
    let kind = text_of(item, "graphicKind").map(|kind| kind.to_ascii_lowercase().replace('-', "_"));
    kind.into_iter().for_each(|kind| set(properties, KIND, kind));
    let identity = match text_of(item, "standardIdentity") {
        Some("2" | "3") => Some("friend"),
        Some("4") => Some("neutral"),
        Some("5" | "6") => Some("hostile"),
        Some("0" | "1") => Some("unknown"),
        _ => None,
    };
    identity.into_iter().for_each(|identity| set(properties, IDENTITY, identity));
    let status = text_of(item, "status").filter(|status| matches!(*status, "planned" | "present"));
    status.into_iter().for_each(|status| set(properties, STATUS, status));
    for (key, value) in item.get("textAmplifiers").and_then(Value::as_object).into_iter().flatten() {
        if let (Some(property), Some(text)) = (field_property(key), amplifier(value)) {
            set(properties, property, text);
        }
    }
}

/// The style of a shape, by the names of simplestyle.
fn add_style(style: &Value, properties: &mut Properties) {
    for key in [STROKE, FILL, MARKER_COLOR] {
        match style.get(key) {
            Some(Value::Null) => set(properties, key, "none"),
            Some(Value::String(color)) => set(properties, key, color.as_str()),
            _ => {}
        }
    }
    text_of(style, "color").into_iter().for_each(|color| set(properties, STROKE, color));
    for key in [STROKE_WIDTH, STROKE_OPACITY, FILL_OPACITY] {
        if let Some(number @ Value::Number(_)) = style.get(key) {
            properties.insert(key.to_owned(), number.clone());
        }
    }
    let dashes: Vec<String> = list(style, "strokeDash").iter().map(Value::to_string).collect();
    let named = text_of(style, "stroke-style").filter(|style| matches!(*style, "dashed" | "dotted"));
    match (dashes.is_empty(), named) {
        (false, _) => set(properties, STROKE_DASHES, dashes.join(",")),
        (true, Some(_)) => set(properties, STROKE_DASHES, "6,4"),
        (true, None) => {}
    }
}
