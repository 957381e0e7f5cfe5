//! Doing shards: each once, however often a worker is started.

use std::sync::Arc;

use crate::analysis::arguments::OpenedAnalysis;
use crate::atlas::arguments::AtlasArguments;
use crate::atlas::renderer::renderer;
use crate::atlas::work::AtlasScene;
use crate::error::ShardError;
use crate::heights::arguments::HeightsArguments;
use crate::plan::{PlannedProduct, ShardPlan};
use crate::planned_dataset::QueriedDataset;
use crate::record::{self, ShardFile, ShardState};
use crate::tiles::arguments::TilesArguments;
use crate::viewsheds::arguments::ViewshedsArguments;
use crate::{analysis, atlas, heights, raster_result, tiles, viewsheds};
use sandtable_render::OtherRenderer;

/// A worker: everything that all shards of a plan share, opened once.
pub struct ShardWorker {
    plan: Arc<ShardPlan>,
    opened: OpenedProduct,
}

enum OpenedProduct {
    Heights(HeightsArguments, QueriedDataset),
    Viewsheds(ViewshedsArguments, QueriedDataset),
    Atlas(AtlasArguments, Box<AtlasScene>),
    Tiles(TilesArguments, QueriedDataset),
    Analysis(Box<OpenedAnalysis>),
}

/// Whether a shard is done: nothing is opened or compared for that but its record.
pub fn is_done(plan: &ShardPlan, id: usize) -> bool {
    record::state(plan, id) == ShardState::Done
}

impl ShardWorker {
    /// Checks that the inputs of a plan have not changed, and opens them. `gpu` draws for a plan that states a graphics adapter; `None`
    /// where it is not built in.
    ///
    /// # Errors
    /// An input has changed or cannot be opened, an argument is wrong, or there is no adapter where one draws.
    pub fn open(plan: &Arc<ShardPlan>, gpu: Option<OtherRenderer>) -> Result<Self, ShardError> {
        plan.verify_inputs()?;
        let opened = match &plan.product {
            PlannedProduct::Heights(arguments) => {
                let dataset = arguments.dataset.open(&plan.folder)?;
                OpenedProduct::Heights(arguments.clone(), dataset)
            }
            PlannedProduct::Viewsheds(arguments) => {
                arguments.fault().map_or(Ok(()), |fault| Err(plan.wrong_argument(fault)))?;
                let dataset = arguments.dataset.open(&plan.folder)?;
                OpenedProduct::Viewsheds(arguments.clone(), dataset)
            }
            PlannedProduct::Atlas(arguments) => {
                arguments.fault().map_or(Ok(()), |fault| Err(plan.wrong_argument(fault)))?;
                let backend = renderer(plan, arguments, gpu)?;
                let scene = AtlasScene::new(arguments.open(&plan.folder)?, backend);
                OpenedProduct::Atlas(arguments.clone(), Box::new(scene))
            }
            PlannedProduct::Tiles(arguments) => {
                arguments.fault().map_or(Ok(()), |fault| Err(plan.wrong_argument(fault)))?;
                let dataset = arguments.dataset.open(&plan.folder)?;
                OpenedProduct::Tiles(arguments.clone(), dataset)
            }
            PlannedProduct::Analysis(arguments) => {
                OpenedProduct::Analysis(Box::new(arguments.open(&plan.folder)?))
            }
        };
        Ok(Self { plan: Arc::clone(plan), opened })
    }

    /// Does a shard and writes its results and its record.
    ///
    /// # Errors
    /// The shard is wrong, its inputs cannot be read, or its results cannot be written. Others may still be done.
    pub fn work(&mut self, id: usize) -> Result<(), ShardError> {
        let (plan, shard) = (&*self.plan, self.plan.shard(id)?);
        let only = |extension: &str, bytes: Vec<u8>| ShardFile::only(id, extension, bytes);
        let files = match &mut self.opened {
            OpenedProduct::Heights(arguments, queried) => {
                only(heights::work::EXTENSION, heights::work::result(plan, arguments, queried, &shard)?)
            }
            OpenedProduct::Viewsheds(arguments, queried) => {
                only(raster_result::EXTENSION, viewsheds::work::result(plan, arguments, queried, &shard)?)
            }
            OpenedProduct::Atlas(arguments, scene) => {
                only(atlas::work::EXTENSION, scene.result(plan, arguments, &shard)?)
            }
            OpenedProduct::Tiles(arguments, queried) => {
                tiles::work::result(plan, arguments, queried, &shard)?
            }
            OpenedProduct::Analysis(opened) => analysis::work::result(plan, opened, &shard)?,
        };
        record::publish(plan, id, &files)
    }
}
