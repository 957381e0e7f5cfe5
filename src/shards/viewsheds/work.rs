//! One shard of viewsheds.

use glam::DVec2;

use crate::error::ShardError;
use crate::plan::ShardPlan;
use crate::planned_dataset::QueriedDataset;
use crate::raster_result;
use crate::shard::{Shard, ShardWindow};
use crate::viewsheds::arguments::ViewshedsArguments;
use crate::viewsheds::counts::SightCounts;
use crate::viewsheds::plan::frame;
use sandtable_base::limits::{PLAN_OBSERVERS, RASTER_SAMPLES};
use sandtable_query::dataset::QueryError;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::viewshed::viewshed;

/// The counts of a shard's observers, as the bytes of a GeoTIFF.
///
/// # Errors
/// The shard is not one of the plan, or its ground cannot be read.
pub fn result(
    plan: &ShardPlan,
    arguments: &ViewshedsArguments,
    queried: &QueriedDataset,
    shard: &Shard,
) -> Result<Vec<u8>, ShardError> {
    let observers: Vec<DVec2> = observers(plan, shard)?;
    let posts = posts(plan, shard)?;
    let frame = frame(queried, observers[0])?;
    let (columns, rows) = (frame.lattice.columns(), frame.lattice.rows());
    if posts.last.column >= columns || posts.last.row >= rows {
        return Err(plan.wrong_shard(shard.id, "its `window` reaches beyond the ground"));
    }
    let mut counts = SightCounts::new(posts);
    for at in observers {
        let ground = arguments.ground(queried, at)?;
        let options = arguments.options(queried, &ground, at)?;
        let seen = viewshed(&ground.lattice, &options).map_err(|answer| QueryError::NoGround {
            what: "the observer at".into(),
            at,
            answer,
        })?;
        counts.add_viewshed(&ground.lattice, &seen);
    }
    raster_result::bytes(plan, shard, &counts.raster(&frame.lattice, &frame.crs))
}

/// The observers of a shard, at least one.
pub fn observers(plan: &ShardPlan, shard: &Shard) -> Result<Vec<DVec2>, ShardError> {
    let found = shard.observers.as_deref().unwrap_or_default();
    if found.is_empty() || found.len() as u64 > PLAN_OBSERVERS.get() {
        return Err(plan.wrong_shard(shard.id, "it has no `observers`, or too many"));
    }
    Ok(found.iter().copied().map(DVec2::from).collect())
}

/// The posts of a shard, counted in the whole ground.
pub fn posts(plan: &ShardPlan, shard: &Shard) -> Result<PostRect, ShardError> {
    let wrong = || plan.wrong_shard(shard.id, "its `window` is not one of posts, or too large");
    let ShardWindow::Grid([column, row, width, height]) = shard.window else { return Err(wrong()) };
    let last = |first: u32, count: u32| first.checked_add(count.checked_sub(1)?);
    let (Some(right), Some(top)) = (last(column, width), last(row, height)) else { return Err(wrong()) };
    if u64::from(width) * u64::from(height) > RASTER_SAMPLES.get() {
        return Err(wrong());
    }
    Ok(PostRect { first: Post { column, row }, last: Post { column: right, row: top } })
}
