//! Stanford PLY, binary and little-endian, with 32-bit coordinates and indices.

use std::io::{self, Write};

use crate::source::{MeshSize, MeshSource};
use crate::write::remarks::Remarks;
use crate::write::words::little_endian;

/// Writes `mesh`.
///
/// # Errors
/// `out` cannot be written, or the mesh cannot be made.
pub fn write(mesh: &mut impl MeshSource, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    out.write_all(b"ply\nformat binary_little_endian 1.0\n")?;
    for line in &remarks.lines {
        writeln!(out, "comment {line}")?;
    }
    let MeshSize { vertices, triangles, .. } = mesh.size();
    writeln!(out, "element vertex {vertices}")?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property float {axis}")?;
    }
    writeln!(out, "element face {triangles}")?;
    out.write_all(b"property list uchar uint vertex_indices\nend_header\n")?;
    mesh.each_vertex(&mut |position| out.write_all(&little_endian(&[position])))?;
    mesh.each_triangle(&mut |corners| {
        out.write_all(&[3])?;
        out.write_all(&little_endian(&corners))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::samples::{remarks, square};

    #[test]
    fn the_header_states_what_follows_it() {
        let mut bytes = Vec::new();
        write(&mut &square(), &remarks(), &mut bytes).expect("memory");
        let end = b"end_header\n";
        let start = bytes.windows(end.len()).position(|window| window == end).expect("a header") + end.len();
        let header = std::str::from_utf8(&bytes[..start]).expect("UTF-8");
        assert!(header.contains("\ncomment a?v 9 9 9\ncomment zwölf\n"), "{header}");
        assert!(header.contains("\nelement vertex 4\n") && header.contains("\nelement face 2\n"), "{header}");
        let body = &bytes[start..];
        assert_eq!(body.len(), 4 * 12 + 2 * 13);
        assert_eq!(body[8..12], (-1.5f32).to_le_bytes());
        assert_eq!(body[48..61], [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    }
}
