//! Cuts a pyramid into shards.

use std::path::Path;

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::{self, PlannedProduct};
use crate::planned_dataset::{PlannedDataset, QueriedDataset};
use crate::shard::{Shard, ShardWindow};
use crate::tiles::arguments::{ColorTileArguments, TileContent, TilePyramid, TilesArguments};
use crate::tiles::degree_bounds::degree_bounds;
use crate::tiles::encoding::TileEncoding;
use crate::tiles::tiling::{TileAddress, TileScheme};
use crate::tiles::{colors, meshes};
use sandtable_base::limits::PLAN_SHARDS;
use sandtable_dem::formats::height_encoding::HeightEncoding;
use sandtable_geom::crs::DEGREE_M;
use sandtable_geom::rect::Rect;

/// The request for a pyramid of tiles.
#[derive(Clone, Copy, Debug)]
pub struct TilesRequest {
    /// How they state heights.
    pub encoding: TileEncoding,
    /// The finest level; as fine as the samples where `None`.
    pub max_zoom: Option<u32>,
}

/// Plans a pyramid of tiles of `dataset`, opened with positions in longitude and latitude; writes the plan to `folder`, which
/// is there, and returns the number of its shards.
///
/// # Errors
/// The elevation has no place in the tiles or cannot be read, there are too many shards, or a file cannot be written.
pub fn plan(
    dataset: PlannedDataset,
    queried: &QueriedDataset,
    TilesRequest { encoding, max_zoom }: TilesRequest,
    folder: &Path,
) -> Result<usize, ShardError> {
    let refused = |fault| PlanError::new(&queried.path, fault);
    let header = queried.dataset.header();
    let crs = header.crs.clone().ok_or_else(|| refused(PlanFault::NoPlace))?;
    let bounds =
        degree_bounds(&crs, &header.extent(), &queried.crs).ok_or_else(|| refused(PlanFault::NoPlace))?;
    let cell = header.spacing().min_element();
    let arguments = match encoding {
        TileEncoding::QuantizedMesh => {
            let cell_deg = if crs.is_geographic() { cell } else { cell * crs.meters_per_unit() / DEGREE_M };
            let max_zoom = max_zoom.unwrap_or_else(|| meshes::plan::natural_zoom(cell_deg));
            let content = TileContent::QuantizedMesh(meshes::plan::mesh_arguments(queried)?);
            TilesArguments { dataset, max_zoom, bounds, content }
        }
        TileEncoding::Colors(encoding) => {
            let bounds = colors::pyramid::within_mercator(bounds)
                .ok_or_else(|| refused(PlanFault::BeyondMercator { south: bounds[1], north: bounds[3] }))?;
            // Pixels are largest where the ground is nearest to the equator.
            let [_, south, _, north] = bounds;
            let latitude = if south <= 0.0 && north >= 0.0 { 0.0 } else { south.abs().min(north.abs()) };
            let degree_m = DEGREE_M * libm::cos(latitude.to_radians());
            let cell_deg = if crs.is_geographic() { cell } else { cell * crs.meters_per_unit() / degree_m };
            let natural = colors::pyramid::natural_zoom(cell_deg);
            let max_zoom = max_zoom.unwrap_or(natural);
            let colors = ColorTileArguments { sampled_zoom: natural.max(max_zoom) };
            let content = match encoding {
                HeightEncoding::TerrainRgb => TileContent::TerrainRgb(colors),
                HeightEncoding::Terrarium => TileContent::Terrarium(colors),
            };
            TilesArguments { dataset, max_zoom, bounds, content }
        }
    };
    let roots = match arguments.pyramid() {
        // No level has more than the finest of those with roots.
        TilePyramid::Meshes(_) => meshes::plan::finest_roots(&arguments).saturating_mul(2),
        TilePyramid::Colors(pyramid) => pyramid.roots().count(),
    };
    if roots > PLAN_SHARDS.get() {
        return Err(refused(PlanFault::TooManyShards(roots)).into());
    }
    let shards = match arguments.pyramid() {
        TilePyramid::Meshes(_) => meshes::plan::shards(&arguments),
        TilePyramid::Colors(pyramid) => colors::plan::shards(&pyramid),
    };
    let inputs = arguments.dataset.inputs(&queried.dataset, folder)?;
    plan::write(folder, PlannedProduct::Tiles(arguments), inputs, &shards)?;
    Ok(shards.len())
}

/// The shard of a tile and so many below it.
pub fn tile_shard(id: usize, scheme: TileScheme, root: TileAddress, name: String, tiles: u64) -> Shard {
    let Rect { min, max } = scheme.extent(root);
    let window = ShardWindow::Map([min.x, min.y, max.x, max.y]);
    let tile = Some([u64::from(root.level), root.x, root.y]);
    Shard { tile, ..Shard::new(id, name, tiles as f64, window) }
}
