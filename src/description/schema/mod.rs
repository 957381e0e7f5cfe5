//! A JSON Schema of the scene file, for editors that complete and check while one writes.
//!
//! Derived from the decoder itself (`sketch`) and from the tables' documentation
//! (`documentation`), so that it cannot say anything else than they. It is of draft 2020-12 (Wright
//! et al. 2022) and uses only what the common TOML editors know. What it cannot tell is what one key means for another,
//! or whether an expression can be read: `sandtable check` does.

use serde_json::{Map, Value, json};

use crate::description::bounds::Bounds;
use crate::description::decode::document;
use crate::description::documentation::{Documentation, default_of};
use crate::description::expression::MAX_TEXT_BYTES;
use crate::description::item::{MAX_COORDINATE, MAX_TEXT};
use crate::description::reader::TableReader;
use crate::description::sketch::{KeyPart, KeyProbe, KeyShape, Needed, SchemaProbe};
use crate::description::source_text::SourceText;

/// The schema as one JSON object.
pub fn schema() -> Value {
    let root = TableReader::sketch_root(|reader| document(reader, SourceText::new("", "")));
    let documentation = Documentation::read();
    let mut tables = Map::new();
    let mut whole = object(&root, "", &documentation, &mut tables);
    let includes = json!({ "required": ["include"] });
    whole.insert("anyOf".into(), json!([includes, completeness(&root)]));
    let mut defs = common();
    defs.append(&mut tables);
    whole.insert("$defs".into(), Value::Object(defs));
    whole.insert("$schema".into(), "https://json-schema.org/draft/2020-12/schema".into());
    whole.insert("title".into(), "sandtable scene file".into());
    Value::Object(whole)
}

/// A table: its keys, and that it has no others.
fn object(
    sketch: &SchemaProbe,
    table: &str,
    documentation: &Documentation,
    tables: &mut Map<String, Value>,
) -> Map<String, Value> {
    let mut properties = Map::new();
    for key in &sketch.keys {
        let mut value = match &key.part {
            KeyPart::Value(shape) => of_shape(shape),
            KeyPart::Table(inner) => {
                Value::Object(object(inner, &inside(table, key.name), documentation, tables))
            }
            KeyPart::Tables(inner) => repeated(inner, key.name, documentation, tables),
            KeyPart::Named => styles(sketch),
        };
        if let (Some(said), Value::Object(value)) = (documentation.of(table, key.name), &mut value) {
            value.insert("description".into(), said.into());
            if let Some(default) = default_of(said) {
                value.insert("default".into(), default);
            }
        }
        properties.insert(key.name.into(), value);
    }
    let fixed = json!({ "type": "object", "properties": properties, "additionalProperties": false });
    match fixed {
        Value::Object(fixed) => fixed,
        _ => Map::new(),
    }
}

/// A list of tables, each defined once under its own name.
fn repeated(
    sketch: &SchemaProbe,
    name: &'static str,
    documentation: &Documentation,
    tables: &mut Map<String, Value>,
) -> Value {
    let mut of = object(sketch, name, documentation, tables);
    let needed = needed_keys(sketch);
    if is_styled(sketch) && !needed.is_empty() {
        of.insert("anyOf".into(), json!([{ "required": ["style"] }, { "required": needed }]));
    } else if !needed.is_empty() {
        of.insert("required".into(), json!(needed));
    }
    tables.insert(name.into(), Value::Object(of));
    json!({ "type": "array", "items": reference(name) })
}

/// `[styles.NAME]`: keys of any one of the tables that can name a style.
fn styles(root: &SchemaProbe) -> Value {
    let keys = |key: &KeyProbe| match &key.part {
        KeyPart::Tables(sketch) if is_styled(sketch) => {
            let known = sketch.keys.iter().filter(|inner| inner.name != STYLE);
            let properties: Map<String, Value> = known
                .map(|inner| {
                    let path = format!("{}/properties/{}", key.name, inner.name);
                    (inner.name.to_owned(), reference(&path))
                })
                .collect();
            Some(json!({ "properties": properties, "additionalProperties": false }))
        }
        _ => None,
    };
    let any: Vec<Value> = root.keys.iter().filter_map(keys).collect();
    json!({ "type": "object", "additionalProperties": { "type": "object", "anyOf": any } })
}

/// The key that names a style.
const STYLE: &str = "style";

fn is_styled(sketch: &SchemaProbe) -> bool {
    sketch.keys.iter().any(|key| key.name == STYLE && matches!(key.part, KeyPart::Value(_)))
}

fn needed_keys(sketch: &SchemaProbe) -> Vec<&'static str> {
    sketch.keys.iter().filter(|key| key.needed == Needed::Yes).map(|key| key.name).collect()
}

