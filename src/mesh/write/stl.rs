//! Binary STL: every triangle with its normal and its three corners; no vertex is shared.

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use crate::source::MeshSource;
use crate::write::remarks::Remarks;
use crate::write::words::{count_u32, little_endian};
use sandtable_geom::triangle::normal;

/// Bytes of the header. It must not begin with `solid`, as text STL files do.
const HEADER: usize = 80;

/// Writes `mesh`; the header holds the short remark.
///
/// # Errors
/// `out` cannot be written, the mesh cannot be made, or has 2³² triangles or more.
pub fn write(mesh: &mut impl MeshSource, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    out.write_all(&header(&remarks.short))?;
    out.write_all(&count_u32(mesh.size().triangles, "triangles")?.to_le_bytes())?;
    mesh.each_facet(&mut |[a, b, c]| {
        let normal: DVec3 = normal([a, b, c].map(Vec3::as_dvec3)).normalize_or_zero();
        out.write_all(&little_endian(&[normal.as_vec3(), a, b, c]))?;
        out.write_all(&[0, 0])
    })
}

/// `text` in 80 bytes: other letters than ASCII become `?`, the rest is blanks.
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
    use crate::write::samples::{remarks, square};

    #[test]
    fn each_triangle_has_fifty_bytes_after_the_header() {
        let mut bytes = Vec::new();
        write(&mut &square(), &remarks(), &mut bytes).expect("memory");
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
