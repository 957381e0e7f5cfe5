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
//! A window's plan has its solids in groups of neighbors (`culling`), whose order in depth the depth rule alone decides. Few
//! triangles out of view do not part two groups in view that one call draws. Of many opaque instances of one mesh the device
//! itself leaves out those that are not seen, where it can (`instance_culling`).
//!
//! Items of a mesh of their own are copied into one buffer, in the list's order and in world space, so that those that
//! follow each other there are drawn at once. A mesh at many places is drawn once with an instance a place.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use crate::culling::{CullingView, GroupId, ItemCells, ItemGroup, mesh_bounds, placed_bounds};
use crate::draw_call::{DrawCall, DrawShape, JoinedCall, color_call, push, shown_calls};
use crate::instance_culling::InstanceCulling;
use crate::materials::{ArrayId, TexturePlaces};
use crate::parts::ShaderParts;
use crate::pipeline_key::{DepthRule, PipelineKey};
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList};
use sandtable_draw::material::AlphaMode;
use sandtable_geom::aabb::Aabb;
use sandtable_view::camera::Camera;

/// The most triangles that one merged buffer holds: 72 MiB at the most, where no two triangles share a corner. Larger
/// buffers save few calls, and some drivers cannot hold them.
pub const MERGED_TRIANGLES: u32 = 1 << 19;

/// The fewest instances of a run that the device culls: fewer are drawn, or left out, for less than a call that may be empty.
const LONG_RUN: usize = 64;

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
    /// The items that instances place, in order; those of `culled` come first.
    pub placed: Vec<usize>,
    /// For the color, runs of many opaque solids of which the device draws what it sees, one call each. They come before `color`.
    pub culled: Vec<DrawCall>,
    /// The boxes of their items, in order.
    pub culled_bounds: Vec<Aabb>,
    /// The groups that are drawn or left out together.
    groups: Vec<ItemGroup>,
    transparent: Vec<TransparentCall>,
}

/// A transparent solid and what it takes up.
#[derive(Debug)]
struct TransparentCall {
    place: ItemGroup,
    call: DrawCall,
}

/// What calls must share to follow each other in a sorted plan.
type SortKey = (bool, ArrayId, bool, bool, ShaderParts);

impl Plan {
    /// The plan for those items of a checked list that are `wanted`; items without triangles are left out.
    pub fn new(list: &DrawList, places: &TexturePlaces, wanted: impl Fn(usize) -> bool) -> Self {
        let mut plan = Self::default();
        let mut end = MergedEnd::default();
        for run in list.runs().filter(|run| !list.items[run.start].triangles.is_empty()) {
            let is_alone = run.len() == 1;
            let run: Vec<usize> = run.filter(|item| wanted(*item)).collect();
            match run[..] {
                [item] if is_alone => plan.merge(list, places, (item, None), &mut end),
                _ => plan.place(list, places, &run, None),
            }
        }
        plan
    }

