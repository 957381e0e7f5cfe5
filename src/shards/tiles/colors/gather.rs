//! The coarse levels of pictures, which are made of what several shards did.

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::ShardPlan;
use crate::record::result_path;
use crate::tiles::colors::means::tile_means;
use crate::tiles::colors::pixels::{PixelHeights, TILE_PIXELS, heights_from_bytes};
use crate::tiles::colors::pyramid::ColorPyramid;
use crate::tiles::colors::work::EXTENSION;
use crate::tiles::tiling::TileAddress;
use sandtable_files::disk;

/// Writes the tiles of the levels above all shards, which are done.
///
/// # Errors
/// A result cannot be read, or a tile cannot be written.
pub fn write_coarse_tiles(plan: &ShardPlan, pyramid: &ColorPyramid) -> Result<(), ShardError> {
    let roots = pyramid.roots();
    let leaf = |tile: TileAddress| {
        let path = result_path(plan, roots.index(tile) as usize, EXTENSION);
        let bytes = disk::read_head(&path, 4 * TILE_PIXELS as u64 + 1)?;
        let wrong = || ShardError::from(PlanError::new(&path, PlanFault::Result));
        heights_from_bytes(&bytes).ok_or_else(wrong).map(PixelHeights::new)
    };
    let write = |tile: TileAddress, heights: &PixelHeights| {
        if tile.level < roots.level && tile.level <= pyramid.max_zoom {
            let path = plan.folder.join(pyramid.path(tile));
            path.parent().map_or(Ok(()), disk::make_folder)?;
            disk::write(&path, &heights.png(pyramid.encoding))?;
        }
        Ok::<Option<()>, ShardError>(None)
    };
    let globe = TileAddress { level: 0, x: 0, y: 0 };
    if roots.level > 0 {
        tile_means(pyramid, globe, roots.level, &leaf, &write)?;
    }
    Ok(())
}
