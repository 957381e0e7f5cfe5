//! What lies on a patch, in chunks that are sent anew only where their pieces changed.
//!
//! ```text
//!   before   a b c │ d e │ f        pieces in drawing order, in chunks that one call draws
//!   now      a b c │ d e'│ f        a chunk whose pieces are all those of before stays on the device
//!   sent             d e'
//! ```
//!
//! A frame draws those pieces of a chunk that it sees. One that moves with few pixels leaves out those narrower than a part of a
//! pixel, too: brooks far away, of which its samples miss the most.
//!
//! A piece is known by the memory of its mesh, which its maker shares as long as it is not cut again. Where pieces come or go,
//! chunks are matched by their first pieces, so that those behind stay too.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Weak};

use bytemuck::cast_slice;

use glam::Vec3;

use crate::buffer_writes::BufferWrites;
use crate::culling::{CullingView, ItemGroup};
use crate::draped_vertex::DrapedMesh;
use crate::error::GpuError;
use crate::live::arena::{Arena, StoredRange};
use crate::live::patch_calls::PatchCall;
use crate::materials::{ArrayId, TexturePlaces};
use crate::merged_vertex::MaterialRow;
use crate::parts::ShaderParts;
use crate::pipeline_key::{DepthRule, PipelineKey, VertexSource};
use sandtable_draw::list::{DrawList, DrawListError, DrawMesh, MaterialId};
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource};
use sandtable_draw::patches::DrapedPiece;
use sandtable_geom::aabb::Aabb;
use sandtable_mesh::sink::VertexId;

/// The vertices up to which pieces share a chunk: more make fewer calls, and send more for each piece that changed.
const CHUNK_VERTICES: usize = 1024;

/// The most indices of pieces that are not seen which a call draws between those that are: they cost a device less than
/// another call does.
const HIDDEN_INDICES: u32 = 96;

/// What pieces must share to be drawn by one call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct DrapeMaterial {
    pub array: ArrayId,
    two_sided: bool,
    masked: bool,
    parts: ShaderParts,
}

/// The draped features of a patch, in drawing order.
#[derive(Debug, Default)]
pub struct StoredDrapes {
    pub chunks: Vec<DrapeChunk>,
}

/// Pieces that one call draws, in their order.
#[derive(Debug)]
pub struct DrapeChunk {
    pieces: Vec<ChunkPiece>,
    pub material: DrapeMaterial,
    pub vertices: StoredRange,
    pub indices: StoredRange,
}

/// A piece as it was handed over.
#[derive(Debug)]
struct ChunkPiece {
    mesh: Weak<DrawMesh>,
    material: MaterialId,
    place: PiecePlace,
    /// The end of its indices in the chunk.
    end: u32,
}

/// The place of a piece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct PiecePlace {
    bounds: Aabb,
    /// Its mean width, meters: that of a ribbon as long as its box.
    width_m: f32,
}

/// The pieces that a frame draws.
#[derive(Clone, Copy, Debug)]
pub struct DrapeView {
    pub view: CullingView,
    /// Whether those are left out that are narrower than a part of a pixel.
    pub leaves_narrow: bool,
}

/// The arenas of what lies on the ground.
#[derive(Debug)]
pub struct DrapeArenas {
    pub vertices: Arena,
    pub indices: Arena,
}

/// A chunk of the pieces that are handed over.
enum PlannedChunk {
    Kept(DrapeChunk),
    Sent(DrapeMaterial, Range<usize>),
}

/// How each material of a list is draped.
#[derive(Debug)]
pub struct DrapeMaterials(Vec<DrapeMaterial>);

impl DrapeMaterial {
    pub fn key(self, picture: ShaderParts) -> PipelineKey {
        PipelineKey {
            source: VertexSource::Draped,
            rule: DepthRule::Drape,
            two_sided: self.two_sided,
            masked: self.masked,
            textured: self.array != ArrayId::NONE,
            parts: self.parts.in_picture(picture),
        }
    }

    /// What draws both, where anything does.
    pub fn joined(self, next: Self) -> Option<Self> {
        let array = self.array.max(next.array);
        let shares_array = [self.array, next.array].iter().all(|&own| own == array || own == ArrayId::NONE);
        let is_alike = (self.two_sided, self.masked, self.parts) == (next.two_sided, next.masked, next.parts);
        (shares_array && is_alike).then_some(Self { array, ..self })
    }
}