    /// The plan for the solids of a checked list, in groups of neighbors of which a frame draws those that it sees. Long runs of
    /// opaque ones come first, as runs without groups where the device culls them.
    pub fn of_solids(list: &DrawList, places: &TexturePlaces, culling: InstanceCulling) -> Self {
        let mut plan = Self::default();
        let is_drawn = |item: &DrawItem| item.layer == DepthLayer::Solid && !item.triangles.is_empty();
        let mut runs: Vec<Range<usize>> =
            list.runs().filter(|run| is_drawn(&list.items[run.start])).collect();
        runs.sort_by_key(|run| !is_long(list, run));
        let bounds: Vec<Vec<Aabb>> = runs
            .par_iter()
            .map(|run| {
                let of_mesh = mesh_bounds(list, &list.items[run.start]);
                list.items[run.clone()].iter().map(|item| placed_bounds(item, &of_mesh)).collect()
            })
            .collect();
        let cells = ItemCells::new(bounds.iter().flatten());
        let mut alone: Vec<(SortKey, u32, usize, Aabb)> = Vec::new();
        for (run, bounds) in runs.into_iter().zip(bounds) {
            let is_long = is_long(list, &run);
            if let (1, Some(bounds)) = (run.len(), bounds.first()) {
                alone.push((sort_key(list, places, run.start), cells.of(bounds), run.start, *bounds));
                continue;
            }
            let mut placed: Vec<(u32, usize, Aabb)> =
                run.zip(bounds).map(|(item, bounds)| (cells.of(&bounds), item, bounds)).collect();
            placed.sort_by_key(|(cell, ..)| *cell);
            if culling == InstanceCulling::Device && is_long {
                let run: Vec<(usize, Aabb)> =
                    placed.into_iter().map(|(_, item, bounds)| (item, bounds)).collect();
                plan.cull(list, places, &run);
                continue;
            }
            for cell in placed.chunk_by(|one, next| one.0 == next.0) {
                let group = plan.group(cell.iter().map(|(_, _, bounds)| *bounds));
                let items: Vec<usize> = cell.iter().map(|(_, item, _)| *item).collect();
                plan.place(list, places, &items, Some(group));
            }
        }
        alone.sort_by_key(|(key, cell, ..)| (*key, *cell));
        let mut end = MergedEnd::default();
        for cell in alone.chunk_by(|one, next| (one.0, one.1) == (next.0, next.1)) {
            let group = plan.group(cell.iter().map(|(.., bounds)| *bounds));
            for (_, _, item, _) in cell {
                plan.merge(list, places, (*item, Some(group)), &mut end);
            }
        }
        plan
    }

    /// The calls for the color that `camera` needs of a plan with groups, in order.
    pub fn seen(&self, camera: &Camera) -> Vec<DrawCall> {
        let view = CullingView::new(camera);
        let is_seen: Vec<bool> = self.groups.iter().map(|group| view.shows(group)).collect();
        let shows = |call: &DrawCall| call.group.is_none_or(|GroupId(group)| is_seen[group as usize]);
        let mut calls = shown_calls(self.color.iter().map(|call| (call, shows(call))));
        let transparent = self.transparent_in(camera, |call| view.shows(&call.place));
        for call in transparent {
            if calls.last_mut().is_none_or(|last| !last.join(call)) {
                calls.push(call.clone());
            }
        }
        calls
    }

    /// The transparent solids for the color, the farthest first; equally far ones keep the list's order.
    pub fn transparent(&self, camera: &Camera) -> Vec<&DrawCall> {
        self.transparent_in(camera, |_| true)
    }

    fn transparent_in(&self, camera: &Camera, shows: impl Fn(&TransparentCall) -> bool) -> Vec<&DrawCall> {
        let depth_m = |center: Vec3| (center - camera.eye()).dot(camera.forward());
        let shown = self.transparent.iter().filter(|call| shows(call));
        let mut order: Vec<(f32, &DrawCall)> =
            shown.map(|each| (depth_m(each.place.bounds.center()), &each.call)).collect();
        order.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        order.into_iter().map(|(_, call)| call).collect()
    }

    /// Adds a group of items with these boxes.
    fn group(&mut self, bounds: impl Iterator<Item = Aabb>) -> GroupId {
        let group = bounds.map(ItemGroup::of).reduce(ItemGroup::with);
        self.groups.push(group.unwrap_or_else(|| ItemGroup::of(Aabb::default())));
        GroupId(self.groups.len() as u32 - 1)
    }

    /// Adds an item of a mesh of its own, of a group.
    fn merge(
        &mut self,
        list: &DrawList,
        places: &TexturePlaces,
        (item, group): (usize, Option<GroupId>),
        end: &mut MergedEnd,
    ) {
        let mut left = list.items[item].triangles.clone();
        while !left.is_empty() {
            let (shape, triangles) = end.take(&left);
            left.start = triangles.end;
            let DrawShape::Merged { chunk, .. } = shape else { continue };
            self.merged.push(MergedPart { chunk, item, triangles });
            self.add(list, places, (item, group), shape);
        }
    }

