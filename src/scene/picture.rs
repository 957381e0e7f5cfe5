//! A scene and a camera to a draw list: refine, emit, drape, set models.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Mat4, Quat, Vec3};
use rayon::prelude::*;

use crate::description::words::Clamp;
use crate::draw::color::Srgba;
use crate::draw::list::{DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId, Layer, MaterialId, MeshId};
use crate::draw::material::{Albedo, Material, Normals, TextureId};
use crate::mesh::sink::{MeshSink, VertexId};
use crate::model::kind::Model;
use crate::ribbon::drape::drape;
use crate::ribbon::texture::{Surface, texture};
use crate::roam::criterion::screen::ScreenError;
use crate::roam::culling::patches_in_view;
use crate::roam::displayed::DisplayedTerrain;
use crate::roam::refine::rebuild::rebuild;
use crate::scene::kind::{Placement, Scene, Terrain, View};
use crate::scene::plinth::plinth;
use crate::terrain::facets::Facets;
use crate::terrain::query::{Interpolation, ground_height};
use crate::view::camera::{Camera, CameraError};
use crate::view::frustum::Frustum;

/// What one camera sees of a scene.
pub struct Shot {
    /// What to draw.
    pub list: DrawList,
    /// The displayed ground.
    pub displayed: Arc<DisplayedTerrain>,
    /// Triangles of the ground among those drawn.
    pub ground_triangles: usize,
}

/// The camera for a view on a picture of `size` pixels, its far plane behind the whole scene.
///
/// # Errors
/// See [`CameraError`].
pub fn camera(scene: &Scene, view: &View, size: (u32, u32)) -> Result<Camera, CameraError> {
    let (min, max) = scene.terrain.bounds();
    let farthest = Vec3::select((view.eye - min).abs().cmpgt((view.eye - max).abs()), min, max);
    let far = view.eye.distance(farthest) * 1.5 + 1000.0;
    Camera::new(view.eye, view.target, view.fov_y_rad, size, (0.5, far))
}

