//! The tiles of shards of meshes.
//!
//! ```text
//! levels 0 to 2   the top: one shard
//! levels 3 to 7   a shard for each tile of level 3, with those below it
//! levels 8 to 12  a shard for each tile of level 8, with those below it
//! ```

use crate::tiles::arguments::TilesArguments;
use crate::tiles::tiling::{TileAddress, TileRange, TileScheme};

/// Levels of a shard: 341 tiles and 1.4 million posts, some seconds' work.
const GROUP_LEVELS: u32 = 5;

/// The levels of the roots of shards, from the finest: each has as many levels as a shard below it. Those above the last, fewer
/// than of a shard, are the top.
pub fn group_starts(max_zoom: u32) -> Vec<u32> {
    let finest = max_zoom.saturating_sub(GROUP_LEVELS - 1);
    (0..=finest).rev().step_by(GROUP_LEVELS as usize).collect()
}

/// The number of levels of the top.
pub fn top_levels(max_zoom: u32) -> u32 {
    group_starts(max_zoom).last().copied().unwrap_or_default()
}

/// The roots of the shards, in their order; `None` is the top.
pub fn shard_roots(max_zoom: u32, bounds: [f64; 4]) -> Vec<Option<TileAddress>> {
    let top = (top_levels(max_zoom) > 0).then_some(None);
    let roots = |start: u32| meeting(start, bounds).tiles().map(Some);
    top.into_iter().chain(group_starts(max_zoom).into_iter().rev().flat_map(roots)).collect()
}

/// The tiles of a shard.
pub fn tiles_of(root: Option<TileAddress>, max_zoom: u32, bounds: [f64; 4]) -> Vec<TileAddress> {
    match root {
        None => (0..top_levels(max_zoom)).flat_map(|level| meeting(level, bounds).tiles()).collect(),
        Some(root) => {
            let last = (root.level + GROUP_LEVELS - 1).min(max_zoom);
            let within = |level: u32| meeting(level, bounds).intersection(&root.below(level));
            (root.level..=last).flat_map(|level| within(level).tiles()).collect()
        }
    }
}

/// The tile with an address, where it is the root of a shard.
pub fn root(tile: [u64; 3], arguments: &TilesArguments) -> Option<TileAddress> {
    let level = u32::try_from(tile[0]).ok()?;
    let is_start = group_starts(arguments.max_zoom).contains(&level);
    is_start.then(|| meeting(level, arguments.bounds).tile(tile)).flatten()
}

/// The tiles of a level that meet bounds in degrees.
pub fn meeting(level: u32, bounds: [f64; 4]) -> TileRange {
    TileScheme::Geographic.tiles_meeting(level, bounds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_that_meets_the_bounds_is_in_one_shard() {
        let bounds = [7.1, 46.2, 9.9, 47.7];
        let max_zoom = 12;
        assert_eq!(group_starts(max_zoom), [8, 3]);
        let mut tiles = Vec::new();
        for root in shard_roots(max_zoom, bounds) {
            let shard = tiles_of(root, max_zoom, bounds);
            assert!((1..=341).contains(&shard.len()));
            tiles.extend(shard);
        }
        let count: u64 = (0..=max_zoom).map(|level| meeting(level, bounds).count()).sum();
        assert_eq!(tiles.len() as u64, count);
        tiles.sort();
        tiles.dedup();
        assert_eq!(tiles.len() as u64, count);
    }
}
