//! The order and the depth rule of every draw call, and which items a call draws together.
//!
//! ```text
//! ground ─► drapes in list order ─► solids ─► transparent solids, farthest first
//! ```
//!
//! A drape lies in the ground's triangles, so that its depth differs from the ground's only by rounding. If it were
//! drawn slightly nearer and wrote *that* depth, the offset would add up from drape to drape and bury what is on the
//! road. A drape is therefore tested slightly nearer and writes no depth: the ground's is its own. All drapes are blended,
//! opaque ones with an alpha of one, so that the order of the list is all that counts: thousands of roads with their
//! markings are one call.
//!
//! Items of a mesh of their own are copied into one buffer, in the list's order and in world space, so that those that
//! follow each other there are drawn at once. A mesh at many places is drawn once with an instance a place.

use std::ops::Range;

use glam::Vec3;

use crate::materials::{ArrayId, TexturePlaces};
use crate::parts::ShaderParts;
use crate::pipeline_key::{DepthRule, PipelineKey, VertexSource};
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, MeshId};
use sandtable_draw::material::AlphaMode;
use sandtable_view::camera::Camera;

/// The most triangles that one merged buffer holds: 72 MiB at the most, where no two triangles share a corner. Larger
/// buffers save few calls, and some drivers cannot hold them.
pub const MERGED_TRIANGLES: u32 = 1 << 19;

/// The shape that one call draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DrawShape {
    /// A range of the indices of a merged buffer.
    Merged { chunk: u32, indices: Range<u32> },
    /// A range of a mesh's indices for a range of instances.
    Placed { mesh: MeshId, indices: Range<u32>, instances: Range<u32> },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawCall {
    pub shape: DrawShape,
    /// The array that holds all textures it shows.
    pub array: ArrayId,
    /// The parts that its materials need.
    parts: ShaderParts,
    rule: DepthRule,
    two_sided: bool,
    masked: bool,
}

/// A range of an item's triangles in a merged buffer; parts lie there one after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MergedPart {
    pub chunk: u32,
    pub item: usize,
    pub triangles: Range<u32>,
}

#[derive(Debug, Default)]
pub struct Plan {
    /// For the color, all but transparent solids.
    pub color: Vec<DrawCall>,
    /// For the feature and depth buffers: the same items, transparent ones like solid ones.
    pub features: Vec<DrawCall>,
    /// What the merged buffers hold, chunks rising.
    pub merged: Vec<MergedPart>,
    /// The items that instances place, in order.
    pub placed: Vec<usize>,
    transparent: Vec<TransparentCall>,
}

/// A transparent solid and the middle of its bounds in world space.
#[derive(Debug)]
struct TransparentCall {
    center: Vec3,
    call: DrawCall,
}

impl DrawCall {
    /// The key of its pipeline in a picture that has the parts `picture`.
    pub fn key(&self, picture: ShaderParts) -> PipelineKey {
        let source = match self.shape {
            DrawShape::Merged { .. } => VertexSource::Merged,
            DrawShape::Placed { .. } => VertexSource::Placed,
        };
        let Self { rule, two_sided, masked, array, .. } = *self;
        let is_colored = self.parts != ShaderParts::NONE;
        let parts = if is_colored { self.parts.in_picture(picture) } else { ShaderParts::NONE };
        PipelineKey { source, rule, two_sided, masked, textured: array != ArrayId::NONE, parts }
    }

    /// Adds `next` to this call if one call draws both, this one first.
    fn join(&mut self, next: &Self) -> bool {
        let is_alike = (self.rule, self.two_sided, self.masked) == (next.rule, next.two_sided, next.masked);
        let array = self.array.max(next.array);
        let shares_array = [self.array, next.array].iter().all(|&own| own == array || own == ArrayId::NONE);
        match (&mut self.shape, &next.shape) {
            (
                DrawShape::Merged { chunk, indices },
                DrawShape::Merged { chunk: next_chunk, indices: added },
            ) if is_alike && shares_array && chunk == next_chunk && indices.end == added.start => {
                (indices.end, self.array) = (added.end, array);
                self.parts = self.parts.with(next.parts);
                true
            }
            _ => false,
        }
    }
}

