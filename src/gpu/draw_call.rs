//! A call of the device: what it draws and with what, and which calls are one.

use std::ops::Range;

use crate::culling::GroupId;
use crate::materials::{ArrayId, TexturePlaces};
use crate::parts::ShaderParts;
use crate::pipeline_key::{DepthRule, PipelineKey, VertexSource};
use sandtable_draw::list::{DepthLayer, DrawList, MeshId};
use sandtable_draw::material::AlphaMode;

/// The most triangles that are not shown which a call draws between those that are: they cost a device less than another call costs
/// the processor.
pub const HIDDEN_TRIANGLES: u64 = 1024;

/// A call that may draw what follows it, too.
pub trait JoinedCall: Clone {
    /// What it draws.
    fn shape(&self) -> &DrawShape;

    /// Adds `next` to this call if one call draws both, this one first.
    fn join(&mut self, next: &Self) -> bool;
}

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
    pub parts: ShaderParts,
    pub rule: DepthRule,
    pub two_sided: bool,
    pub masked: bool,
    /// The group of what it draws; `None` in a plan without groups.
    pub group: Option<GroupId>,
}

impl DrawCall {
    /// The key of its pipeline in a picture that has the parts `picture`.
    pub fn key(&self, picture: ShaderParts) -> PipelineKey {
        let source = match self.shape {
            DrawShape::Merged { .. } => VertexSource::Merged,
            DrawShape::Placed { .. } => VertexSource::Placed,
        };
        let Self { rule, two_sided, masked, array, .. } = *self;
        let is_colored = self.parts != self.parts.of_alpha();
        let parts = if is_colored { self.parts.in_picture(picture) } else { self.parts };
        PipelineKey { source, rule, two_sided, masked, textured: array != ArrayId::NONE, parts }
    }
}

impl JoinedCall for DrawCall {
    fn shape(&self) -> &DrawShape {
        &self.shape
    }

    fn join(&mut self, next: &Self) -> bool {
        let is_alike = (self.rule, self.two_sided, self.masked) == (next.rule, next.two_sided, next.masked);
        let array = self.array.max(next.array);
        let shares_array = [self.array, next.array].iter().all(|&own| own == array || own == ArrayId::NONE);
        // What is seen in one frame and not in the next must not need another pipeline.
        let is_same = self.group.is_none() || (self.array, self.parts) == (next.array, next.parts);
        let joins = is_alike && shares_array && is_same && self.shape.extend(&next.shape);
        if joins {
            self.array = array;
            self.parts = self.parts.with(next.parts);
        }
        joins
    }
}

impl DrawShape {
    /// How many triangles it has at all places.
    pub fn triangles(&self) -> u64 {
        let (indices, places) = match self {
            Self::Merged { indices, .. } => (indices, 1),
            Self::Placed { indices, instances, .. } => (indices, instances.len() as u64),
        };
        indices.len() as u64 / 3 * places
    }

    /// Adds `next` if it goes on where this one ends.
    pub fn extend(&mut self, next: &Self) -> bool {
        match (self, next) {
            (Self::Merged { chunk, indices }, Self::Merged { chunk: next_chunk, indices: added })
                if *chunk == *next_chunk && indices.end == added.start =>
            {
                indices.end = added.end;
                true
            }
            (
                Self::Placed { mesh, indices, instances },
                Self::Placed { mesh: next_mesh, indices: next_indices, instances: added },
            ) if (*mesh, &*indices) == (*next_mesh, next_indices) && instances.end == added.start => {
                instances.end = added.end;
                true
            }
            _ => false,
        }
    }
}

/// The call that draws the color of an item, or of a run that it is the first of.
pub fn color_call(
    list: &DrawList,
    places: &TexturePlaces,
    (index, group): (usize, Option<GroupId>),
    shape: DrawShape,
) -> DrawCall {
    let item = &list.items[index];
    let material = &list.materials[item.material.0 as usize];
    let is_draped = matches!(item.layer, DepthLayer::Draped(_));
    DrawCall {
        shape,
        array: places.array_of(item.material),
        parts: ShaderParts::of_material(material),
        rule: if is_draped { DepthRule::Drape } else { DepthRule::Solid },
        two_sided: material.two_sided,
        masked: matches!(material.alpha, AlphaMode::Mask(_)),
        group,
    }
}

/// Those of `calls` that are shown, in order; few others between them do not part two that one call draws.
pub fn shown_calls<'a, C: JoinedCall + 'a>(calls: impl Iterator<Item = (&'a C, bool)>) -> Vec<C> {
    let mut shown: Vec<C> = Vec::new();
    // The last of them with others that follow it.
    let mut bridge: Option<C> = None;
    for (call, is_shown) in calls {
        if is_shown {
            let over = bridge.take().and_then(|mut over| over.join(call).then_some(over));
            match (shown.last_mut(), over) {
                (Some(last), Some(over)) => *last = over,
                _ => shown.push(call.clone()),
            }
            bridge = shown.last().cloned();
        } else if let (Some(last), Some(over)) = (shown.last(), &mut bridge) {
            let is_bridged =
                over.join(call) && over.shape().triangles() - last.shape().triangles() <= HIDDEN_TRIANGLES;
            bridge = bridge.filter(|_| is_bridged);
        }
    }
    shown
}

/// Adds a call; calls of different groups stay apart.
pub fn push(calls: &mut Vec<DrawCall>, call: DrawCall) {
    let joins = |last: &mut DrawCall| last.group == call.group && last.join(&call);
    if !calls.last_mut().is_some_and(joins) {
        calls.push(call);
    }
}
