//! Binary glTF 2.0: one mesh of one primitive.
//!
//! glTF has Y up, and programs that read it turn it to what they have. The accessors hold the coordinates as the
//! mesh has them, Z up, and the node that shows the mesh carries the turn: `(x, y, z)` becomes `(x, z, −y)`, so
//! that east stays X, up becomes Y and north is −Z, away from the viewer. Who looks at the accessors finds the
//! meters; who looks at the scene finds it upright.

use std::io::{self, Write};

use glam::Vec3;
use serde_json::{Value, json};

use crate::mesh::trimesh::TriMesh;
use crate::mesh::write::{Remarks, count};

/// From X east, Y north, Z up to glTF's axes, column by column.
pub const GLTF_FROM_WORLD: [f32; 16] = [1., 0., 0., 0., 0., 0., -1., 0., 0., 1., 0., 0., 0., 0., 0., 1.];

/// The specification's number for an accessor that holds f32.
pub const FLOAT: u32 = 5126;
/// For one that holds u32.
pub const UNSIGNED_INT: u32 = 5125;
/// For a buffer view of vertices.
pub const ARRAY_BUFFER: u32 = 34962;
/// For one of indices.
pub const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes `mesh`, which has at least one triangle; remarks go to `asset.extras`.
///
/// # Errors
/// `out` cannot be written, the file would be larger than 4 GiB, or there is no triangle.
pub fn write(mesh: &TriMesh, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    if mesh.triangles.is_empty() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "glTF has no mesh without triangles"));
    }
    let (positions, indices) = (mesh.positions.len() * 12, mesh.triangles.len() * 12);
    let mut text = document(mesh, remarks).to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = count(12 + 8 + text.len() + 8 + positions + indices, "bytes")?;
    out.write_all(b"glTF")?;
    for number in [2, total, count(text.len(), "bytes")?] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&count(positions + indices, "bytes")?.to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    for coordinate in mesh.positions.iter().flat_map(|at| at.to_array()) {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    for id in mesh.triangles.iter().flatten() {
        out.write_all(&id.0.to_le_bytes())?;
    }
    Ok(())
}

fn document(mesh: &TriMesh, remarks: &Remarks) -> Value {
    let (vertices, corners) = (mesh.positions.len(), mesh.triangles.len() * 3);
    let low = mesh.positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = mesh.positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    json!({
        "asset": {"version": "2.0", "generator": "sandtable", "extras": {"remarks": remarks.lines()}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "terrain", "mesh": 0, "matrix": GLTF_FROM_WORLD}],
        "meshes": [{"name": "terrain", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {
                "bufferView": 0, "componentType": FLOAT, "count": vertices, "type": "VEC3",
                "min": low.to_array(), "max": high.to_array(),
            },
            {"bufferView": 1, "componentType": UNSIGNED_INT, "count": corners, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": vertices * 12, "target": ARRAY_BUFFER},
            {
                "buffer": 0, "byteOffset": vertices * 12, "byteLength": corners * 4,
                "target": ELEMENT_ARRAY_BUFFER,
            },
        ],
        "buffers": [{"byteLength": vertices * 12 + corners * 4}],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::write::samples::{remarks, square};
    use glam::{Mat4, Vec3};

    #[test]
    fn chunks_are_aligned_and_bounds_are_those_of_the_positions() {
        let mut bytes = Vec::new();
        write(&square(), &remarks(), &mut bytes).expect("memory");
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
    fn the_node_turns_up_to_y_and_north_away() {
        let turn = Mat4::from_cols_array(&GLTF_FROM_WORLD);
        assert_eq!(turn.transform_point3(Vec3::new(1.0, 2.0, 3.0)), Vec3::new(1.0, 3.0, -2.0));
        assert_eq!(turn.determinant(), 1.0);
    }

    #[test]
    fn no_triangle_no_file() {
        assert!(write(&TriMesh::default(), &remarks(), &mut Vec::new()).is_err());
    }
}
