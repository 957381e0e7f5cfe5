//! The schema says what the decoder does, no more and no less.

use std::collections::BTreeSet;

use serde_json::Value;

use super::*;
use crate::description::defaults;

fn sketch() -> SchemaProbe {
    TableReader::sketch_root(|reader| document(reader, SourceText::new("", "")))
}

/// Every key as `table.key`.
fn keys(sketch: &SchemaProbe, table: &str) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for key in &sketch.keys {
        let path = inside(table, key.name);
        match &key.part {
            KeyPart::Table(inner) | KeyPart::Tables(inner) => all.extend(keys(inner, &path)),
            KeyPart::Value(_) | KeyPart::Named => {}
        }
        all.insert(path);
    }
    all
}

/// The same out of the schema.
fn keys_in_schema(of: &Value, schema: &Value, table: &str) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for (name, value) in of["properties"].as_object().expect("properties") {
        let path = inside(table, name);
        let items = value["items"]["$ref"].as_str().and_then(|path| path.strip_prefix("#/$defs/"));
        if let Some(of) = items.map(|name| &schema["$defs"][name]).filter(|of| of["properties"].is_object()) {
            all.extend(keys_in_schema(of, schema, &path));
        } else if value["properties"].is_object() {
            all.extend(keys_in_schema(value, schema, &path));
        }
        all.insert(path);
    }
    all
}

#[test]
fn the_schema_has_every_key_that_the_decoder_knows_and_no_other() {
    let (known, schema) = (keys(&sketch(), ""), schema());
    assert!(known.len() > 100 && known.contains("road.width") && known.contains("model.instances.where"));
    assert_eq!(keys_in_schema(&schema, &schema, ""), known);
}

#[test]
fn every_key_is_described() {
    let documentation = Documentation::read();
    for path in keys(&sketch(), "") {
        let (table, key) = path.rsplit_once('.').unwrap_or(("", &path));
        let said = documentation.of(table, key);
        assert!(said.is_some_and(|said| said.len() >= 10), "{path} is described as {said:?}");
    }
}

#[test]
fn nothing_in_the_schema_refers_to_what_is_not_there() {
    fn check(value: &Value, schema: &Value) {
        if let Some(path) = value["$ref"].as_str() {
            let pointer = path.strip_prefix('#').expect("a reference within the schema");
            assert!(schema.pointer(pointer).is_some(), "{path}");
        }
        match value {
            Value::Array(list) => list.iter().for_each(|value| check(value, schema)),
            Value::Object(object) => object.values().for_each(|value| check(value, schema)),
            _ => {}
        }
    }
    let schema = schema();
    check(&schema, &schema);
}

#[test]
fn documented_defaults_are_those_that_are_taken() {
    let schema = schema();
    for (table, key, taken) in [
        ("terrain", "vertical_exaggeration", defaults::VERTICAL_EXAGGERATION),
        ("terrain", "tolerance_px", defaults::TOLERANCE_PX),
        ("style/properties/contours", "major_every", f64::from(defaults::CONTOUR_MAJOR_EVERY)),
        ("style/properties/light", "azimuth", defaults::LIGHT_AZIMUTH_DEG),
        ("style/properties/light", "altitude", defaults::LIGHT_ALTITUDE_DEG),
        ("camera", "eye_height", defaults::EYE_HEIGHT_M),
        ("camera", "field_of_view", defaults::FIELD_OF_VIEW_DEG),
        ("label", "height", defaults::LABEL_HEIGHT_M),
        ("road", "width", defaults::ROAD_WIDTH_M),
        ("road", "shoulder", defaults::ROAD_SHOULDER_M),
        ("road", "miter_limit", defaults::MITER_LIMIT),
        ("road", "max_grade", defaults::MAX_GRADE_PERCENT),
        ("road", "crown", defaults::CROWN_PERCENT),
        ("road", "fill_slope", defaults::FILL_SLOPE),
        ("road", "cut_slope", defaults::CUT_SLOPE),
        ("bridge", "width", defaults::BRIDGE_WIDTH_M),
        ("bridge", "pier_spacing", defaults::PIER_SPACING_M),
        ("river", "width", defaults::RIVER_WIDTH_M),
        ("area", "border_width", defaults::BORDER_WIDTH_M),
        ("fence", "sag", defaults::SAG),
        ("model", "heading", defaults::HEADING_DEG),
        ("model", "scale", defaults::MODEL_SCALE),
        ("model", "tilt", defaults::TILT_DEG),
        ("model", "sink", defaults::SINK_M),
        ("scatter", "density", defaults::DENSITY_PER_HA),
        ("scatter", "seed", f64::from(defaults::SEED)),
    ] {
        let fixed = schema.pointer(&format!("/properties/{table}/properties/{key}/default"));
        let repeated = schema.pointer(&format!("/$defs/{table}/properties/{key}/default"));
        let documented = fixed.or(repeated).and_then(Value::as_f64);
        assert_eq!(documented, Some(taken), "[{table}] {key}");
    }
    let scatter = &schema["$defs"]["scatter"]["properties"];
    assert_eq!(scatter["scale"]["default"], json!(defaults::SCATTER_SCALE));
    let slope: Vec<f64> =
        scatter["slope"]["default"].as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
    assert_eq!(slope, defaults::SCATTER_SLOPE_DEG);
    for (table, key, word) in
        [("road", "surface", "asphalt"), ("road", "join", "miter"), ("lake", "level_rule", "lowest")]
    {
        assert_eq!(schema["$defs"][table]["properties"][key]["default"], word, "{table} {key}");
    }
}
