//! Queries of a file on disk: read whole, and read where the query needs it.
//!
//! The file is 4097² 32-bit floats in deflated tiles of 256, in the system's cache. Both sides open it, answer one query, and
//! let it go, in turn; answers are compared before.

use std::path::Path;

use glam::{DAffine2, DMat2, DVec2};
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::write;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, DatasetOptions};
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_raster::answer::Answer;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_terrain::profile::profile;
use sandtable_terrain::query::{Interpolation, Surface};
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{ViewshedCounts, ViewshedOptions, viewshed};

use crate::rounds::{ROUNDS, interleaved, median, ratio, time_ms};
use crate::{fields, peers};

const SIDE: usize = 4097;
const CELL_M: f64 = 10.0;
const CORNER: DVec2 = DVec2::new(500_000.0, 5_000_000.0);

/// How far the viewshed looks.
const RANGE_M: f64 = 2000.0;

/// Prints the section.
pub fn print() {
    let path = peers::folder().join("windows_4097.tif");
    let map_from_grid =
        DAffine2 { matrix2: DMat2::from_diagonal(DVec2::new(CELL_M, -CELL_M)), translation: CORNER };
    let raster = Raster {
        map_from_grid,
        georeferenced: true,
        crs: Some(Crs::from_epsg(32612).expect("known")),
        ..Raster::new(SIDE as u32, Samples::F32(fields::fractal(SIDE)))
    };
    let format = DemFormat::to_write("tif").expect("written");
    let bytes = write::write(&raster, format, "windows_4097").expect("it has a place").bytes;
    std::fs::write(&path, bytes).expect("the target directory can be written");
    println!("milliseconds: medians of {ROUNDS} rounds; ratio: whole to windows, more is better\n");
    println!("{:<28} {:>9} {:>9} {:>7}", "query", "whole", "windows", "ratio");
    let scattered = |count: u32| -> Vec<DVec2> {
        let spread = |index: u32, by: u32| f64::from(index.wrapping_mul(by) >> 8) / f64::from(1u32 << 24);
        let part = |index| DVec2::new(spread(index, 0x9e37_79b1), -spread(index, 0x85eb_ca77));
        (0..count).map(|index| CORNER + part(index) * (SIDE as f64 * CELL_M)).collect()
    };
    row(&path, "one height", |dataset| heights(dataset, &scattered(1)));
    row(&path, "100 scattered heights", |dataset| heights(dataset, &scattered(100)));
    row(&path, "10,000 scattered heights", |dataset| heights(dataset, &scattered(10_000)));
    row(&path, "a profile of 5 km", |dataset| profile_over(dataset, 5000.0));
    row(&path, "a viewshed of 2 km", viewshed_within);
}

fn row<A: PartialEq + std::fmt::Debug>(path: &Path, title: &str, ask: impl Fn(&Dataset) -> A) {
    let open = |most_kept| {
        Dataset::open(path, &DatasetOptions { most_kept, ..DatasetOptions::default() })
            .expect("it was written")
    };
    assert_eq!(ask(&open(u64::MAX)), ask(&open(0)), "{title}");
    let times = interleaved(
        ROUNDS,
        &mut [&mut || time_ms(|| ask(&open(u64::MAX))), &mut || time_ms(|| ask(&open(0)))],
    );
    let (whole, windows) = (&times[0], &times[1]);
    println!("{title:<28} {:>9.2} {:>9.2} {:>7.1}", median(whole), median(windows), ratio(whole, windows));
}

fn heights(dataset: &Dataset, at: &[DVec2]) -> Vec<Answer> {
    let crs = dataset.crs();
    dataset.heights(Surface::Source, Interpolation::Bilinear, &crs, at).expect("readable")
}

fn middle() -> DVec2 {
    CORNER + DVec2::new(0.5, -0.5) * (SIDE as f64 * CELL_M)
}

fn profile_over(dataset: &Dataset, length_m: f64) -> Vec<Answer> {
    let line = [middle(), middle() + DVec2::new(0.6, 0.8) * length_m];
    let reach = GroundReach { crs: &dataset.crs(), at: &line, around_m: 0.0 };
    let ground = dataset.ground(&reach).expect("readable");
    profile(&ground.lattice, &line).iter().map(|station| station.ground).collect()
}

fn viewshed_within(dataset: &Dataset) -> [usize; 3] {
    let reach = GroundReach { crs: &dataset.crs(), at: &[middle()], around_m: RANGE_M };
    let ground = dataset.ground(&reach).expect("readable");
    let options =
        ViewshedOptions { range_m: RANGE_M, ..ViewshedOptions::new(SightEnd { at: middle(), above_m: 2.0 }) };
    let seen = viewshed(&ground.lattice, &options).expect("there is ground");
    let ViewshedCounts { visible, hidden, no_data, .. } = seen.counts();
    [visible, hidden, no_data]
}
