//! The library's own time for what `heights.py` measures from Python: prints the seconds of the fastest of the runs.
//!
//! usage: heights DEM POSITIONS RUNS, where POSITIONS holds x and y of each as 64-bit floats, little-endian

use std::env;
use std::error::Error;
use std::fs;
use std::time::Instant;

use sandtable::{DVec2, Elevation, HeightSlices, Interpolation, Status};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [dem, positions, runs] = &arguments[..] else {
        return Err("usage: heights DEM POSITIONS RUNS".into());
    };
    let number = |bytes: &[u8; 8]| f64::from_le_bytes(*bytes);
    let bytes = fs::read(positions)?;
    let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(number).collect();
    let at: &[DVec2] = bytemuck::cast_slice(&numbers);
    let elevation = Elevation::open(dem)?;
    let (surface, crs) = (elevation.default_surface(), elevation.crs());
    let mut best_s = f64::INFINITY;
    for _ in 0..runs.parse()? {
        let start = Instant::now();
        let (mut heights_m, mut statuses) = (vec![0.0; at.len()], vec![Status::Outside; at.len()]);
        let out = HeightSlices { heights_m: &mut heights_m, statuses: &mut statuses };
        elevation.heights(surface, Interpolation::Bilinear, (&crs, at), out)?;
        best_s = best_s.min(start.elapsed().as_secs_f64());
        std::hint::black_box(heights_m);
    }
    println!("{best_s}");
    Ok(())
}