impl Plan {
    /// The plan for those items of a checked list whose layer is among `layers`; items without triangles are left out.
    pub fn new(list: &DrawList, places: &TexturePlaces, layers: impl Fn(DepthLayer) -> bool) -> Self {
        let mut plan = Self::default();
        let mut end = MergedEnd::default();
        for run in list.runs() {
            let item = &list.items[run.start];
            if item.triangles.is_empty() || !layers(item.layer) {
                continue;
            }
            if run.len() > 1 {
                plan.place(list, places, run);
                continue;
            }
            let mut left = item.triangles.clone();
            while !left.is_empty() {
                let (shape, triangles) = end.take(&left);
                left.start = triangles.end;
                let DrawShape::Merged { chunk, .. } = shape else { continue };
                plan.merged.push(MergedPart { chunk, item: run.start, triangles });
                plan.add(list, places, run.start, shape);
            }
        }
        plan
    }

    /// The transparent solids for the color, the farthest first; equally far ones keep the list's order.
    pub fn transparent(&self, camera: &Camera) -> Vec<&DrawCall> {
        let depth_m = |center: Vec3| (center - camera.eye()).dot(camera.forward());
        let mut order: Vec<(f32, &DrawCall)> =
            self.transparent.iter().map(|each| (depth_m(each.center), &each.call)).collect();
        order.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        order.into_iter().map(|(_, call)| call).collect()
    }

    /// The keys of all calls for the color in a picture that has the parts `picture`, and of all for the features.
    pub fn keys(&self, picture: ShaderParts) -> [Vec<PipelineKey>; 2] {
        let transparent = self.transparent.iter().map(|each| &each.call);
        let color = self.color.iter().chain(transparent).map(|call| call.key(picture));
        [color.collect(), self.features.iter().map(|call| call.key(picture)).collect()]
    }

    /// Adds a run of items of one mesh.
    fn place(&mut self, list: &DrawList, places: &TexturePlaces, run: Range<usize>) {
        let item = &list.items[run.start];
        let first = self.placed.len() as u32;
        self.placed.extend(run.clone());
        let indices = item.triangles.start * 3..item.triangles.end * 3;
        let shape = |instances| DrawShape::Placed { mesh: item.mesh, indices: indices.clone(), instances };
        let is_transparent = list.materials[item.material.0 as usize].alpha == AlphaMode::Blend;
        if is_transparent && item.layer == DepthLayer::Solid {
            for (instance, index) in (first..).zip(run) {
                self.add(list, places, index, shape(instance..instance + 1));
            }
        } else {
            self.add(list, places, run.start, shape(first..first + run.len() as u32));
        }
    }

    /// Adds what `shape` draws of an item, or of a run that it is the first of.
    fn add(&mut self, list: &DrawList, places: &TexturePlaces, index: usize, shape: DrawShape) {
        let item = &list.items[index];
        let material = &list.materials[item.material.0 as usize];
        let is_draped = matches!(item.layer, DepthLayer::Draped(_));
        let is_transparent = material.alpha == AlphaMode::Blend && !is_draped;
        let rule = if is_draped { DepthRule::Drape } else { DepthRule::Solid };
        let (array, two_sided) = (places.array_of(item.material), material.two_sided);
        let masked = matches!(material.alpha, AlphaMode::Mask(_));
        let parts = ShaderParts::of_material(material);
        let color = DrawCall { shape, array, parts, rule, two_sided, masked };
        // An opaque surface hides what is behind it, whatever its texture.
        let array = if material.alpha == AlphaMode::Opaque { ArrayId::NONE } else { array };
        let feature = DrawCall { array, parts: ShaderParts::NONE, masked: false, ..color.clone() };
        push(&mut self.features, feature);
        if is_transparent {
            let call = DrawCall { rule: DepthRule::Blend, ..color };
            self.transparent.push(TransparentCall { center: center_of(list, item), call });
        } else {
            push(&mut self.color, color);
        }
    }
}

