//! The schema and the declarations agree with what the decoder does.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::*;
use crate::parse::parse;

/// Every key by its path, `table.key`.
fn declared(keys: &'static [KeyDeclaration], table: &str) -> BTreeMap<String, &'static KeyDeclaration> {
    let mut all = BTreeMap::new();
    for key in KeyDeclaration::flattened(keys) {
        let dot = if table.is_empty() { "" } else { "." };
        let path = format!("{table}{dot}{}", key.name);
        all.append(&mut declared(key.inner(), &path));
        if matches!(key.kind, KeyKind::StyledTables(_)) {
            all.insert(format!("{path}.style"), &STYLE_KEY);
            all.insert(format!("{path}.phases"), &PHASES_KEY);
        }
        all.insert(path, key);
    }
    all
}

fn all_declared() -> BTreeMap<String, &'static KeyDeclaration> {
    declared(Document::DECLARATIONS, "")
}

/// The paths of all keys in the schema.
fn keys_in_schema(of: &Value, schema: &Value, table: &str) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for (name, value) in of["properties"].as_object().expect("properties") {
        let path = if table.is_empty() { name.clone() } else { format!("{table}.{name}") };
        let items = value["items"]["$ref"].as_str().and_then(|path| path.strip_prefix("#/$defs/"));
        if let Some(of) = items.map(|name| &schema["$defs"][name]).filter(|of| of["properties"].is_object()) {
            all.extend(keys_in_schema(of, schema, &path));
        } else if value["additionalProperties"]["properties"].is_object() {
            all.extend(keys_in_schema(&value["additionalProperties"], schema, &path));
        } else if value["properties"].is_object() {
            all.extend(keys_in_schema(value, schema, &path));
        }
        all.insert(path);
    }
    all
}

#[test]
fn the_schema_has_every_declared_key_and_no_other() {
    let (known, schema) = (all_declared(), schema());
    assert!(known.len() > 100 && known.contains_key("road.width"));
    assert!(known.contains_key("model.instances.where"));
    assert_eq!(keys_in_schema(&schema, &schema, ""), known.into_keys().collect());
}

#[test]
fn every_key_is_described() {
    for (path, key) in all_declared() {
        assert!(key.doc().len() >= 10 && key.doc().ends_with('.'), "{path} is described as {:?}", key.doc());
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
fn every_declared_default_is_a_value_of_its_key() {
    let source = "points = [[0, 0], [1, 0], [1, 1]]\n";
    let needed = |name: &str| match name {
        "area" => format!("{source}cover = \"forest\"\n"),
        "model" => "file = \"conifer\"\nat = [0, 0]\n".into(),
        "scatter" => format!("{source}of = \"conifer\"\n"),
        "earthwork" => "kind = \"crater\"\npoints = [[0, 0]]\nradius = 5\n".into(),
        "graphic" => format!("{source}kind = \"objective\"\n"),
        "viewshed" => "observers = [[0, 0]]\n".into(),
        "sight" => "observer = [0, 0]\ntargets = [[1, 1]]\n".into(),
        "range" => "at = [0, 0]\ndistances = [100]\n".into(),
        "label" => "text = \"a\"\nat = [0, 0]\n".into(),
        "symbol" => "sidc = \"10031000161211000000\"\nat = [0, 0]\n".into(),
        "overlay" => "file = \"a.json\"\n".into(),
        "phase" => "name = \"a\"\n".into(),
        "flight" => format!("{source}name = \"a\"\n"),
        "analysis" => "kind = \"slope\"\n".into(),
        "camera" => "name = \"a\"\neye = [0, 0]\nlook_at = [1, 1]\n".into(),
        _ => source.to_owned(),
    };
    let mut text = "[terrain]\ndem = \"a\"\n[style.contours]\ninterval = 5\n".to_owned();
    for table in Document::DECLARATIONS {
        if matches!(table.kind, KeyKind::Tables(_) | KeyKind::StyledTables(_)) {
            text += &format!("[[{}]]\n{}", table.name, needed(table.name));
        }
    }
    let document = parse("defaults.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(*document.roads[0].width.default(), 6.0);
    assert_eq!(document.roads[0].miter_limit, 2.0);
    assert_eq!(document.scatters[0].scale, [0.8, 1.2]);
    assert_eq!((document.style.light.azimuth, *document.terrain.tolerance_px), (None, 1.0));
    assert!(document.furniture.legend && document.terrain.fill_voids.is_none());
    let with_default = |key: &&KeyDeclaration| matches!(key.presence, Presence::Default(_));
    assert!(all_declared().into_values().filter(with_default).count() > 40);
}
