//! In which order and by which rule each item is drawn.
//!
//! ```text
//! ground ─► drapes in list order ─► solids ─► blended solids, farthest first
//! ```
//!
//! A drape lies in the ground's triangles, so its depth differs from the ground's by rounding only. Drawing
//! it as if it were nearer by a hair and writing *that* depth would stack up from drape to drape, and bury
//! what stands on the road; so a drape is tested a hair nearer but leaves its true depth behind, by a second,
//! colorless draw. A blended drape keeps its place among the drapes: a lake under a road stays under it.

use std::ops::Range;

use glam::Vec3;

use crate::draw::list::{DepthLayer, DrawItem, DrawList};
use crate::draw::material::AlphaMode;
use crate::view::camera::Camera;

/// The rule by which an item meets the depth buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::render::gpu) enum DepthRule {
    /// Drawn where nearer, leaving its depth.
    Solid,
    /// Drawn where nearer, mixed with what is there, leaving no depth.
    Blend,
    /// Drawn where no farther by a hair, leaving no depth.
    Drape,
    /// The same, mixed with what is there.
    DrapeBlend,
    /// Not drawn; leaves its depth where no farther.
    DrapeDepth,
}

/// One draw call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::render::gpu) struct DrawCall {
    /// Indices into the draw list's items: part of a run, so that they differ in place and feature only.
    pub items: Range<usize>,
    /// What it needs of a pipeline.
    pub way: PipelineKey,
}

/// All that tells one pipeline of a pass from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::render::gpu) struct PipelineKey {
    /// How it meets the depth buffer.
    pub rule: DepthRule,
    /// Whether backs are drawn too.
    pub two_sided: bool,
    /// Whether alpha cuts holes.
    pub masked: bool,
}

/// The draw calls of both passes.
#[derive(Debug, Default, PartialEq, Eq)]
pub(in crate::render::gpu) struct Plan {
    /// What makes the colors.
    pub color: Vec<DrawCall>,
    /// What makes the feature and depth buffers: the same items, blended ones like solid ones.
    pub features: Vec<DrawCall>,
}

impl Plan {
    /// The plan for a list that has passed its own check; items without triangles are left out.
    pub fn of(list: &DrawList, camera: &Camera) -> Self {
        let mut plan = Self::default();
        let mut blended = Vec::new();
        for run in list.runs().filter(|run| !list.items[run.start].triangles.is_empty()) {
            let item = &list.items[run.start];
            let material = &list.materials[item.material.0 as usize];
            let masked = matches!(material.alpha, AlphaMode::Mask(_));
            let way = |rule| PipelineKey { rule, two_sided: material.two_sided, masked };
            let is_blend = material.alpha == AlphaMode::Blend;
            match (item.layer, is_blend) {
                (DepthLayer::Draped(_), _) => {
                    for index in run {
                        let step = |rule| DrawCall { items: index..index + 1, way: way(rule) };
                        plan.features.extend([step(DepthRule::Drape), step(DepthRule::DrapeDepth)]);
                        match is_blend {
                            true => plan.color.push(step(DepthRule::DrapeBlend)),
                            false => plan.color.extend([step(DepthRule::Drape), step(DepthRule::DrapeDepth)]),
                        }
                    }
                }
                (_, false) => {
                    let step = DrawCall { items: run, way: way(DepthRule::Solid) };
                    plan.color.push(step.clone());
                    plan.features.push(step);
                }
                (_, true) => {
                    let middle = middle_of(list, item);
                    blended.extend(run.clone().map(|index| {
                        let step = DrawCall { items: index..index + 1, way: way(DepthRule::Blend) };
                        (depth_of(middle, &list.items[index], camera), step)
                    }));
                    plan.features.push(DrawCall { items: run, way: way(DepthRule::Solid) });
                }
            }
        }
        // Stable, so that equally far items keep the list's order.
        blended.sort_by(|a, b| b.0.total_cmp(&a.0));
        plan.color.extend(blended.into_iter().map(|(_, step): (f32, DrawCall)| step));
        plan
    }
}

