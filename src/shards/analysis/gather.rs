//! The raster of all shards of an analysis.

use std::path::Path;

use crate::analysis::arguments::AnalysisPlan;
use crate::analysis::work::{EXTENSION, ground_posts};
use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::ShardPlan;
use crate::record::result_path;
use sandtable_analysis::outcome::PostValues;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::memory::check_memory;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemOptions;
use sandtable_files::raster_file;
use sandtable_query::analysis::posts_raster;
use sandtable_query::dem;
use sandtable_raster::raster::Raster;
use sandtable_terrain::post_rect::PostRect;

/// Writes the values of a plan whose shards are all done: the raster that `analyze` writes.
///
/// # Errors
/// A file cannot be read or written, or is not the one of the plan.
pub fn gather(
    plan: &ShardPlan,
    arguments: &AnalysisPlan,
    out: &Path,
    format: &DemFormat,
) -> Result<(), ShardError> {
    let opened = arguments.open(&plan.folder)?;
    let tile = |id: usize| ground_posts(plan, &opened, &plan.shard(id)?);
    let tiles: Vec<PostRect> = (0..plan.count()).map(tile).collect::<Result<_, ShardError>>()?;
    let all = tiles.iter().fold(tiles[0], |all, tile| all.with(tile.first).with(tile.last));
    let posts = all.width() as u64 * all.height() as u64;
    if posts > RASTER_SAMPLES.get() {
        let (columns, rows) = (all.width() as u64, all.height() as u64);
        return Err(PlanError::new(&plan.folder, PlanFault::AnalysisPosts { columns, rows }).into());
    }
    let checked = check_memory(posts * 2 * size_of::<f32>() as u64, "the raster", "plan a smaller `extent`");
    checked.map_err(|error| PlanError::new(&plan.folder, PlanFault::Output(error.to_string())))?;
    let mut values = None;
    for (id, &tile) in tiles.iter().enumerate() {
        let path = result_path(plan, id, EXTENSION);
        let raster = dem::open(&path, &DemOptions::default())?.raster;
        if (raster.width as usize, raster.height as usize) != (tile.width(), tile.height()) {
            return Err(PlanError::new(&path, PlanFault::Result).into());
        }
        let values = values.get_or_insert_with(|| without_values(&raster, posts as usize));
        put(values, all, tile, &raster);
    }
    let values = values.unwrap_or(PostValues::Codes(Vec::new()));
    let frame = opened.parts.frame();
    let raster = posts_raster(&values, opened.kind.name, (&frame.lattice, all), &frame.crs);
    raster_file::write(&raster, format, out, &[opened.queried.path])?;
    Ok(())
}

/// No data for so many posts, of the type of a tile.
fn without_values(tile: &Raster, posts: usize) -> PostValues {
    match tile.data_type {
        "Byte" => PostValues::Codes(vec![PostValues::NO_CODE; posts]),
        _ => PostValues::Numbers(vec![f32::NAN; posts]),
    }
}

/// Puts the samples of a tile, north up, in their places.
fn put(values: &mut PostValues, all: PostRect, tile: PostRect, raster: &Raster) {
    let samples = raster.samples.iter().collect::<Vec<f64>>();
    for (row, samples) in (tile.first.row..=tile.last.row).rev().zip(samples.chunks(tile.width())) {
        let start = all.index(sandtable_terrain::lattice::Post { column: tile.first.column, row });
        match values {
            PostValues::Numbers(values) => {
                let places = &mut values[start..][..tile.width()];
                places.iter_mut().zip(samples).for_each(|(place, &sample)| *place = sample as f32);
            }
            PostValues::Codes(codes) => {
                let code = |sample: f64| if sample.is_nan() { PostValues::NO_CODE } else { sample as u8 };
                let places = &mut codes[start..][..tile.width()];
                places.iter_mut().zip(samples).for_each(|(place, &sample)| *place = code(sample));
            }
        }
    }
}
