//! Meshes and instances on the device. Only what items use is sent.

use std::collections::HashMap;
use std::ops::Range;

use bytemuck::{Zeroable, cast_slice};
use glam::{Mat4, Vec3};

use crate::draw_call::DrawShape;
use crate::error::GpuError;
use crate::instance_culling::CulledInstances;
use crate::memory::Loader;
use crate::merged_vertex::{MergedVertex, SurfaceOwner};
use crate::plan::Plan;
use crate::uniforms::Instance;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, DrawVertex};
use sandtable_mesh::sink::VertexId;
use sandtable_view::camera::Camera;

/// The meaning of the texture coordinates of merged corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerUv {
    /// Those of the mesh.
    Own,
    /// The weights of a triangle's second and third corner, for its edges; no triangles share corners.
    Weights,
}

/// Triangles of many items.
#[derive(Debug, Default, PartialEq)]
pub struct MergedTriangles {
    pub vertices: Vec<MergedVertex>,
    pub indices: Vec<u32>,
}

/// A mesh on the device; clones share it.
#[derive(Clone, Debug)]
pub struct MeshBuffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
}

/// The geometry of a plan.
#[derive(Debug)]
pub struct GpuGeometry {
    merged: Vec<MeshBuffers>,
    /// One per mesh; `None` for one that no instance places.
    placed: Vec<Option<MeshBuffers>>,
    instances: wgpu::Buffer,
}

impl MergedTriangles {
    /// Adds triangles of `mesh` with the vertices that they use.
    pub fn add(
        &mut self,
        mesh: &DrawMesh,
        triangles: impl ExactSizeIterator<Item = u32>,
        world_from_mesh: &Mat4,
        owner: SurfaceOwner,
        uv: CornerUv,
    ) {
        let (start, first_vertex) = (self.indices.len(), self.vertices.len());
        let is_moved = *world_from_mesh != Mat4::IDENTITY;
        let mut known = KnownVertices::new(mesh.vertices.len(), triangles.len() * 3);
        for id in triangles.flat_map(|triangle| mesh.triangles[triangle as usize]) {
            let index = known.of(id, || {
                let mut corner = mesh.vertices[id.index()];
                if is_moved {
                    let position = Vec3::from(corner.position).extend(1.0);
                    let normal = Vec3::from(corner.normal).extend(0.0);
                    corner.position = (*world_from_mesh * position).truncate().to_array();
                    corner.normal = (*world_from_mesh * normal).truncate().to_array();
                }
                self.vertices.push(MergedVertex { corner, owner });
                self.vertices.len() as u32 - 1
            });
            self.indices.push(index);
        }
        if uv == CornerUv::Weights {
            self.weigh_corners(start, first_vertex);
        }
    }

    /// Gives each triangle from index `start` on corners of its own, with their weights, in place of the vertices from
    /// `first_vertex` on.
    fn weigh_corners(&mut self, start: usize, first_vertex: usize) {
        let corners: Vec<MergedVertex> =
            self.indices.drain(start..).map(|index| self.vertices[index as usize]).collect();
        self.vertices.truncate(first_vertex);
        for (corner, weights) in corners.into_iter().zip([[0.0; 2], [1.0, 0.0], [0.0, 1.0]].iter().cycle()) {
            self.indices.push(self.vertices.len() as u32);
            let corner = MergedVertex { corner: DrawVertex { uv: *weights, ..corner.corner }, ..corner };
            self.vertices.push(corner);
        }
    }
}

/// The places of a mesh's vertices in a merged mesh.
enum KnownVertices {
    /// By vertex; `u32::MAX` for none.
    All(Vec<u32>),
    /// Of a small part of a large mesh.
    Few(HashMap<VertexId, u32>),
}

impl KnownVertices {
    /// No places yet, of at most `used` of so many vertices.
    fn new(vertices: usize, used: usize) -> Self {
        if vertices <= used * 4 { Self::All(vec![u32::MAX; vertices]) } else { Self::Few(HashMap::new()) }
    }

    /// The place of a vertex; where it has none, that which `add` returns.
    fn of(&mut self, id: VertexId, add: impl FnOnce() -> u32) -> u32 {
        match self {
            Self::Few(places) => *places.entry(id).or_insert_with(add),
            Self::All(places) => {
                let place = &mut places[id.index()];
                if *place == u32::MAX {
                    *place = add();
                }
                *place
            }
        }
    }
}

impl GpuGeometry {
    /// Sends what `plan` draws of a checked list for a picture by `camera`, or by many cameras.
    pub fn upload(
        loader: &Loader<'_>,
        list: &DrawList,
        plan: &Plan,
        camera: Option<&Camera>,
    ) -> Result<Self, GpuError> {
        Self::upload_beside(loader, list, plan, camera, &[])
    }

