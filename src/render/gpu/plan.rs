//! The order and the depth rule of every draw call.
//!
//! ```text
//! ground ─► drapes in list order ─► solids ─► transparent solids, farthest first
//! ```
//!
//! A drape lies in the ground's triangles, so that its depth differs from the ground's only by rounding. If it were
//! drawn slightly nearer and wrote *that* depth, the offset would add up from drape to drape and bury what is on the
//! road. A drape is therefore tested slightly nearer, and a second, colorless draw writes its true depth. A transparent
//! drape keeps its place among the drapes: a lake under a road stays under it.

use std::ops::Range;

use glam::Vec3;

use crate::draw::list::{DepthLayer, DrawItem, DrawList};
use crate::draw::material::AlphaMode;
use crate::view::camera::Camera;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DepthRule {
    /// Drawn where nearer; writes its depth.
    Solid,
    /// Blended where nearer; writes no depth.
    Blend,
    /// Drawn where not farther by more than the drape tolerance; writes no depth.
    Drape,
    /// Blended where not farther by more than the drape tolerance; writes no depth.
    DrapeBlend,
    /// Not drawn; writes its depth where not farther.
    DrapeDepth,
    /// Drawn everywhere; writes no depth.
    Sky,
}

impl DepthRule {
    /// Whether it draws the color of a drape, and so tests it slightly nearer.
    pub fn is_drape_color(self) -> bool {
        matches!(self, Self::Drape | Self::DrapeBlend)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawCall {
    /// Indices into the draw list's items: part of a run, so that they differ in placement and feature only.
    pub items: Range<usize>,
    pub key: PipelineKey,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PipelineKey {
    pub rule: DepthRule,
    pub two_sided: bool,
    /// Whether alpha cuts holes.
    pub masked: bool,
}

#[derive(Debug, Default, PartialEq, Eq)]
pub struct Plan {
    pub color: Vec<DrawCall>,
    /// For the feature and depth buffers: the same items, transparent ones like solid ones.
    pub features: Vec<DrawCall>,
}

impl PipelineKey {
    pub const SKY: Self = Self { rule: DepthRule::Sky, two_sided: true, masked: false };
}

impl Plan {
    /// The plan for a checked list; items without triangles are left out.
    pub fn new(list: &DrawList, camera: &Camera) -> Self {
        let mut plan = Self::default();
        let mut transparent = Vec::new();
        for run in list.runs().filter(|run| !list.items[run.start].triangles.is_empty()) {
            let item = &list.items[run.start];
            let material = &list.materials[item.material.0 as usize];
            let masked = matches!(material.alpha, AlphaMode::Mask(_));
            let is_blend = material.alpha == AlphaMode::Blend;
            let call = |items: Range<usize>, rule| DrawCall {
                items,
                key: PipelineKey { rule, two_sided: material.two_sided, masked },
            };
            if matches!(item.layer, DepthLayer::Draped(_)) {
                for index in run {
                    let call = |rule| call(index..index + 1, rule);
                    plan.features.extend([call(DepthRule::Drape), call(DepthRule::DrapeDepth)]);
                    match is_blend {
                        true => plan.color.push(call(DepthRule::DrapeBlend)),
                        false => plan.color.extend([call(DepthRule::Drape), call(DepthRule::DrapeDepth)]),
                    }
                }
                continue;
            }
            plan.features.push(call(run.clone(), DepthRule::Solid));
            if is_blend {
                let center = center_of(list, item);
                transparent.extend(run.map(|index| {
                    let depth_m = depth_m(center, &list.items[index], camera);
                    (depth_m, call(index..index + 1, DepthRule::Blend))
                }));
            } else {
                plan.color.push(call(run, DepthRule::Solid));
            }
        }
        // Stable, so that equally far items keep the list's order.
        transparent.sort_by(|(a, _), (b, _): &(f32, _)| b.total_cmp(a));
        plan.color.extend(transparent.into_iter().map(|(_, call)| call));
        plan
    }
}

/// The center of the bounds of what `item` draws, in mesh space.
fn center_of(list: &DrawList, item: &DrawItem) -> Vec3 {
    let mesh = &list.meshes[item.mesh.0 as usize];
    let Range { start, end } = item.triangles;
    let corners = mesh.triangles[start as usize..end as usize].iter().flatten();
    let (min, max) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), id| {
        let at = Vec3::from_array(mesh.vertices[id.index()].position);
        (min.min(at), max.max(at))
    });
    (min + max) * 0.5
}

/// Meters along the viewing direction to the point `center` of the mesh of `item`.
fn depth_m(center: Vec3, item: &DrawItem, camera: &Camera) -> f32 {
    (item.world_from_mesh.transform_point3(center) - camera.eye()).dot(camera.forward())
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
        Plan::new(list, &camera).color.iter().map(|call| (call.items.start, call.key.rule)).collect()
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
    fn a_run_is_drawn_at_once_unless_it_is_blended() {
        let mut list =
            list(&[(DepthLayer::Solid, AlphaMode::Opaque, 5.0), (DepthLayer::Solid, AlphaMode::Blend, 5.0)]);
        let [solid, glass] = [list.items[0].clone(), list.items[1].clone()];
        list.items = vec![solid.clone(), solid.clone(), solid, glass.clone(), glass];
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (8, 8), (1.0, 100.0)).expect("sound");
        let plan = Plan::new(&list, &camera);
        let ranges = |calls: &[DrawCall]| calls.iter().map(|call| call.items.clone()).collect::<Vec<_>>();
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
