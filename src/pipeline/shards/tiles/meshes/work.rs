//! One shard of tiles.

use rayon::prelude::*;

use crate::dem::answer::Answer;
use crate::pipeline::shards::error::ShardError;
use crate::pipeline::shards::plan::ShardPlan;
use crate::pipeline::shards::planned_dataset::QueriedDataset;
use crate::pipeline::shards::record::ShardFile;
use crate::pipeline::shards::shard::Shard;
use crate::pipeline::shards::tiles::arguments::TilesArguments;
use crate::pipeline::shards::tiles::plan::tiles_of;
use crate::pipeline::shards::tiles::quantized_mesh::tile_bytes;
use crate::pipeline::shards::tiles::tiling::{TileAddress, TileRange, group_starts};

/// Tiles whose posts are asked about together.
const TILES_AT_ONCE: usize = 64;

/// The tiles of a shard.
///
/// # Errors
/// The shard is not one of the plan, or the elevation cannot be read.
pub fn result(
    plan: &ShardPlan,
    arguments: &TilesArguments,
    queried: &QueriedDataset,
    shard: &Shard,
) -> Result<Vec<ShardFile>, ShardError> {
    let wrong = || plan.wrong_shard(shard.id, "its `tile` is not one of the plan");
    let root = shard.tile.map(|tile| root_of(arguments, tile).ok_or_else(wrong)).transpose()?;
    let mut files = Vec::new();
    for tiles in tiles_of(root, arguments).chunks(TILES_AT_ONCE) {
        let posts: Vec<_> = tiles.iter().flat_map(|tile| tile.posts()).collect();
        let heights: Vec<f64> =
            arguments.answers(queried, &posts)?.iter().map(|answer| height_m(*answer)).collect();
        let each = posts.len() / tiles.len();
        let file = |(tile, heights): (&TileAddress, &[f64])| ShardFile {
            path: format!("tiles/{}", tile.path()),
            bytes: tile_bytes(*tile, heights, arguments.height_range),
        };
        files.par_extend(tiles.par_iter().zip(heights.par_chunks(each)).map(file));
    }
    Ok(files)
}

/// The tile with an address, where it is the root of a shard.
fn root_of(arguments: &TilesArguments, [level, x, y]: [u64; 3]) -> Option<TileAddress> {
    let level = u32::try_from(level).ok()?;
    let is_root = group_starts(arguments.max_zoom).contains(&level)
        && TileRange::meeting(level, arguments.bounds).contains(x, y);
    is_root.then_some(TileAddress { level, x, y })
}

/// The height of a post; one without is on the ellipsoid, so that the globe is whole.
fn height_m(answer: Answer) -> f64 {
    answer.height_m().unwrap_or(0.0)
}
