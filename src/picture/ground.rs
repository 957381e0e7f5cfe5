//! The displayed ground and the block under it.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::add_mesh;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, DrawVertex, FeatureId, MaterialId};
use sandtable_draw::material::{Albedo, Material, NormalSource};
use sandtable_geom::aabb::Aabb;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_scene::plinth::{base_plate, plinth};
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::cell_triangle::CellTriangle;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_view::camera::Camera;

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

/// The most posts of a ground map with cells of the model halved: so many for each pixel of a picture, as in perspective some are
/// out of view, and a hundred megabytes.
const POSTS_PER_PIXEL: u64 = 2;
const MOST_HALVED_POSTS: u64 = 1 << 22;

/// The most times that cells of the model are halved: what is wider in a picture is smooth.
const MOST_HALVINGS: u32 = 3;

/// The coarsest level of the ground's posts at which none is farther from the next than a pixel is wide where the ground
/// comes nearest to the camera: a picture of wide ground reads none of the finer levels. Below 0 where the posts of the model
/// are farther apart, as far as the picture has pixels for that many.
pub(super) fn map_level(scene: &SceneModel, camera: &Camera) -> i32 {
    let (min, max) = scene.bounds;
    let (ground, forward) = (Aabb { min, max }, camera.forward());
    let depth_m = (ground.center() - camera.eye()).dot(forward) - 0.5 * ground.size().dot(forward.abs());
    let is_around = depth_m <= 0.0 && camera.parallel_frame().is_none();
    let pixel_m = if is_around { 0.0 } else { camera.pixels_per_meter(depth_m).recip() };
    let posts = pixel_m / scene.lattice.cell().max_element() as f32;
    if posts >= 1.0 {
        let most = (scene.lattice.columns().max(scene.lattice.rows()) - 1).ilog2();
        return libm::log2f(posts).min(most as f32) as i32;
    }
    let (width, height) = camera.size();
    let most = (POSTS_PER_PIXEL * u64::from(width) * u64::from(height)).min(MOST_HALVED_POSTS);
    let count = u64::from(scene.lattice.columns()) * u64::from(scene.lattice.rows());
    let is_useful =
        |halvings: u32| (posts * (1u32 << halvings) as f32) <= 1.0 && count << (2 * halvings) <= most;
    let halvings = (1..=MOST_HALVINGS).take_while(|&halvings| is_useful(halvings)).count();
    -(halvings as i32)
}

/// Adds the ground and returns the walls below its edge.
pub(super) fn add(list: &mut DrawList, scene: &SceneModel, displayed: &DisplayedTerrain) -> DrawMesh {
    let mut sink = GroundSink(DrawMesh::default());
    displayed.emit(&mut sink);
    let walls = plinth(&sink.0, scene.ground().lattice(), scene.bounds);
    let material = add_material(list);
    list.materials[material.0 as usize].shows_edges = scene.wireframe;
    add_mesh(list, sink.0, material, DepthLayer::Ground, FeatureId::GROUND);
    walls
}

/// Adds the material of the ground.
pub(super) fn add_material(list: &mut DrawList) -> MaterialId {
    list.add_material(Material {
        name: "ground".into(),
        normals: NormalSource::Ground,
        albedo: Albedo::GroundMap,
        ..Material::default()
    })
}

/// The finest triangles along the edge of the ground and around its holes: all that walls under it need.
fn rim(lattice: &Lattice) -> DrawMesh {
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    let is_missing: Vec<bool> = lattice.heights().iter().map(|height| height.is_nan()).collect();
    let has_holes = is_missing.contains(&true);
    let is_rim = |column: usize, row: usize| {
        if column == 0 || row == 0 || column + 2 == columns || row + 2 == rows {
            return true;
        }
        has_holes
            && (row - 1..=row + 2).any(|row| {
                is_missing[row * columns + column - 1..=row * columns + column + 2].contains(&true)
            })
    };
    let (mut sink, mut placed) = (GroundSink(DrawMesh::default()), BTreeMap::new());
    for row in 0..rows - 1 {
        // Between the borders a row without holes near it has two cells.
        let inner = if row == 0 || row + 2 == rows || has_holes { 1 } else { (columns - 2).max(1) };
        for column in (0..columns - 1).step_by(inner).filter(|&column| is_rim(column, row)) {
            let cell = Post { column: column as u32, row: row as u32 };
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(east, north)| cell.offset(east, north));
            for triangle in CellTriangle::of_cell(cell) {
                let posts = triangle.corner_indices().map(|index| corners[index]);
                if posts.iter().all(|&post| !lattice.height(post).is_nan()) {
                    let ids = posts.map(|post| {
                        let position = || lattice.position(post).extend(lattice.height(post));
                        *placed.entry(lattice.index(post)).or_insert_with(|| sink.vertex(position()))
                    });
                    sink.triangle(ids);
                }
            }
        }
    }
    sink.0
}

/// The walls below the edge of the finest ground, whose drawn heights are `lattice`.
pub(super) fn finest_walls(scene: &SceneModel, lattice: &Lattice) -> DrawMesh {
    plinth(&rim(lattice), lattice, scene.bounds)
}

/// Adds the walls and, where they do not end straight, the plate that they stand on.
pub(super) fn add_plinth(list: &mut DrawList, scene: &SceneModel, walls: DrawMesh) {
    let material = list.add_material(Material { name: "plinth".into(), ..Material::default() });
    add_mesh(list, walls, material, DepthLayer::Solid, FeatureId::PLINTH);
    if let Some(plate) = base_plate(scene.ground().lattice(), scene.bounds) {
        add_mesh(list, plate, material, DepthLayer::Solid, FeatureId::PLINTH);
    }
}
