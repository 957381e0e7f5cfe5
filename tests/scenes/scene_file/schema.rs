//! The schema takes what the decoder takes and refuses what it refuses.
//!
//! A validator of the few words of JSON Schema that the schema uses, small enough to be seen to be right.

use std::path::Path;

use sandtable_description::parse::parse;
use sandtable_description::schema::schema;
use serde_json::{Value, json};

use crate::scene_file::{BROKEN, COMPLETE, FEATURES, LEAST};

/// What is wrong with `value` by the schema `of`; empty where nothing is.
fn flaws(value: &Value, of: &Value, root: &Value, at: &str) -> Vec<String> {
    let mut all = Vec::new();
    let Some(of) = of.as_object() else { panic!("{of} is no schema") };
    for (word, asked) in of {
        let sound = match word.as_str() {
            "$ref" => {
                let pointer = asked.as_str().and_then(|path| path.strip_prefix('#')).expect("a reference");
                all.extend(flaws(value, root.pointer(pointer).expect("defined"), root, at));
                true
            }
            "allOf" => {
                list(asked).iter().for_each(|of| all.extend(flaws(value, of, root, at)));
                true
            }
            "anyOf" => list(asked).iter().any(|of| flaws(value, of, root, at).is_empty()),
            "type" => match asked {
                Value::String(kind) => is(value, kind),
                kinds => list(kinds).iter().any(|kind| is(value, kind.as_str().expect("a type"))),
            },
            "enum" => list(asked).contains(value),
            "pattern" => value.as_str().is_none_or(|text| matches(text, asked.as_str().expect("a pattern"))),
            "minimum" => value.as_f64().is_none_or(|number| number >= number_of(asked)),
            "maximum" => value.as_f64().is_none_or(|number| number <= number_of(asked)),
            "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > number_of(asked)),
            "minLength" => value.as_str().is_none_or(|text| text.chars().count() as f64 >= number_of(asked)),
            "maxLength" => value.as_str().is_none_or(|text| text.chars().count() as f64 <= number_of(asked)),
            "minItems" => value.as_array().is_none_or(|list| list.len() as f64 >= number_of(asked)),
            "maxItems" => value.as_array().is_none_or(|list| list.len() as f64 <= number_of(asked)),
            "minProperties" => value.as_object().is_none_or(|object| object.len() as f64 >= number_of(asked)),
            "maxProperties" => value.as_object().is_none_or(|object| object.len() as f64 <= number_of(asked)),
            "required" => value.as_object().is_none_or(|object| {
                list(asked).iter().all(|key| object.contains_key(key.as_str().expect("a key")))
            }),
            "items" => {
                for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                    all.extend(flaws(item, asked, root, &format!("{at}[{index}]")));
                }
                true
            }
            "prefixItems" => {
                for (item, of) in value.as_array().into_iter().flatten().zip(list(asked)) {
                    all.extend(flaws(item, of, root, at));
                }
                true
            }
            "properties" => {
                for (key, value) in value.as_object().into_iter().flatten() {
                    if let Some(of) = asked.get(key) {
                        all.extend(flaws(value, of, root, &format!("{at}.{key}")));
                    }
                }
                true
            }
            "additionalProperties" => {
                for (key, value) in value.as_object().into_iter().flatten() {
                    match asked {
                        _ if of.get("properties").is_some_and(|known| known.get(key).is_some()) => {}
                        Value::Bool(false) => all.push(format!("{at}: {key} is not known")),
                        of => all.extend(flaws(value, of, root, &format!("{at}.{key}"))),
                    }
                }
                true
            }
            "$schema" | "$defs" | "title" | "description" | "default" => true,
            other => panic!("the validator does not know {other}"),
        };
        if !sound {
            all.push(format!("{at}: {value} is not of {word} {asked}"));
        }
    }
    all
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn number_of(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn is(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number == number.trunc()),
        other => panic!("no such type as {other}"),
    }
}

