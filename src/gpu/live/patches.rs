//! The ground and its draped features on the device, patch by patch.
//!
//! A patch's vertices are stored once; its index list of 16 bits an index and what lies on it are stored anew when they
//! change, and nothing else is ever sent.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use bytemuck::cast_slice;
use glam::{Mat4, Vec3};

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::geometry::{CornerUv, MergedTriangles};
use crate::live::arena::{Arena, StoredRange};
use crate::live::ground_calls::{GroundCall, GroundCalls};
use crate::live::{LiveStatistics, UploadedBytes};
use crate::materials::{ArrayId, TexturePlaces};
use crate::merged_vertex::SurfaceOwner;
use crate::parts::ShaderParts;
use crate::passes::ScenePass;
use crate::pipeline_key::{DepthRule, PipelineKey, VertexSource};
use sandtable_draw::list::{DrawList, DrawListError, MaterialId};
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource};
use sandtable_draw::patches::{
    DrapedPiece, GroundChanges, PatchDrapes, PatchId, PatchTriangles, PatchVertices,
};
use sandtable_view::camera::Camera;

/// All patches.
#[derive(Debug)]
pub struct PatchStore {
    patches: BTreeMap<PatchId, StoredPatch>,
    positions: Arena,
    triangles: Arena,
    drapes: Arena,
    drape_indices: Arena,
    /// What the device reads of the calls of the ground.
    call_arguments: Option<wgpu::Buffer>,
    /// How each material of the list is draped.
    materials: Vec<DrapeMaterial>,
}

#[derive(Debug, Default)]
struct StoredPatch {
    positions: Option<StoredRange>,
    /// The middle of its bounds.
    center: Vec3,
    /// What it shows; `None` while it is hidden.
    triangles: Option<StoredTriangles>,
    drapes: Option<StoredDrapes>,
}

#[derive(Debug)]
struct StoredTriangles {
    indices: StoredRange,
    count: u32,
    /// As they were handed over, for their edges.
    handed: Arc<Vec<[u16; 3]>>,
    /// Their edges and how many indices these have, from when they are first shown.
    lines: Option<(StoredRange, u32)>,
}

#[derive(Debug)]
struct StoredDrapes {
    vertices: StoredRange,
    indices: StoredRange,
    calls: Vec<DrapeCall>,
}

/// Pieces that one call draws, in their order.
#[derive(Clone, Debug, PartialEq, Eq)]
struct DrapeCall {
    indices: Range<u32>,
    material: DrapeMaterial,
}

/// What pieces must share to be drawn by one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct DrapeMaterial {
    array: ArrayId,
    two_sided: bool,
    masked: bool,
    parts: ShaderParts,
}

impl DrapeMaterial {
    fn key(self, picture: ShaderParts) -> PipelineKey {
        PipelineKey {
            source: VertexSource::Merged,
            rule: DepthRule::Drape,
            two_sided: self.two_sided,
            masked: self.masked,
            textured: self.array != ArrayId::NONE,
            parts: self.parts.in_picture(picture),
        }
    }

    /// What draws both, where anything does.
    fn joined(self, next: Self) -> Option<Self> {
        let array = self.array.max(next.array);
        let shares_array = [self.array, next.array].iter().all(|&own| own == array || own == ArrayId::NONE);
        let is_alike = (self.two_sided, self.masked, self.parts) == (next.two_sided, next.masked, next.parts);
        (shares_array && is_alike).then_some(Self { array, ..self })
    }
}

impl PatchStore {
    /// No patches, of a scene with the materials of `list`.
    pub fn new(list: &DrawList, places: &TexturePlaces) -> Self {
        // All that lies on the ground in its light has the parts that any of it needs: one pipeline, made before anything
        // is drawn.
        let is_ribbon = |material: &Material| {
            material.normals == NormalSource::Ground && material.albedo == Albedo::Surface
        };
        let parts =
            list.materials.iter().filter(|material| is_ribbon(material)).map(ShaderParts::of_material);
        let ribbons = parts.fold(ShaderParts::NONE, ShaderParts::with);
        let material = |(index, material): (usize, &Material)| DrapeMaterial {
            array: places.array_of(MaterialId(index as u32)),
            two_sided: material.two_sided,
            masked: matches!(material.alpha, AlphaMode::Mask(_)),
            parts: if is_ribbon(material) { ribbons } else { ShaderParts::of_material(material) },
        };
        let (vertices, indices) = (wgpu::BufferUsages::VERTEX, wgpu::BufferUsages::INDEX);
        Self {
            patches: BTreeMap::new(),
            positions: Arena::new("vertices of the ground", vertices),
            triangles: Arena::new("triangles of the ground", indices),
            drapes: Arena::new("what lies on the ground", vertices),
            drape_indices: Arena::new("triangles of what lies on the ground", indices),
            call_arguments: None,
            materials: list.materials.iter().enumerate().map(material).collect(),
        }
    }

    /// Takes over the materials of another list, in which the stored features have the same material numbers.
    pub fn adopt_materials(&mut self, other: Self) {
        self.materials = other.materials;
    }

