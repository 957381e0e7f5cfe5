//! The ribbons of a scene by patch, for flights that cut again only the patches that changed.

use crate::ribbon::patches::{Borders, Drapes};
use crate::roam::graph::Vertex;
use crate::roam::patched_ground::PatchedGround;
use crate::scene::SceneModel;

/// The scene's ribbons divided along its patches, numbered as [`crate::roam::layout::PatchLayout::patches`] lists them;
/// the places of ribbons are those in [`SceneModel::ribbons`].
pub fn drapes(scene: &SceneModel) -> Drapes {
    Drapes::new(&borders(scene.ground().patched()), scene.ribbons.iter().map(|ribbon| &ribbon.plan))
}

/// The borders as f32 has them, where the displayed triangles end.
fn borders(ground: PatchedGround<'_>) -> Borders {
    let layout = ground.layout;
    let (columns, rows) = layout.patch_grid();
    let at =
        |x: usize, y: usize| ground.plan(Vertex::new(x as i32 * layout.patch(), y as i32 * layout.patch()));
    Borders {
        east: (0..=columns).map(|column| f64::from(at(column, 0).x)).collect(),
        north: (0..=rows).map(|row| f64::from(at(0, row).y)).collect(),
    }
}
