//! The shared test data, which is not part of the project.

use std::path::{Path, PathBuf};

/// Where `path` of the test data is, or `None` with a loud line where there is none.
///
/// # Panics
/// Where it is not there and `SANDTABLE_REQUIRE_DATA` is set.
pub fn data(path: &str) -> Option<PathBuf> {
    let at = Path::new(concat!(env!("SANDTABLE_ROOT"), "../shared/data")).join(path);
    if at.exists() {
        return Some(at.canonicalize().expect("it is there"));
    }
    super::skip::skipped(&format!("no test data at {}", at.display()));
    assert!(std::env::var_os("SANDTABLE_REQUIRE_DATA").is_none(), "SANDTABLE_REQUIRE_DATA is set");
    None
}

/// All files below a folder, sorted.
pub fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("readable").flatten() {
            let path = entry.path();
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}
