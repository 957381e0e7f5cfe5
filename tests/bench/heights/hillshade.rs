//! Hillshading 4,097² posts, beside `gdaldem`.
//!
//! `gdaldem` is timed as a whole process that reads a raw file and writes another; ours in memory, and beside it the
//! same with the same file read first and the grays written after, which is the fair pair.

use std::fs;

use glam::DVec2;
use rayon::ThreadPoolBuilder;
use sandtable_terrain::hillshade::{HillshadeOptions, hillshade};
use sandtable_terrain::lattice::Lattice;

use crate::rounds::{ROUNDS, interleaved, median, ratio, time_ms};
use crate::{fields, peers};

const SIZE: usize = 4097;
const CELL_M: f64 = 10.0;
const ORIGIN: DVec2 = DVec2::new(500_000.0, 5_000_000.0);

/// Prints the table.
pub fn print() {
    let heights = fields::fractal(SIZE);
    let raster = peers::folder().join("hillshade.bin");
    peers::write_envi(&raster, &heights, SIZE, ORIGIN, CELL_M);
    let lattice = |heights| Lattice::new(ORIGIN, DVec2::splat(CELL_M), SIZE as u32, heights).expect("ground");
    let ground = lattice(heights);
    let options = HillshadeOptions::default();
    let pools = [1, 2].map(|count| ThreadPoolBuilder::new().num_threads(count).build().expect("threads"));
    let mut one = || time_ms(|| pools[0].install(|| hillshade(&ground, &options)));
    let mut two = || time_ms(|| pools[1].install(|| hillshade(&ground, &options)));
    let ours = peers::folder().join("hillshade-ours.bin");
    let mut with_files = || {
        time_ms(|| {
            let bytes = fs::read(&raster).expect("written above");
            let heights =
                bytes.chunks_exact(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]));
            let grays = pools[1].install(|| hillshade(&lattice(heights.collect()), &options));
            fs::write(&ours, grays).expect("the target directory can be written");
        })
    };
    let (from, to) = (raster.to_string_lossy(), peers::folder().join("hillshade-gdal.bin"));
    let to_name = to.to_string_lossy().into_owned();
    let mut gdal = || time_ms(|| peers::run("gdaldem", &["hillshade", "-q", "-of", "ENVI", &from, &to_name]));
    let mut contenders: Vec<&mut dyn FnMut() -> f64> = vec![&mut one, &mut two, &mut with_files];
    let mut names = vec!["ours in memory, 1 thread", "ours in memory, 2 threads", "ours, file to file, 2"];
    let has_gdal = peers::is_there("gdaldem");
    if has_gdal {
        contenders.push(&mut gdal);
        names.push("gdaldem, process");
    }
    let times = interleaved(ROUNDS, &mut contenders);
    println!("{SIZE}² fractal posts, median ms of {ROUNDS} rounds.");
    println!("{:<28}{:>8}{:>12}{:>16}", "", "ms", "× in memory", "× file to file");
    for (name, values) in names.iter().zip(&times) {
        println!(
            "{name:<28}{:>8.1}{:>12.2}{:>16.2}",
            median(values),
            ratio(values, &times[1]),
            ratio(values, &times[2])
        );
    }
    if has_gdal {
        difference(&hillshade(&ground, &options), &peers::read_bytes_from_south(&to, SIZE));
    }
}

/// How far our grays are from GDAL's, but for its empty frame.
fn difference(ours: &[u8], gdal: &[u8]) {
    let inside = |index: &usize| {
        let inner = 1..SIZE - 1;
        inner.contains(&(index % SIZE)) && inner.contains(&(index / SIZE))
    };
    let most = (0..ours.len()).filter(inside).map(|index| ours[index].abs_diff(gdal[index])).max();
    let equal = (0..ours.len()).filter(inside).filter(|&index| ours[index] == gdal[index]).count();
    let all = (SIZE - 2) * (SIZE - 2);
    println!(
        "grays differ by at most {}; {:.3} % are equal",
        most.unwrap_or(0),
        equal as f64 / all as f64 * 100.0
    );
}