    /// Sends what another plan of the same list draws; meshes that instances of this one place are not sent again.
    pub fn upload_more(&self, loader: &Loader<'_>, list: &DrawList, plan: &Plan) -> Result<Self, GpuError> {
        Self::upload_beside(loader, list, plan, None, &self.placed)
    }

    /// Sends what `plan` draws; of `sent`, by mesh, are those that the device has.
    fn upload_beside(
        loader: &Loader<'_>,
        list: &DrawList,
        plan: &Plan,
        camera: Option<&Camera>,
        sent: &[Option<MeshBuffers>],
    ) -> Result<Self, GpuError> {
        let merged = plan.merged.chunk_by(|a, b| a.chunk == b.chunk).map(|parts| {
            let mut merged = MergedTriangles::default();
            for part in parts {
                let item = &list.items[part.item];
                let owner = SurfaceOwner { feature: item.feature, material: item.material.into() };
                let mesh = &list.meshes[item.mesh.0 as usize];
                let shows_edges = list.materials[item.material.0 as usize].shows_edges;
                let uv = if shows_edges { CornerUv::Weights } else { CornerUv::Own };
                let world_from_mesh = &item.world_from_mesh;
                match camera.filter(|_| item.layer == DepthLayer::Ground) {
                    Some(camera) => {
                        let order = nearest_first(mesh, part.triangles.clone(), camera);
                        merged.add(mesh, order.into_iter(), world_from_mesh, owner, uv);
                    }
                    None => merged.add(mesh, part.triangles.clone(), world_from_mesh, owner, uv),
                }
            }
            let what = || format!("{} triangles", merged.indices.len() / 3);
            MeshBuffers::upload(loader, what, cast_slice(&merged.vertices), cast_slice(&merged.indices))
        });
        let merged = merged.collect::<Result<_, _>>()?;
        let mut is_placed = vec![false; list.meshes.len()];
        plan.placed.iter().for_each(|&item| is_placed[list.items[item].mesh.0 as usize] = true);
        let placed = list.meshes.iter().zip(is_placed).enumerate().map(|(index, (mesh, is_placed))| {
            let upload = || {
                if let Some(sent) = sent.get(index).and_then(Option::as_ref) {
                    return Ok(sent.clone());
                }
                let indices: Vec<[u32; 3]> =
                    mesh.triangles.iter().map(|corners| corners.map(|id| id.0)).collect();
                let what = || format!("mesh {index}");
                MeshBuffers::upload(loader, what, cast_slice(&mesh.vertices), cast_slice(&indices))
            };
            is_placed.then(upload).transpose()
        });
        let placed = placed.collect::<Result<_, _>>()?;
        Ok(Self { merged, placed, instances: instances(loader, list, plan)? })
    }

    /// The instances of the plan, in its order.
    pub fn instances(&self) -> &wgpu::Buffer {
        &self.instances
    }

    /// Draws those instances of run `run` of the plan's culled ones, of this shape, that `culled` has found to be seen, with the
    /// pipeline and the groups that are set.
    pub fn draw_seen(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        (run, shape): (usize, &DrawShape),
        culled: &CulledInstances,
    ) {
        let DrawShape::Placed { mesh, instances, .. } = shape else { return };
        let Some(buffers) = &self.placed[mesh.0 as usize] else { return };
        buffers.set(pass);
        pass.set_vertex_buffer(1, culled.seen_from(instances.start));
        let (calls, offset) = culled.call(run);
        pass.draw_indexed_indirect(calls, offset);
    }

    /// Draws a shape of the plan with the pipeline and the groups that are set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shape: &DrawShape) {
        match shape {
            DrawShape::Merged { chunk, indices } => {
                self.merged[*chunk as usize].set(pass);
                pass.draw_indexed(indices.clone(), 0, 0..1);
            }
            DrawShape::Placed { mesh, indices, instances } => {
                let Some(buffers) = &self.placed[mesh.0 as usize] else { return };
                buffers.set(pass);
                // Bound at the first instance and counted from zero: OpenGL ES has no first instance.
                let first = u64::from(instances.start) * size_of::<Instance>() as u64;
                pass.set_vertex_buffer(1, self.instances.slice(first..));
                pass.draw_indexed(indices.clone(), 0, 0..instances.len() as u32);
            }
        }
    }
}

/// Triangles of the ground from the nearest to the farthest, so that little is shaded that nearer ground hides; those at
/// about the same depth keep their order, in which neighbors share corners.
fn nearest_first(mesh: &DrawMesh, triangles: Range<u32>, camera: &Camera) -> Vec<u32> {
    /// Bands of depth to a doubling: more hide more, and share fewer corners.
    const BANDS: f32 = 4.0;
    let band = |triangle: &u32| {
        let [corner, ..] = mesh.triangles[*triangle as usize];
        let offset = Vec3::from(mesh.vertices[corner.index()].position) - camera.eye();
        // Not finite for hostile corners, which any band is right for.
        (libm::log2f(offset.dot(camera.forward()).max(1.0)) * BANDS) as i32
    };
    let mut order: Vec<u32> = triangles.collect();
    order.sort_by_cached_key(band);
    order
}

