//! A JSON Schema of the scene file, for editors that complete and check text while it is written.
//!
//! Made from the declarations that the decoder reads ([`KeyDeclaration`]). It is of draft 2020-12 (Wright et al. 2022)
//! and uses only what the common TOML editors know. It checks neither rules between keys nor the syntax of expressions;
//! `sandtable check` does.

use serde_json::{Map, Value, json};

use crate::bounds::Bounds;
use crate::declaration::{KeyDeclaration, KeyKind, Presence};
use crate::document::Document;
use crate::phases::PHASES_KEY;
use crate::styles::STYLE_KEY;
use crate::value::COORDINATES;
use crate::words::{RampName, WordDeclaration, declarations};
use sandtable_base::limits::{EXPRESSION_BYTES, INLINE_POINTS, SCENE_LIST, SCENE_TEXT};
use sandtable_catalog::parameter::ParameterForm;

/// The schema as one JSON object.
pub fn schema() -> Value {
    let keys = Document::DECLARATIONS;
    let mut root = object(KeyDeclaration::flattened(keys));
    root.insert("anyOf".into(), json!([{ "required": ["include"] }, completeness(keys)]));
    let repeated = keys.iter().filter_map(|key| Some((key.name.to_owned(), repeated_table(key)?)));
    let definitions: Map<String, Value> = shared_definitions().into_iter().chain(repeated).collect();
    root.insert("$defs".into(), Value::Object(definitions));
    root.insert("$schema".into(), "https://json-schema.org/draft/2020-12/schema".into());
    root.insert("title".into(), "sandtable scene file".into());
    Value::Object(root)
}

/// A table that has `keys` and no others.
fn object<'k>(keys: impl Iterator<Item = &'k KeyDeclaration>) -> Map<String, Value> {
    let properties: Map<String, Value> = keys.map(|key| (key.name.to_owned(), property(key))).collect();
    [
        ("type".to_owned(), json!("object")),
        ("properties".to_owned(), Value::Object(properties)),
        ("additionalProperties".to_owned(), json!(false)),
    ]
    .into_iter()
    .collect()
}

/// The value of a key, with its description and, for what an editor may insert, its default.
fn property(key: &KeyDeclaration) -> Value {
    let mut value = shape(key);
    value["description"] = description(key).into();
    let is_insertable = key.inner().is_empty() && !matches!(key.kind, KeyKind::Switch | KeyKind::Styles);
    if let Presence::Default(text) = key.presence
        && is_insertable
        && let Ok(default) = serde_json::from_str(text)
    {
        value["default"] = default;
    }
    value
}

fn description(key: &KeyDeclaration) -> String {
    let unit = if key.unit.is_empty() { String::new() } else { format!(" Unit: {}.", key.unit) };
    let words = match key.kind {
        KeyKind::Word(words) | KeyKind::FeatureWord(words) => meanings(&words()),
        _ => String::new(),
    };
    let presence = match key.presence {
        Presence::Required => " Needed.".to_owned(),
        Presence::Default(value) if key.inner().is_empty() => format!(" Default: {value}."),
        Presence::Otherwise(text) => format!(" Default: {text}."),
        Presence::Default(_) | Presence::Inline => String::new(),
    };
    format!("{}{words}{unit}{presence}", key.doc())
}

fn meanings(words: &[WordDeclaration]) -> String {
    let meaning = |declared: &WordDeclaration| format!("`{}`: {}", declared.word, declared.doc);
    format!(" {}.", words.iter().map(meaning).collect::<Vec<_>>().join("; "))
}

/// The definition of a table that may be repeated; `None` for other keys.
fn repeated_table(key: &KeyDeclaration) -> Option<Value> {
    let required = required_keys(key.inner());
    let mut table = match key.kind {
        KeyKind::Tables(keys) => object(KeyDeclaration::flattened(keys)),
        KeyKind::StyledTables(keys) => {
            object(KeyDeclaration::flattened(keys).chain([&STYLE_KEY, &PHASES_KEY]))
        }
        _ => return None,
    };
    match key.kind {
        _ if required.is_empty() => {}
        KeyKind::StyledTables(_) => {
            table.insert("anyOf".into(), json!([{ "required": [STYLE_KEY.name] }, { "required": required }]));
        }
        _ => drop(table.insert("required".into(), json!(required))),
    }
    Some(Value::Object(table))
}

