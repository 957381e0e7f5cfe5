//! Land in bands against the same land in memory, bit by bit.

use std::ops::Range;
use std::path::Path;

use glam::DVec2;

use super::banded::BandedWater;
use super::bands::{BandArray, BandStore, LandBands};
use crate::arguments::{AnalysisArguments, ArgumentValue};
use crate::error::AnalysisError;
use crate::outcome::{Figure, PostValues};
use crate::run::run;
use crate::test_land::{bare, noise, on_pool, random};
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_terrain::stop_flag::StopFlag;

/// A store in memory.
struct MemoryStore<'a> {
    heights: &'a [f32],
    columns: usize,
    kept: Vec<u8>,
}

impl MemoryStore<'_> {
    fn place(&self, array: BandArray, at: u64, bytes: usize) -> Range<usize> {
        let start = array.before() as usize * self.heights.len() + at as usize;
        start..start + bytes
    }
}

impl BandStore for MemoryStore<'_> {
    type Error = AnalysisError;

    fn heights(&mut self, rows: Range<usize>) -> Result<Vec<f32>, AnalysisError> {
        assert!(rows.len() >= 2);
        Ok(self.heights[rows.start * self.columns..rows.end * self.columns].to_vec())
    }

    fn read(&mut self, array: BandArray, at: u64, out: &mut [u8]) -> Result<(), AnalysisError> {
        out.copy_from_slice(&self.kept[self.place(array, at, out.len())]);
        Ok(())
    }

    fn write(&mut self, array: BandArray, at: u64, bytes: &[u8]) -> Result<(), AnalysisError> {
        let place = self.place(array, at, bytes.len());
        self.kept[place].copy_from_slice(bytes);
        Ok(())
    }
}

const CELL: DVec2 = DVec2::new(10.0, 14.0);

fn shown(kind: &str, show: &str) -> AnalysisArguments {
    let kind = sandtable_catalog::kind(kind).expect("a kind");
    AnalysisArguments::new(kind).with("show", ArgumentValue::Word(show.into()))
}

fn bits(values: &PostValues) -> Vec<u32> {
    match values {
        PostValues::Numbers(numbers) => numbers.iter().map(|number| number.to_bits()).collect(),
        PostValues::Codes(codes) => codes.iter().map(|&code| code.into()).collect(),
    }
}

/// The values and figures in bands of so many rows; the bytes that were kept are those that are stated.
fn in_bands(
    arguments: &AnalysisArguments,
    (columns, heights): (usize, &[f32]),
    band_rows: usize,
) -> (Vec<u32>, Vec<Figure>) {
    let bytes = BandedWater::kept_bytes(arguments, heights.len() as u64) as usize;
    let mut store = MemoryStore { heights, columns, kept: vec![0xa5; bytes] };
    let rows = heights.len() / columns;
    let bands = LandBands::of_rows(columns, rows, band_rows);
    let stop = StopFlag::default();
    let mut water = BandedWater::of_bands(arguments, (CELL, bands), &mut store, &stop).expect("prepared");
    let (mut found, mut row) = (Vec::new(), 0);
    while row < rows {
        let (held, values) = water.band_of_row(row, &mut store).expect("a band");
        found.extend(bits(&values));
        row = held.end;
    }
    (found, water.figures())
}

/// Compares all that is shown of land in memory and in bands of so many rows.
fn compare(name: &str, (columns, heights): (usize, &[f32]), band_rows: &[usize]) {
    let land = bare((DVec2::ZERO, CELL), columns as u32, heights.to_vec());
    for (kind, show) in
        [("fill", "depth"), ("fill", "filled"), ("flow", "direction"), ("flow", "accumulation")]
    {
        let arguments = shown(kind, show);
        let whole = run(&land, &arguments, &StopFlag::default()).expect(kind);
        let wanted = bits(&whole.raster.as_ref().expect("a raster").values);
        for &rows in band_rows {
            let (found, figures) = in_bands(&arguments, (columns, heights), rows);
            let first = found.iter().zip(&wanted).position(|(found, wanted)| found != wanted);
            assert!(
                found.len() == wanted.len() && first.is_none(),
                "{name}: {show} in {rows} rows: post {first:?}"
            );
            assert_eq!(figures, whole.figures, "{name}: {show} in {rows} rows");
        }
    }
}

