//! A plinth: the block of concrete between a building and ground that falls away under it.

use glam::Vec3;

use crate::faces::Faces;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;
use sandtable_geom::polygon;

/// Weathered concrete, and its lit top.
const WALL: Srgba = Srgba::opaque(158, 154, 146);
const TOP: Srgba = Srgba::opaque(182, 178, 168);

/// A block with upright walls from `foot_z` up to a flat top, whose corners run counter-clockwise seen from above; world
/// space, drawn heights. It has no underside, which is in the ground.
pub fn block(top: &[Vec3; 4], foot_z: f32) -> DrawMesh {
    let mut faces = Faces::default();
    faces.polygon(top, TOP);
    for (from, to) in polygon::edges(top) {
        faces.polygon(&[from.with_z(foot_z), to.with_z(foot_z), to, from], WALL);
    }
    faces.into_mesh()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn it_is_closed_but_for_its_underside_and_faces_outward_at_four_rotations() {
        for quarter in 0..4 {
            let turn = Quat::from_rotation_z(quarter as f32 * 1.1);
            let corners = [(-3.0, -2.0, 5.0), (3.0, -2.0, 6.0), (3.0, 2.0, 6.0), (-3.0, 2.0, 5.0)];
            let top = corners.map(|(x, y, z)| turn * Vec3::new(x, y, z));
            let mesh = block(&top, 1.0);
            assert_eq!(mesh.triangles.len(), 10);
            // The volume above the foot, by the divergence theorem: 24 m² times 4.5 m.
            let volume: f32 = mesh
                .triangles
                .iter()
                .map(|ids| ids.map(|id| Vec3::from(mesh.vertices[id.index()].position) - Vec3::Z))
                .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                .sum();
            assert!((volume - 108.0).abs() < 1e-2, "{volume}");
        }
    }
}
