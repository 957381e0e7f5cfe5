//! One sheet of an atlas.

use crate::atlas::arguments::AtlasArguments;
use crate::atlas::plan::sheet_rect;
use crate::error::ShardError;
use crate::plan::ShardPlan;
use crate::shard::{Shard, SheetNeighbors};
use sandtable_description::document::FurnitureTable;
use sandtable_geom::rect::Rect;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::{PictureSize, compose_view, draw_view};
use sandtable_sheet::sheet_file::{picture_description, sheet_png};

/// The extension of a shard's results.
pub const EXTENSION: &str = "png";

/// A scene of which sheets are drawn.
pub struct AtlasScene {
    scene: SceneModel,
    /// What the scene file states: sheets add to it.
    furniture: FurnitureTable,
    subtitle: Option<String>,
    backend: RenderBackend,
}

impl AtlasScene {
    /// The scene of an atlas whose sheets `backend` draws.
    pub fn new(scene: SceneModel, backend: RenderBackend) -> Self {
        let (furniture, subtitle) = (scene.furniture.clone(), scene.subtitle.clone());
        Self { scene, furniture, subtitle, backend }
    }

    /// A sheet, as the bytes of a PNG.
    ///
    /// # Errors
    /// The shard is not one of the plan, or cannot be drawn.
    pub fn result(
        &mut self,
        plan: &ShardPlan,
        arguments: &AtlasArguments,
        shard: &Shard,
    ) -> Result<Vec<u8>, ShardError> {
        let wrong = || plan.wrong_shard(shard.id, "it has no `window` of a sheet");
        let rect = sheet_rect(shard).ok_or_else(wrong)?;
        self.name(plan, shard)?;
        let scene = &self.scene;
        let to_map = scene.lattice.map_extent().min - scene.lattice.extent().min;
        let view = arguments.view(&shard.name, Rect { min: rect.min - to_map, max: rect.max - to_map });
        let drawn = draw_view(scene, &view, PictureSize::of(scene, &view), self.backend, &|_| ())?;
        let sheet = compose_view(scene, drawn, &|_| ()).sheet;
        let description = picture_description(scene, &view);
        Ok(sheet_png(sheet, view.dpi(), (scene.title.as_deref(), &description)))
    }

    /// Puts the name of a sheet under the title, and those of its neighbors into the notes of the margin.
    fn name(&mut self, plan: &ShardPlan, shard: &Shard) -> Result<(), ShardError> {
        let mut beside = Vec::new();
        for (side, id) in shard.neighbors.iter().flat_map(SheetNeighbors::sides) {
            let initial = side[..1].to_uppercase();
            beside.push(format!("{initial} {}", plan.shard(id)?.name));
        }
        let name = format!("Sheet {}", shard.name);
        self.scene.subtitle = Some(match &self.subtitle {
            Some(subtitle) => format!("{subtitle} · {name}"),
            None => name,
        });
        let mut notes = self.furniture.notes.clone().unwrap_or_default();
        if !beside.is_empty() {
            notes.push(format!("Adjoining: {}", beside.join(", ")));
        }
        self.scene.furniture.notes = Some(notes);
        Ok(())
    }
}
