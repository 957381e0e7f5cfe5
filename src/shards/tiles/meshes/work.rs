//! The tiles of a shard of meshes.

use glam::DVec2;
use rayon::prelude::*;

use crate::error::ShardError;
use crate::planned_dataset::QueriedDataset;
use crate::record::ShardFile;
use crate::tiles::arguments::{MeshTileArguments, TilesArguments};
use crate::tiles::meshes::groups::tiles_of;
use crate::tiles::meshes::posts::{POSTS, posts};
use crate::tiles::meshes::quantized_mesh::tile_bytes;
use crate::tiles::tiling::TileAddress;
use sandtable_files::error::FileError;
use sandtable_geom::geoid::Geoid;
use sandtable_query::heights_above::bring_heights;
use sandtable_raster::answer::Answer;
use sandtable_raster::height_datum::HeightDatum;

/// Tiles whose posts are asked about together.
const TILES_AT_ONCE: usize = 64;

/// The tiles of the shard with a root, or of the top.
///
/// # Errors
/// The elevation cannot be read.
pub fn tile_files(
    root: Option<TileAddress>,
    (arguments, meshes): (&TilesArguments, &MeshTileArguments),
    queried: &QueriedDataset,
) -> Result<Vec<ShardFile>, ShardError> {
    let mut files = Vec::new();
    for tiles in tiles_of(root, arguments.max_zoom, arguments.bounds).chunks(TILES_AT_ONCE) {
        let at: Vec<DVec2> = tiles.iter().flat_map(|&tile| posts(tile)).collect();
        let mut answers = arguments.answers(queried, &at)?;
        if meshes.from_geoid {
            bring_to_ellipsoid(&mut answers, queried, &at)?;
        }
        let heights: Vec<f64> = answers.into_iter().map(height_m).collect();
        let each = at.len() / tiles.len();
        let file = |(tile, heights): (&TileAddress, &[f64])| ShardFile {
            path: format!("tiles/{}", tile.path("terrain")),
            bytes: tile_bytes(*tile, heights, meshes.height_range),
        };
        files.par_extend(tiles.par_iter().zip(heights.par_chunks(each)).map(file));
    }
    Ok(files)
}

/// Brings heights above the geoid to the ellipsoid. There are as many as rows of posts have, so that the geoid is asked about a
/// row at a time.
fn bring_to_ellipsoid(
    answers: &mut [Answer],
    QueriedDataset { path, dataset, crs }: &QueriedDataset,
    at: &[DVec2],
) -> Result<(), ShardError> {
    let header = dataset.header();
    let datums = (header.vertical_datum.as_deref(), HeightDatum::Ellipsoid);
    let geoid = Geoid::default();
    for (answers, at) in answers.chunks_mut(POSTS).zip(at.chunks(POSTS)) {
        bring_heights(answers, datums, (crs, at), &geoid).map_err(FileError::at(path))?;
    }
    Ok(())
}

/// The height of a post; one without is on the ellipsoid, so that the globe is whole.
fn height_m(answer: Answer) -> f64 {
    answer.height_m().unwrap_or(0.0)
}
