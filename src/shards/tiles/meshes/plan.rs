//! Cuts a pyramid of meshes into shards.

use crate::error::ShardError;
use crate::planned_dataset::QueriedDataset;
use crate::shard::{Shard, ShardWindow};
use crate::tiles::arguments::{MeshTileArguments, TilesArguments};
use crate::tiles::degree_bounds::described_bounds;
use crate::tiles::meshes::groups::{group_starts, meeting, shard_roots, tiles_of, top_levels};
use crate::tiles::meshes::posts::CELLS;
use crate::tiles::plan::tile_shard;
use crate::tiles::tiling::{TileAddress, TileScheme};
use sandtable_raster::height_datum::HeightDatum;

/// Meters between the ellipsoid and the geoid, at most: it lies 107 m below it south of India.
const MOST_UNDULATION_M: f64 = 110.0;

/// The level whose posts are no farther apart than `cell_deg` degrees.
pub fn natural_zoom(cell_deg: f64) -> u32 {
    TileScheme::Geographic.level_of(CELLS, cell_deg)
}

/// The mesh arguments of an opened dataset.
///
/// # Errors
/// The elevation cannot be read.
pub fn mesh_arguments(queried: &QueriedDataset) -> Result<MeshTileArguments, ShardError> {
    let header = queried.dataset.header();
    let datum = header.vertical_datum.as_deref().and_then(HeightDatum::from_name);
    let from_geoid = datum == Some(HeightDatum::Egm96);
    let (low, high) = queried.dataset.height_range()?;
    // Where there is no elevation, tiles lie on the ellipsoid.
    let beyond = if from_geoid { MOST_UNDULATION_M } else { 0.0 };
    let height_range =
        [(low.min(0.0) - beyond).floor() as f32, (high.max(0.0) + beyond).ceil().max(1.0) as f32];
    Ok(MeshTileArguments { height_range, from_geoid })
}

/// The number of roots of shards on the finest level that has some.
pub fn finest_roots(arguments: &TilesArguments) -> u64 {
    meeting(group_starts(arguments.max_zoom)[0], arguments.bounds).count()
}

/// The shards of a plan.
pub fn shards(arguments: &TilesArguments) -> Vec<Shard> {
    let roots = shard_roots(arguments.max_zoom, arguments.bounds);
    roots.into_iter().enumerate().map(|(id, root)| shard(id, root, arguments)).collect()
}

fn shard(id: usize, root: Option<TileAddress>, arguments: &TilesArguments) -> Shard {
    let tiles = tiles_of(root, arguments.max_zoom, arguments.bounds).len() as u64;
    match root {
        Some(root) => tile_shard(id, TileScheme::Geographic, root, root.path("terrain"), tiles),
        None => {
            let name = format!("levels 0 to {}", top_levels(arguments.max_zoom) - 1);
            Shard::new(id, name, tiles as f64, ShardWindow::Map(described_bounds(arguments.bounds)))
        }
    }
}