    /// The keys of all calls for the color in a picture that has the parts `picture`, and of all for the features.
    pub fn keys(&self, picture: ShaderParts) -> [Vec<PipelineKey>; 2] {
        let transparent = self.transparent.iter().map(|each| &each.call);
        let calls = self.culled.iter().chain(&self.color).chain(transparent);
        let color = calls.map(|call| call.key(picture));
        [color.collect(), self.features.iter().map(|call| call.key(picture)).collect()]
    }

    /// Adds a run of opaque items of one mesh, of which the device draws what it sees.
    fn cull(&mut self, list: &DrawList, places: &TexturePlaces, run: &[(usize, Aabb)]) {
        let Some(&(start, _)) = run.first() else { return };
        let first = self.placed.len() as u32;
        self.placed.extend(run.iter().map(|(item, _)| *item));
        self.culled_bounds.extend(run.iter().map(|(_, bounds)| *bounds));
        let item = &list.items[start];
        let shape = DrawShape::Placed {
            mesh: item.mesh,
            indices: item.triangles.start * 3..item.triangles.end * 3,
            instances: first..first + run.len() as u32,
        };
        self.culled.push(color_call(list, places, (start, None), shape));
    }

    /// Adds items of one mesh, which are of a run and of a group.
    fn place(&mut self, list: &DrawList, places: &TexturePlaces, run: &[usize], group: Option<GroupId>) {
        let Some(&start) = run.first() else { return };
        let item = &list.items[start];
        let first = self.placed.len() as u32;
        self.placed.extend(run);
        let indices = item.triangles.start * 3..item.triangles.end * 3;
        let shape = |instances| DrawShape::Placed { mesh: item.mesh, indices: indices.clone(), instances };
        let is_transparent = list.materials[item.material.0 as usize].alpha == AlphaMode::Blend;
        if is_transparent && item.layer == DepthLayer::Solid {
            for (instance, &index) in (first..).zip(run) {
                self.add(list, places, (index, group), shape(instance..instance + 1));
            }
        } else {
            self.add(list, places, (start, group), shape(first..first + run.len() as u32));
        }
    }

    /// Adds what `shape` draws of an item, or of a run that it is the first of.
    fn add(
        &mut self,
        list: &DrawList,
        places: &TexturePlaces,
        (index, group): (usize, Option<GroupId>),
        shape: DrawShape,
    ) {
        let item = &list.items[index];
        let material = &list.materials[item.material.0 as usize];
        let color = color_call(list, places, (index, group), shape);
        let is_transparent = material.alpha == AlphaMode::Blend && color.rule != DepthRule::Drape;
        // An opaque surface hides what is behind it, whatever its texture.
        let array = if material.alpha == AlphaMode::Opaque { ArrayId::NONE } else { color.array };
        let feature = DrawCall { array, parts: color.parts.of_alpha(), masked: false, ..color.clone() };
        push(&mut self.features, feature);
        if is_transparent {
            let call = DrawCall { rule: DepthRule::Blend, ..color };
            let place = ItemGroup::of(placed_bounds(item, &mesh_bounds(list, item)));
            self.transparent.push(TransparentCall { place, call });
        } else {
            push(&mut self.color, color);
        }
    }
}

