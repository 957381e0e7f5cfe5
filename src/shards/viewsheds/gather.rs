//! The sums of all shards of viewsheds.

use std::path::Path;

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::ShardPlan;
use crate::planned_dataset::PlannedDataset;
use crate::raster_result::EXTENSION;
use crate::record::result_path;
use crate::viewsheds::arguments::ViewshedsArguments;
use crate::viewsheds::counts::SightCounts;
use crate::viewsheds::plan::frame;
use crate::viewsheds::work::{observers, posts};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemOptions;
use sandtable_files::raster_file;
use sandtable_query::dem;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// Writes the counts of a plan whose shards are all done, over the posts that any observer may look at; `watch` says how many
/// shards are added.
///
/// # Errors
/// A file cannot be read or written, or is not the one of the plan.
pub fn gather(
    plan: &ShardPlan,
    arguments: &ViewshedsArguments,
    (out, format): (&Path, &DemFormat),
    watch: &StopFlag,
) -> Result<(), ShardError> {
    let windows: Vec<PostRect> =
        (0..plan.count()).map(|id| posts(plan, &plan.shard(id)?)).collect::<Result<_, ShardError>>()?;
    let all = windows.iter().fold(windows[0], |all, window| all.with(window.first).with(window.last));
    if all.width() as u64 * all.height() as u64 > RASTER_SAMPLES.get() {
        let (columns, rows) = (all.width() as u64, all.height() as u64);
        return Err(PlanError::new(&plan.folder, PlanFault::Region { columns, rows }).into());
    }
    let mut counts = SightCounts::new(all);
    watch.stretch(0.0..1.0, windows.len());
    for (id, &window) in windows.iter().enumerate() {
        let path = result_path(plan, id, EXTENSION);
        let raster = dem::open(&path, &DemOptions::default())?.raster;
        if (raster.width as usize, raster.height as usize) != (window.width(), window.height()) {
            return Err(PlanError::new(&path, PlanFault::Result).into());
        }
        counts.add_raster(window, &raster);
        watch.did(1);
    }
    let queried = PlannedDataset::open(&arguments.dataset, &plan.folder)?;
    let ground = frame(&queried, observers(plan, &plan.shard(0)?)?[0])?;
    let inputs = [queried.path];
    raster_file::write(&counts.raster(&ground.lattice, &ground.crs), format, out, &inputs)?;
    Ok(())
}