/// `[styles.NAME]`: keys of any one of the tables that can name a style.
fn styles() -> Value {
    let keys_of = |key: &KeyDeclaration| {
        let KeyKind::StyledTables(keys) = key.kind else { return None };
        let property = |inner: &KeyDeclaration| {
            (inner.name.to_owned(), reference(&format!("{}/properties/{}", key.name, inner.name)))
        };
        let properties: Map<String, Value> = KeyDeclaration::flattened(keys).map(property).collect();
        Some(json!({ "properties": properties, "additionalProperties": false }))
    };
    let any: Vec<Value> = Document::DECLARATIONS.iter().filter_map(keys_of).collect();
    json!({ "type": "object", "additionalProperties": { "type": "object", "anyOf": any } })
}

fn required_keys(keys: &'static [KeyDeclaration]) -> Vec<&'static str> {
    let required = KeyDeclaration::flattened(keys).filter(|key| key.presence == Presence::Required);
    required.map(|key| key.name).collect()
}

/// The required keys of single tables, for a scene file that includes no other.
fn completeness(keys: &'static [KeyDeclaration]) -> Value {
    let inner = keys.iter().filter_map(|key| match key.kind {
        KeyKind::Table(inner) => Some((key.name.to_owned(), completeness(inner))),
        _ => None,
    });
    let inner: Map<String, Value> = inner.filter(|(_, needs)| *needs != json!({})).collect();
    let mut needs = Map::new();
    if !required_keys(keys).is_empty() {
        needs.insert("required".into(), json!(required_keys(keys)));
    }
    if !inner.is_empty() {
        needs.insert("properties".into(), Value::Object(inner));
    }
    Value::Object(needs)
}

/// Definitions that many keys refer to.
fn shared_definitions() -> [(String, Value); 5] {
    let definitions = [
        (
            "expression",
            json!({ "type": "string", "minLength": 1, "maxLength": EXPRESSION_BYTES.count(),
                    "description": "An expression over the feature's properties, such as \"lanes * 3.25 ?? 6\"." }),
        ),
        (
            "computed",
            json!({ "type": "string", "pattern": "[^\\w-]", "maxLength": EXPRESSION_BYTES.count(),
                    "description": "An expression that gives one of the words, such as \"property('surface')\"." }),
        ),
        (
            "color",
            json!({ "type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})$" }),
        ),
        (
            "point",
            json!({ "anyOf": [{ "type": "array", "items": number(COORDINATES), "minItems": 2, "maxItems": 2 }, text()],
                    "description": "Two numbers of the system, or a position in words: a grid reference, UTM, or latitude and longitude." }),
        ),
        ("scalar", json!({ "type": ["string", "number", "boolean"] })),
    ];
    definitions.map(|(name, value)| (name.to_owned(), value))
}

/// The values that the type of a key allows.
fn shape(key: &KeyDeclaration) -> Value {
    match key.kind {
        KeyKind::Number(range) => number(range),
        KeyKind::Integer(least, most) => json!({ "type": "integer", "minimum": least, "maximum": most }),
        KeyKind::FeatureNumber(range) => json!({ "anyOf": [number(range), reference("expression")] }),
        KeyKind::Switch => json!({ "type": "boolean" }),
        KeyKind::Text => json!({ "type": "string", "maxLength": SCENE_TEXT.count() }),
        KeyKind::FilledText => text(),
        KeyKind::TextList => json!({ "anyOf": [text(), list(text(), 1, SCENE_LIST.count())] }),
        KeyKind::FilesOrTables(keys) => {
            let mut table = object(KeyDeclaration::flattened(keys));
            table.insert("required".into(), json!(required_keys(keys)));
            let one = [text(), Value::Object(table)];
            let any = json!({ "anyOf": one });
            json!({ "anyOf": [one[0], one[1], list(any, 1, SCENE_LIST.count())] })
        }
        KeyKind::TextTable => {
            json!({ "type": "object", "additionalProperties": text(), "minProperties": 1, "maxProperties": SCENE_LIST.count() })
        }
        KeyKind::Expression => json!({ "allOf": [reference("expression")] }),
        KeyKind::Word(words) => one_of(&words()),
        KeyKind::FeatureWord(words) => json!({ "anyOf": [one_of(&words()), reference("computed")] }),
        KeyKind::Color => json!({ "allOf": [reference("color")] }),
        KeyKind::Point => json!({ "allOf": [reference("point")] }),
        KeyKind::Points(least) => list(reference("point"), least, INLINE_POINTS.count()),
        KeyKind::NumberRange(range) => list(number(range), 2, 2),
        KeyKind::Numbers(range) => list(number(range), 0, INLINE_POINTS.count()),
        KeyKind::Ramp => {
            let stop = json!({ "type": "array", "prefixItems": [{ "type": "number" }, reference("color")],
                               "minItems": 2, "maxItems": 2 });
            json!({ "anyOf": [one_of(&declarations::<RampName>()), list(stop, 2, SCENE_LIST.count())] })
        }
        KeyKind::Selection => {
            let values =
                json!({ "anyOf": [reference("scalar"), list(reference("scalar"), 1, SCENE_LIST.count())] });
            let table = json!({ "type": "object", "additionalProperties": values, "minProperties": 1 });
            json!({ "anyOf": [table, reference("expression")] })
        }
        KeyKind::Table(keys) => Value::Object(object(KeyDeclaration::flattened(keys))),
        KeyKind::Tables(_) | KeyKind::StyledTables(_) => {
            json!({ "type": "array", "items": reference(key.name) })
        }
        KeyKind::Styles => styles(),
        KeyKind::NamedTables(keys) => {
            let table = Value::Object(object(KeyDeclaration::flattened(keys)));
            json!({ "type": "object", "additionalProperties": table })
        }
        KeyKind::Argument(forms) => match forms {
            [form] => argument(form),
            _ => json!({ "anyOf": forms.iter().map(argument).collect::<Vec<_>>() }),
        },
        KeyKind::Group(_) | KeyKind::AnalysisArguments => Value::Null,
    }
}

/// The values of an argument of an analysis.
fn argument(form: &ParameterForm) -> Value {
    match *form {
        ParameterForm::Number { least, greatest } => number(Bounds::Within(least, greatest)),
        ParameterForm::Numbers { least, greatest } => {
            list(number(Bounds::Within(least, greatest)), 1, INLINE_POINTS.count())
        }
        ParameterForm::Word(words) => json!({ "enum": words }),
        ParameterForm::Vehicle | ParameterForm::Ground => text(),
        ParameterForm::Points { least: least @ 2.. } => {
            list(reference("point"), least, INLINE_POINTS.count())
        }
        ParameterForm::Points { .. } => {
            json!({ "anyOf": [reference("point"), list(reference("point"), 1, INLINE_POINTS.count())] })
        }
        ParameterForm::Line | ParameterForm::Extent => list(reference("point"), 2, INLINE_POINTS.count()),
        ParameterForm::Area => list(reference("point"), 3, INLINE_POINTS.count()),
    }
}

fn one_of(words: &[WordDeclaration]) -> Value {
    json!({ "enum": words.iter().map(|declared| declared.word).collect::<Vec<_>>() })
}

fn text() -> Value {
    json!({ "type": "string", "minLength": 1, "maxLength": SCENE_TEXT.count() })
}

fn list(items: Value, least: usize, most: usize) -> Value {
    json!({ "type": "array", "items": items, "minItems": least, "maxItems": most })
}

fn number(range: Bounds) -> Value {
    let (low, least, most) = match range {
        Bounds::Above(least, most) => ("exclusiveMinimum", least, most),
        Bounds::Within(least, most) => ("minimum", least, most),
    };
    json!({ "type": "number", low: whole_or_exact(least), "maximum": whole_or_exact(most) })
}

/// A number without trailing zeros where it is whole.
fn whole_or_exact(number: f64) -> Value {
    const EXACT: f64 = (1_u64 << 53) as f64;
    if number == number.trunc() && number.abs() < EXACT { json!(number as i64) } else { json!(number) }
}

fn reference(path: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{path}") })
}

#[cfg(test)]
mod tests;
