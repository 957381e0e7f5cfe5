//! Cuts a pyramid of pictures into shards.

use crate::shard::Shard;
use crate::tiles::colors::pyramid::ColorPyramid;
use crate::tiles::plan::tile_shard;
use crate::tiles::tiling::TileScheme;

/// The shards of a plan: one for each root.
pub fn shards(pyramid: &ColorPyramid) -> Vec<Shard> {
    let shard = |(id, root)| {
        let tiles = pyramid.sampled_below(root).count();
        tile_shard(id, TileScheme::WebMercator, root, root.path("png"), tiles)
    };
    (0..).zip(pyramid.roots().tiles()).map(shard).collect()
}
