//! Small lands for tests, and what kinds give on them.

use std::sync::Arc;

use glam::DVec2;

use crate::arguments::{AnalysisArguments, ArgumentValue};
use crate::error::AnalysisError;
use crate::land::{Land, LandCover, WaterKind, WaterPost};
use crate::outcome::{Outcome, OutcomeRaster, PostValues};
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

/// Gives each post a cover, by its column and row.
pub(crate) fn paint(land: &mut Land, cover: impl Fn(u32, u32) -> LandCover) {
    land.cover = Some(land.ground.posts().map(|post| cover(post.column, post.row)).collect());
}

/// Makes swamp of posts by column and row, and open ground of the others.
pub(crate) fn swamp(land: &mut Land, is_swamp: impl Fn(u32, u32) -> bool) {
    paint(land, |column, row| if is_swamp(column, row) { LandCover::Wetland } else { LandCover::Open });
}

/// Makes a column of posts a river of this depth, and all others dry.
pub(crate) fn flood(land: &mut Land, column: u32, depth_m: f32) {
    let water = |post: Post| match post.column == column {
        true => WaterPost { kind: WaterKind::River, depth_m },
        false => WaterPost::default(),
    };
    land.water = Some(land.ground.posts().map(water).collect());
}

/// Plants a tree of up to 12 m at some 1 % of the posts, the same for the same seed.
pub(crate) fn plant(land: &mut Land, seed: u64) {
    let mut bits = random(seed);
    let mut share = || bits() as f32 / (1_u64 << 31) as f32;
    let mut tree = |_| if share() < 0.01 { share() * 12.0 } else { 0.0 };
    land.obstacles_m = Some((0..land.ground.heights().len()).map(&mut tree).collect());
}

/// Random numbers of 31 bits, the same for the same seed.
pub(crate) fn random(mut state: u64) -> impl FnMut() -> u64 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 33
    }
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

/// The codes of a raster.
pub(crate) fn codes_of(outcome: Outcome) -> Vec<u8> {
    match outcome.raster.expect("a raster").values {
        PostValues::Codes(codes) => codes,
        PostValues::Numbers(_) => panic!("codes"),
    }
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
