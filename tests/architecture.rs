//! Holds the code to the map: `src/ARCHITECTURE.md` and `src/` must agree.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The package at the top.
const ROOT_CRATE: &str = "sandtable";

/// The cells of every row of the table whose heading row is `heading`.
fn table(page: &str, heading: &str) -> Vec<Vec<String>> {
    let rows = page.lines().skip_while(|line| *line != heading).skip(2);
    rows.take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect())
        .collect()
}

fn page() -> String {
    fs::read_to_string(Path::new(ROOT).join("src/ARCHITECTURE.md")).expect("the map is there")
}

/// Every crate with its layer.
fn layers() -> BTreeMap<String, u32> {
    let rows = table(&page(), "| layer | crate | what lives there | knows nothing of |");
    assert!(rows.len() > 10, "the table of crates was not found");
    rows.into_iter().map(|row| (row[1].clone(), row[0].parse().expect("a layer is a number"))).collect()
}

/// The folder of a crate of the table.
fn folder(name: &str) -> PathBuf {
    if name == ROOT_CRATE { ROOT.into() } else { Path::new(ROOT).join("src").join(name) }
}

/// The crates of this workspace that a crate's manifest names under `[dependencies]`, whatever the platform and the features.
fn dependencies(name: &str) -> Vec<String> {
    let text = fs::read_to_string(folder(name).join("Cargo.toml")).expect("a crate has a manifest");
    let manifest: toml::Table = text.parse().expect("a manifest is TOML");
    let dependencies = manifest["dependencies"].as_table().expect("a table").keys();
    let own = dependencies
        .filter_map(|name| name.strip_prefix("sandtable-").or((name == ROOT_CRATE).then_some(name)));
    own.map(str::to_owned).collect()
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("readable").map(|entry| entry.expect("readable").path()) {
        if entry.is_dir() {
            found.extend(rust_files(&entry));
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            found.push(entry);
        }
    }
    found.sort();
    found
}

/// Every source file with its path below `src/` and its code: no comments, no unit tests.
fn sources() -> Vec<(String, String)> {
    let src = Path::new(ROOT).join("src");
    let code = |path: &PathBuf| {
        let text = fs::read_to_string(path).expect("readable");
        let code = text.lines().take_while(|line| *line != "#[cfg(test)]");
        code.filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
    };
    let name =
        |path: &PathBuf| path.strip_prefix(&src).expect("below src").to_string_lossy().replace('\\', "/");
    rust_files(&src).iter().map(|path| (name(path), code(path))).collect()
}

/// Every place where `code` names a path that starts with `name::`.
fn names(code: &str, name: &str) -> bool {
    let needle = format!("{name}::");
    code.match_indices(&needle).any(|(at, _)| {
        let before = code[..at].chars().next_back();
        !before.is_some_and(|before| before.is_alphanumeric() || before == '_' || before == ':')
    })
}

#[test]
fn every_crate_is_in_the_table_and_every_row_is_a_crate() {
    let manifest = fs::read_to_string(Path::new(ROOT).join("Cargo.toml")).expect("readable");
    let manifest: toml::Table = manifest.parse().expect("TOML");
    let members = manifest["workspace"]["members"].as_array().expect("a list");
    let members: BTreeSet<String> = members
        .iter()
        .map(|member| member.as_str().expect("a path").trim_start_matches("src/"))
        .map(|member| if member == "." { ROOT_CRATE.to_owned() } else { member.to_owned() })
        .collect();
    let listed: BTreeSet<String> = layers().into_keys().collect();
    assert_eq!(members, listed, "members of the workspace on the left, crates of the table on the right");
}

#[test]
fn a_crate_depends_on_crates_of_lower_layers_alone() {
    let layers = layers();
    let mut wrong = Vec::new();
    for (name, layer) in &layers {
        for other in dependencies(name) {
            if layers[&other] >= *layer {
                wrong.push(format!("{name} (layer {layer}) depends on {other} (layer {})", layers[&other]));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_dependency_with_one_user_is_named_nowhere_else() {
    let users = table(&page(), "| what | only in |");
    assert!(users.len() > 5, "the table of users was not found");
    let mut wrong = Vec::new();
    for (file, code) in sources() {
        for user in &users {
            let allowed = user[1].split(", ").any(|place| file.starts_with(place));
            if !allowed && names(&code, &user[0]) {
                wrong.push(format!("{file} names {}, which belongs in {}", user[0], user[1]));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_source_file_opens_with_what_it_does_and_stays_one_idea() {
    for path in rust_files(&Path::new(ROOT).join("src")) {
        let text = fs::read_to_string(&path).expect("readable");
        let opens = text.starts_with("//!") || text.starts_with("#![doc");
        assert!(opens, "{} does not open with //!", path.display());
        let lines = text.lines().count();
        assert!(lines <= 600, "{} has {lines} lines: split it", path.display());
    }
}

#[test]
fn nothing_is_imported_through_the_root_or_by_glob() {
    // The front door is the one place that re-exports.
    for (file, code) in sources().into_iter().filter(|(file, _)| file != "lib.rs") {
        let globs =
            code.lines().filter(|line| line.trim_start().starts_with("use crate") && line.contains('*'));
        let globs: Vec<&str> = globs.collect();
        assert!(globs.is_empty(), "{file}: {globs:?}");
        let reexports = code.lines().filter(|line| line.trim_start().starts_with("pub use"));
        let reexports: Vec<&str> = reexports.collect();
        assert!(reexports.is_empty(), "{file}: {reexports:?}");
    }
}

/// The name that a line of code gives to a type; associated types, which are indented, have none of their own.
fn declared_type(line: &str) -> Option<&str> {
    let mut words = line.split_whitespace().skip_while(|word| word.starts_with("pub"));
    let kind = words.next()?;
    let is_type =
        ["struct", "enum", "trait", "union"].contains(&kind) || (kind == "type" && !line.starts_with(' '));
    let name = words.next()?.split(|char: char| !char.is_alphanumeric()).next()?;
    (is_type && name.starts_with(|first: char| first.is_ascii_uppercase())).then_some(name)
}

#[test]
fn a_type_name_exists_once() {
    let mut files: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, code) in sources() {
        for name in code.lines().filter_map(declared_type) {
            files.entry(name.to_owned()).or_default().push(file.clone());
        }
    }
    assert!(files.len() > 500, "types are not found where this test looks for them");
    let twice: Vec<_> = files.iter().filter(|(_, files)| files.len() > 1).collect();
    assert!(twice.is_empty(), "{twice:#?}");
}

#[test]
fn the_front_door_is_short_and_tests_have_short_names() {
    let door = fs::read_to_string(Path::new(ROOT).join("src/lib.rs")).expect("it is there");
    assert!(door.lines().count() <= 150, "lib.rs has {} lines", door.lines().count());
    for path in ["src", "tests"].iter().flat_map(|folder| rust_files(&Path::new(ROOT).join(folder))) {
        let text = fs::read_to_string(&path).expect("readable");
        for after in text.split("#[test]").skip(1) {
            let name = after.split("fn ").nth(1).and_then(|rest| rest.split('(').next()).unwrap_or_default();
            assert!(name.len() < 80, "{}: {name} has {} characters", path.display(), name.len());
        }
    }
}
