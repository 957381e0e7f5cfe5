//! The ground and its draped features on the device, patch by patch.
//!
//! A patch's vertices are stored once; its index list of 16 bits an index is stored anew when it changes, and so are those
//! chunks of what lies on it that changed (`drapes`); nothing else is ever sent.

use std::collections::BTreeMap;
use std::sync::Arc;

use bytemuck::cast_slice;
use glam::Vec3;

use crate::buffer_writes::BufferWrites;
use crate::draped_vertex::DrapedVertex;
use crate::error::GpuError;
use crate::live::arena::{Arena, StoredRange};
use crate::live::drapes::{DrapeArenas, DrapeMaterial, DrapeMaterials, DrapeView, StoredDrapes};
use crate::live::patch_calls::{CallSource, PatchCall, PatchCalls};
use crate::live::{LiveStatistics, UploadedBytes};
use crate::materials::{ArrayId, TexturePlaces};
use crate::parts::ShaderParts;
use crate::passes::ScenePass;
use crate::pipeline_key::PipelineKey;
use sandtable_draw::list::DrawList;
use sandtable_draw::patches::{GroundChanges, PatchDrapes, PatchId, PatchTriangles, PatchVertices};
use sandtable_view::camera::Camera;

/// All patches.
#[derive(Debug)]
pub struct PatchStore {
    patches: BTreeMap<PatchId, StoredPatch>,
    positions: Arena,
    triangles: Arena,
    drapes: DrapeArenas,
    /// What the device reads of the calls of the ground, and of those of what lies on it.
    call_arguments: [Option<wgpu::Buffer>; 2],
    /// How each material of the list is draped.
    materials: DrapeMaterials,
}

/// The calls of patches that are shown.
#[derive(Debug)]
pub struct ShownCalls {
    /// Their ground, in their order.
    ground: PatchCalls<()>,
    /// Their draped features: the first ones of all patches, the second ones, and so on.
    drapes: PatchCalls<DrapeMaterial>,
}

#[derive(Debug, Default)]
struct StoredPatch {
    positions: Option<StoredRange>,
    /// The middle of its bounds.
    center: Vec3,
    /// What it shows; `None` while it is hidden.
    triangles: Option<StoredTriangles>,
    drapes: StoredDrapes,
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

impl PatchStore {
    /// No patches, of a scene with the materials of `list`.
    pub fn new(list: &DrawList, places: &TexturePlaces) -> Self {
        let (vertices, indices) = (wgpu::BufferUsages::VERTEX, wgpu::BufferUsages::INDEX);
        Self {
            patches: BTreeMap::new(),
            positions: Arena::new("vertices of the ground", vertices),
            triangles: Arena::new("triangles of the ground", indices),
            drapes: DrapeArenas::new(),
            call_arguments: [None, None],
            materials: DrapeMaterials::new(list, places),
        }
    }

    /// Takes over the materials of another list, in which the stored features have the same material numbers.
    pub fn adopt_materials(&mut self, other: Self) {
        self.materials = other.materials;
    }

    /// The keys that drapes are drawn with in a picture that has the parts `picture`.
    pub fn keys(&self, picture: ShaderParts) -> impl Iterator<Item = PipelineKey> + '_ {
        self.materials.keys(picture)
    }

