//! The static draw list of a walk: solids, models and light, which stay while the ground and the draped features change
//! from frame to frame.
//!
//! Everything is set on the finest ground: the displayed one is off by no more than the tolerance in pixels, so that nothing
//! seems to float, and nothing moves while the ground is refined.

use glam::Vec3;

use crate::detail::Viewer;
use crate::models::PlacementMoves;
use crate::setting::PictureSetting;
use crate::{airspace, ground, has_table, lighting, models, solids, table, uprights, voids};
use sandtable_draw::list::DrawList;
use sandtable_scene::ground_map_cache::GroundMapKey;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;

/// The most posts of a walk's ground map: a hundred megabytes.
const MOST_MAP_POSTS: u64 = 1 << 22;

/// The ground of a walk as it is drawn, its light, and the models that were moved on it.
#[derive(Clone, Copy, Debug)]
pub struct WalkedGround<'a> {
    /// The models that stand elsewhere.
    pub moves: &'a PlacementMoves,
    /// The heights, as they are drawn.
    pub lattice: &'a Lattice,
    /// Unit vector toward the sun.
    pub to_sun: Vec3,
}

/// The level of the posts of a walk's ground map: the finest whose posts are few enough.
pub fn map_level(lattice: &Lattice) -> u32 {
    let posts = u64::from(lattice.columns()) * u64::from(lattice.rows());
    let most = (lattice.columns().max(lattice.rows()) - 1).ilog2();
    (0..most).find(|level| posts >> (2 * level) <= MOST_MAP_POSTS).unwrap_or(most)
}

/// `head`, whose materials keep their numbers, with the ground map, the light, and all solids and models, for an eye
/// that turns around where `camera` is. `progress` is called with the name of each step as it begins.
pub fn standing(
    scene: &SceneModel,
    walked: WalkedGround<'_>,
    camera: &Camera,
    head: &DrawList,
    progress: &dyn Fn(&'static str),
) -> DrawList {
    let key = GroundMapKey { level: map_level(walked.lattice) as i32, to_sun: walked.to_sun };
    let map = scene.map(key, || progress("lighting terrain"));
    let lighting = lighting(scene, camera, walked.to_sun);
    let mut list = DrawList { ground: Some(map), lighting, ..head.clone() };
    let surface = FullResolution { lattice: walked.lattice };
    progress("setting models");
    ground::add_plinth(&mut list, scene, ground::finest_walls(scene, walked.lattice));
    if has_table(scene, PictureSetting::new(camera, scene.bounds)) {
        table::add(&mut list, scene);
    }
    solids::add(&mut list, scene);
    voids::add(&mut list, scene);
    uprights::add(&mut list, scene, &surface);
    models::add_moved(&mut list, scene, &surface, Viewer::Around(camera), walked.moves);
    airspace::add(&mut list, scene);
    list
}

/// Whether the models of a list of [`standing`] depend on how far away they are: whether they are too many to be drawn in
/// full.
pub fn depends_on_distance(scene: &SceneModel) -> bool {
    scene.placements.iter().map(|placed| scene.models[placed.model].triangle_count()).sum::<usize>()
        > crate::detail::FULL_TRIANGLES
}
