//! Lumps: an icosahedron, once subdivided or not, pushed in and out.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::{DrawMesh, DrawVertex};
use crate::mesh::sink::{MeshSink, VertexId};

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
        let triangles = triangles_of(&directions);
        Self { directions, triangles }
    }

    /// Each triangle cut in four: 42 directions, 80 triangles.
    pub(super) fn fine() -> Self {
        let mut ball = Self::coarse();
        let mut middles: Vec<((usize, usize), usize)> = Vec::new();
        let mut finer = Vec::with_capacity(80);
        for [a, b, c] in std::mem::take(&mut ball.triangles) {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
                let edge = (from.min(to), from.max(to));
                let known = middles.iter().find(|(known, _)| *known == edge).map(|&(_, middle)| middle);
                known.unwrap_or_else(|| {
                    let middle = ball.directions[from] + ball.directions[to];
                    ball.directions.push(middle.normalize_or_zero());
                    middles.push((edge, ball.directions.len() - 1));
                    ball.directions.len() - 1
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        ball.triangles = finer;
        ball
    }

    /// Adds it with smooth normals: `shape` gives a direction's position and color.
    pub(super) fn add_round(&self, mesh: &mut DrawMesh, shape: impl Fn(Vec3) -> (Vec3, Srgba)) {
        let ids: Vec<VertexId> = self
            .directions
            .iter()
            .map(|&direction| {
                let (position, color) = shape(direction);
                mesh.vertex(vertex(position, direction, color))
            })
            .collect();
        self.triangles.iter().for_each(|corners| mesh.triangle(corners.map(|corner| ids[corner])));
    }

    /// Adds it with sharp edges: `shape` gives a direction's position, `color` a facet's color by its normal.
    pub(super) fn add_sharp(
        &self,
        mesh: &mut DrawMesh,
        shape: impl Fn(Vec3) -> Vec3,
        color: impl Fn(Vec3) -> Srgba,
    ) {
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|corner| shape(self.directions[corner]));
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            let ids = [a, b, c].map(|position| mesh.vertex(vertex(position, normal, color(normal))));
            mesh.triangle(ids);
        }
    }
}

fn vertex(position: Vec3, normal: Vec3, color: Srgba) -> DrawVertex {
    DrawVertex { position: position.to_array(), normal: normal.to_array(), uv: [0.0; 2], color }
}

/// The triples of an icosahedron's corners that are each other's neighbors, turned outward.
fn triangles_of(corners: &[Vec3]) -> Vec<[usize; 3]> {
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

/// A smooth, uneven number in about -1..=1 for a direction: three waves that do not run along one another.
pub(super) fn waves(at: Vec3, phase: f32) -> f32 {
    let wave = |way: Vec3, shift: f32| libm::sinf(at.dot(way) + shift + phase);
    (wave(Vec3::new(3.1, 1.7, -2.3), 0.0)
        + wave(Vec3::new(-1.9, 3.7, 1.3), 2.1)
        + wave(Vec3::new(2.3, -2.9, 3.3), 4.2))
        / 2.2
}

/// The color between two, in 0..=1 of the way, channel by channel.
pub(super) fn between(from: Srgba, to: Srgba, part: f32) -> Srgba {
    let part = part.clamp(0.0, 1.0);
    Srgba(std::array::from_fn(|channel| {
        let (from, to) = (f32::from(from.0[channel]), f32::from(to.0[channel]));
        (from + (to - from) * part + 0.5) as u8
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_closed_and_faces_outward() {
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
