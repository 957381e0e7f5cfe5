//! The draw calls of shadow casters: the ground and solids where a picture's buffers hold them.

use crate::draw_call::{DrawShape, JoinedCall, shown_calls};
use crate::materials::{ArrayId, TexturePlaces};
use crate::pipeline_key::VertexSource;
use crate::plan::Plan;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList};
use sandtable_draw::material::AlphaMode;

/// The kind of a call's pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CasterKey {
    pub source: VertexSource,
    /// Whether the ground is drawn, and not solids.
    pub on_ground: bool,
    /// Whether alpha cuts holes.
    pub masked: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CasterCall {
    pub key: CasterKey,
    /// The array with the textures whose alpha cuts holes.
    pub array: ArrayId,
    pub shape: DrawShape,
}

/// What casts of a plan, item by item in the order of its buffers.
#[derive(Debug)]
pub struct PlanCasters(Vec<(usize, CasterCall)>);

impl CasterCall {
    /// The call for `shape`, which is of an item; `None` where that casts no shadow.
    fn new(list: &DrawList, places: &TexturePlaces, item: &DrawItem, shape: DrawShape) -> Option<Self> {
        let alpha = list.materials[item.material.0 as usize].alpha;
        let on_ground = match item.layer {
            DepthLayer::Ground => true,
            DepthLayer::Solid if alpha != AlphaMode::Blend => false,
            DepthLayer::Solid | DepthLayer::Draped(_) => return None,
        };
        let masked = matches!(alpha, AlphaMode::Mask(_));
        let source = match shape {
            DrawShape::Merged { .. } => VertexSource::Merged,
            DrawShape::Placed { .. } => VertexSource::Placed,
        };
        let array = if masked { places.array_of(item.material) } else { ArrayId::NONE };
        Some(Self { key: CasterKey { source, on_ground, masked }, array, shape })
    }
}

impl JoinedCall for CasterCall {
    fn shape(&self) -> &DrawShape {
        &self.shape
    }

    fn join(&mut self, next: &Self) -> bool {
        (self.key, self.array) == (next.key, next.array) && self.shape.extend(&next.shape)
    }
}

impl PlanCasters {
    /// What casts of a checked list's `plan`.
    pub fn new(list: &DrawList, places: &TexturePlaces, plan: &Plan) -> Self {
        let (mut chunk, mut end) = (0, 0);
        let merged = plan.merged.iter().map(|part| {
            if part.chunk != chunk {
                (chunk, end) = (part.chunk, 0);
            }
            let start = end;
            end += part.triangles.len() as u32 * 3;
            (part.item, DrawShape::Merged { chunk, indices: start..end })
        });
        let placed = (0..).zip(&plan.placed).map(|(instance, &index)| {
            let item = &list.items[index];
            let indices = item.triangles.start * 3..item.triangles.end * 3;
            (index, DrawShape::Placed { mesh: item.mesh, indices, instances: instance..instance + 1 })
        });
        let call = |(index, shape): (usize, DrawShape)| {
            Some((index, CasterCall::new(list, places, &list.items[index], shape)?))
        };
        Self(merged.chain(placed).filter_map(call).collect())
    }

    /// The keys of all calls.
    pub fn keys(&self) -> impl Iterator<Item = CasterKey> {
        self.0.iter().map(|(_, call)| call.key)
    }

    /// The calls for the ground and those solids that are on a level; few others between them do not part two calls.
    pub fn on_level(&self, is_on: impl Fn(usize) -> bool) -> Vec<CasterCall> {
        shown_calls(self.0.iter().map(|(item, call)| (call, call.key.on_ground || is_on(*item))))
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::*;
    use crate::materials::TextureScope;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DrawMesh, DrawVertex, FeatureId, MeshId};
    use sandtable_draw::material::Material;
    use sandtable_mesh::sink::{MeshSink, VertexId};

    /// Ground, a drape and solids of one triangle with these kinds of alpha; the last three are places of one mesh.
    fn list(solids: &[AlphaMode]) -> DrawList {
        let mut list = DrawList::default();
        let layers = [(DepthLayer::Ground, AlphaMode::Opaque), (DepthLayer::Draped(0), AlphaMode::Opaque)];
        let solids = solids.iter().map(|&alpha| (DepthLayer::Solid, alpha));
        for (layer, alpha) in layers.into_iter().chain(solids) {
            let mut mesh = DrawMesh::default();
            for position in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
                mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE });
            }
            mesh.triangle([VertexId(0), VertexId(1), VertexId(2)]);
            let (mesh, world_from_mesh) = (list.add_mesh(mesh), Mat4::IDENTITY);
            let material = list.add_material(Material { alpha, ..Default::default() });
            let feature = FeatureId::GROUND;
            list.items.push(DrawItem { mesh, triangles: 0..1, material, world_from_mesh, layer, feature });
        }
        for x in [1.0, 2.0] {
            let last = list.items[list.items.len() - 1].clone();
            list.items.push(DrawItem { world_from_mesh: Mat4::from_translation(Vec3::X * x), ..last });
        }
        list
    }

    #[test]
    fn what_casts_is_drawn_from_the_buffers_of_the_plan_and_few_others_part_no_calls() {
        use AlphaMode::{Blend, Mask, Opaque};
        let list = list(&[Opaque, Opaque, Blend, Opaque, Mask(0.5), Opaque]);
        let places = TexturePlaces::new(&list, TextureScope::Items, &wgpu::Limits::default());
        let casters = PlanCasters::new(&list, &places, &Plan::new(&list, &places, |_| true));
        let shapes = |is_on: &dyn Fn(usize) -> bool| -> Vec<(bool, bool, DrawShape)> {
            let calls = casters.on_level(is_on);
            calls.into_iter().map(|call| (call.key.on_ground, call.key.masked, call.shape)).collect()
        };
        let merged = |indices| DrawShape::Merged { chunk: 0, indices };
        let placed = |instances| DrawShape::Placed { mesh: MeshId(7), indices: 0..3, instances };
        let ground = (true, false, merged(0..3));
        assert_eq!(
            shapes(&|_| true),
            [
                ground.clone(),
                (false, false, merged(6..12)),
                (false, false, merged(15..18)),
                (false, true, merged(18..21)),
                (false, false, placed(0..3)),
            ]
        );
        assert_eq!(shapes(&|_| false), std::slice::from_ref(&ground));
        let ends = (false, false, placed(0..3));
        assert_eq!(shapes(&|item| item == 7 || item == 9), [ground.clone(), ends], "one lies between");
        assert_eq!(shapes(&|item| item == 8), [ground, (false, false, placed(1..2))]);
    }
}