/// Whether a run is worth a call of its own whatever is seen of it.
fn is_long(list: &DrawList, run: &Range<usize>) -> bool {
    let material = list.items[run.start].material;
    run.len() >= LONG_RUN && list.materials[material.0 as usize].alpha != AlphaMode::Blend
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

/// What an item shares with those that are drawn alike.
fn sort_key(list: &DrawList, places: &TexturePlaces, item: usize) -> SortKey {
    let id = list.items[item].material;
    let material = &list.materials[id.0 as usize];
    let (is_transparent, is_masked) =
        (material.alpha == AlphaMode::Blend, matches!(material.alpha, AlphaMode::Mask(_)));
    let parts = ShaderParts::of_material(material);
    (is_transparent, places.array_of(id), material.two_sided, is_masked, parts)
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::draw_call::HIDDEN_TRIANGLES;
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
        assert_eq!(features, [vec![0, 1, 2], vec![3, 4]]);
    }

    #[test]
    fn solids_that_are_not_seen_are_not_drawn_and_neighbors_are_one_call() {
        use AlphaMode::{Blend, Opaque};
        let solid = |alpha, y| (DepthLayer::Solid, alpha, y);
        // Two cells ahead, two behind, glass on both sides.
        let mut list = list(&[
            solid(Opaque, -40.0),
            solid(Opaque, 60.0),
            solid(Blend, 30.0),
            solid(Opaque, 40.0),
            solid(Blend, -30.0),
            solid(Opaque, -60.0),
        ]);
        let tree = list.items[1].clone();
        let trees = [-50.0, 50.0, 20.0, -20.0].map(|y| {
            let world_from_mesh = Mat4::from_translation(Vec3::new(0.5, y, 0.0));
            DrawItem { world_from_mesh, ..tree.clone() }
        });
        list.items.extend(trees);
        let places = TexturePlaces::new(&list, TextureScope::Items, &wgpu::Limits::default());
        let plan = Plan::of_solids(&list, &places, InstanceCulling::Processor);
        let seen = |toward: Vec3| -> Vec<Vec<usize>> {
            let camera = Camera::new(Vec3::ZERO, toward, 1.0, (800, 800), (0.1, 100.0)).expect("sound");
            let calls = plan.seen(&camera);
            let mut items: Vec<Vec<usize>> = calls.iter().map(|call| items_of(&plan, call)).collect();
            items.iter_mut().for_each(|items| items.sort_unstable());
            items.sort();
            items
        };
        assert_eq!(seen(Vec3::Y), [vec![1, 3], vec![2], vec![7, 8]]);
        assert_eq!(seen(-Vec3::Y), [vec![0, 5], vec![4], vec![6, 9]]);
        let keys = |calls: &[DrawCall]| -> Vec<PipelineKey> {
            calls.iter().map(|call| call.key(ShaderParts::NONE)).collect()
        };
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (800, 800), (0.1, 100.0)).expect("sound");
        let [made, _] = plan.keys(ShaderParts::NONE);
        assert!(keys(&plan.seen(&camera)).iter().all(|key| made.contains(key)), "made before they are seen");
    }

    #[test]
    fn one_call_draws_what_is_seen_on_both_sides_of_a_few_triangles_that_are_not() {
        let calls = |triangles: usize| -> Vec<Vec<usize>> {
            let mut list = list(&[(DepthLayer::Solid, AlphaMode::Opaque, 50.0)]);
            list.meshes[0] = mesh(triangles);
            list.items[0].triangles = 0..triangles as u32;
            // In the order of cells: ahead, beside the view, ahead.
            for (x, y) in [(100.0, 50.0), (0.0, 100.0)] {
                let world_from_mesh = Mat4::from_translation(Vec3::new(x, y, 0.0));
                list.items.push(DrawItem { world_from_mesh, ..list.items[0].clone() });
            }
            let places = TexturePlaces::new(&list, TextureScope::Items, &wgpu::Limits::default());
            let plan = Plan::of_solids(&list, &places, InstanceCulling::Processor);
            let camera = Camera::new(Vec3::ZERO, Vec3::Y, 0.5, (800, 800), (0.1, 500.0)).expect("sound");
            plan.seen(&camera).iter().map(|call| items_of(&plan, call)).collect()
        };
        assert_eq!(calls(1), [vec![0, 1, 2]]);
        assert_eq!(calls(HIDDEN_TRIANGLES as usize), [vec![0, 1, 2]]);
        assert_eq!(calls(HIDDEN_TRIANGLES as usize + 1), [vec![0], vec![2]]);
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
