//! Beams: straight bars from one point to another, of which pylons, posts and obstacles are made.

use glam::Vec3;

use crate::faces::Faces;
use sandtable_draw::color::Srgba;

/// Adds a bar with a square section from `from` to `to`, `half_m` from its axis to its sides at either end, closed at
/// both; nothing where it has no length.
pub fn beam(faces: &mut Faces, (from, to): (Vec3, Vec3), half_m: (f32, f32), color: Srgba) {
    let Some(way) = (to - from).try_normalize() else { return };
    // Upright bars stand square to the axes of the world, others with two sides level.
    let aside = way.cross(Vec3::Z).try_normalize().unwrap_or(Vec3::X);
    square(faces, (from, to), half_m, aside, color);
}

/// As [`beam`], two of its sides facing along `aside`, a unit vector across it.
pub fn square(faces: &mut Faces, (from, to): (Vec3, Vec3), half_m: (f32, f32), aside: Vec3, color: Srgba) {
    let Some(way) = (to - from).try_normalize() else { return };
    let other = way.cross(aside);
    // Counter-clockwise seen against the way.
    let ring = |at: Vec3, half: f32| {
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(a, b)| at + (aside * a + other * b) * half)
    };
    let (near, far) = (ring(from, half_m.0), ring(to, half_m.1));
    faces.tube(&near, &far, color);
    faces.polygon(&far, color);
    faces.polygon(&[near[3], near[2], near[1], near[0]], color);
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_mesh::sink::VertexId;

    #[test]
    fn every_side_faces_outward_whichever_way_it_points() {
        for way in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(1.0, -2.0, 0.5), Vec3::new(-3.0, 0.1, -1.0)] {
            let mut faces = Faces::default();
            beam(&mut faces, (Vec3::ONE, Vec3::ONE + way * 4.0), (0.3, 0.1), Srgba::WHITE);
            let mesh = faces.into_mesh();
            let corner = |id: VertexId| Vec3::from(mesh.vertices[id.index()].position) - Vec3::ONE;
            let volume: f32 = mesh
                .triangles
                .iter()
                .map(|t| {
                    let [a, b, c] = t.map(corner);
                    a.cross(b).dot(c) / 6.0
                })
                .sum();
            // A frustum: length times (A + B + √(AB)) / 3.
            let expected = (way * 4.0).length() * (0.36 + 0.04 + 0.12) / 3.0;
            assert!((volume - expected).abs() < 1e-3, "{volume} {expected} along {way}");
        }
    }
}