    /// The keys that drapes are drawn with in a picture that has the parts `picture`.
    pub fn keys(&self, picture: ShaderParts) -> impl Iterator<Item = PipelineKey> + '_ {
        let untextured =
            self.materials.iter().map(|&material| DrapeMaterial { array: ArrayId::NONE, ..material });
        let drapes = self.materials.iter().copied().chain(untextured);
        drapes.map(move |material| material.key(picture))
    }

    /// Applies changes; returns the bytes sent for them.
    pub fn update(&mut self, gpu: &Gpu, changes: &GroundChanges) -> Result<UploadedBytes, GpuError> {
        let mut sent = UploadedBytes::default();
        for id in &changes.dropped {
            if let Some(patch) = self.patches.remove(id) {
                self.release(patch);
            }
        }
        for id in &changes.hidden {
            let shown = self.patches.get_mut(id).and_then(|patch| patch.triangles.take());
            shown.into_iter().for_each(|shown| release_triangles(&mut self.triangles, shown));
        }
        for vertices in &changes.vertices {
            sent.vertices += self.store_vertices(gpu, vertices)?;
        }
        for triangles in &changes.triangles {
            sent.triangles += self.store_triangles(gpu, triangles)?;
        }
        for drapes in &changes.drapes {
            sent.drapes += self.store_drapes(gpu, drapes)?;
        }
        Ok(sent)
    }

    /// The patches shown, the nearest first: what they hide is not shaded.
    pub fn shown(&self, camera: &Camera) -> Vec<PatchId> {
        let depth_m = |center: Vec3| (center - camera.eye()).dot(camera.forward());
        let shown = self.patches.iter().filter(|(_, patch)| patch.triangles.is_some());
        let mut order: Vec<(f32, PatchId)> = shown.map(|(&id, patch)| (depth_m(patch.center), id)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.into_iter().map(|(_, id)| id).collect()
    }

    /// The ground of patches, to be drawn before the next submission.
    pub fn ground_calls(&mut self, gpu: &Gpu, shown: &[PatchId]) -> Result<GroundCalls, GpuError> {
        let call = |patch: &StoredPatch| {
            let (vertices, triangles) = (patch.positions.clone()?, patch.triangles.as_ref()?);
            Some(GroundCall { vertices, indices: triangles.indices.clone(), triangles: triangles.count })
        };
        let calls = shown.iter().filter_map(|id| call(self.patches.get(id)?)).collect();
        GroundCalls::new(gpu, calls, &mut self.call_arguments)
    }

    /// Draws the ground of patches.
    pub fn draw_ground(
        &self,
        pass: &mut ScenePass<'_, '_>,
        calls: &GroundCalls,
        key: PipelineKey,
    ) -> LiveStatistics {
        match pass.set(key, ArrayId::NONE) {
            true => calls.draw(&mut pass.pass, &self.positions, &self.triangles),
            false => LiveStatistics::default(),
        }
    }

    /// Sends the edges of patches that have none yet.
    pub fn store_lines(&mut self, gpu: &Gpu, shown: &[PatchId]) -> Result<(), GpuError> {
        for id in shown {
            let triangles = self.patches.get_mut(id).and_then(|patch| patch.triangles.as_mut());
            let Some(triangles) = triangles.filter(|triangles| triangles.lines.is_none()) else { continue };
            let lines = edges(&triangles.handed);
            let stored = self.triangles.store(gpu, cast_slice(&lines))?;
            triangles.lines = Some((stored, lines.len() as u32 * 2));
        }
        Ok(())
    }

    /// Draws the edges of patches.
    pub fn draw_lines(&self, pass: &mut ScenePass<'_, '_>, shown: &[PatchId]) -> LiveStatistics {
        let mut drawn = LiveStatistics::default();
        if !pass.set(PipelineKey::PATCH_LINES, ArrayId::NONE) {
            return drawn;
        }
        for patch in shown.iter().filter_map(|id| self.patches.get(id)) {
            let lines = patch.triangles.as_ref().and_then(|triangles| triangles.lines.as_ref());
            let (Some(positions), Some((lines, count))) = (&patch.positions, lines) else { continue };
            let slices = self.positions.slice(positions).zip(self.triangles.slice(lines));
            let Some((vertices, indices)) = slices else { continue };
            pass.pass.set_vertex_buffer(0, vertices);
            pass.pass.set_index_buffer(indices, wgpu::IndexFormat::Uint16);
            pass.pass.draw_indexed(0..*count, 0, 0..1);
            drawn.calls += 1;
        }
        drawn
    }

    /// Draws the draped features of patches.
    pub fn draw_drapes(
        &self,
        pass: &mut ScenePass<'_, '_>,
        shown: &[PatchId],
        picture: ShaderParts,
    ) -> LiveStatistics {
        let mut drawn = LiveStatistics::default();
        for drapes in shown.iter().filter_map(|id| self.patches.get(id)?.drapes.as_ref()) {
            let Some((vertices, indices)) =
                self.drapes.slice(&drapes.vertices).zip(self.drape_indices.slice(&drapes.indices))
            else {
                continue;
            };
            pass.pass.set_vertex_buffer(0, vertices);
            pass.pass.set_index_buffer(indices, wgpu::IndexFormat::Uint32);
            for call in &drapes.calls {
                if pass.set(call.material.key(picture), call.material.array) {
                    pass.pass.draw_indexed(call.indices.clone(), 0, 0..1);
                    drawn.count(call.indices.len() as u32 / 3);
                }
            }
        }
        drawn
    }

    fn release(&mut self, patch: StoredPatch) {
        patch.positions.into_iter().for_each(|range| self.positions.release(range));
        patch.triangles.into_iter().for_each(|shown| release_triangles(&mut self.triangles, shown));
        patch.drapes.into_iter().for_each(|drapes| self.release_drapes(drapes));
    }

    fn release_drapes(&mut self, drapes: StoredDrapes) {
        self.drapes.release(drapes.vertices);
        self.drape_indices.release(drapes.indices);
    }

    fn store_vertices(&mut self, gpu: &Gpu, new: &PatchVertices) -> Result<u64, GpuError> {
        let patch = self.patches.entry(new.patch).or_default();
        patch.positions.take().into_iter().for_each(|old| self.positions.release(old));
        let corners = || new.positions.iter().map(|&at| Vec3::from(at));
        let low = corners().fold(Vec3::INFINITY, Vec3::min);
        patch.center = (low + corners().fold(Vec3::NEG_INFINITY, Vec3::max)) * 0.5;
        if new.positions.is_empty() {
            return Ok(0);
        }
        let bytes = cast_slice(&new.positions);
        patch.positions = Some(self.positions.store(gpu, bytes)?);
        Ok(bytes.len() as u64)
    }

    fn store_triangles(&mut self, gpu: &Gpu, new: &PatchTriangles) -> Result<u64, GpuError> {
        let patch = self.patches.entry(new.patch).or_default();
        patch.triangles.take().into_iter().for_each(|old| release_triangles(&mut self.triangles, old));
        if new.triangles.is_empty() {
            return Ok(0);
        }
        let bytes = cast_slice(&new.triangles);
        let indices = self.triangles.store(gpu, bytes)?;
        let (count, handed) = (new.triangles.len() as u32, Arc::clone(&new.triangles));
        patch.triangles = Some(StoredTriangles { indices, count, handed, lines: None });
        Ok(bytes.len() as u64)
    }

    fn store_drapes(&mut self, gpu: &Gpu, new: &PatchDrapes) -> Result<u64, GpuError> {
        let old = self.patches.get_mut(&new.patch).and_then(|patch| patch.drapes.take());
        old.into_iter().for_each(|old| self.release_drapes(old));
        let (merged, calls) = self.merged(&new.pieces)?;
        if merged.indices.is_empty() {
            return Ok(0);
        }
        let [vertices, indices]: [&[u8]; 2] = [cast_slice(&merged.vertices), cast_slice(&merged.indices)];
        let stored = StoredDrapes {
            vertices: self.drapes.store(gpu, vertices)?,
            indices: self.drape_indices.store(gpu, indices)?,
            calls,
        };
        self.patches.entry(new.patch).or_default().drapes = Some(stored);
        Ok((vertices.len() + indices.len()) as u64)
    }

    /// Pieces as one mesh, and what of it each call draws.
    fn merged(&self, pieces: &[DrapedPiece]) -> Result<(MergedTriangles, Vec<DrapeCall>), GpuError> {
        let mut merged = MergedTriangles::default();
        let mut calls: Vec<DrapeCall> = Vec::new();
        for (index, piece) in pieces.iter().enumerate() {
            let material = self.materials.get(piece.material.0 as usize).copied();
            let material = material.ok_or(DrawListError::MissingMaterial(index))?;
            let owner = SurfaceOwner { feature: piece.feature, material: piece.material.into() };
            let start = merged.indices.len() as u32;
            let triangles = 0..piece.mesh.triangles.len() as u32;
            merged.add(&piece.mesh, triangles, &Mat4::IDENTITY, owner, CornerUv::Own);
            let indices = start..merged.indices.len() as u32;
            let joined = calls.last().and_then(|last| last.material.joined(material));
            match (calls.last_mut(), joined) {
                (Some(last), Some(material)) => {
                    *last = DrapeCall { indices: last.indices.start..indices.end, material };
                }
                _ => calls.push(DrapeCall { indices, material }),
            }
        }
        Ok((merged, calls))
    }
}

fn release_triangles(arena: &mut Arena, triangles: StoredTriangles) {
    arena.release(triangles.indices);
    triangles.lines.into_iter().for_each(|(lines, _)| arena.release(lines));
}

/// The edges of triangles, each once.
fn edges(triangles: &[[u16; 3]]) -> Vec<[u16; 2]> {
    let sides =
        |&[a, b, c]: &[u16; 3]| [[a, b], [b, c], [c, a]].map(|[from, to]| [from.min(to), from.max(to)]);
    let mut edges: Vec<[u16; 2]> = triangles.iter().flat_map(sides).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_that_triangles_share_is_one_line() {
        assert_eq!(edges(&[[0, 1, 2], [2, 1, 3]]), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
    }
}
