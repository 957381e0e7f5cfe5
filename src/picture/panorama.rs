//! The draw list of a panorama: one list for an eye that turns around, so that nothing changes from strip to strip.
//!
//! Lines of sight reckon with the Earth's curvature and the air's refraction, which a draw list on flat ground does not. So
//! everything is lowered by as much as lines of sight lower it, and the picture shows a summit where a line of sight to it is
//! free, and no other. Ground between two corners of a triangle counts as straight, and what lies on it is not below it, as a
//! chord of a falling curve lies below the curve.

use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};
use rayon::prelude::*;

use crate::detail::Viewer;
use crate::nested_ground::NestedHeights;
use crate::{ListPurpose, ListedScene, ViewDraw, listed};
use sandtable_draw::list::DrawList;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::sight::Curvature;
use sandtable_view::camera::CameraError;
use sandtable_view::panorama::Panorama;

/// The lowering of what an eye sees by the Earth's curvature, as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HorizonDrop {
    eye: Vec2,
    /// World Z per square meter of distance.
    per_square_m: f64,
}

impl HorizonDrop {
    /// The lowering for the eye of a panorama of `scene`.
    pub fn new(scene: &SceneModel, panorama: &Panorama) -> Self {
        let per_square_m = Curvature::default().drop_per_square_m();
        Self { eye: panorama.eye.truncate(), per_square_m: scene.scale.world_z(per_square_m) }
    }

    /// A world point where the eye sees it.
    pub fn lowered(&self, world: Vec3) -> Vec3 {
        world - Vec3::Z * self.at(world)
    }

    fn at(&self, world: Vec3) -> f32 {
        (f64::from(world.truncate().distance_squared(self.eye)) * self.per_square_m) as f32
    }

    /// Lowers all of a list: the vertices of meshes in world space, and other meshes as a whole, such as models.
    fn lower(&self, list: &mut DrawList) {
        let mut is_placed = vec![false; list.meshes.len()];
        for item in &mut list.items {
            if item.world_from_mesh != Mat4::IDENTITY {
                is_placed[item.mesh.0 as usize] = true;
                let at = item.world_from_mesh.w_axis.truncate();
                item.world_from_mesh.w_axis.z -= self.at(at);
            }
        }
        list.meshes.par_iter_mut().zip(is_placed).filter(|(_, is_placed)| !is_placed).for_each(
            |(mesh, _)| {
                for vertex in &mut mesh.vertices {
                    vertex.position = self.lowered(Vec3::from_array(vertex.position)).to_array();
                }
            },
        );
    }
}

/// The draw list of a panorama, for all of its strips. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// See [`CameraError`].
pub fn build_panorama_draw_list(
    scene: &SceneModel,
    panorama: &Panorama,
    progress: &dyn Fn(&'static str),
) -> Result<ViewDraw, CameraError> {
    let guide = panorama.guide()?;
    progress("refining terrain");
    let displayed: Arc<DisplayedTerrain> =
        Arc::new(scene.ground().displayed_around(&guide, scene.tolerance_px));
    let viewer = Viewer::Around(&guide);
    let ListedScene { mut list, ground_triangles, graphic_texts } =
        listed(scene, &displayed, viewer, ListPurpose::Picture, progress);
    HorizonDrop::new(scene, panorama).lower(&mut list);
    Ok(ViewDraw { list, displayed, ground_triangles, graphic_texts, nested: NestedHeights::default() })
}
