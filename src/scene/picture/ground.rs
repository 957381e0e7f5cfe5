//! The displayed ground and the block under it.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::{DepthLayer, DrawList, DrawMesh, DrawVertex, FeatureId};
use crate::draw::material::{Albedo, Material, NormalSource};
use crate::geom::aabb::Aabb;
use crate::mesh::sink::{MeshSink, VertexId};
use crate::roam::displayed::DisplayedTerrain;
use crate::scene::SceneModel;
use crate::scene::picture::add_mesh;
use crate::scene::plinth::{base_plate, plinth};
use crate::view::camera::Camera;

/// Makes draw vertices of bare positions.
struct GroundSink(DrawMesh);

impl MeshSink<Vec3> for GroundSink {
    fn vertex(&mut self, position: Vec3) -> VertexId {
        self.0.vertex(DrawVertex {
            position: position.to_array(),
            normal: [0.0, 0.0, 1.0],
            uv: [0.0; 2],
            color: Srgba::WHITE,
        })
    }

    fn triangle(&mut self, corners: [VertexId; 3]) {
        self.0.triangle(corners);
    }
}

/// The coarsest level of the ground's posts at which none is farther from the next than a pixel is wide where the ground
/// comes nearest to the camera: a picture of wide ground reads none of the finer levels.
pub(super) fn map_level(scene: &SceneModel, camera: &Camera) -> u32 {
    let (min, max) = scene.bounds;
    let (ground, forward) = (Aabb { min, max }, camera.forward());
    let depth_m = (ground.center() - camera.eye()).dot(forward) - 0.5 * ground.size().dot(forward.abs());
    if depth_m <= 0.0 && camera.parallel_frame().is_none() {
        return 0;
    }
    let pixel_m = camera.pixels_per_meter(depth_m).recip();
    let posts = pixel_m / scene.lattice.cell().max_element() as f32;
    let most = (scene.lattice.columns().max(scene.lattice.rows()) - 1).ilog2();
    (libm::log2f(posts.max(1.0)) as u32).min(most)
}

/// Adds the ground and returns the walls below its edge.
pub(super) fn add(list: &mut DrawList, scene: &SceneModel, displayed: &DisplayedTerrain) -> DrawMesh {
    let mut sink = GroundSink(DrawMesh::default());
    displayed.emit(&mut sink);
    let walls = plinth(&sink.0, scene.ground().lattice(), scene.bounds);
    let material = list.add_material(Material {
        name: "ground".into(),
        normals: NormalSource::Ground,
        albedo: Albedo::GroundMap,
        ..Material::default()
    });
    add_mesh(list, sink.0, material, DepthLayer::Ground, FeatureId::GROUND);
    walls
}

/// Adds the walls and, where they do not end straight, the plate that they stand on.
pub(super) fn add_plinth(list: &mut DrawList, scene: &SceneModel, walls: DrawMesh) {
    let material = list.add_material(Material { name: "plinth".into(), ..Material::default() });
    add_mesh(list, walls, material, DepthLayer::Solid, FeatureId::PLINTH);
    if let Some(plate) = base_plate(scene.ground().lattice(), scene.bounds) {
        add_mesh(list, plate, material, DepthLayer::Solid, FeatureId::PLINTH);
    }
}
