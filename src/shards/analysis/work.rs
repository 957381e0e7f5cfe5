//! One shard of an analysis.

use crate::analysis::arguments::OpenedAnalysis;
use crate::error::ShardError;
use crate::plan::ShardPlan;
use crate::raster_result;
use crate::shard::Shard;
use crate::viewsheds::work::posts;
use sandtable_query::analysis::Analyzed;
use sandtable_query::analysis_bands::OutcomeWindows;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// The values of a shard's posts, as the bytes of a GeoTIFF.
///
/// # Errors
/// The shard is wrong, or the elevation cannot be read.
pub fn result(plan: &ShardPlan, opened: &OpenedAnalysis, shard: &Shard) -> Result<Vec<u8>, ShardError> {
    let posts = ground_posts(plan, opened, shard)?;
    let analyzed = opened.parts.part(&opened.queried.dataset, posts, &StopFlag::default())?;
    let Analyzed { ground, crs, outcome } = &analyzed;
    let values = outcome.raster.as_ref();
    let values = values.unwrap_or_else(|| panic!("{} gives a raster", opened.kind.name));
    raster_result::bytes(plan, shard, &OutcomeWindows::new(values, ground, crs).raster())
}

/// The posts of a shard, which lie on the ground.
///
/// # Errors
/// The shard is wrong.
pub fn ground_posts(
    plan: &ShardPlan,
    opened: &OpenedAnalysis,
    shard: &Shard,
) -> Result<PostRect, ShardError> {
    let (posts, ground) = (posts(plan, shard)?, &opened.parts.frame().lattice);
    let is_inside = posts.last.column < ground.columns() && posts.last.row < ground.rows();
    match is_inside && posts.width() > 1 && posts.height() > 1 {
        true => Ok(posts),
        false => Err(plan.wrong_shard(shard.id, "its `window` is not one of posts of the ground")),
    }
}
