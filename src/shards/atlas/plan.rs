//! Cuts a scene into sheets.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::atlas::arguments::AtlasArguments;
use crate::atlas::sheet_grid::{SheetGrid, posts_in, sheet_name};
use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::{self, PlannedProduct};
use crate::planned_dataset::scene_inputs;
use crate::shard::{Shard, ShardWindow, SheetNeighbors};
use sandtable_base::limits::PLAN_SHARDS;
use sandtable_geom::rect::Rect;
use sandtable_scene::scene_model::SceneModel;

/// Plans the atlas of a scene; writes the plan to `folder`, which is there, and returns the number of its sheets.
///
/// # Errors
/// There are too many sheets or none, or a file cannot be read or written.
pub fn plan(arguments: AtlasArguments, scene: &SceneModel, folder: &Path) -> Result<usize, ShardError> {
    let path: PathBuf = folder.join(&arguments.scene);
    let grid = SheetGrid::new(scene, &arguments);
    let count = grid.columns.saturating_mul(grid.rows);
    if count > PLAN_SHARDS.get() {
        return Err(PlanError::new(&path, PlanFault::TooManyShards(count)).into());
    }
    let places = (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column)));
    let with_posts = places.map(|place| (place, posts_in(&scene.lattice, &grid.rect(place.0, place.1))));
    let sheets: Vec<((u64, u64), usize)> = with_posts.filter(|&(_, posts)| posts > 0).collect();
    if sheets.is_empty() {
        return Err(PlanError::new(&path, PlanFault::NoGround).into());
    }
    let ids: BTreeMap<(u64, u64), usize> = (0..).zip(&sheets).map(|(id, &(place, _))| (place, id)).collect();
    let to_map = scene.lattice.map_extent().min - scene.lattice.extent().min;
    let shard = |(id, &((row, column), posts)): (usize, &((u64, u64), usize))| {
        let rect = grid.rect(row, column);
        let beside = |rows: i64, columns: i64| {
            let place = row.checked_add_signed(rows).zip(column.checked_add_signed(columns));
            place.and_then(|place| ids.get(&place).copied())
        };
        let neighbors = SheetNeighbors {
            north: beside(-1, 0),
            east: beside(0, 1),
            south: beside(1, 0),
            west: beside(0, -1),
        };
        let (min, max) = (rect.min + to_map, rect.max + to_map);
        let window = ShardWindow::Map([min.x, min.y, max.x, max.y]);
        let shard = Shard::new(id, sheet_name(row, column), posts as f64, window);
        Shard { sheet: Some([row, column]), neighbors: Some(neighbors), ..shard }
    };
    let lines: Vec<Shard> = sheets.iter().enumerate().map(shard).collect();
    let inputs = scene_inputs(&arguments.scene, &scene.files, folder)?;
    plan::write(folder, PlannedProduct::Atlas(arguments), inputs, &lines)?;
    Ok(lines.len())
}

/// The rectangle of a sheet in the scene's system; `None` where the shard has none.
pub fn sheet_rect(shard: &Shard) -> Option<Rect> {
    let ShardWindow::Map([min_x, min_y, max_x, max_y]) = shard.window else { return None };
    let rect = Rect { min: DVec2::new(min_x, min_y), max: DVec2::new(max_x, max_y) };
    (rect.min.is_finite() && rect.max.is_finite() && rect.min.cmplt(rect.max).all()).then_some(rect)
}
