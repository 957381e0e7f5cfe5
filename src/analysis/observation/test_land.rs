//! Lands for the tests of the family: squares of posts 10 m apart.

use std::sync::Arc;

use glam::DVec2;

use crate::arguments::{AnalysisArguments, ArgumentValue};
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::Outcome;
use crate::run::run;
use sandtable_geom::crs::Crs;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The south-west post.
pub(crate) const ORIGIN: DVec2 = DVec2::new(500_000.0, 4_000_000.0);

/// A land of `side` × `side` posts with these heights by column and row.
pub(crate) fn land(side: u32, height: impl Fn(u32, u32) -> f32) -> Land {
    let heights = (0..side * side).map(|index| height(index % side, index / side)).collect();
    let lattice = Lattice::new(ORIGIN, DVec2::splat(10.0), side, heights).expect("sound");
    Land::bare(Arc::new(lattice), Crs::local())
}

/// Hills of some 12 m with a hole around column 10, row 17.
pub(crate) fn ripples(column: u32, row: u32) -> f32 {
    let (x, y) = (f64::from(column), f64::from(row));
    if column.abs_diff(10) < 2 && row.abs_diff(17) < 2 {
        return f32::NAN;
    }
    (6.0 * libm::sin(x * 0.9) * libm::cos(y * 0.7) + 6.0 * libm::sin(x * 0.31 + y * 0.43)) as f32
}

/// Map coordinates of a column and row, whole or not.
pub(crate) fn at(column: f64, row: f64) -> DVec2 {
    ORIGIN + DVec2::new(column, row) * 10.0
}

/// The outcome of a kind with these arguments.
pub(crate) fn run_kind(
    name: &str,
    land: &Land,
    arguments: Vec<(&'static str, ArgumentValue)>,
) -> Result<Outcome, AnalysisError> {
    let kind = sandtable_catalog::kind(name).expect("a kind");
    let with = |arguments: AnalysisArguments, (name, value)| arguments.with(name, value);
    let arguments = arguments.into_iter().fold(AnalysisArguments::new(kind), with);
    run(land, &arguments, &StopFlag::default())
}

/// What `task` gives on so many threads.
pub(crate) fn on_pool<T: Send>(threads: usize, task: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(task)
}