#[test]
fn bands_of_rough_and_level_land_have_the_bits_of_the_whole() {
    for (columns, rows) in [(2, 2), (2, 9), (3, 5), (9, 3), (40, 33), (37, 61)] {
        for (seed, steps, holes) in
            [(1, 3, false), (2, 12, true), (3, 100_000, false), (4, 5, true), (5, 1, false), (6, 1, true)]
        {
            let heights = noise(columns * rows, seed, steps, holes);
            compare(&format!("{columns} x {rows}, seed {seed}"), (columns, &heights), &[2, 3, 7, 32]);
        }
    }
}

/// Terraces with pits: flats that reach through many bands and lakes with islands.
#[test]
fn lakes_and_winding_flats_through_many_bands_have_the_bits_of_the_whole() {
    for seed in 0..12 {
        let mut next = random(seed);
        let (columns, rows) = (45, 70);
        let scale = [3.0, 6.0, 15.0, 40.0][seed as usize % 4];
        let phase = (next() % 100) as f64;
        let heights: Vec<f32> = (0..columns * rows)
            .map(|index| {
                let (x, y) = ((index % columns) as f64, (index / columns) as f64);
                let hills = libm::sin(x / scale + phase) * libm::cos(y / scale) * 3.0;
                let hole = next().is_multiple_of(211);
                let rough = f64::from(u8::from(next().is_multiple_of(9)));
                if hole { f32::NAN } else { (hills + rough).round() as f32 }
            })
            .collect();
        compare(&format!("terraces {seed}"), (columns, &heights), &[2, 5, 11]);
    }
}

#[test]
fn a_flat_that_crosses_borders_again_and_again_has_the_bits_of_the_whole() {
    // A channel that goes up and down between walls, with its outlet at one end.
    let (columns, rows) = (41, 23);
    let heights: Vec<f32> = (0..columns * rows)
        .map(|index| {
            let (x, y) = (index % columns, index / columns);
            let is_end = if x % 4 == 1 { y == rows - 2 } else { y == 1 };
            match (x, y) {
                (0, 1) => 0.0,
                (0, _) | (_, 0) => 9.0,
                _ if x == columns - 1 || y == rows - 1 => 9.0,
                _ if x % 2 == 0 || is_end => 1.0,
                _ => 5.0,
            }
        })
        .collect();
    compare("a serpentine", (columns, &heights), &[2, 4, 9]);
}

#[test]
fn one_thread_gives_the_bits_of_three_in_bands() {
    let heights = noise(120 * 90, 9, 6, true);
    let of = |threads| on_pool(threads, || in_bands(&shown("flow", "accumulation"), (120, &heights), 8));
    assert_eq!(of(1), of(3));
}

#[cfg(test)]
#[test]
fn real_elevations_in_bands_have_the_bits_of_the_whole() {
    let folder = Path::new(concat!(env!("SANDTABLE_ROOT"), "../shared/data/dem"));
    let is_required = std::env::var_os("SANDTABLE_REQUIRE_DATA").is_some();
    if !folder.exists() && !is_required {
        eprintln!("SKIPPED: no test data at {}", folder.display());
        return;
    }
    for line in include_str!("oracle.tsv").lines().skip(1) {
        let name = line.split('\t').next().expect("a name");
        let bytes = std::fs::read(folder.join(name)).expect("a file");
        let raster = read(name, &bytes, &DemHints::default()).expect("elevation");
        let south_first =
            (0..raster.height).rev().flat_map(|row| (0..raster.width).map(move |column| (column, row)));
        let heights: Vec<f32> = south_first.map(|(column, row)| raster.at(column, row) as f32).collect();
        compare(name, (raster.width as usize, &heights), &[17, 64]);
    }
}

#[test]
fn a_stopped_analysis_of_bands_ends() {
    let heights = noise(40 * 40, 3, 4, false);
    let arguments = shown("flow", "accumulation");
    let mut store = MemoryStore { heights: &heights, columns: 40, kept: vec![0; 13 * 1600] };
    let stop = StopFlag::default();
    stop.stop();
    let bands = LandBands::of_rows(40, 40, 4);
    let stopped = BandedWater::of_bands(&arguments, (CELL, bands), &mut store, &stop);
    assert!(matches!(stopped, Err(AnalysisError::Stopped)));
}
