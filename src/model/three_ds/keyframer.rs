//! The keyframer's tree of nodes: the pose of every object at frame 0.
//!
//! A node moves its object by `translation · rotation · scale` of its first keys, in its parent's space.

use glam::{Mat4, Quat, Vec3};

use crate::error::ModelError;

use super::chunk::{Chunk, ChunkCursor};

/// The id that means no parent.
const NO_PARENT: u16 = 0xFFFF;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct KeyframeNode {
    id: u16,
    parent: u16,
    /// The name of its object; `$$$DUMMY` for a node without one.
    pub object: String,
    /// The point, in the object's axes, that the node moves and rotates about.
    pub pivot: Vec3,
    parent_from_node: Mat4,
}

/// The object nodes of a keyframer chunk, in order.
pub(super) fn parse(chunk: &Chunk<'_>) -> Result<Vec<KeyframeNode>, ModelError> {
    const OBJECT_NODE: u16 = 0xB002;
    let mut nodes: Vec<KeyframeNode> = Vec::new();
    for part in chunk.children() {
        let part = part?;
        if part.id == OBJECT_NODE {
            // Files of the first version have no ids; their parents are indices of nodes.
            let next = u16::try_from(nodes.len()).unwrap_or(NO_PARENT);
            nodes.push(node(&part, next)?);
        }
    }
    Ok(nodes)
}

fn node(chunk: &Chunk<'_>, id: u16) -> Result<KeyframeNode, ModelError> {
    const HEADER: u16 = 0xB010;
    const PIVOT: u16 = 0xB013;
    const POSITION: u16 = 0xB020;
    const ROTATION: u16 = 0xB021;
    const SCALE: u16 = 0xB022;
    const ID: u16 = 0xB030;
    let mut node = KeyframeNode {
        id,
        parent: NO_PARENT,
        object: String::new(),
        pivot: Vec3::ZERO,
        parent_from_node: Mat4::IDENTITY,
    };
    let (mut position, mut turn, mut scale) = (Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
    for part in chunk.children() {
        let part = part?;
        let mut cursor = part.read();
        match part.id {
            HEADER => {
                node.object = cursor.text()?;
                cursor.skip(4)?;
                node.parent = cursor.u16()?;
            }
            PIVOT => node.pivot = cursor.vec3()?,
            POSITION => position = first_key(cursor, ChunkCursor::vec3)?.unwrap_or(Vec3::ZERO),
            ROTATION => turn = first_key(cursor, rotation)?.unwrap_or(Quat::IDENTITY),
            SCALE => scale = first_key(cursor, ChunkCursor::vec3)?.unwrap_or(Vec3::ONE),
            ID => node.id = cursor.u16()?,
            _ => {}
        }
    }
    node.parent_from_node = Mat4::from_scale_rotation_translation(scale, turn, position);
    Ok(node)
}

/// The value of a track's first key. A track is `flags: u16, 8 bytes, keys: u32`, then for each key
/// `frame: u32, spline flags: u16`, a float for each of the five spline flags that is set, and the value.
fn first_key<'a, T>(
    mut cursor: ChunkCursor<'a>,
    value: impl FnOnce(&mut ChunkCursor<'a>) -> Result<T, ModelError>,
) -> Result<Option<T>, ModelError> {
    const SPLINE_FLAGS: u16 = 0b1_1111;
    cursor.skip(10)?;
    if cursor.u32()? == 0 {
        return Ok(None);
    }
    cursor.skip(4)?;
    let flags = cursor.u16()? & SPLINE_FLAGS;
    cursor.skip(4 * flags.count_ones() as usize)?;
    value(&mut cursor).map(Some)
}

/// `angle, axis`; the angle is clockwise seen against the axis.
fn rotation(cursor: &mut ChunkCursor<'_>) -> Result<Quat, ModelError> {
    let (angle, axis) = (cursor.f32()?, cursor.vec3()?);
    let axis = axis.try_normalize().unwrap_or(Vec3::Y);
    let (sin, cos) = libm::sincosf(-angle * 0.5);
    let vector = axis * sin;
    Ok(Quat::from_xyzw(vector.x, vector.y, vector.z, cos))
}

/// The transforms from `nodes` to the world, in the same order. Nodes without a parent in the file and nodes that are
/// their own ancestors have the world as their parent.
pub(super) fn world_from_nodes(nodes: &[KeyframeNode]) -> Vec<Mat4> {
    let mut by_id = std::collections::BTreeMap::new();
    for (index, node) in nodes.iter().enumerate() {
        by_id.entry(node.id).or_insert(index);
    }
    let parents: Vec<Option<usize>> = nodes
        .iter()
        .map(|node| if node.parent == NO_PARENT { None } else { by_id.get(&node.parent).copied() })
        .collect();
    let mut done: Vec<Option<Mat4>> = vec![None; nodes.len()];
    let mut open = vec![false; nodes.len()];
    for start in 0..nodes.len() {
        let mut path = Vec::new();
        let mut next = Some(start);
        while let Some(index) = next.filter(|&index| done[index].is_none() && !open[index]) {
            open[index] = true;
            path.push(index);
            next = parents[index];
        }
        for &index in path.iter().rev() {
            let parent = parents[index].and_then(|parent| done[parent]).unwrap_or(Mat4::IDENTITY);
            done[index] = Some(parent * nodes[index].parent_from_node);
        }
    }
    done.into_iter().map(Option::unwrap_or_default).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(id: u16, parent: u16, x: f32) -> KeyframeNode {
        KeyframeNode {
            id,
            parent,
            object: String::new(),
            pivot: Vec3::ZERO,
            parent_from_node: Mat4::from_translation(Vec3::X * x),
        }
    }

    #[test]
    fn children_move_with_their_parents_whatever_the_order() {
        let worlds = world_from_nodes(&[node(5, 7, 1.0), node(7, 9, 10.0), node(9, NO_PARENT, 100.0)]);
        let places: Vec<f32> = worlds.iter().map(|world| world.w_axis.x).collect();
        assert_eq!(places, [111.0, 110.0, 100.0]);
    }

    #[test]
    fn cycles_and_missing_parents_end() {
        let worlds = world_from_nodes(&[node(0, 1, 1.0), node(1, 0, 1.0), node(2, 2, 1.0), node(3, 77, 1.0)]);
        assert!(worlds.iter().all(|world| world.is_finite()));
        assert_eq!(worlds[3].w_axis.x, 1.0);
    }
}
