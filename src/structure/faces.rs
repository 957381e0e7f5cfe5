//! Flat faces with one color each, from which all structures are made.

use glam::{DVec2, Vec2, Vec3};

use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_geom::polygon;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// Collects faces; each has vertices of its own, so that its edges are sharp.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    mesh: DrawMesh,
}

impl Faces {
    /// The collected faces as a mesh.
    pub fn into_mesh(self) -> DrawMesh {
        self.mesh
    }

    /// Adds a convex, flat polygon, counter-clockwise seen from where it faces; nothing where it has no area.
    pub fn polygon(&mut self, corners: &[Vec3], color: Srgba) {
        self.textured(corners.iter().map(|&at| (at, Vec2::ZERO)), color);
    }

    /// As [`Self::polygon`], with texture coordinates.
    pub fn textured(&mut self, corners: impl IntoIterator<Item = (Vec3, Vec2)>, color: Srgba) {
        let ids = self.vertices(&corners.into_iter().collect::<Vec<_>>(), color);
        polygon::fan(&ids).for_each(|triangle| self.mesh.triangle(triangle));
    }

    /// Adds the corners of a flat polygon with its normal; none where it has no area.
    fn vertices(&mut self, corners: &[(Vec3, Vec2)], color: Srgba) -> Vec<VertexId> {
        let Some(normal) = normal(corners) else { return Vec::new() };
        let vertex = |&(at, uv): &(Vec3, Vec2)| {
            let (position, normal, uv) = (at.to_array(), normal.to_array(), uv.to_array());
            self.mesh.vertex(DrawVertex { position, normal, uv, color })
        };
        corners.iter().map(vertex).collect()
    }

    /// Adds the quads between two rings of as many corners, the second counter-clockwise about the first seen from outside.
    pub fn tube(&mut self, near: &[Vec3], far: &[Vec3], color: Srgba) {
        for ((a, b), (d, c)) in polygon::edges(near).zip(polygon::edges(far)) {
            self.polygon(&[a, b, c, d], color);
        }
    }

    /// Adds the closed solid of tubes between rings in a row.
    pub fn stack<const CORNERS: usize>(&mut self, rings: &[[Vec3; CORNERS]], color: Srgba) {
        for pair in rings.windows(2) {
            self.tube(&pair[0], &pair[1], color);
        }
        if let [first, .., last] = rings {
            self.polygon(&std::array::from_fn::<_, CORNERS, _>(|at| first[CORNERS - 1 - at]), color);
            self.polygon(last, color);
        }
    }

    /// Adds a flat polygon of any shape in triangles, triples of positions in `corners`, all counter-clockwise seen from
    /// where it faces; nothing where it has no area.
    pub fn flat(&mut self, corners: &[Vec3], triangles: &[[usize; 3]], color: Srgba) {
        let around: Vec<(Vec3, Vec2)> = corners.iter().map(|&at| (at, Vec2::ZERO)).collect();
        let ids = self.vertices(&around, color);
        if !ids.is_empty() {
            triangles.iter().for_each(|triangle| self.mesh.triangle(triangle.map(|index| ids[index])));
        }
    }

    /// Adds upright walls under a closed ring, counter-clockwise in plan, facing outward: from `foot` to `top`, both
    /// drawn heights.
    pub fn walls(&mut self, ring: &[DVec2], (foot, top): (f32, f32), color: Srgba) {
        let at = |plan: DVec2, z: f32| plan.as_vec2().extend(z);
        for (from, to) in polygon::edges(ring) {
            self.polygon(&[at(from, foot), at(to, foot), at(to, top), at(from, top)], color);
        }
    }
}

/// The unit normal of a flat polygon by Newell's sum; `None` where it has no area.
fn normal(corners: &[(Vec3, Vec2)]) -> Option<Vec3> {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let first = corners.first()?.0;
    edges.map(|((a, _), (b, _))| (a - first).cross(b - first)).sum::<Vec3>().try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_face_outward_however_they_are_turned() {
        for quarter in 0..4 {
            let ring: Vec<DVec2> = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]
                .map(|(x, y)| (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp()))
                .to_vec();
            let middle = ring.iter().sum::<DVec2>().as_vec2() / 4.0;
            let mut faces = Faces::default();
            faces.walls(&ring, (1.0, 6.0), Srgba::WHITE);
            let mesh = faces.into_mesh();
            assert_eq!(mesh.triangles.len(), 8);
            for vertex in &mesh.vertices {
                let (at, normal) = (Vec3::from(vertex.position), Vec3::from(vertex.normal));
                assert!(normal.truncate().dot(at.truncate() - middle) > 0.0, "{at} faces {normal}");
            }
        }
    }

    #[test]
    fn a_face_without_area_is_left_out() {
        let mut faces = Faces::default();
        faces.polygon(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], Srgba::WHITE);
        assert!(faces.into_mesh().vertices.is_empty());
    }
}
