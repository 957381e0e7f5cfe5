//! Hatching on the block's base where the elevation model has no data, so that nobody takes the base for ground.

use glam::{Vec2, Vec3};

use crate::add_mesh;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, DrawVertex, FeatureId};
use sandtable_draw::material::{Albedo, AlphaMode, Material};
use sandtable_mesh::sink::MeshSink;
use sandtable_scene::plinth::floor_z;
use sandtable_scene::scene_model::SceneModel;

/// The color of the lines: neutral, and lighter than ink, so that the ground stays the figure.
pub const LINES: Srgba = Srgba([96, 96, 104, 130]);

/// How far the lines lie over the base, as a share of the ground's longer side: less is lost in the rounding of depths.
const ABOVE: f32 = 4e-4;

/// Adds the hatching over the whole rectangle of the model; the block stands before it where there is ground.
pub(super) fn add(list: &mut DrawList, scene: &SceneModel) {
    if !scene.has_voids() {
        return;
    }
    let (min, max) = scene.bounds;
    let (low, high) = (min.truncate(), max.truncate());
    let z = floor_z(scene.ground().lattice(), scene.bounds) + ABOVE * (high - low).max_element();
    let mut mesh = DrawMesh::default();
    let corners = [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)].map(|corner| {
        let position = corner.extend(z).to_array();
        mesh.vertex(DrawVertex { position, normal: Vec3::Z.to_array(), uv: [0.0; 2], color: Srgba::WHITE })
    });
    mesh.triangle([corners[0], corners[1], corners[2]]);
    mesh.triangle([corners[0], corners[2], corners[3]]);
    let material = list.add_material(Material {
        name: "no data".into(),
        base_color: LINES,
        alpha: AlphaMode::Blend,
        albedo: Albedo::Hatching,
        ..Material::default()
    });
    add_mesh(list, mesh, material, DepthLayer::Solid, FeatureId::NONE);
}
