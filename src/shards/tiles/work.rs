//! One shard of tiles.

use crate::error::ShardError;
use crate::plan::ShardPlan;
use crate::planned_dataset::QueriedDataset;
use crate::record::ShardFile;
use crate::shard::Shard;
use crate::tiles::arguments::{TilePyramid, TilesArguments};
use crate::tiles::{colors, meshes};

/// The files of a shard.
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
    match arguments.pyramid() {
        TilePyramid::Meshes(meshes) => {
            let root = |tile| meshes::groups::root(tile, arguments).ok_or_else(wrong);
            let root = shard.tile.map(root).transpose()?;
            meshes::work::tile_files(root, (arguments, meshes), queried)
        }
        TilePyramid::Colors(pyramid) => {
            let roots = pyramid.roots();
            let root = shard.tile.and_then(|tile| roots.tile(tile));
            let root = root.filter(|&root| roots.index(root) == shard.id as u64).ok_or_else(wrong)?;
            colors::work::tile_files(shard.id, root, (arguments, &pyramid), queried)
        }
    }
}
