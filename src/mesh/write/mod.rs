//! Meshes as files that other programs read: OBJ, PLY, STL and binary glTF.
//!
//! All say where the mesh stands in remarks, since none of the formats has a place for it. Coordinates are written
//! as the mesh has them (meters, X east, Y north, Z up), every one so that an f32 read back is the very same.

pub mod glb;
pub mod obj;
pub mod ply;
pub mod stl;

use std::io::{self, Write};

use crate::mesh::trimesh::TriMesh;

/// A format by the extension of its files.
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
    /// The format of files with this extension, in upper or lower case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }
}

/// What a file says about the mesh in it: lines without control characters, so that none of them can end a comment
/// or begin anything else.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Remarks {
    lines: Vec<String>,
    short: String,
}

impl Remarks {
    /// Full sentences, and in short what fits the 80 bytes that STL has; more is cut off there.
    pub fn new(lines: &[String], short: &str) -> Self {
        Self { lines: lines.iter().map(|line| plain(line)).collect(), short: plain(short) }
    }

    /// All lines.
    pub fn lines(&self) -> &[String] {
        &self.lines
    }

    /// The short form.
    pub fn short(&self) -> &str {
        &self.short
    }
}

fn plain(line: &str) -> String {
    line.chars().map(|at| if at.is_control() { '?' } else { at }).collect()
}

/// Writes `mesh` in a format.
///
/// # Errors
/// `out` cannot be written, or the mesh is larger than the format can hold.
pub fn write(format: MeshFormat, mesh: &TriMesh, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    match format {
        MeshFormat::Obj => obj::write(mesh, remarks, out),
        MeshFormat::Ply => ply::write(mesh, remarks, out),
        MeshFormat::Stl => stl::write(mesh, remarks, out),
        MeshFormat::Glb => glb::write(mesh, remarks, out),
    }
}

/// A count as the 32 bits that a format has for it.
///
/// # Errors
/// It is more than they hold.
pub fn count(number: usize, what: &str) -> io::Result<u32> {
    u32::try_from(number).map_err(|_| {
        let reason = format!("{number} {what} are more than this format can hold; choose a larger error");
        io::Error::new(io::ErrorKind::InvalidInput, reason)
    })
}

#[cfg(test)]
pub(in crate::mesh::write) mod samples {
    use super::Remarks;
    use crate::mesh::sink::{MeshSink, VertexId};
    use crate::mesh::trimesh::TriMesh;
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

    #[test]
    fn formats_go_by_extension_in_any_case() {
        assert_eq!(MeshFormat::of_extension("GLB"), Some(MeshFormat::Glb));
        assert_eq!(MeshFormat::of_extension("gltf"), None);
    }

    #[test]
    fn remarks_are_single_lines() {
        assert_eq!(samples::remarks().lines(), ["a?v 9 9 9", "zwölf"]);
    }
}
