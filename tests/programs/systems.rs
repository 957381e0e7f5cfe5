//! Places in the code that depend on the system, all of them in a list: its separator of paths and its folders, its ends of
//! lines, its locale, its time zone.
//!
//! A new place fails here. If it has to be, it gets its row with what other systems do.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A text in the code, and the files of `src/` that may hold it.
const PLACES: &[(&str, &[&str])] = &[
    // What only Unix has: each has `#[cfg(unix)]`, and something that does the same or nothing beside it.
    (
        "std::os::",
        &[
            "cli/address_space.rs",
            "cli/invocation.rs",
            "cli/supervisor.rs",
            "files/output_files.rs",
            "files/scratch_file.rs",
            "files/set_record.rs",
            "raster/content.rs",
            "remote/blocks_on_disk.rs",
        ],
    ),
    // Which signals are ignored, and the address space: without it, no signal and no limit.
    ("\"/proc/", &["cli/address_space.rs", "cli/signals.rs"]),
    ("\"/dev/", &[]),
    ("\"/tmp", &[]),
    // Paths of Windows in files, which are refused or found by their last part, and tests of that.
    ("\"C:\\", &["model/texture.rs", "remote/address.rs", "scene/assets.rs"]),
    // Paths are joined and taken apart by `std::path`; names in files have `/` everywhere.
    ("MAIN_SEPARATOR", &[]),
    // Folders of the user.
    ("\"TMPDIR\"", &["files/scratch_file.rs"]),
    ("\"HOME\"", &["remote/access.rs", "viewer/recent.rs"]),
    ("\"USERPROFILE\"", &[]),
    // No locale and no time zone.
    ("\"LANG\"", &[]),
    ("\"LC_", &[]),
    ("\"TZ\"", &[]),
    ("localtime", &[]),
    ("Local::now", &[]),
    // Lines are read by `lines`, which takes both ends; those of OBJ may end with CR alone, and headers of HTTP end alike everywhere.
    ("split('\\n')", &["model/obj/text.rs"]),
    ("split(\"\\n\")", &[]),
    ("split(\"\\r\\n\")", &["remote/http_client.rs"]),
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn what_depends_on_the_system_is_in_the_list() {
    let src = Path::new(env!("SANDTABLE_ROOT")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    assert!(files.len() > 500, "the code was not found");
    let name = |path: &Path| -> String {
        let parts = path.strip_prefix(&src).expect("below src").components();
        parts.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect::<Vec<_>>().join("/")
    };
    let texts: Vec<(String, String)> = files
        .iter()
        .map(|path| (name(path), std::fs::read_to_string(path).expect("a file of the project")))
        .collect();
    for &(text, wanted) in PLACES {
        let holding = texts.iter().filter(|(_, code)| code.contains(text)).map(|(name, _)| name.as_str());
        let (found, wanted): (BTreeSet<&str>, BTreeSet<&str>) =
            (holding.collect(), wanted.iter().copied().collect());
        assert_eq!(found, wanted, "{text}");
    }
}
