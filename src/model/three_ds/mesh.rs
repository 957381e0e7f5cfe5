//! Triangle meshes: positions, texture coordinates, faces with materials and smoothing groups, and the mesh's axes.

use glam::{Mat4, Vec2, Vec3};

use crate::error::ModelError;

use super::chunk::{Chunk, ChunkCursor};

#[derive(Clone, Debug, Default)]
pub(super) struct TriObject {
    pub name: String,
    /// Positions in the editor's world.
    pub positions: Vec<Vec3>,
    /// As many as positions, or none. V runs upward.
    pub uvs: Vec<Vec2>,
    /// Triples of indices, which may be out of range.
    pub faces: Vec<[u16; 3]>,
    /// Smoothing masks, as many as faces, or none.
    pub smoothing: Vec<u32>,
    pub groups: Vec<MaterialGroup>,
    /// From the object's axes to the editor's world; the identity where none is stored.
    pub world_from_object: Mat4,
}

#[derive(Clone, Debug)]
pub(super) struct MaterialGroup {
    pub material: String,
    /// Indices of faces, which may be out of range.
    pub faces: Vec<u16>,
}

/// The mesh of an object chunk; `None` for a light, a camera or an empty object.
pub(super) fn parse(object: &Chunk<'_>) -> Result<Option<TriObject>, ModelError> {
    const TRI_OBJECT: u16 = 0x4100;
    let mut cursor = object.read();
    let name = cursor.text()?;
    for chunk in cursor.chunks() {
        let chunk = chunk?;
        if chunk.id == TRI_OBJECT {
            return tri_object(name, &chunk).map(Some);
        }
    }
    Ok(None)
}

fn tri_object(name: String, chunk: &Chunk<'_>) -> Result<TriObject, ModelError> {
    const POINTS: u16 = 0x4110;
    const FACES: u16 = 0x4120;
    const TEXTURE_COORDINATES: u16 = 0x4140;
    const MATRIX: u16 = 0x4160;
    let mut mesh = TriObject { name, world_from_object: Mat4::IDENTITY, ..TriObject::default() };
    for part in chunk.children() {
        let part = part?;
        let mut cursor = part.read();
        match part.id {
            POINTS => {
                let count = cursor.u16()?.into();
                mesh.positions = cursor.list(count, 12, ChunkCursor::vec3)?;
            }
            FACES => faces(&mut mesh, cursor)?,
            TEXTURE_COORDINATES => {
                let count = cursor.u16()?.into();
                mesh.uvs = cursor.list(count, 8, |cursor| Ok(Vec2::new(cursor.f32()?, cursor.f32()?)))?;
            }
            MATRIX => {
                let axes = cursor.list(4, 12, ChunkCursor::vec3)?;
                let [x, y, z, origin] = [axes[0], axes[1], axes[2], axes[3]];
                mesh.world_from_object =
                    Mat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), origin.extend(1.0));
            }
            _ => {}
        }
    }
    Ok(mesh)
}

fn faces(mesh: &mut TriObject, mut cursor: ChunkCursor<'_>) -> Result<(), ModelError> {
    const MATERIAL_GROUP: u16 = 0x4130;
    const SMOOTHING: u16 = 0x4150;
    let count = cursor.u16()?.into();
    mesh.faces = cursor.list(count, 8, |cursor| {
        let corners = [cursor.u16()?, cursor.u16()?, cursor.u16()?];
        cursor.u16().map(|_edges_drawn| corners)
    })?;
    for part in cursor.chunks() {
        let part = part?;
        let mut cursor = part.read();
        match part.id {
            MATERIAL_GROUP => {
                let material = cursor.text()?;
                let count = cursor.u16()?.into();
                let faces = cursor.list(count, 2, ChunkCursor::u16)?;
                mesh.groups.push(MaterialGroup { material, faces });
            }
            SMOOTHING => mesh.smoothing = cursor.list(count, 4, ChunkCursor::u32)?,
            _ => {}
        }
    }
    Ok(())
}
