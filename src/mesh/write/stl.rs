//! Binary STL: every triangle with its normal and its three corners, nothing shared.

use std::io::{self, Write};

use crate::mesh::trimesh::TriMesh;
use crate::mesh::write::{Remarks, count};

/// Bytes of the header, which may hold anything but what begins a text STL: `solid`.
const HEADER: usize = 80;

/// Writes `mesh`, the short remark in its header.
///
/// # Errors
/// `out` cannot be written, or there are 2³² triangles or more.
pub fn write(mesh: &TriMesh, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    out.write_all(&header(remarks.short()))?;
    out.write_all(&count(mesh.triangles.len(), "triangles")?.to_le_bytes())?;
    for triangle in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(triangle);
        let normal = (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
        let normal = normal.normalize_or_zero().as_vec3();
        for number in [normal, a, b, c].iter().flat_map(|at| at.to_array()) {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(&[0, 0])?;
    }
    Ok(())
}

/// The text in 80 bytes: what a reader takes for Latin, so without other letters; padded with blanks.
fn header(text: &str) -> [u8; HEADER] {
    let mut header = [b' '; HEADER];
    let text = if text.trim_start().to_ascii_lowercase().starts_with("solid") { "" } else { text };
    for (byte, letter) in header.iter_mut().zip(text.chars()) {
        *byte = if letter.is_ascii() { letter as u8 } else { b'?' };
    }
    header
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::write::samples::{remarks, square};

    #[test]
    fn each_triangle_has_fifty_bytes_after_the_header() {
        let mut bytes = Vec::new();
        write(&square(), &remarks(), &mut bytes).expect("memory");
        assert!(bytes.starts_with(b"origin 5 6  "));
        assert_eq!(bytes.len(), 84 + 2 * 50);
        assert_eq!(bytes[80..84], [2, 0, 0, 0]);
        let number =
            |at: usize| f32::from_le_bytes(bytes[84 + 4 * at..][..4].try_into().expect("four bytes"));
        let normal = glam::Vec3::new(number(0), number(1), number(2));
        assert!((normal.length() - 1.0).abs() < 1e-6 && normal.z > 0.0, "{normal}");
        assert_eq!((number(5), number(8), number(11)), (-1.5, 0.1, 1e7));
    }

    #[test]
    fn a_header_never_passes_for_a_text_file_nor_grows() {
        assert_eq!(header("Solid ground"), [b' '; HEADER]);
        assert_eq!(header(&"ö".repeat(200)), [b'?'; HEADER]);
    }
}
