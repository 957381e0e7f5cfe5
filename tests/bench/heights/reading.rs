//! GeoTIFF: to all heights, and to the first one.
//!
//! The file is what GDAL's users write: 4097² 32-bit floats in deflated tiles of 256, with the floating-point
//! predictor and without. Both sides read it from the system's cache, as often as the other in every round; what is
//! compared is a round's median. rasterio (which is GDAL) runs in a process of its own that has started GDAL before it
//! takes the time.

use std::fs;
use std::path::Path;

use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_dem::tiff::windows::GeoTiffWindows;
use sandtable_raster::windows::{RasterWindow, Windows};

use crate::fields;
use crate::peers;
use crate::rounds::{ROUNDS, interleaved, median, ratio, time_ms};

const SIDE: usize = 4097;

/// Reads of the whole file, and first heights, in each round.
const READS: usize = 3;
const OPENINGS: usize = 15;

/// Decoded blocks that are kept while single heights are asked.
const CACHE_BYTES: usize = 16 << 20;

/// Prints the section.
pub fn print() {
    let Some(python) = peers::python() else { return };
    let folder = peers::folder();
    let raw = folder.join("field_4097.f32");
    let bytes: Vec<u8> = fields::fractal(SIDE).into_iter().flat_map(f32::to_le_bytes).collect();
    fs::write(&raw, bytes).expect("the target directory can be written");
    println!("milliseconds: medians of {ROUNDS} rounds; ratio: ours to rasterio's, less is better\n");
    println!("{:<34} {:>9} {:>9} {:>7}", "file, what", "ours", "rasterio", "ratio");
    for predictor in ["1", "2", "3"] {
        let file = folder.join(format!("field_4097_p{predictor}.tif"));
        let name = file.to_string_lossy().into_owned();
        let (raw, side) = (raw.to_string_lossy(), SIDE.to_string());
        peers::script(&python, "read_raster.py", &["write", &raw, &side, &name, predictor]);
        let megabytes = fs::metadata(&file).expect("it was written").len() >> 20;
        row(&python, &file, &format!("predictor {predictor}, {megabytes} MiB: whole"), "whole", READS, whole);
        row(&python, &file, &format!("predictor {predictor}: first height"), "first", OPENINGS, first);
    }
}

fn row(python: &str, file: &Path, title: &str, what: &str, runs: usize, work: fn(&Path) -> f64) {
    let name = file.to_string_lossy();
    let times = interleaved(
        ROUNDS,
        &mut [&mut || median(&(0..runs).map(|_| time_ms(|| work(file))).collect::<Vec<_>>()), &mut || {
            median(&peers::script(python, "read_raster.py", &[what, &name, &runs.to_string()]))
        }],
    );
    let (ours, theirs) = (&times[0], &times[1]);
    println!("{title:<34} {:>9.2} {:>9.2} {:>7.2}", median(ours), median(theirs), ratio(ours, theirs));
}

/// Reads the file whole and returns its last height.
fn whole(file: &Path) -> f64 {
    let bytes = fs::read(file).expect("it was written");
    let raster = read("field.tif", &bytes, &DemHints::default()).expect("a plain file");
    raster.at(SIDE as u32 - 1, SIDE as u32 - 1)
}

/// Opens the file and returns a height near its middle.
fn first(file: &Path) -> f64 {
    let opened = fs::File::open(file).expect("it was written");
    let mut windows =
        GeoTiffWindows::open("field.tif", opened, &DemHints::default(), CACHE_BYTES).expect("a plain file");
    let middle = SIDE as u32 / 2;
    let mut height = Vec::new();
    let window = RasterWindow { column: middle, row: middle, width: 1, height: 1 };
    windows.read(window, &mut height).expect("inside");
    f64::from(height[0])
}
