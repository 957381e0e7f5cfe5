//! `sandtable schema`: what an editor is given.

use crate::cli::run;

#[test]
fn the_schema_is_printed_as_one_json_object() {
    let out = run(&["schema"]).ok();
    let schema: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert!(schema["properties"]["terrain"]["properties"]["dem"]["description"].is_string());
    assert_eq!(run(&["schema"]).ok(), out, "the same every time");
}

#[test]
fn the_schema_takes_no_arguments() {
    assert!(run(&["schema", "more"]).failed(2).contains("unexpected argument"));
}
