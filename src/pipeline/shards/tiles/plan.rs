//! Cuts a pyramid into shards.

use std::path::Path;

use glam::DVec2;

use crate::dem::height_datum::HeightDatum;
use crate::geom::crs::Crs;
use crate::geom::rect::Rect;
use crate::limits::PLAN_SHARDS;
use crate::pipeline::shards::error::{PlanError, PlanFault, ShardError};
use crate::pipeline::shards::plan::{self, PlannedProduct};
use crate::pipeline::shards::planned_dataset::{PlannedDataset, QueriedDataset};
use crate::pipeline::shards::shard::{Shard, ShardWindow};
use crate::pipeline::shards::tiles::arguments::TilesArguments;
use crate::pipeline::shards::tiles::tiling::{
    MOST_LEVEL, SHARD_LEVELS, TileAddress, TileRange, group_starts, pyramid, top,
};

/// Points along each side of the elevation that are brought to longitude and latitude for its bounds.
const SIDE_POINTS: u32 = 64;
/// Meters between the ellipsoid and the geoid, at most: it lies 107 m below it south of India.
const MOST_UNDULATION_M: f64 = 110.0;
/// Meters of a degree along a meridian, about.
const DEGREE_M: f64 = 111_320.0;

/// Plans a pyramid of tiles of `dataset`, opened with positions in longitude and latitude, to the level `max_zoom` or as fine
/// as its samples; writes the plan to `folder`, which is there, and returns the number of its shards.
///
/// # Errors
/// The elevation has no place on the globe or cannot be read, there are too many shards, or a file cannot be written.
pub fn plan(
    dataset: PlannedDataset,
    queried: &QueriedDataset,
    max_zoom: Option<u32>,
    folder: &Path,
) -> Result<usize, ShardError> {
    let no_place = || PlanError::new(&queried.path, PlanFault::NoPlace);
    let header = queried.dataset.header();
    let crs = header.crs.clone().ok_or_else(no_place)?;
    let bounds = bounds(&crs, &header.extent(), &queried.crs).ok_or_else(no_place)?;
    let cell = header.spacing().min_element();
    let cell_deg = if crs.is_geographic() { cell } else { cell * crs.meters_per_unit() / DEGREE_M };
    let max_zoom = max_zoom.unwrap_or_else(|| level_of(cell_deg));
    let datum = header.vertical_datum.as_deref().and_then(HeightDatum::from_name);
    let from_geoid = datum == Some(HeightDatum::Egm96);
    let (low, high) = queried.dataset.height_range()?;
    // Where there is no elevation, tiles lie on the ellipsoid.
    let beyond = if from_geoid { MOST_UNDULATION_M } else { 0.0 };
    let height_range =
        [(low.min(0.0) - beyond).floor() as f32, (high.max(0.0) + beyond).ceil().max(1.0) as f32];
    let arguments = TilesArguments { dataset, max_zoom, bounds, height_range, from_geoid };
    // No level has more than the finest of those with roots.
    let roots = TileRange::meeting(group_starts(max_zoom)[0], bounds).count();
    if roots.saturating_mul(2) > PLAN_SHARDS.get() {
        return Err(PlanError::new(&queried.path, PlanFault::TooManyShards(roots)).into());
    }
    let shards: Vec<Shard> =
        (0..).zip(shard_roots(&arguments)).map(|(id, root)| shard(id, root, &arguments)).collect();
    let inputs = arguments.dataset.inputs(&queried.dataset, folder)?;
    plan::write(folder, PlannedProduct::Tiles(arguments), inputs, &shards)?;
    Ok(shards.len())
}

/// The roots of the shards of a plan, in their order; `None` is the top.
pub fn shard_roots(arguments: &TilesArguments) -> Vec<Option<TileAddress>> {
    let starts = group_starts(arguments.max_zoom);
    let top = starts.last().filter(|&&start| start > 0).map(|_| None);
    let roots = |&start: &u32| TileRange::meeting(start, arguments.bounds).tiles().map(Some);
    top.into_iter().chain(starts.iter().rev().flat_map(roots)).collect()
}

/// The tiles of a shard.
pub fn tiles_of(root: Option<TileAddress>, arguments: &TilesArguments) -> Vec<TileAddress> {
    match root {
        None => top(top_levels(arguments), arguments.bounds),
        Some(root) => {
            let last = (root.level + SHARD_LEVELS - 1).min(arguments.max_zoom);
            pyramid(root, last, arguments.bounds)
        }
    }
}

/// The number of levels of the top.
fn top_levels(arguments: &TilesArguments) -> u32 {
    group_starts(arguments.max_zoom).last().copied().unwrap_or_default()
}

fn shard(id: usize, root: Option<TileAddress>, arguments: &TilesArguments) -> Shard {
    let tiles = tiles_of(root, arguments).len();
    let (name, [west, south, east, north]) = match root {
        None => (format!("levels 0 to {}", top_levels(arguments) - 1), arguments.bounds),
        Some(root) => {
            let (min, max) = root.corners();
            (root.path(), [min.x, min.y, max.x, max.y])
        }
    };
    let window = ShardWindow::Map([west, south, east, north]);
    let root = root.map(|TileAddress { level, x, y }| [u64::from(level), x, y]);
    Shard { tile: root, ..Shard::new(id, name, tiles as f64, window) }
}

/// The level whose posts are no farther apart than `cell_deg` degrees.
fn level_of(cell_deg: f64) -> u32 {
    let spacing = |level: u32| {
        let tile = TileAddress { level, x: 0, y: 0 };
        tile.post(1, 0).x - tile.post(0, 0).x
    };
    // A share of a cell is no reason for four times as many tiles.
    (0..MOST_LEVEL).find(|&level| spacing(level) <= cell_deg * 1.05).unwrap_or(MOST_LEVEL)
}

/// West, south, east and north of a rectangle in `crs` in degrees; `None` where it has no place.
fn bounds(crs: &Crs, rect: &Rect, degrees: &Crs) -> Option<[f64; 4]> {
    let share = |step: u32| f64::from(step) / f64::from(SIDE_POINTS);
    let sides = (0..=SIDE_POINTS).flat_map(|step| {
        let at = share(step);
        [DVec2::new(at, 0.0), DVec2::new(at, 1.0), DVec2::new(0.0, at), DVec2::new(1.0, at)]
    });
    let placed = sides.map(|at| crs.transform(degrees, rect.min + at * rect.size()).ok());
    let Rect { min, max } = Rect::around(placed.collect::<Option<Vec<DVec2>>>()?);
    // What crosses the meridian of 180 degrees lies at both ends of the map.
    let (west, east) = if min.x < -180.0 || max.x > 180.0 { (-180.0, 180.0) } else { (min.x, max.x) };
    let (south, north) = (min.y.max(-90.0), max.y.min(90.0));
    (west < east && south < north).then_some([west, south, east, north])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_level_has_posts_as_close_as_the_samples() {
        assert_eq!(level_of(180.0 / 64.0), 0);
        // Three and one arc second.
        assert_eq!([level_of(3.0 / 3600.0), level_of(1.0 / 3600.0)], [12, 14]);
        assert_eq!(level_of(1e-12), MOST_LEVEL);
    }
}