/// The middle of what `item` draws, in its mesh's space.
fn middle_of(list: &DrawList, item: &DrawItem) -> Vec3 {
    let mesh = &list.meshes[item.mesh.0 as usize];
    let Range { start, end } = item.triangles;
    let corners = mesh.triangles[start as usize..end as usize].iter().flatten();
    let (min, max) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), id| {
        let at = Vec3::from_array(mesh.vertices[id.index()].position);
        (min.min(at), max.max(at))
    });
    (min + max) * 0.5
}

/// Meters along the viewing direction to `middle` of the mesh of `item`.
fn depth_of(middle: Vec3, item: &DrawItem, camera: &Camera) -> f32 {
    (item.world_from_mesh.transform_point3(middle) - camera.eye()).dot(camera.forward())
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::draw::color::Srgba;
    use crate::draw::list::{DrawMesh, DrawVertex, FeatureId};
    use crate::draw::material::Material;
    use crate::mesh::sink::{MeshSink, VertexId};

    fn list(items: &[(DepthLayer, AlphaMode, f32)]) -> DrawList {
        let mut list = DrawList::default();
        let mut mesh = DrawMesh::default();
        for position in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE });
        }
        mesh.triangle([VertexId(0), VertexId(1), VertexId(2)]);
        let mesh = list.add_mesh(mesh);
        for &(layer, alpha, y) in items {
            let material = list.add_material(Material { alpha, ..Default::default() });
            let world_from_mesh = Mat4::from_translation(Vec3::Y * y);
            let feature = FeatureId::GROUND;
            list.items.push(DrawItem { mesh, triangles: 0..1, material, world_from_mesh, layer, feature });
        }
        list
    }

    fn color_order(list: &DrawList) -> Vec<(usize, DepthRule)> {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (8, 8), (1.0, 100.0)).expect("sound");
        Plan::of(list, &camera).color.iter().map(|step| (step.items.start, step.way.rule)).collect()
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
            (0, DepthRule::Solid),
            (2, DepthRule::Solid),
            (3, DepthRule::Blend),
            (4, DepthRule::Blend),
            (1, DepthRule::Blend),
        ];
        assert_eq!(color_order(&list), expected);
    }

    #[test]
    fn a_blended_drape_keeps_its_place_below_a_higher_one() {
        let list = list(&[
            (DepthLayer::Ground, AlphaMode::Opaque, 9.0),
            (DepthLayer::Draped(0), AlphaMode::Blend, 9.0),
            (DepthLayer::Draped(1), AlphaMode::Opaque, 9.0),
        ]);
        let expected = [
            (0, DepthRule::Solid),
            (1, DepthRule::DrapeBlend),
            (2, DepthRule::Drape),
            (2, DepthRule::DrapeDepth),
        ];
        assert_eq!(color_order(&list), expected);
    }

    #[test]
    fn what_is_alike_is_drawn_at_once_unless_it_is_blended() {
        let mut list =
            list(&[(DepthLayer::Solid, AlphaMode::Opaque, 5.0), (DepthLayer::Solid, AlphaMode::Blend, 5.0)]);
        let [solid, glass] = [list.items[0].clone(), list.items[1].clone()];
        list.items = vec![solid.clone(), solid.clone(), solid, glass.clone(), glass];
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (8, 8), (1.0, 100.0)).expect("sound");
        let plan = Plan::of(&list, &camera);
        let ranges = |steps: &[DrawCall]| steps.iter().map(|step| step.items.clone()).collect::<Vec<_>>();
        assert_eq!(ranges(&plan.color), [0..3, 3..4, 4..5]);
        assert_eq!(ranges(&plan.features), [0..3, 3..5]);
    }

    #[test]
    fn items_without_triangles_are_not_drawn() {
        let mut list = list(&[(DepthLayer::Solid, AlphaMode::Opaque, 5.0)]);
        list.items[0].triangles = 1..1;
        assert_eq!(color_order(&list), []);
    }
}