    /// Applies changes; returns the bytes sent for them.
    pub fn update(
        &mut self,
        writes: &mut BufferWrites<'_>,
        changes: &GroundChanges,
    ) -> Result<UploadedBytes, GpuError> {
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
            sent.vertices += self.store_vertices(writes, vertices)?;
        }
        for triangles in &changes.triangles {
            sent.triangles += self.store_triangles(writes, triangles)?;
        }
        for drapes in &changes.drapes {
            sent.drapes += self.store_drapes(writes, drapes)?;
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

    /// What patches show in a view, to be drawn before the next submission.
    pub fn calls(
        &mut self,
        writes: &mut BufferWrites<'_>,
        shown: &[PatchId],
        view: &DrapeView,
    ) -> Result<ShownCalls, GpuError> {
        let patches = || shown.iter().filter_map(|id| self.patches.get(id));
        let ground = |patch: &StoredPatch| {
            let (vertices, triangles) = (patch.positions.clone()?, patch.triangles.as_ref()?);
            let indices = triangles.indices.clone();
            Some(((), PatchCall { vertices, indices, drawn: 0..triangles.count * 3 }))
        };
        let ground: Vec<((), PatchCall)> = patches().filter_map(ground).collect();
        // What lies on one patch does not lie on another: the order of the features of each counts, not that of patches.
        let mut drapes: Vec<(usize, DrapeMaterial, PatchCall)> =
            patches().flat_map(|patch| patch.drapes.calls(view)).collect();
        drapes.sort_by_key(|(place, material, call)| (*place, *material, call.blocks()));
        let drapes = drapes.into_iter().map(|(_, material, call)| (material, call));
        let [mut of_ground, mut of_drapes] = std::mem::take(&mut self.call_arguments);
        let calls = ShownCalls {
            ground: PatchCalls::new(writes, &self.ground_source(), ground, &mut of_ground)?,
            drapes: PatchCalls::new(writes, &self.drape_source(), drapes, &mut of_drapes)?,
        };
        self.call_arguments = [of_ground, of_drapes];
        Ok(calls)
    }

    /// Draws the ground of patches.
    pub fn draw_ground(
        &self,
        pass: &mut ScenePass<'_, '_>,
        calls: &ShownCalls,
        key: PipelineKey,
    ) -> LiveStatistics {
        let source = self.ground_source();
        let drawn = calls.ground.draw(pass, &source, |pass, ()| pass.set(key, ArrayId::NONE));
        LiveStatistics { patches: calls.ground.count() as u32, ..drawn }
    }

    /// Draws the draped features of patches, in a picture that has the parts `picture`.
    pub fn draw_drapes(
        &self,
        pass: &mut ScenePass<'_, '_>,
        calls: &ShownCalls,
        picture: ShaderParts,
    ) -> LiveStatistics {
        let set = |pass: &mut ScenePass<'_, '_>, material: DrapeMaterial| {
            pass.set(material.key(picture), material.array)
        };
        calls.drapes.draw(pass, &self.drape_source(), set)
    }

    fn ground_source(&self) -> CallSource<'_> {
        CallSource {
            vertices: &self.positions,
            indices: &self.triangles,
            vertex_bytes: size_of::<[f32; 3]>() as u64,
            format: wgpu::IndexFormat::Uint16,
        }
    }

    fn drape_source(&self) -> CallSource<'_> {
        CallSource {
            vertices: &self.drapes.vertices,
            indices: &self.drapes.indices,
            vertex_bytes: size_of::<DrapedVertex>() as u64,
            format: wgpu::IndexFormat::Uint32,
        }
    }

    /// Sends the edges of patches that have none yet.
    pub fn store_lines(&mut self, writes: &mut BufferWrites<'_>, shown: &[PatchId]) -> Result<(), GpuError> {
        for id in shown {
            let triangles = self.patches.get_mut(id).and_then(|patch| patch.triangles.as_mut());
            let Some(triangles) = triangles.filter(|triangles| triangles.lines.is_none()) else { continue };
            let lines = edges(&triangles.handed);
            let stored = self.triangles.store(writes, cast_slice(&lines))?;
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

    fn release(&mut self, patch: StoredPatch) {
        patch.positions.into_iter().for_each(|range| self.positions.release(range));
        patch.triangles.into_iter().for_each(|shown| release_triangles(&mut self.triangles, shown));
        self.drapes.release(patch.drapes);
    }

    fn store_vertices(
        &mut self,
        writes: &mut BufferWrites<'_>,
        new: &PatchVertices,
    ) -> Result<u64, GpuError> {
        let patch = self.patches.entry(new.patch).or_default();
        patch.positions.take().into_iter().for_each(|old| self.positions.release(old));
        let corners = || new.positions.iter().map(|&at| Vec3::from(at));
        let low = corners().fold(Vec3::INFINITY, Vec3::min);
        patch.center = (low + corners().fold(Vec3::NEG_INFINITY, Vec3::max)) * 0.5;
        if new.positions.is_empty() {
            return Ok(0);
        }
        let bytes = cast_slice(&new.positions);
        patch.positions = Some(self.positions.store(writes, bytes)?);
        Ok(bytes.len() as u64)
    }

    fn store_triangles(
        &mut self,
        writes: &mut BufferWrites<'_>,
        new: &PatchTriangles,
    ) -> Result<u64, GpuError> {
        let patch = self.patches.entry(new.patch).or_default();
        patch.triangles.take().into_iter().for_each(|old| release_triangles(&mut self.triangles, old));
        if new.triangles.is_empty() {
            return Ok(0);
        }
        let bytes = cast_slice(&new.triangles);
        let indices = self.triangles.store(writes, bytes)?;
        let (count, handed) = (new.triangles.len() as u32, Arc::clone(&new.triangles));
        patch.triangles = Some(StoredTriangles { indices, count, handed, lines: None });
        Ok(bytes.len() as u64)
    }

    fn store_drapes(&mut self, writes: &mut BufferWrites<'_>, new: &PatchDrapes) -> Result<u64, GpuError> {
        let materials = self.materials.of(&new.pieces)?;
        let drapes = &mut self.patches.entry(new.patch).or_default().drapes;
        let (stored, sent) = self.drapes.store(writes, std::mem::take(drapes), (&new.pieces, &materials))?;
        *drapes = stored;
        Ok(sent)
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
