//! `licenses`: the notices that go with the program, complete and of allowed licenses only.

use std::collections::{BTreeMap, BTreeSet};

use toml::{Table, Value};

use crate::cli::{project, run};

fn table(path: &str) -> Table {
    std::fs::read_to_string(project(path)).expect("a file of the project").parse().expect("TOML")
}

fn text<'a>(table: &'a Value, key: &str) -> &'a str {
    table[key].as_str().expect("a text")
}

/// The names in the tables of dependencies of a manifest, without those of tests.
fn dependencies(path: &str) -> BTreeSet<String> {
    let manifest = table(path);
    let of = |table: &Table| -> Vec<String> {
        table
            .get("dependencies")
            .and_then(Value::as_table)
            .into_iter()
            .flatten()
            .map(|(name, _)| name.clone())
            .collect()
    };
    let targets = manifest.get("target").and_then(Value::as_table).into_iter().flatten();
    let targets = targets.filter_map(|(_, target)| target.as_table()).flat_map(of);
    of(&manifest).into_iter().chain(targets).collect()
}

/// The packages of others of Cargo.lock that are reached from `[dependencies]`, with their versions.
fn shipped() -> BTreeSet<String> {
    let lock = table("Cargo.lock");
    let mut named: BTreeMap<&str, Vec<&Value>> = BTreeMap::new();
    for package in lock["package"].as_array().expect("packages") {
        named.entry(text(package, "name")).or_default().push(package);
    }
    let needs = |package: &Value| -> Vec<String> {
        let names = package.get("dependencies").and_then(Value::as_array).into_iter().flatten();
        let names = names.map(|name| name.as_str().expect("a name").to_owned());
        // The lock file does not tell what tests need from what all need; the manifests of the workspace do.
        match text(package, "name").strip_prefix("sandtable") {
            Some(own) => {
                let path = own
                    .strip_prefix('-')
                    .map_or("Cargo.toml".to_owned(), |own| format!("src/{own}/Cargo.toml"));
                let direct = dependencies(&path);
                names.filter(|name| direct.contains(name.split(' ').next().expect("a name"))).collect()
            }
            None => names.collect(),
        }
    };
    let mut waiting = needs(named["sandtable"][0]);
    let (mut found, mut own) = (BTreeSet::new(), BTreeSet::new());
    while let Some(reference) = waiting.pop() {
        let mut words = reference.split(' ');
        let (name, version) = (words.next().expect("a name"), words.next());
        for package in &named[name] {
            let found = if name.starts_with("sandtable-") { &mut own } else { &mut found };
            if version.is_none_or(|version| version == text(package, "version"))
                && found.insert(format!("{name} {}", text(package, "version")))
            {
                waiting.extend(needs(package));
            }
        }
    }
    found
}

#[test]
fn every_package_is_noticed_with_a_license_that_is_allowed_and_printed() {
    let notices = run(&["licenses"]).ok();
    let (packages, texts) = notices.split_once("\n\n====").expect("packages, then licenses");
    let lines = packages.lines().skip(2).filter(|line| !line.starts_with(' '));
    let lines: Vec<(&str, &str)> = lines.map(|line| line.split_once(": ").expect("a license")).collect();
    let noticed: BTreeSet<String> =
        lines.iter().map(|(name, _)| (*name).to_owned()).filter(|name| !name.contains('(')).collect();
    assert_eq!(noticed, shipped(), "make assets/NOTICES.txt anew: python3 tests/tools/notices.py");
    let rules = table("deny.toml");
    let mut allowed: BTreeSet<&str> = BTreeSet::new();
    let names = |list: &Value| list["allow"].as_array().expect("a list").clone();
    let exceptions = rules["licenses"]["exceptions"].as_array().expect("a list");
    let all: Vec<Value> = exceptions.iter().flat_map(names).chain(names(&rules["licenses"])).collect();
    allowed.extend(all.iter().filter_map(Value::as_str));
    for (name, licenses) in lines {
        for license in licenses.split(" and ").filter(|license| *license != "in the public domain") {
            assert!(allowed.contains(license), "{name}: {license}");
            let heading = format!("{license}\n====");
            assert_eq!(texts.matches(&heading).count(), 1, "{name}: {license}");
        }
    }
}
