//! A mesh as a binary glTF file that is written while the mesh is made.

use std::io::{self, Write};

use serde_json::json;

use crate::source::{MeshSize, MeshSource};
use crate::write::glb::{
    ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, FLOAT, GLTF_FROM_WORLD, UNSIGNED_INT, write_chunks,
};
use crate::write::remarks::Remarks;
use crate::write::words::{MeshWriteError, little_endian};

/// Bytes of a vertex and of a triangle: three numbers of 32 bits.
const BYTES: usize = 12;

/// Writes `mesh` as a [`GlbScene`](crate::write::glb::GlbScene) of one node writes it; remarks go to `asset.extras`.
///
/// # Errors
/// `out` cannot be written, the mesh cannot be made, has no triangle, or its file would exceed 4 GiB.
pub fn write(mesh: &mut impl MeshSource, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    let MeshSize { vertices, triangles, bounds } = mesh.size();
    if triangles == 0 {
        return Err(MeshWriteError::Empty.into());
    }
    let (positions, length) = (BYTES * vertices, BYTES * (vertices + triangles));
    let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
    let document = json!({
        "asset": {"version": "2.0", "generator": "sandtable", "extras": {"remarks": remarks.lines}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "world", "matrix": GLTF_FROM_WORLD, "children": [1]},
            {"mesh": 0, "name": "terrain"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": length}],
        "accessors": [
            {
                "componentType": FLOAT, "type": "VEC3", "min": min, "max": max,
                "bufferView": 0, "byteOffset": 0, "count": vertices,
            },
            {
                "componentType": UNSIGNED_INT, "type": "SCALAR",
                "bufferView": 1, "byteOffset": 0, "count": 3 * triangles,
            },
        ],
        "bufferViews": [
            {
                "byteStride": BYTES, "target": ARRAY_BUFFER,
                "buffer": 0, "byteOffset": 0, "byteLength": positions,
            },
            {
                "target": ELEMENT_ARRAY_BUFFER,
                "buffer": 0, "byteOffset": positions, "byteLength": BYTES * triangles,
            },
        ],
    });
    write_chunks(document.to_string(), length, out)?;
    mesh.each_vertex(&mut |position| out.write_all(&little_endian(&[position])))?;
    mesh.each_triangle(&mut |corners| out.write_all(&little_endian(&corners)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::glb::{GlbNode, GlbPrimitive, GlbScene, GlbVertices};
    use crate::write::samples::{remarks, square};
    use glam::Mat4;
    use serde_json::Value;
    use std::borrow::Cow;

    #[test]
    fn chunks_are_aligned_and_bounds_are_those_of_the_positions() {
        let mut bytes = Vec::new();
        write(&mut &square(), &remarks(), &mut bytes).expect("memory");
        let number =
            |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
        let text = number(12);
        assert_eq!((text % 4, number(20 + text), &bytes[24 + text..28 + text]), (0, 72, &b"BIN\0"[..]));
        let document: Value = serde_json::from_slice(&bytes[20..20 + text]).expect("JSON");
        assert_eq!(document["accessors"][0]["min"], json!([0.0f32, 0.0f32, -1.5f32]));
        assert_eq!(document["accessors"][0]["max"], json!([2.0f32, 3.0f32, 1e7f32]));
        assert_eq!(document["asset"]["extras"]["remarks"][1], "zwölf");
    }

    #[test]
    fn the_file_is_that_of_a_scene_of_one_node() {
        let mesh = square();
        let primitive =
            GlbPrimitive { vertices: 0, triangles: Cow::Borrowed(&mesh.triangles), material: None };
        let scene = GlbScene {
            vertices: vec![GlbVertices {
                positions: Cow::Borrowed(&mesh.positions),
                ..GlbVertices::default()
            }],
            meshes: vec![vec![primitive]],
            nodes: vec![GlbNode { name: "terrain".into(), mesh: 0, world_from_mesh: Mat4::IDENTITY }],
            ..GlbScene::default()
        };
        let (mut whole, mut streamed) = (Vec::new(), Vec::new());
        scene.write(&remarks(), &mut whole).expect("memory");
        write(&mut &mesh, &remarks(), &mut streamed).expect("memory");
        assert_eq!(streamed, whole);
    }
}