/// What must be there where nothing is included: the needed keys of the tables that there is one of.
fn completeness(sketch: &SchemaProbe) -> Value {
    let inner = sketch.keys.iter().filter_map(|key| match &key.part {
        KeyPart::Table(table) => Some((key.name.to_owned(), completeness(table))),
        _ => None,
    });
    let inner: Map<String, Value> = inner.filter(|(_, needs)| *needs != json!({})).collect();
    let mut needs = Map::new();
    if !needed_keys(sketch).is_empty() {
        needs.insert("required".into(), json!(needed_keys(sketch)));
    }
    if !inner.is_empty() {
        needs.insert("properties".into(), Value::Object(inner));
    }
    Value::Object(needs)
}

/// Definitions that many keys refer to.
fn common() -> Map<String, Value> {
    let coordinate = number(Bounds::Within(-MAX_COORDINATE, MAX_COORDINATE));
    let scalar = json!({ "type": ["string", "number", "boolean"] });
    let pairs = [
        (
            "expression",
            json!({ "type": "string", "minLength": 1, "maxLength": MAX_TEXT_BYTES,
                    "description": "An expression over the feature's properties, such as \"lanes * 3.25 ?? 6\"." }),
        ),
        (
            "computed",
            json!({ "type": "string", "pattern": "[^\\w-]", "maxLength": MAX_TEXT_BYTES,
                    "description": "An expression that gives one of the words, such as \"property('surface')\"." }),
        ),
        (
            "color",
            json!({ "type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})$" }),
        ),
        ("point", json!({ "type": "array", "items": coordinate, "minItems": 2, "maxItems": 2 })),
        ("scalar", scalar),
    ];
    pairs.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn of_shape(shape: &KeyShape) -> Value {
    match shape {
        KeyShape::Number(bounds) => number(*bounds),
        KeyShape::Whole(bounds) => {
            json!({ "type": "integer", "minimum": bounds.start(), "maximum": bounds.end() })
        }
        KeyShape::Quantity(bounds) => json!({ "anyOf": [number(*bounds), reference("expression")] }),
        KeyShape::Switch => json!({ "type": "boolean" }),
        KeyShape::Text => json!({ "type": "string", "maxLength": MAX_TEXT }),
        KeyShape::FilledText => text(),
        KeyShape::OneOrMoreTexts(most) => json!({ "anyOf": [text(), list(text(), 1, *most)] }),
        KeyShape::Texts(most) => {
            json!({ "type": "object", "additionalProperties": text(), "minProperties": 1, "maxProperties": most })
        }
        KeyShape::Expression => json!({ "allOf": [reference("expression")] }),
        KeyShape::Word(words) => json!({ "enum": words }),
        KeyShape::Choice(words) => json!({ "anyOf": [{ "enum": words }, reference("computed")] }),
        KeyShape::Color => json!({ "allOf": [reference("color")] }),
        KeyShape::Point => json!({ "allOf": [reference("point")] }),
        KeyShape::Points(least, most) => list(reference("point"), *least, *most),
        KeyShape::Range(bounds) => list(number(*bounds), 2, 2),
        KeyShape::Numbers(bounds, most) => list(number(*bounds), 0, *most),
        KeyShape::Ramp(words, most) => {
            let stop = json!({ "type": "array", "prefixItems": [{ "type": "number" }, reference("color")],
                               "minItems": 2, "maxItems": 2 });
            json!({ "anyOf": [{ "enum": words }, list(stop, 2, *most)] })
        }
        KeyShape::Filter(most) => {
            let values = json!({ "anyOf": [reference("scalar"), list(reference("scalar"), 1, *most)] });
            let table = json!({ "type": "object", "additionalProperties": values, "minProperties": 1 });
            json!({ "anyOf": [table, reference("expression")] })
        }
    }
}

fn text() -> Value {
    json!({ "type": "string", "minLength": 1, "maxLength": MAX_TEXT })
}

fn list(items: Value, least: usize, most: usize) -> Value {
    json!({ "type": "array", "items": items, "minItems": least, "maxItems": most })
}

fn number(bounds: Bounds) -> Value {
    match bounds {
        Bounds::Above(low, high) => {
            json!({ "type": "number", "exclusiveMinimum": plain(low), "maximum": plain(high) })
        }
        Bounds::Within(low, high) => {
            json!({ "type": "number", "minimum": plain(low), "maximum": plain(high) })
        }
    }
}

/// A number without a tail of zeros where it is whole.
fn plain(number: f64) -> Value {
    const EXACT: f64 = (1_u64 << 53) as f64;
    if number == number.trunc() && number.abs() < EXACT { json!(number as i64) } else { json!(number) }
}

fn reference(path: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{path}") })
}

fn inside(table: &str, key: &str) -> String {
    if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") }
}

#[cfg(test)]
mod tests;