impl DrapeMaterials {
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
        Self(list.materials.iter().enumerate().map(material).collect())
    }

    /// The keys that drapes are drawn with in a picture that has the parts `picture`.
    pub fn keys(&self, picture: ShaderParts) -> impl Iterator<Item = PipelineKey> + '_ {
        let untextured = self.0.iter().map(|&material| DrapeMaterial { array: ArrayId::NONE, ..material });
        self.0.iter().copied().chain(untextured).map(move |material| material.key(picture))
    }

    /// The material of each piece.
    ///
    /// # Errors
    /// [`DrawListError::MissingMaterial`] where there is none.
    pub fn of(&self, pieces: &[DrapedPiece]) -> Result<Vec<DrapeMaterial>, DrawListError> {
        let of_piece = |(index, piece): (usize, &DrapedPiece)| {
            let material = self.0.get(piece.material.0 as usize).copied();
            material.ok_or(DrawListError::MissingMaterial(index))
        };
        pieces.iter().enumerate().map(of_piece).collect()
    }
}

/// What draws all of some pieces; `None` where nothing does.
fn joined(materials: &[DrapeMaterial]) -> Option<DrapeMaterial> {
    let (&first, rest) = materials.split_first()?;
    rest.iter().try_fold(first, |all, &next| all.joined(next))
}

impl PiecePlace {
    fn of(mesh: &DrawMesh) -> Self {
        let corners = mesh.triangles.iter().flatten();
        let at = |id: &VertexId| Vec3::from(mesh.vertices[id.index()].position);
        let bounds = Aabb::around(corners.map(at)).unwrap_or_default();
        let twice_area = |[a, b, c]: &[VertexId; 3]| (at(b) - at(a)).cross(at(c) - at(a)).length();
        let area = 0.5 * mesh.triangles.iter().map(twice_area).sum::<f32>();
        // Of what is not finite, or has no length, nothing is left out.
        Self { bounds, width_m: area / bounds.size().length() }
    }
}

impl DrapeView {
    fn shows(&self, PiecePlace { bounds, width_m }: PiecePlace) -> bool {
        match self.leaves_narrow {
            true => self.view.shows(&ItemGroup { bounds, largest_m: width_m }),
            false => self.view.reaches(&bounds),
        }
    }
}

impl DrapeChunk {
    /// The indices of the pieces that a view shows, in order.
    fn seen(&self, view: &DrapeView) -> Vec<Range<u32>> {
        let mut seen: Vec<Range<u32>> = Vec::new();
        let mut start = 0;
        for piece in &self.pieces {
            let indices = start..piece.end;
            start = piece.end;
            if indices.is_empty() || !view.shows(piece.place) {
                continue;
            }
            match seen.last_mut() {
                Some(last) if indices.start - last.end <= HIDDEN_INDICES => last.end = indices.end,
                _ => seen.push(indices),
            }
        }
        seen
    }
}

impl StoredDrapes {
    /// The calls that draw what `view` shows of them, each with its place in their order and with what it is drawn with; calls of
    /// the same place are drawn alike.
    pub fn calls<'a>(
        &'a self,
        view: &'a DrapeView,
    ) -> impl Iterator<Item = (usize, DrapeMaterial, PatchCall)> + 'a {
        let mut runs: Vec<(DrapeMaterial, Range<usize>)> = Vec::new();
        for (index, chunk) in self.chunks.iter().enumerate() {
            match runs.last_mut().and_then(|run| Some((run.0.joined(chunk.material)?, run))) {
                Some((material, run)) => *run = (material, run.1.start..index + 1),
                None => runs.push((chunk.material, index..index + 1)),
            }
        }
        runs.into_iter().enumerate().flat_map(move |(place, (material, run))| {
            self.chunks[run].iter().flat_map(move |chunk| {
                chunk.seen(view).into_iter().map(move |drawn| {
                    let (vertices, indices) = (chunk.vertices.clone(), chunk.indices.clone());
                    (place, material, PatchCall { vertices, indices, drawn })
                })
            })
        })
    }
}

impl DrapeArenas {
    pub fn new() -> Self {
        Self {
            vertices: Arena::new("what lies on the ground", wgpu::BufferUsages::VERTEX),
            indices: Arena::new("triangles of what lies on the ground", wgpu::BufferUsages::INDEX),
        }
    }

