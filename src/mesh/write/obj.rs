//! Wavefront OBJ: a line a vertex, a line a face, indices from 1.

use std::io::{self, Write};

use crate::mesh::trimesh::TriMesh;
use crate::mesh::write::Remarks;

/// Writes `mesh`; coordinates in the fewest digits that tell them from their neighbors.
///
/// # Errors
/// `out` cannot be written.
pub fn write(mesh: &TriMesh, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
    for line in remarks.lines() {
        writeln!(out, "# {line}")?;
    }
    for at in &mesh.positions {
        writeln!(out, "v {} {} {}", at.x, at.y, at.z)?;
    }
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|id| id.index() + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::write::samples::{remarks, square};

    #[test]
    fn a_reader_gets_back_what_was_written() {
        let mut text = Vec::new();
        write(&square(), &remarks(), &mut text).expect("memory");
        let text = String::from_utf8(text).expect("UTF-8");
        assert!(text.starts_with("# a?v 9 9 9\n# zwölf\nv 0 0 -1.5\n"), "{text}");
        let numbers = |kind: &str| -> Vec<f32> {
            let lines = text.lines().filter(|line| line.starts_with(kind));
            lines
                .flat_map(|line| line.split(' ').skip(1).map(|word| word.parse().expect("a number")))
                .collect()
        };
        let expected: Vec<f32> = square().positions.iter().flat_map(|at| at.to_array()).collect();
        assert_eq!(numbers("v "), expected);
        assert_eq!(numbers("f "), [1.0, 2.0, 3.0, 1.0, 3.0, 4.0]);
    }
}
