//! Meshes and instances on the device. Only what items use is sent.

use std::collections::HashMap;
use std::ops::Range;

use bytemuck::{Pod, Zeroable, cast_slice};
use glam::{Mat4, Vec3};

use crate::draw::list::{DrawList, DrawMesh, DrawVertex, FeatureId};
use crate::mesh::sink::VertexId;
use crate::render::gpu::error::GpuError;
use crate::render::gpu::materials::MaterialRow;
use crate::render::gpu::memory::Loader;
use crate::render::gpu::plan::{DrawShape, Plan};
use crate::render::gpu::uniforms::Instance;

/// A corner in world space: `Corner` and `Owner` in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MergedVertex {
    pub corner: DrawVertex,
    pub owner: SurfaceOwner,
}

/// Whose a corner is: `Owner` in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SurfaceOwner {
    pub feature: FeatureId,
    pub material: MaterialRow,
}

/// Triangles of many items.
#[derive(Debug, Default, PartialEq)]
pub struct MergedMesh {
    pub vertices: Vec<MergedVertex>,
    pub indices: Vec<u32>,
}

#[derive(Debug)]
pub struct MeshBuffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
}

/// The geometry of a plan.
#[derive(Debug)]
pub struct Geometry {
    merged: Vec<MeshBuffers>,
    /// One per mesh; `None` for one that no instance places.
    placed: Vec<Option<MeshBuffers>>,
    instances: wgpu::Buffer,
}

impl MergedMesh {
    /// Adds a range of the triangles of `mesh` with the vertices that they use.
    pub fn add(
        &mut self,
        mesh: &DrawMesh,
        triangles: Range<u32>,
        world_from_mesh: &Mat4,
        owner: SurfaceOwner,
    ) {
        let is_moved = *world_from_mesh != Mat4::IDENTITY;
        let mut known = KnownVertices::new(mesh.vertices.len(), triangles.len() * 3);
        for id in mesh.triangles[triangles.start as usize..triangles.end as usize].iter().flatten() {
            let index = known.of(*id, || {
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

impl Geometry {
    /// Sends what `plan` draws of a checked list.
    pub fn upload(loader: &Loader<'_>, list: &DrawList, plan: &Plan) -> Result<Self, GpuError> {
        let merged = plan.merged.chunk_by(|a, b| a.chunk == b.chunk).map(|parts| {
            let mut merged = MergedMesh::default();
            for part in parts {
                let item = &list.items[part.item];
                let owner = SurfaceOwner { feature: item.feature, material: item.material.into() };
                let mesh = &list.meshes[item.mesh.0 as usize];
                merged.add(mesh, part.triangles.clone(), &item.world_from_mesh, owner);
            }
            let what = || format!("{} triangles", merged.indices.len() / 3);
            MeshBuffers::upload(loader, what, cast_slice(&merged.vertices), cast_slice(&merged.indices))
        });
        let merged = merged.collect::<Result<_, _>>()?;
        let mut is_placed = vec![false; list.meshes.len()];
        plan.placed.iter().for_each(|&item| is_placed[list.items[item].mesh.0 as usize] = true);
        let placed = list.meshes.iter().zip(is_placed).enumerate().map(|(index, (mesh, is_placed))| {
            let upload = || {
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
    loader.filled_buffer(what, wgpu::BufferUsages::VERTEX, cast_slice(&instances))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::color::Srgba;
    use crate::draw::list::MaterialId;
    use crate::mesh::sink::MeshSink;

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
        let mut merged = MergedMesh::default();
        merged.add(&mesh, 0..1, &Mat4::IDENTITY, owner);
        merged.add(&mesh, 1..2, &turned, owner);
        assert_eq!(merged.indices, [0, 1, 2, 3, 4, 3]);
        assert_eq!(merged.vertices.len(), 5);
        let last = merged.vertices[3];
        assert!(Vec3::from(last.corner.position).abs_diff_eq(Vec3::new(0.0, 4.0, 7.0), 1e-5));
        assert!(Vec3::from(last.corner.normal).abs_diff_eq(Vec3::Y, 1e-6));
        assert_eq!(last.owner, owner);
    }
}
