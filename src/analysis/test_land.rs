//! Small lands for tests, and what kinds give on them.

use std::sync::Arc;

use glam::DVec2;

use crate::arguments::{AnalysisArguments, ArgumentValue};
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Outcome, OutcomeRaster};
use crate::run::run;
use sandtable_geom::crs::Crs;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::stop_flag::StopFlag;

/// Bare land with these heights, row by row from the south-west post at `origin`; it may hold no data at all.
pub(crate) fn bare((origin, cell): (DVec2, DVec2), columns: u32, heights: Vec<f32>) -> Land {
    let ground = Lattice::part((origin, cell), Post { column: 0, row: 0 }, columns, heights).expect("sound");
    Land::bare(Arc::new(ground), Crs::local())
}

/// Level ground of so many posts, `cell_m` apart, its south-west post at the origin.
pub(crate) fn flat(columns: u32, rows: u32, cell_m: f64) -> Land {
    shaped(columns, rows, cell_m, |_, _| 0.0)
}

/// Ground of a form given by column and row.
pub(crate) fn shaped(columns: u32, rows: u32, cell_m: f64, height: impl Fn(u32, u32) -> f32) -> Land {
    let heights = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let heights = heights.map(|(column, row)| height(column, row)).collect();
    bare((DVec2::ZERO, DVec2::splat(cell_m)), columns, heights)
}

/// The outcome of a kind with these arguments.
pub(crate) fn run_kind<'a>(
    name: &str,
    land: &Land,
    arguments: impl IntoIterator<Item = (&'a str, ArgumentValue)>,
) -> Result<Outcome, AnalysisError> {
    let kind = sandtable_catalog::kind(name).expect("a kind");
    let with = |arguments: AnalysisArguments, (name, value)| arguments.with(name, value);
    let arguments = arguments.into_iter().fold(AnalysisArguments::new(kind), with);
    run(land, &arguments, &StopFlag::default())
}

/// The values of a raster.
pub(crate) fn values_of(raster: &OutcomeRaster) -> Vec<f32> {
    (0..raster.values.len()).map(|index| raster.values.value(index)).collect()
}

/// What `task` gives on so many threads.
pub(crate) fn on_pool<T: Send>(threads: usize, task: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(task)
}

/// Heights from 0 to below `steps` without any form, the same for the same seed; where `is_holed`, one in 29 is missing.
pub(crate) fn noise(count: usize, mut seed: u32, steps: u32, is_holed: bool) -> Vec<f32> {
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        seed >> 8
    };
    (0..count)
        .map(|_| if is_holed && next() % 29 == 0 { f32::NAN } else { (next() % steps) as f32 })
        .collect()
}
