//! Khronos's glTF validator, or a loud word that there is none.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// What the validator says of a file: `errors`, `warnings`, `messages`. `None` with a loud line where it is not
/// installed: `SANDTABLE_GLTF_VALIDATOR` names the folder into which npm installed `gltf-validator`.
///
/// # Panics
/// Where it is not installed and `SANDTABLE_REQUIRE_VALIDATOR` is set, or it cannot read the file.
pub fn validate(file: &Path) -> Option<Value> {
    let Some(folder) = std::env::var_os("SANDTABLE_GLTF_VALIDATOR") else {
        super::skip::skipped("no glTF validator: SANDTABLE_GLTF_VALIDATOR is not set");
        assert!(
            std::env::var_os("SANDTABLE_REQUIRE_VALIDATOR").is_none(),
            "SANDTABLE_REQUIRE_VALIDATOR is set"
        );
        return None;
    };
    let script = concat!(env!("SANDTABLE_ROOT"), "tests/tools/validate_gltf.js");
    let modules = Path::new(&folder).join("node_modules");
    let ran =
        Command::new("node").env("NODE_PATH", modules).arg(script).arg(file).output().expect("node runs");
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(ran.status.success(), "{said}{}", String::from_utf8_lossy(&ran.stderr));
    Some(serde_json::from_str(&said).expect("one line of JSON"))
}

/// Fails where the validator finds an error or a warning.
pub fn assert_valid(file: &Path) {
    if let Some(found) = validate(file) {
        assert_eq!((&found["errors"], &found["warnings"]), (&Value::from(0), &Value::from(0)), "{found:#}");
    }
}