    pub fn release(&mut self, drapes: StoredDrapes) {
        drapes.chunks.into_iter().for_each(|chunk| self.release_chunk(chunk));
    }

    /// Stores what lies on a patch, `pieces` of these `materials`, in place of what lay there; returns it and the bytes sent.
    pub fn store(
        &mut self,
        writes: &mut BufferWrites<'_>,
        before: StoredDrapes,
        (pieces, materials): (&[DrapedPiece], &[DrapeMaterial]),
    ) -> Result<(StoredDrapes, u64), GpuError> {
        let (planned, left) = plan(before, pieces, materials);
        self.release(left);
        let (mut drapes, mut sent) = (StoredDrapes::default(), 0);
        for chunk in planned {
            match chunk {
                PlannedChunk::Kept(chunk) => drapes.chunks.push(chunk),
                PlannedChunk::Sent(material, range) => {
                    let (chunk, bytes) = self.send(writes, material, &pieces[range])?;
                    sent += bytes;
                    drapes.chunks.extend(chunk);
                }
            }
        }
        Ok((drapes, sent))
    }

    /// Sends pieces as one mesh; `None` where they have no triangles.
    fn send(
        &mut self,
        writes: &mut BufferWrites<'_>,
        material: DrapeMaterial,
        pieces: &[DrapedPiece],
    ) -> Result<(Option<DrapeChunk>, u64), GpuError> {
        let corners = pieces.iter().map(|piece| piece.mesh.triangles.len() * 3).sum();
        let mut merged = DrapedMesh::with_corners(corners);
        let mut held = Vec::with_capacity(pieces.len());
        for DrapedPiece { mesh, material, .. } in pieces {
            let corners = mesh.triangles.iter().flatten().map(|id| &mesh.vertices[id.index()]);
            corners.for_each(|corner| merged.add(corner, MaterialRow::from(*material)));
            held.push(ChunkPiece {
                mesh: Arc::downgrade(mesh),
                material: *material,
                place: PiecePlace::of(mesh),
                end: merged.indices.len() as u32,
            });
        }
        let DrapedMesh { vertices, indices, .. } = &merged;
        if indices.is_empty() {
            return Ok((None, 0));
        }
        let [vertex_bytes, index_bytes]: [&[u8]; 2] = [cast_slice(vertices), cast_slice(indices)];
        let chunk = DrapeChunk {
            pieces: held,
            material,
            vertices: self.vertices.store(writes, vertex_bytes)?,
            indices: self.indices.store(writes, index_bytes)?,
        };
        Ok((Some(chunk), (vertex_bytes.len() + index_bytes.len()) as u64))
    }

    fn release_chunk(&mut self, chunk: DrapeChunk) {
        self.vertices.release(chunk.vertices);
        self.indices.release(chunk.indices);
    }
}

impl DrapeChunk {
    /// Whether the first of `pieces`, which are of these `materials`, are those of this chunk.
    fn holds(&self, pieces: &[DrapedPiece], materials: &[DrapeMaterial]) -> bool {
        let is_same = |(held, piece): (&ChunkPiece, &DrapedPiece)| {
            held.mesh.as_ptr() == Arc::as_ptr(&piece.mesh) && held.material == piece.material
        };
        let count = self.pieces.len();
        count <= pieces.len()
            && self.pieces.iter().zip(pieces).all(is_same)
            && joined(&materials[..count]) == Some(self.material)
    }
}