fn push(calls: &mut Vec<DrawCall>, call: DrawCall) {
    if calls.last_mut().is_none_or(|last| !last.join(&call)) {
        calls.push(call);
    }
}

/// The end of what the merged buffers hold so far.
#[derive(Default)]
struct MergedEnd {
    chunk: u32,
    triangles: u32,
}

impl MergedEnd {
    /// Takes as many of `wanted` as the last chunk has capacity for, at least one.
    fn take(&mut self, wanted: &Range<u32>) -> (DrawShape, Range<u32>) {
        if self.triangles == MERGED_TRIANGLES {
            *self = Self { chunk: self.chunk + 1, triangles: 0 };
        }
        let start = self.triangles;
        let count = (wanted.end - wanted.start).min(MERGED_TRIANGLES - start);
        self.triangles += count;
        let shape = DrawShape::Merged { chunk: self.chunk, indices: start * 3..self.triangles * 3 };
        (shape, wanted.start..wanted.start + count)
    }
}

/// The center of the bounds of what `item` draws, in world space.
fn center_of(list: &DrawList, item: &DrawItem) -> Vec3 {
    let mesh = &list.meshes[item.mesh.0 as usize];
    let Range { start, end } = item.triangles;
    let corners = mesh.triangles[start as usize..end as usize].iter().flatten();
    let (min, max) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), id| {
        let at = Vec3::from_array(mesh.vertices[id.index()].position);
        (min.min(at), max.max(at))
    });
    item.world_from_mesh.transform_point3((min + max) * 0.5)
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::materials::TextureScope;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DrawMesh, DrawVertex, FeatureId};
    use sandtable_draw::material::Material;
    use sandtable_draw::pixels::Pixels;
    use sandtable_mesh::sink::{MeshSink, VertexId};

    fn mesh(triangles: usize) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        for position in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE });
        }
        (0..triangles).for_each(|_| mesh.triangle([VertexId(0), VertexId(1), VertexId(2)]));
        mesh
    }

    /// Items of a mesh of their own, so that none of them is a run.
    fn list(items: &[(DepthLayer, AlphaMode, f32)]) -> DrawList {
        let mut list = DrawList::default();
        for &(layer, alpha, y) in items {
            let mesh = list.add_mesh(mesh(1));
            let material = list.add_material(Material { alpha, ..Default::default() });
            let world_from_mesh = Mat4::from_translation(Vec3::Y * y);
            let feature = FeatureId::GROUND;
            list.items.push(DrawItem { mesh, triangles: 0..1, material, world_from_mesh, layer, feature });
        }
        list
    }

    fn plan(list: &DrawList) -> Plan {
        let places = TexturePlaces::new(list, TextureScope::Items, &wgpu::Limits::default());
        Plan::new(list, &places, |_| true)
    }

    /// The items that a call draws.
    fn items_of(plan: &Plan, call: &DrawCall) -> Vec<usize> {
        match &call.shape {
            DrawShape::Placed { instances, .. } => {
                plan.placed[instances.start as usize..instances.end as usize].to_vec()
            }
            DrawShape::Merged { chunk, indices } => {
                let mut start = 0;
                let parts = plan.merged.iter().filter(|part| part.chunk == *chunk).filter(|part| {
                    let first = start;
                    start += (part.triangles.end - part.triangles.start) * 3;
                    indices.contains(&first)
                });
                parts.map(|part| part.item).collect()
            }
        }
    }

    fn color_order(list: &DrawList) -> Vec<(Vec<usize>, DepthRule)> {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (8, 8), (1.0, 100.0)).expect("sound");
        let plan = plan(list);
        let calls = plan.color.iter().chain(plan.transparent(&camera));
        calls.map(|call| (items_of(&plan, call), call.rule)).collect()
    }

    #[test]
    fn blended_solids_come_last_and_farthest_first() {
        use AlphaMode::{Blend, Opaque};
        let list = list(&[
            (DepthLayer::Ground, Opaque, 9.0),
            (DepthLayer::Solid, Blend, 5.0),
            (DepthLayer::Solid, Opaque, 4.0),
            (DepthLayer::Solid, Blend, 50.0),
            (DepthLayer::Solid, Blend, 7.0),
        ]);
        let expected = [
            (vec![0], DepthRule::Solid),
            (vec![2], DepthRule::Solid),
            (vec![3], DepthRule::Blend),
            (vec![4], DepthRule::Blend),
            (vec![1], DepthRule::Blend),
        ];
        assert_eq!(color_order(&list), expected);
    }

    #[test]
    fn drapes_are_one_call_in_the_order_of_the_list_whether_blended_or_not() {
        let list = list(&[
            (DepthLayer::Ground, AlphaMode::Opaque, 9.0),
            (DepthLayer::Draped(0), AlphaMode::Blend, 9.0),
            (DepthLayer::Draped(1), AlphaMode::Opaque, 9.0),
            (DepthLayer::Draped(1), AlphaMode::Blend, 9.0),
            (DepthLayer::Solid, AlphaMode::Opaque, 9.0),
        ]);
        let expected =
            [(vec![0], DepthRule::Solid), (vec![1, 2, 3], DepthRule::Drape), (vec![4], DepthRule::Solid)];
        assert_eq!(color_order(&list), expected);
    }

    #[test]
    fn a_call_ends_where_textures_are_of_another_size() {
        let mut list = list(&[(DepthLayer::Draped(0), AlphaMode::Opaque, 9.0); 5]);
        for (index, side) in [Some(8), None, Some(8), Some(4), None].into_iter().enumerate() {
            let texture = side.map(|side| list.add_texture(Pixels::filled(side, side, Srgba::WHITE)));
            list.materials[index].texture = texture;
        }
        let expected = [(vec![0, 1, 2], DepthRule::Drape), (vec![3, 4], DepthRule::Drape)];
        assert_eq!(color_order(&list), expected);
    }

    #[test]
    fn a_run_is_drawn_at_once_unless_it_is_blended() {
        let mut list =
            list(&[(DepthLayer::Solid, AlphaMode::Opaque, 5.0), (DepthLayer::Solid, AlphaMode::Blend, 5.0)]);
        let [solid, glass] = [list.items[0].clone(), list.items[1].clone()];
        list.items = vec![solid.clone(), solid.clone(), solid, glass.clone(), glass];
        let items: Vec<Vec<usize>> = color_order(&list).into_iter().map(|(items, _)| items).collect();
        assert_eq!(items, [vec![0, 1, 2], vec![3], vec![4]]);
        let plan = plan(&list);
        let features: Vec<Vec<usize>> = plan.features.iter().map(|call| items_of(&plan, call)).collect();
        assert_eq!(features, [vec![0, 1, 2], vec![3], vec![4]]);
    }

    #[test]
    fn what_one_buffer_does_not_hold_continues_in_the_next() {
        let mut list = list(&[(DepthLayer::Solid, AlphaMode::Opaque, 5.0); 2]);
        let many = MERGED_TRIANGLES + 7;
        list.meshes[1] = mesh(many as usize);
        list.items[1].triangles = 0..many;
        let plan = plan(&list);
        let shapes: Vec<DrawShape> = plan.color.iter().map(|call| call.shape.clone()).collect();
        let expected = [
            DrawShape::Merged { chunk: 0, indices: 0..MERGED_TRIANGLES * 3 },
            DrawShape::Merged { chunk: 1, indices: 0..24 },
        ];
        assert_eq!(shapes, expected);
        assert_eq!(plan.merged[2].triangles, MERGED_TRIANGLES - 1..many);
    }

    #[test]
    fn items_without_triangles_are_not_drawn() {
        let mut list = list(&[(DepthLayer::Solid, AlphaMode::Opaque, 5.0)]);
        list.items[0].triangles = 1..1;
        assert_eq!(color_order(&list), []);
    }
}