/// The draw list for one camera. `step` is called with what is done next.
pub fn shoot(scene: &Scene, camera: &Camera, step: &dyn Fn(&'static str)) -> Shot {
    step("refining terrain");
    let displayed = Arc::new(display(&scene.terrain, camera));
    let mut list =
        DrawList { ground: Some(Arc::clone(&scene.map)), lighting: scene.lighting, ..DrawList::default() };
    let walls = add_ground(&mut list, &scene.terrain, &displayed);
    let ground_triangles = list.triangle_count();
    step("draping features");
    add_ribbons(&mut list, scene, &*displayed);
    step("setting models");
    add_plinth(&mut list, walls);
    add_models(&mut list, scene, &*displayed);
    Shot { list, displayed, ground_triangles }
}

/// The terrain as `camera` shows it.
pub fn display(terrain: &Terrain, camera: &Camera) -> DisplayedTerrain {
    let (ground, heights) = (terrain.ground(), &terrain.patch_heights);
    let patches = patches_in_view(ground, heights, &Frustum::of(camera));
    let criterion = ScreenError::new(ground, &terrain.errors, heights, camera, terrain.tolerance_px);
    let active = rebuild(&terrain.layout, &criterion, patches.iter().copied());
    DisplayedTerrain::new(Arc::clone(&terrain.lattice), active, terrain.exaggeration, patches)
}

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

/// Adds the ground and returns the walls below its edge.
fn add_ground(list: &mut DrawList, terrain: &Terrain, displayed: &DisplayedTerrain) -> DrawMesh {
    let mut sink = GroundSink(DrawMesh::default());
    displayed.emit(&mut sink);
    let walls = plinth(&sink.0, &terrain.lattice, terrain.exaggeration);
    let material = list.add_material(Material {
        name: "ground".into(),
        normals: Normals::Ground,
        albedo: Albedo::GroundMap,
        ..Material::default()
    });
    add_mesh(list, sink.0, material, Layer::Ground, FeatureId::GROUND);
    walls
}

fn add_plinth(list: &mut DrawList, walls: DrawMesh) {
    let material = list.add_material(Material { name: "plinth".into(), ..Material::default() });
    add_mesh(list, walls, material, Layer::Solid, FeatureId::GROUND);
}

fn add_mesh(list: &mut DrawList, mesh: DrawMesh, material: MaterialId, layer: Layer, feature: FeatureId) {
    let triangles = 0..mesh.triangles.len() as u32;
    let mesh = list.add_mesh(mesh);
    list.items.push(DrawItem { mesh, triangles, material, world_from_mesh: Mat4::IDENTITY, layer, feature });
}

fn add_ribbons(list: &mut DrawList, scene: &Scene, displayed: &dyn Facets) {
    let meshes: Vec<DrawMesh> = scene
        .ribbons
        .par_iter()
        .map(|ribbon| {
            let mut mesh = DrawMesh::default();
            drape(&ribbon.plan, displayed, &mut mesh);
            mesh
        })
        .collect();
    let mut materials: BTreeMap<Surface, MaterialId> = BTreeMap::new();
    let mut order: Vec<_> =
        scene.ribbons.iter().zip(meshes).filter(|(_, mesh)| !mesh.triangles.is_empty()).collect();
    order.sort_by_key(|(ribbon, _)| ribbon.layer);
    for (ribbon, mesh) in order {
        let material =
            *materials.entry(ribbon.surface).or_insert_with(|| draped_material(list, ribbon.surface));
        add_mesh(list, mesh, material, Layer::Draped(ribbon.layer), ribbon.feature);
    }
}

fn draped_material(list: &mut DrawList, surface: Surface) -> MaterialId {
    let texture = list.add_texture(texture(surface));
    list.add_material(Material {
        name: format!("{surface:?}").to_lowercase(),
        texture: Some(texture),
        normals: Normals::Ground,
        ..Material::default()
    })
}

/// A model's meshes and materials in a draw list.
struct Listed {
    parts: Vec<(MeshId, u32, MaterialId)>,
    lowest_z: f32,
}

fn add_models(list: &mut DrawList, scene: &Scene, displayed: &dyn Facets) {
    let mut listed: BTreeMap<usize, Listed> = BTreeMap::new();
    for placement in &scene.placements {
        let Some(ground_z) = foot_z(scene, placement, displayed) else {
            continue;
        };
        let model =
            listed.entry(placement.model).or_insert_with(|| list_model(list, &scene.models[placement.model]));
        let world_from_mesh =
            transform(placement, model.lowest_z, ground_z as f32, scene.terrain.exaggeration);
        for &(mesh, count, material) in &model.parts {
            list.items.push(DrawItem {
                mesh,
                triangles: 0..count,
                material,
                world_from_mesh,
                layer: Layer::Solid,
                feature: placement.feature,
            });
        }
    }
}

/// World Z of the ground under a model: as displayed, or as it is where the ground there is out of view, since
/// the model's upper parts may be in view all the same. `None` over no data.
fn foot_z(scene: &Scene, placement: &Placement, displayed: &dyn Facets) -> Option<f64> {
    let lattice = &scene.terrain.lattice;
    let at = placement.at.as_dvec2();
    displayed.displayed_z(at).or_else(|| {
        let height_m = ground_height(lattice, Interpolation::Planar, at + lattice.origin()).height_m()?;
        Some(height_m * f64::from(scene.terrain.exaggeration))
    })
}

fn list_model(list: &mut DrawList, model: &Model) -> Listed {
    let first_texture = list.textures.len() as u32;
    list.textures.extend(model.textures.iter().cloned());
    let first_material = list.materials.len() as u32;
    list.materials.extend(model.materials.iter().map(|material| Material {
        texture: material.texture.map(|TextureId(id)| TextureId(id + first_texture)),
        ..material.clone()
    }));
    let parts = model
        .parts
        .iter()
        .map(|part| {
            let count = part.mesh.triangles.len() as u32;
            (list.add_mesh(part.mesh.clone()), count, MaterialId(part.material.0 + first_material))
        })
        .collect();
    Listed { parts, lowest_z: model.bounds().map_or(0.0, |(min, _)| min.z) }
}

/// Where a model stands, given its lowest Z and the drawn ground at its origin.
///
/// Its front, −Y, is turned to the heading.
fn transform(placement: &Placement, lowest_z: f32, ground_z: f32, exaggeration: f32) -> Mat4 {
    let z = match placement.clamp {
        Clamp::Ground => ground_z - lowest_z * placement.scale,
        Clamp::Relative => ground_z + placement.height_m,
        Clamp::Absolute => placement.height_m * exaggeration,
    };
    let turn = std::f32::consts::PI - placement.heading_rad;
    let half = turn * 0.5;
    let rotation = Quat::from_xyzw(0.0, 0.0, libm::sinf(half), libm::cosf(half));
    Mat4::from_scale_rotation_translation(Vec3::splat(placement.scale), rotation, placement.at.extend(z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn a_model_s_front_turns_to_its_heading_and_its_foot_stands_on_the_ground() {
        for (heading, front) in [(0.0, Vec2::Y), (90.0, Vec2::X), (180.0, Vec2::NEG_Y), (270.0, Vec2::NEG_X)]
        {
            let placement = Placement {
                model: 0,
                at: Vec2::new(100.0, 200.0),
                clamp: Clamp::Ground,
                height_m: 0.0,
                heading_rad: f32::to_radians(heading),
                scale: 2.0,
                feature: FeatureId(2),
            };
            let world_from_mesh = transform(&placement, -1.5, 40.0, 1.0);
            let foot = world_from_mesh.transform_point3(Vec3::new(0.0, 0.0, -1.5));
            assert!((foot - Vec3::new(100.0, 200.0, 40.0)).length() < 1e-4);
            let seen = world_from_mesh.transform_vector3(Vec3::NEG_Y).truncate();
            assert!((seen - front * 2.0).length() < 1e-5, "heading {heading}: {seen}");
        }
    }
}