/// The chunks of `pieces`, as many of `before` among them as hold what is handed over, and those of `before` that are left.
fn plan(
    before: StoredDrapes,
    pieces: &[DrapedPiece],
    materials: &[DrapeMaterial],
) -> (Vec<PlannedChunk>, StoredDrapes) {
    let first_of = |chunk: &DrapeChunk| chunk.pieces.first().map(|piece| piece.mesh.as_ptr());
    let places: BTreeMap<_, usize> =
        before.chunks.iter().enumerate().map(|(place, chunk)| (first_of(chunk), place)).collect();
    let mut held: Vec<Option<DrapeChunk>> = before.chunks.into_iter().map(Some).collect();
    let mut planned: Vec<PlannedChunk> = Vec::new();
    let (mut at, mut vertices) = (0, 0);
    while at < pieces.len() {
        let known = places.get(&Some(Arc::as_ptr(&pieces[at].mesh))).and_then(|&place| held.get_mut(place));
        let is_held = |chunk: &mut DrapeChunk| chunk.holds(&pieces[at..], &materials[at..]);
        if let Some(chunk) = known.and_then(|chunk| chunk.take_if(is_held)) {
            at += chunk.pieces.len();
            planned.push(PlannedChunk::Kept(chunk));
            continue;
        }
        vertices += pieces[at].mesh.vertices.len();
        let open = match planned.last_mut() {
            Some(PlannedChunk::Sent(material, range)) if vertices <= CHUNK_VERTICES => {
                material.joined(materials[at]).map(|joined| (*material, range.end) = (joined, at + 1))
            }
            _ => None,
        };
        if open.is_none() {
            vertices = pieces[at].mesh.vertices.len();
            planned.push(PlannedChunk::Sent(materials[at], at..at + 1));
        }
        at += 1;
    }
    (planned, StoredDrapes { chunks: held.into_iter().flatten().collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DepthLayer, DrawVertex, FeatureId};
    use sandtable_mesh::sink::MeshSink;
    use sandtable_view::camera::Camera;

    fn piece(vertices: usize) -> DrapedPiece {
        let mut mesh = DrawMesh::default();
        let corner = DrawVertex { position: [0.0; 3], normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE };
        for _ in 0..vertices {
            mesh.vertex(corner);
        }
        mesh.triangle([VertexId(0), VertexId(1), VertexId(2)]);
        let (material, layer, feature) = (MaterialId(0), DepthLayer::Draped(0), FeatureId::GROUND);
        DrapedPiece { mesh: Arc::new(mesh), material, layer, feature }
    }

    /// What is planned after `before`, as the pieces that are kept and those that are sent, and the number of chunks that go.
    fn planned(before: &[&[&DrapedPiece]], pieces: &[DrapedPiece]) -> (Vec<(bool, Range<usize>)>, usize) {
        let stored = || StoredRange { block: 0, bytes: 0..4 };
        let chunk = |held: &&[&DrapedPiece]| DrapeChunk {
            pieces: held
                .iter()
                .map(|piece| ChunkPiece {
                    mesh: Arc::downgrade(&piece.mesh),
                    material: piece.material,
                    place: PiecePlace::default(),
                    end: 3,
                })
                .collect(),
            material: DrapeMaterial::default(),
            vertices: stored(),
            indices: stored(),
        };
        let before = StoredDrapes { chunks: before.iter().map(chunk).collect() };
        let materials = vec![DrapeMaterial::default(); pieces.len()];
        let (chunks, left) = plan(before, pieces, &materials);
        let mut at = 0;
        let ranges = chunks.into_iter().map(|chunk| {
            let (is_kept, count) = match chunk {
                PlannedChunk::Kept(chunk) => (true, chunk.pieces.len()),
                PlannedChunk::Sent(_, range) => (false, range.len()),
            };
            at += count;
            (is_kept, at - count..at)
        });
        (ranges.collect(), left.chunks.len())
    }

    #[test]
    fn pieces_are_sent_in_chunks_of_so_many_vertices() {
        let pieces: Vec<DrapedPiece> = [400, 500, 200, 3000, 20, 30].map(piece).into();
        assert_eq!(
            planned(&[], &pieces),
            (vec![(false, 0..2), (false, 2..3), (false, 3..4), (false, 4..6)], 0)
        );
    }

    #[test]
    fn a_chunk_stays_where_its_pieces_do_whatever_comes_or_goes_before_it() {
        let [a, b, c, d, e, new] = [600, 300, 600, 300, 900, 50].map(piece);
        let before: [&[&DrapedPiece]; 3] = [&[&a, &b], &[&c, &d], &[&e]];
        let same = [a.clone(), b.clone(), c.clone(), d.clone(), e.clone()];
        assert_eq!(planned(&before, &same), (vec![(true, 0..2), (true, 2..4), (true, 4..5)], 0));
        let cut_again = [a.clone(), b.clone(), c.clone(), new.clone(), e.clone()];
        assert_eq!(planned(&before, &cut_again), (vec![(true, 0..2), (false, 2..4), (true, 4..5)], 1));
        let one_more = [new.clone(), a.clone(), b.clone(), c.clone(), d.clone(), e.clone()];
        let expected = vec![(false, 0..1), (true, 1..3), (true, 3..5), (true, 5..6)];
        assert_eq!(planned(&before, &one_more), (expected, 0));
        let one_less = [a.clone(), b.clone(), e.clone()];
        assert_eq!(planned(&before, &one_less), (vec![(true, 0..2), (true, 2..3)], 1));
    }

    #[test]
    fn a_mesh_of_another_material_is_sent_anew() {
        let a = piece(9);
        let recolored = DrapedPiece { material: MaterialId(1), ..a.clone() };
        assert_eq!(planned(&[&[&a]], &[recolored]), (vec![(false, 0..1)], 1));
    }

    #[test]
    fn memory_that_another_mesh_takes_is_not_mistaken_for_the_mesh_before() {
        let held = piece(9);
        let before = [&held];
        let chunk: &[&DrapedPiece] = &before;
        let (chunks, _) = planned(&[chunk], &[piece(9)]);
        assert_eq!(chunks, [(false, 0..1)], "equal, but cut again");
    }

    /// A chunk of ribbons 900 m long across the view of `camera`, each so far ahead, so far aside and so wide, in meters.
    fn chunk(ribbons: &[(f32, f32, f32)]) -> DrapeChunk {
        let mesh = |&(y, x, width): &(f32, f32, f32)| {
            let mut mesh = DrawMesh::default();
            for (x, y) in [(x - 450.0, y), (x + 450.0, y), (x + 450.0, y + width), (x - 450.0, y + width)] {
                let (normal, color) = ([0.0, 0.0, 1.0], Srgba::WHITE);
                mesh.vertex(DrawVertex { position: [x, y, 0.0], normal, uv: [0.0; 2], color });
            }
            // As many triangles as would not be drawn for nothing.
            for _ in 0..20 {
                mesh.triangle([0, 1, 2].map(VertexId));
                mesh.triangle([0, 2, 3].map(VertexId));
            }
            let mut place = PiecePlace::of(&mesh);
            place.width_m /= 20.0;
            place
        };
        let piece = |(number, ribbon): (u32, &(f32, f32, f32))| ChunkPiece {
            mesh: Weak::new(),
            material: MaterialId(0),
            place: mesh(ribbon),
            end: number * 120,
        };
        let stored = || StoredRange { block: 0, bytes: 0..4 };
        DrapeChunk {
            pieces: (1..).zip(ribbons).map(piece).collect(),
            material: DrapeMaterial::default(),
            vertices: stored(),
            indices: stored(),
        }
    }

    #[test]
    fn a_frame_draws_the_pieces_that_it_sees_and_one_that_moves_those_wide_enough() {
        let camera =
            Camera::new(Vec3::Z * 500.0, Vec3::new(0.0, 2000.0, 0.0), 1.0, (100, 100), (1.0, 50_000.0));
        let view = CullingView::new(&camera.expect("sound"));
        // At 5 km a pixel is 55 m wide.
        let chunk = chunk(&[
            (5000.0, 0.0, 90.0),
            (5000.0, 0.0, 9.0),
            (-5000.0, 0.0, 90.0),
            (5000.0, 9000.0, 90.0),
            (1000.0, 0.0, 9.0),
            (5000.0, 0.0, 90.0),
        ]);
        let seen = |leaves_narrow| chunk.seen(&DrapeView { view, leaves_narrow });
        assert_eq!(seen(false), [0..240, 480..720]);
        assert_eq!(seen(true), [0..120, 480..720]);
    }

    #[test]
    fn few_triangles_that_are_not_seen_part_no_call() {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (100, 100), (1.0, 50_000.0)).expect("sound");
        let mut chunk = chunk(&[(5000.0, 0.0, 90.0), (-5000.0, 0.0, 90.0), (5000.0, 0.0, 90.0)]);
        let view = DrapeView { view: CullingView::new(&camera), leaves_narrow: false };
        let mut seen = |between: u32| {
            chunk.pieces[1].end = 120 + between;
            chunk.seen(&view)
        };
        assert_eq!(seen(HIDDEN_INDICES), vec![0..360]);
        assert_eq!(seen(HIDDEN_INDICES + 3), [0..120, 123 + HIDDEN_INDICES..360]);
    }
}