/// The two patterns that the schema has.
fn matches(text: &str, pattern: &str) -> bool {
    match pattern {
        "[^\\w-]" => text.chars().any(|letter| !letter.is_ascii_alphanumeric() && !"_-".contains(letter)),
        color if color.starts_with("^#(") => {
            let digits = text.strip_prefix('#').unwrap_or("no");
            [3, 6, 8].contains(&digits.len()) && digits.chars().all(|digit| digit.is_ascii_hexdigit())
        }
        other => panic!("the validator does not know the pattern {other}"),
    }
}

/// The scene file's text as JSON; what JSON cannot say (infinities) becomes null.
fn as_json(text: &str) -> Option<Value> {
    let table: toml::Table = toml::from_str(text).ok()?;
    serde_json::to_value(table).ok()
}

fn flaws_of(text: &str) -> Vec<String> {
    let schema = schema();
    flaws(&as_json(text).expect("TOML"), &schema, &schema, "")
}

#[test]
fn every_scene_of_the_project_and_every_key_is_sound() {
    let folder = Path::new(env!("SANDTABLE_ROOT")).join("scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the scenes") {
        let path = entry.expect("readable").path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let text = std::fs::read_to_string(&path).expect("readable");
            assert_eq!(flaws_of(&text), Vec::<String>::new(), "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 8, "{count} scenes");
    for text in [COMPLETE.to_owned(), format!("{LEAST}{FEATURES}"), LEAST.to_owned()] {
        parse("hill.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(flaws_of(&text), Vec::<String>::new());
    }
}

#[test]
fn two_thirds_of_the_mistakes_that_are_told_an_editor_shows_while_one_writes() {
    let (mut refused, mut judged) = (0, 0);
    for (rest, _) in BROKEN {
        if let Some(broken) = as_json(&format!("{LEAST}{rest}")) {
            let schema = schema();
            judged += 1;
            refused += usize::from(!flaws(&broken, &schema, &schema, "").is_empty());
        }
    }
    assert!(refused * 3 >= judged * 2, "of {judged} broken scenes the schema sees {refused}");
}

#[test]
fn an_included_file_may_lack_what_the_whole_scene_needs() {
    assert!(!flaws_of("[[road]]\nfile = \"a\"\n").is_empty(), "a scene needs a terrain");
    assert_eq!(flaws_of("include = \"b.toml\"\n[terrain]\ntolerance_px = 2\n"), Vec::<String>::new());
    assert!(!flaws_of("[terrain]\ntolerance_px = 2\n").is_empty(), "alone it needs a dem");
}

#[test]
fn a_style_may_hold_the_keys_of_any_one_table() {
    let style = |keys: &str| flaws_of(&format!("{LEAST}[styles.a]\n{keys}\n"));
    assert_eq!(style("width = 3\nsurface = \"gravel\""), Vec::<String>::new());
    assert_eq!(style("cover = \"forest\""), Vec::<String>::new());
    assert!(!style("cover = \"forest\"\nsag = 0.1").is_empty(), "no table has both");
    let styled = format!("{LEAST}[styles.a]\ncover = \"forest\"\n[[area]]\nstyle = \"a\"\nfile = \"f\"\n");
    assert_eq!(flaws_of(&styled), Vec::<String>::new());
    assert!(
        !flaws_of(&format!("{LEAST}[[area]]\nfile = \"f\"\n")).is_empty(),
        "without a style it needs a cover"
    );
}

#[test]
fn words_ranges_and_defaults_are_stated() {
    let schema = schema();
    let road = &schema["$defs"]["road"]["properties"];
    assert_eq!(road["surface"]["anyOf"][0]["enum"], json!(["asphalt", "gravel", "track"]));
    assert_eq!(road["width"]["anyOf"][0]["minimum"], json!(0.01));
    assert_eq!(road["width"]["default"], json!(6));
    let description = road["width"]["description"].as_str().expect("described");
    assert!(
        description.starts_with("Width of the carriageway") && description.ends_with("Default: 6."),
        "{description}"
    );
}
