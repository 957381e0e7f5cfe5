//! Checks that meshes together form a closed surface.

use std::collections::BTreeMap;

use glam::Vec3;

use sandtable_draw::list::DrawMesh;

/// A position, bit by bit.
type CornerBits = [u32; 3];

/// Edges nearer than this to each other are one, in meters: computed twice, they are rounded to f32 twice.
const SAME_M: f32 = 1e-3;

/// An edge along which a surface is open.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the surface is open along the edge from {from} to {to}")]
pub struct OpenSurfaceError {
    /// Where the edge begins, in the world.
    pub from: Vec3,
    /// Where it ends.
    pub to: Vec3,
}

/// Whether every edge of a triangle is run along once in each direction, or as often in one as in the other: then the
/// meshes are the whole surface of one or several solids. Positions are compared whichever mesh and vertex they belong
/// to: bit by bit, and where that leaves edges over, to a millimeter.
///
/// # Errors
/// An edge where the surface is open.
pub fn closed(meshes: &[&DrawMesh]) -> Result<(), OpenSurfaceError> {
    unmatched(open_edges(meshes)).map_or(Ok(()), |(from, to)| Err(OpenSurfaceError { from, to }))
}

/// The edges that triangles run along more often in this direction than in the other, compared bit by bit.
pub(crate) fn open_edges(meshes: &[&DrawMesh]) -> impl Iterator<Item = (Vec3, Vec3)> {
    let mut edges: BTreeMap<(CornerBits, CornerBits), i32> = BTreeMap::new();
    for mesh in meshes {
        for triangle in &mesh.triangles {
            // Adding zero makes one number of both zeros.
            let corners = triangle.map(|id| mesh.vertices[id.index()].position.map(|x| (x + 0.0).to_bits()));
            for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(from, to)| (corners[from], corners[to])) {
                let (edge, way) = if from <= to { ((from, to), 1) } else { ((to, from), -1) };
                *edges.entry(edge).or_default() += way;
            }
        }
    }
    edges.into_iter().flat_map(|((from, to), count)| {
        let [from, to] = [from, to].map(|corner| Vec3::from(corner.map(f32::from_bits)));
        let edge = if count > 0 { (from, to) } else { (to, from) };
        std::iter::repeat_n(edge, count.unsigned_abs() as usize)
    })
}

/// The first of some directed edges that has a length and no other runs back along.
fn unmatched(open: impl Iterator<Item = (Vec3, Vec3)>) -> Option<(Vec3, Vec3)> {
    let is_same = |a: Vec3, b: Vec3| (a - b).abs().max_element() < SAME_M;
    let mut left: Vec<(Vec3, Vec3)> = open.filter(|&(from, to)| !is_same(from, to)).collect();
    while let Some((from, to)) = left.pop() {
        match left.iter().position(|&(back, forth)| is_same(back, to) && is_same(forth, from)) {
            Some(other) => drop(left.swap_remove(other)),
            None => return Some((from, to)),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faces::Faces;
    use glam::DVec2;
    use sandtable_draw::color::Srgba;

    #[test]
    fn a_box_is_closed_and_one_without_its_lid_is_not() {
        let ring = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let level = |z: f32| ring.map(|at| at.as_vec2().extend(z));
        let mut faces = Faces::default();
        faces.walls(&ring, (0.0, 3.0), Srgba::WHITE);
        let floor: Vec<Vec3> = level(0.0).into_iter().rev().collect();
        faces.polygon(&floor, Srgba::WHITE);
        assert!(closed(&[&faces.clone().into_mesh()]).is_err());
        faces.polygon(&level(3.0), Srgba::WHITE);
        assert_eq!(closed(&[&faces.into_mesh()]), Ok(()));
    }
}
