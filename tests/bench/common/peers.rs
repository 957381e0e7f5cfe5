//! Other people's programs, timed beside ours in the same rounds where they are installed.
//!
//! A peer is a program on the `PATH` (`gdaldem`, `gdal_grid`) or a script in `tests/bench/peers` for the Python that
//! `SANDTABLE_PYTHON` names, which needs numpy, scipy, numba and rasterio. A peer that is not there is told, and its
//! row left out.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A folder for the files that peers read, below the target directory; made where it is not there.
pub fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers");
    std::fs::create_dir_all(&folder).expect("the target directory can be written");
    folder
}

/// Whether a program can be started.
pub fn is_there(program: &str) -> bool {
    let there =
        Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    if !there {
        println!("({program} is not installed: its rows are left out)");
    }
    there
}

/// The Python with the peers' packages, if one is named.
pub fn python() -> Option<String> {
    let python = std::env::var("SANDTABLE_PYTHON").ok();
    if python.is_none() {
        println!(
            "(SANDTABLE_PYTHON names no Python with numpy, scipy, numba and rasterio: its rows are left out)"
        );
    }
    python
}

/// Runs a script of `tests/bench/peers` and returns the numbers that it prints, one a line.
pub fn script(python: &str, name: &str, arguments: &[&str]) -> Vec<f64> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bench/peers").join(name);
    let ran = Command::new(python).arg(&script).args(arguments).output().expect("the Python starts");
    assert!(ran.status.success(), "{name}: {}", String::from_utf8_lossy(&ran.stderr));
    String::from_utf8_lossy(&ran.stdout).lines().filter_map(|line| line.trim().parse().ok()).collect()
}

/// Runs a program to its end, its output thrown away; it must succeed.
pub fn run(program: &str, arguments: &[&str]) {
    let ran = Command::new(program).args(arguments).output().expect("the program starts");
    assert!(ran.status.success(), "{program}: {}", String::from_utf8_lossy(&ran.stderr));
}
