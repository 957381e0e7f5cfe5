//! Other people's programs, timed beside ours in the same rounds where they are installed.
//!
//! A peer is a program on the `PATH` (`gdaldem`, `gdal_grid`) or a script in `tests/bench/peers` for the Python that
//! `SANDTABLE_PYTHON` names, which needs numpy, scipy, numba and rasterio. A peer that is not there is told, and its
//! row left out.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A folder for the files that peers read, below the target directory; made where it is not there.
pub fn folder() -> PathBuf {
    let folder = Path::new(env!("SANDTABLE_ROOT")).join("target/peers");
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
    let script = Path::new(env!("SANDTABLE_ROOT")).join("tests/bench/peers").join(name);
    let ran = Command::new(python).arg(&script).args(arguments).output().expect("the Python starts");
    assert!(ran.status.success(), "{name}: {}", String::from_utf8_lossy(&ran.stderr));
    String::from_utf8_lossy(&ran.stdout).lines().filter_map(|line| line.trim().parse().ok()).collect()
}

/// Runs a program to its end, its output thrown away; it must succeed.
pub fn run(program: &str, arguments: &[&str]) {
    let ran = Command::new(program).args(arguments).output().expect("the program starts");
    assert!(ran.status.success(), "{program}: {}", String::from_utf8_lossy(&ran.stderr));
}

/// Writes square heights, row by row from the south-west, as a raw file that GDAL reads (ENVI: rows from the north, a
/// header beside). Posts `cell_m` apart are pixel centers, the south-west one at `origin`.
pub fn write_envi(path: &Path, heights: &[f32], size: usize, origin: glam::DVec2, cell_m: f64) {
    let bytes: Vec<u8> =
        heights.chunks_exact(size).rev().flatten().flat_map(|height| height.to_le_bytes()).collect();
    let (west, north) = (origin.x - cell_m / 2.0, origin.y + cell_m * (size as f64 - 0.5));
    let header = format!(
        "ENVI\nsamples = {size}\nlines = {size}\nbands = 1\nheader offset = 0\nfile type = ENVI Standard\n\
         data type = 4\ninterleave = bsq\nbyte order = 0\n\
         map info = {{UTM, 1, 1, {west}, {north}, {cell_m}, {cell_m}, 33, North, WGS-84}}\n"
    );
    let written =
        std::fs::write(path, bytes).and_then(|()| std::fs::write(path.with_extension("hdr"), header));
    written.expect("the target directory can be written");
}

/// The bytes of a square raw raster with one byte a pixel, row by row from the south.
pub fn read_bytes_from_south(path: &Path, size: usize) -> Vec<u8> {
    let bytes = std::fs::read(path).expect("the peer wrote it");
    bytes.chunks_exact(size).rev().flatten().copied().collect()
}
