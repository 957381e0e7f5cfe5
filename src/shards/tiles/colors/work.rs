//! The pictures of a shard.

use std::collections::BTreeMap;

use crate::error::ShardError;
use crate::planned_dataset::QueriedDataset;
use crate::record::ShardFile;
use crate::tiles::arguments::TilesArguments;
use crate::tiles::colors::means::tile_means;
use crate::tiles::colors::pixels::{PixelHeights, heights_to_bytes, pixel_centers};
use crate::tiles::colors::pyramid::ColorPyramid;
use crate::tiles::tiling::TileAddress;
use sandtable_raster::answer::Answer;

/// The extension of a shard's heights of its root.
pub const EXTENSION: &str = "means";

/// The pictures of the shard with a root, and the heights of that.
///
/// # Errors
/// The elevation cannot be read.
pub fn tile_files(
    id: usize,
    root: TileAddress,
    (arguments, pyramid): (&TilesArguments, &ColorPyramid),
    queried: &QueriedDataset,
) -> Result<Vec<ShardFile>, ShardError> {
    // One tile after the other: a query uses all threads, and what is read from disk is read once.
    let mut sampled = BTreeMap::new();
    for tile in pyramid.sampled_below(root).tiles() {
        let answers = arguments.answers(queried, &pixel_centers(tile))?;
        let heights = answers.into_iter().map(height_m).collect();
        sampled.insert(tile, PixelHeights::new(heights));
    }
    let leaf = |tile: TileAddress| Ok::<_, ShardError>(sampled.get(&tile).cloned().flatten());
    let file = |tile: TileAddress, heights: &PixelHeights| {
        let file = || ShardFile { path: pyramid.path(tile), bytes: heights.png(pyramid.encoding) };
        Ok((tile.level <= pyramid.max_zoom).then(file))
    };
    let root = tile_means(pyramid, root, pyramid.sampled_zoom, &leaf, &file)?;
    let mut files = ShardFile::only(id, EXTENSION, heights_to_bytes(root.heights.as_ref()));
    files.extend(root.made);
    Ok(files)
}

/// The height of a pixel; NaN without elevation.
fn height_m(answer: Answer) -> f32 {
    answer.height_m().map_or(f32::NAN, |height| height as f32)
}