impl MeshBuffers {
    fn upload(
        loader: &Loader<'_>,
        what: impl Fn() -> String,
        vertices: &[u8],
        indices: &[u8],
    ) -> Result<Self, GpuError> {
        Ok(Self {
            vertices: loader.filled_buffer(&what, wgpu::BufferUsages::VERTEX, vertices)?,
            indices: loader.filled_buffer(&what, wgpu::BufferUsages::INDEX, indices)?,
        })
    }

    fn set(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

fn instances(loader: &Loader<'_>, list: &DrawList, plan: &Plan) -> Result<wgpu::Buffer, GpuError> {
    let mut instances: Vec<Instance> =
        plan.placed.iter().map(|&item| Instance::new(&list.items[item])).collect();
    if instances.is_empty() {
        instances.push(Instance::zeroed());
    }
    let what = || format!("the placement of {} items", instances.len());
    let read = if plan.culled.is_empty() { wgpu::BufferUsages::empty() } else { wgpu::BufferUsages::STORAGE };
    loader.filled_buffer(what, wgpu::BufferUsages::VERTEX | read, cast_slice(&instances))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{FeatureId, MaterialId};
    use sandtable_mesh::sink::MeshSink;

    #[test]
    fn merging_takes_only_the_vertices_in_use_and_moves_them_to_the_world() {
        let mut mesh = DrawMesh::default();
        for x in 0..5u8 {
            let position = [f32::from(x), 0.0, 0.0];
            mesh.vertex(DrawVertex { position, normal: [1.0, 0.0, 0.0], uv: [0.0; 2], color: Srgba::WHITE });
        }
        mesh.triangle([VertexId(0), VertexId(1), VertexId(2)]);
        mesh.triangle([VertexId(4), VertexId(2), VertexId(4)]);
        let owner = SurfaceOwner { feature: FeatureId(9), material: MaterialId(3).into() };
        let turned =
            Mat4::from_translation(Vec3::Z * 7.0) * Mat4::from_rotation_z(std::f32::consts::FRAC_PI_2);
        let mut merged = MergedTriangles::default();
        merged.add(&mesh, 0..1, &Mat4::IDENTITY, owner, CornerUv::Own);
        merged.add(&mesh, 1..2, &turned, owner, CornerUv::Own);
        assert_eq!(merged.indices, [0, 1, 2, 3, 4, 3]);
        assert_eq!(merged.vertices.len(), 5);
        let last = merged.vertices[3];
        assert!(Vec3::from(last.corner.position).abs_diff_eq(Vec3::new(0.0, 4.0, 7.0), 1e-5));
        assert!(Vec3::from(last.corner.normal).abs_diff_eq(Vec3::Y, 1e-6));
        assert_eq!(last.owner, owner);
    }

    #[test]
    fn ground_is_drawn_from_the_nearest_to_the_farthest() {
        let mut mesh = DrawMesh::default();
        for y in [900.0, 10.0, 100.0, 11.0] {
            let [a, b, c] = [[0.0, y, 0.0], [1.0, y, 0.0], [0.0, y, 1.0]].map(|position| {
                mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE })
            });
            mesh.triangle([a, b, c]);
        }
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (8, 8), (1.0, 1000.0)).expect("sound");
        assert_eq!(nearest_first(&mesh, 0..4, &camera), [1, 3, 2, 0]);
    }

    #[test]
    fn triangles_whose_edges_show_have_corners_of_their_own_with_weights() {
        let mut mesh = DrawMesh::default();
        for x in 0..4u8 {
            let position = [f32::from(x), 0.0, 0.0];
            mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [7.0; 2], color: Srgba::WHITE });
        }
        mesh.triangle([VertexId(0), VertexId(1), VertexId(2)]);
        mesh.triangle([VertexId(1), VertexId(3), VertexId(2)]);
        let owner = SurfaceOwner { feature: FeatureId(9), material: MaterialId(3).into() };
        let mut merged = MergedTriangles::default();
        merged.add(&mesh, 0..2, &Mat4::IDENTITY, owner, CornerUv::Weights);
        let seen: Vec<(f32, [f32; 2])> = merged
            .indices
            .iter()
            .map(|&index| {
                let corner = merged.vertices[index as usize].corner;
                (corner.position[0], corner.uv)
            })
            .collect();
        let weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let expected: Vec<(f32, [f32; 2])> =
            [0.0, 1.0, 2.0, 1.0, 3.0, 2.0].into_iter().zip(weights.into_iter().cycle()).collect();
        assert_eq!(seen, expected);
    }
}
