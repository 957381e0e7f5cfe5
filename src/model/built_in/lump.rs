//! Lumps: an icosahedron, subdivided once or not, with an uneven surface.

use glam::Vec3;

use crate::built_in::vertex::colored_vertex;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_mesh::numbering::Numbering;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// An uneven ellipsoid of leaves: its center and half its size, in meters.
pub(super) struct Lump {
    pub center: Vec3,
    pub half: Vec3,
}

impl Lump {
    /// The surface in a direction. `unevenness` moves it outward relative to the lump's size.
    pub(super) fn surface(&self, direction: Vec3, unevenness: f32) -> Vec3 {
        self.center + self.half * direction * (1.0 + unevenness)
    }
}

/// Unit directions and counter-clockwise triangles of them.
pub(super) struct UnitSphere {
    pub directions: Vec<Vec3>,
    pub triangles: Vec<[usize; 3]>,
}

impl UnitSphere {
    /// An icosahedron: 12 directions, 20 triangles.
    pub(super) fn coarse() -> Self {
        let golden = (1.0 + libm::sqrtf(5.0)) / 2.0;
        let directions = [(0.0, 1.0, golden), (0.0, -1.0, golden), (0.0, 1.0, -golden), (0.0, -1.0, -golden)]
            .into_iter()
            .flat_map(|(a, b, c)| [Vec3::new(a, b, c), Vec3::new(c, a, b), Vec3::new(b, c, a)])
            .map(Vec3::normalize)
            .collect::<Vec<_>>();
        let triangles = icosahedron_triangles(&directions);
        Self { directions, triangles }
    }

    /// An icosahedron with each triangle cut in four: 42 directions, 80 triangles.
    pub(super) fn fine() -> Self {
        let Self { mut directions, triangles } = Self::coarse();
        let first = directions.len();
        let mut edges = Numbering::default();
        let mut finer = Vec::with_capacity(80);
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
                let edge = edges.number((from.min(to), from.max(to)));
                if edge.is_new {
                    directions.push((directions[from] + directions[to]).normalize_or_zero());
                }
                first + edge.index as usize
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Self { directions, triangles: finer }
    }

    /// Adds it with smooth normals: `shape` gives a direction's vertex.
    pub(super) fn add_smooth(&self, mesh: &mut DrawMesh, shape: impl Fn(Vec3) -> DrawVertex) {
        let ids: Vec<VertexId> =
            self.directions.iter().map(|&direction| mesh.vertex(shape(direction))).collect();
        self.triangles.iter().for_each(|corners| mesh.triangle(corners.map(|corner| ids[corner])));
    }

    /// Adds it with sharp edges: `shape` gives a direction's position, `color` a facet's color by its normal.
    pub(super) fn add_faceted(
        &self,
        mesh: &mut DrawMesh,
        shape: impl Fn(Vec3) -> Vec3,
        color: impl Fn(Vec3) -> Srgba,
    ) {
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|corner| shape(self.directions[corner]));
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            let ids = [a, b, c].map(|position| mesh.vertex(colored_vertex(position, normal, color(normal))));
            mesh.triangle(ids);
        }
    }
}

/// The triples of an icosahedron's corners that are neighbors of each other, facing outward.
fn icosahedron_triangles(corners: &[Vec3]) -> Vec<[usize; 3]> {
    let near = |a: usize, b: usize| corners[a].dot(corners[b]) > 0.4;
    let count = corners.len();
    (0..count)
        .flat_map(|a| (a + 1..count).map(move |b| (a, b)))
        .flat_map(|(a, b)| (b + 1..count).map(move |c| [a, b, c]))
        .filter(|&[a, b, c]| near(a, b) && near(b, c) && near(c, a))
        .map(|[a, b, c]| {
            let outward = (corners[b] - corners[a]).cross(corners[c] - corners[a]).dot(corners[a]) > 0.0;
            if outward { [a, b, c] } else { [a, c, b] }
        })
        .collect()
}

/// A smooth noise of a direction in about −1..=1: three waves in independent directions.
pub(super) fn waves(at: Vec3, phase: f32) -> f32 {
    let wave = |frequency: Vec3, shift: f32| libm::sinf(at.dot(frequency) + shift + phase);
    (wave(Vec3::new(3.1, 1.7, -2.3), 0.0)
        + wave(Vec3::new(-1.9, 3.7, 1.3), 2.1)
        + wave(Vec3::new(2.3, -2.9, 3.3), 4.2))
        / 2.2
}

/// The color at `t` in 0..=1 between two, channel by channel.
pub(super) fn mix(from: Srgba, to: Srgba, t: f32) -> Srgba {
    let t = t.clamp(0.0, 1.0);
    Srgba(std::array::from_fn(|channel| {
        let (from, to) = (f32::from(from.0[channel]), f32::from(to.0[channel]));
        (from + (to - from) * t + 0.5) as u8
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_sphere_is_closed_and_faces_outward() {
        for (ball, corners, triangles) in [(UnitSphere::coarse(), 12, 20), (UnitSphere::fine(), 42, 80)] {
            assert_eq!((ball.directions.len(), ball.triangles.len()), (corners, triangles));
            let sum: f32 = ball
                .triangles
                .iter()
                .map(|ids| ids.map(|id| ball.directions[id]))
                .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                .sum();
            assert!(sum > 2.5 && sum < 4.19, "its volume is nearly the unit ball's: {sum}");
        }
    }
}
