//! Finer posts of a part of the ground than its ground map has, lit as the map is.
//!
//! The light of a part knows nothing of the ground around it, and that of the map nothing of its small forms: a post
//! receives what both let through.

use glam::Vec3;
use rayon::prelude::*;

use crate::scene_model::SceneModel;
use crate::texture_shading::sky_in_part;
use sandtable_draw::contour_ground::lift_level_ground;
use sandtable_draw::ground::{GroundMap, GroundPost};
use sandtable_draw::ground_levels::PostCount;
use sandtable_draw::ground_window::GroundWindow;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::light::TerrainLight;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::terraces::{are_whole, without_terraces};

/// A part of the ground with a border around it.
pub struct WindowGround {
    /// Its heights, true to scale; a part of the lattice whose south-west post is that of the map.
    pub lattice: Lattice,
    /// The posts of the window among its own.
    pub inner: PostRect,
}

/// The window of a part of the ground of `scene`, of which `map` is the ground map for a sun in the direction of the unit
/// vector `to_sun`.
pub fn ground_window(
    scene: &SceneModel,
    map: &GroundMap,
    WindowGround { lattice, inner }: &WindowGround,
    to_sun: Vec3,
) -> GroundWindow {
    let drawn = (scene.scale.0 != 1.0).then(|| lattice.stretched(scene.scale.0));
    let light = TerrainLight::new(drawn.as_ref().unwrap_or(lattice), to_sun, 0);
    let smooth = are_whole(lattice.heights()).then(|| without_terraces(lattice, 1.0, &|_| false));
    let shaded = smooth.as_ref().unwrap_or(lattice);
    let columns = inner.first.column..=inner.last.column;
    let row = |row: u32| -> Vec<GroundPost> {
        let heights = shaded.filled_row(row, scene.height_range_m.0);
        let slopes = shaded.shaded_slopes_of_row(row);
        let (sun, sky) = (light.sun(row as usize), light.sky(row as usize));
        let post = |column: u32| {
            let at = column as usize;
            let around = map.sample(lattice.position(Post { column, row }));
            GroundPost {
                height_m: heights[at],
                slope_east: scene.scale.world_z(slopes[at].x),
                slope_north: scene.scale.world_z(slopes[at].y),
                sun_visibility: sun[at].min(around.sun_visibility),
                sky_visibility: sky_in_part(scene.texture, sky[at], around.sky_visibility),
                water: around.water,
            }
        };
        columns.clone().map(post).collect()
    };
    let rows: Vec<Vec<GroundPost>> = (inner.first.row..=inner.last.row).into_par_iter().map(row).collect();
    let origin = lattice.first();
    let size = PostCount {
        columns: inner.last.column - inner.first.column + 1,
        rows: inner.last.row - inner.first.row + 1,
    };
    let mut posts = rows.concat();
    if let Some(contours) = &map.contours {
        lift_level_ground(&mut posts, size, contours, if smooth.is_some() { 1.0 } else { 0.0 });
    }
    GroundWindow {
        first: [origin.column + inner.first.column, origin.row + inner.first.row],
        columns: size.columns,
        posts,
    }
}
