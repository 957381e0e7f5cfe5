//! One shard of an analysis.

use crate::analysis::arguments::OpenedAnalysis;
use crate::analysis::said::PartSaid;
use crate::error::ShardError;
use crate::plan::ShardPlan;
use crate::raster_result;
use crate::record::ShardFile;
use crate::shard::Shard;
use crate::viewsheds::work::posts;
use sandtable_query::analysis_bands::OutcomeWindows;
use sandtable_query::parted_analysis::AnalyzedPart;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// The values of a shard's posts, as the bytes of a GeoTIFF, and what their figures are made of.
///
/// # Errors
/// The shard is wrong, or the elevation cannot be read.
pub fn result(
    plan: &ShardPlan,
    opened: &OpenedAnalysis,
    shard: &Shard,
) -> Result<Vec<ShardFile>, ShardError> {
    let posts = ground_posts(plan, opened, shard)?;
    let part = opened.parts.part(&opened.queried.dataset, posts, &StopFlag::default())?;
    let AnalyzedPart { raster, tally, notes } = &part;
    let frame = opened.parts.frame();
    let raster = OutcomeWindows::at(raster, (&frame.lattice, posts), &frame.crs).raster();
    let mut files =
        ShardFile::only(shard.id, raster_result::EXTENSION, raster_result::bytes(plan, shard, &raster)?);
    files.extend(PartSaid::new(tally, notes).file(plan, shard.id)?);
    Ok(files)
}

/// The posts of a shard, which lie among those of the analysis.
///
/// # Errors
/// The shard is wrong.
pub fn ground_posts(
    plan: &ShardPlan,
    opened: &OpenedAnalysis,
    shard: &Shard,
) -> Result<PostRect, ShardError> {
    let (posts, all) = (posts(plan, shard)?, opened.parts.posts());
    let is_inside = all.contains(posts.first) && all.contains(posts.last);
    match is_inside && posts.width() > 1 && posts.height() > 1 {
        true => Ok(posts),
        false => Err(plan.wrong_shard(shard.id, "its `window` is not one of posts of the ground")),
    }
}
