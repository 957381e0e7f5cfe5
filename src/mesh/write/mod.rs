//! Writers of mesh files: OBJ, PLY, STL, 3MF and binary glTF.
//!
//! Coordinates are written as the mesh has them: meters, X east, Y north, Z up; an f32 that is read back is the very
//! same. No format has a field for the origin, so files state it in remarks.

pub mod glb;
pub mod glb_mesh;
pub mod obj;
pub mod ply;
pub mod remarks;
pub mod stl;
pub mod three_mf;
pub mod words;

use std::io::{self, Write};

use crate::source::MeshSource;
use crate::write::remarks::Remarks;

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ, text.
    Obj,
    /// Stanford PLY, binary.
    Ply,
    /// STL, binary: triangles without shared vertices.
    Stl,
    /// glTF 2.0 in one binary file.
    Glb,
}

impl MeshFormat {
    /// The format of files with this extension, in any case; `None` for other extensions.
    pub fn from_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }
}

/// Writes `mesh` in a format.
///
/// # Errors
/// `out` cannot be written, the mesh cannot be made, or does not fit the format ([`MeshWriteError`](words::MeshWriteError)).
pub fn write(
    format: MeshFormat,
    mesh: &mut impl MeshSource,
    remarks: &Remarks,
    out: &mut impl Write,
) -> io::Result<()> {
    match format {
        MeshFormat::Obj => obj::write(mesh, remarks, out),
        MeshFormat::Ply => ply::write(mesh, remarks, out),
        MeshFormat::Stl => stl::write(mesh, remarks, out),
        MeshFormat::Glb => glb_mesh::write(mesh, remarks, out),
    }
}

#[cfg(test)]
pub(in crate::write) mod samples {
    use crate::sink::{MeshSink, VertexId};
    use crate::trimesh::TriMesh;
    use crate::write::remarks::Remarks;
    use glam::Vec3;

    /// A square of two triangles, one corner raised.
    pub fn square() -> TriMesh {
        let mut mesh = TriMesh::default();
        for (x, y, z) in [(0.0, 0.0, -1.5), (2.0, 0.0, 0.1), (2.0, 3.0, 1e7), (0.0, 3.0, 1.0 / 3.0)] {
            mesh.vertex(Vec3::new(x, y, z));
        }
        mesh.triangle([0, 1, 2].map(VertexId));
        mesh.triangle([0, 2, 3].map(VertexId));
        mesh
    }

    pub fn remarks() -> Remarks {
        Remarks::new(&["a\nv 9 9 9".into(), "zwölf".into()], "origin 5 6")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trimesh::TriMesh;

    #[test]
    fn formats_are_known_by_their_extensions_in_any_case() {
        assert_eq!(MeshFormat::from_extension("GLB"), Some(MeshFormat::Glb));
        assert_eq!(MeshFormat::from_extension("gltf"), None);
    }

    #[test]
    fn a_glb_without_triangles_is_refused() {
        let result = write(MeshFormat::Glb, &mut &TriMesh::default(), &samples::remarks(), &mut Vec::new());
        assert_eq!(result.expect_err("empty").kind(), io::ErrorKind::InvalidInput);
    }
}
