//! The ground without what lies on it.
//!
//! Everything draped was cut along the ground's triangles, so each of its triangles lies in one of them. Here each
//! triangle of the ground loses, in plan, those that lie in it; what is left lies in the same plane. Ground and drapes
//! together then cover every place once, and no program can draw one through the other.

use std::collections::BTreeMap;

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use crate::draw::list::{DrawMesh, DrawVertex};
use crate::geom::convex;
use crate::geom::polygon;
use crate::geom::rect::Rect;
use crate::mesh::sink::{MeshSink, VertexId};
use crate::terrain::triangle_surface::{SurfaceTriangle, facet_contains, plane_z};

/// What is left is kept from this area on, in square meters: less is what rounding to f32 makes of nothing.
const SLIVER_M2: f64 = 1e-4;

/// `ground` without what the triangles of `drapes` cover. Both in world space.
pub fn inlaid<'a>(ground: &DrawMesh, drapes: impl IntoIterator<Item = &'a DrawMesh>) -> DrawMesh {
    let facets: Vec<SurfaceTriangle> = facets(ground).collect();
    let over = assigned(&facets, drapes);
    let pieces: Vec<Option<Vec<Vec<DVec2>>>> = facets
        .par_iter()
        .zip(&over)
        .map(|(facet, over)| (!over.is_empty()).then(|| uncovered(facet, over)))
        .collect();
    let mut left = DrawMesh::default();
    let mut kept: Vec<Option<VertexId>> = vec![None; ground.vertices.len()];
    for ((ids, facet), pieces) in ground.triangles.iter().zip(&facets).zip(pieces) {
        match pieces {
            None => {
                let ids = ids.map(|id| {
                    *kept[id.index()].get_or_insert_with(|| left.vertex(ground.vertices[id.index()]))
                });
                left.triangle(ids);
            }
            Some(pieces) => {
                let like = ground.vertices[ids[0].index()];
                pieces.iter().for_each(|piece| add(&mut left, piece, facet, like));
            }
        }
    }
    left
}

fn facets(mesh: &DrawMesh) -> impl Iterator<Item = SurfaceTriangle> + '_ {
    let corner = |id: VertexId| Vec3::from(mesh.vertices[id.index()].position);
    mesh.triangles.iter().map(move |ids| ids.map(corner))
}

/// For each facet the drapes' triangles in it, in plan.
fn assigned<'a>(
    facets: &[SurfaceTriangle],
    drapes: impl IntoIterator<Item = &'a DrawMesh>,
) -> Vec<Vec<[DVec2; 3]>> {
    let squares = Squares::of(facets);
    let mut over = vec![Vec::new(); facets.len()];
    for triangle in drapes.into_iter().flat_map(self::facets) {
        let plan = triangle.map(|corner| corner.truncate().as_dvec2());
        if let Some(facet) = squares.facet_at(facets, (plan[0] + plan[1] + plan[2]) / 3.0) {
            over[facet].push(plan);
        }
    }
    over
}

/// Which facets may lie over a place.
struct Squares {
    side: f64,
    members: BTreeMap<(i64, i64), Vec<u32>>,
}

impl Squares {
    fn of(facets: &[SurfaceTriangle]) -> Self {
        let bounds = |facet: &SurfaceTriangle| Rect::around(facet.map(|corner| corner.truncate().as_dvec2()));
        let sum: f64 = facets.iter().map(|facet| bounds(facet).size().max_element()).sum();
        let side = (sum / facets.len().max(1) as f64).max(1e-3);
        let mut members: BTreeMap<(i64, i64), Vec<u32>> = BTreeMap::new();
        for (index, facet) in facets.iter().enumerate() {
            let Rect { min, max } = bounds(facet);
            let (low, high) = ((min / side).floor(), (max / side).floor());
            for row in low.y as i64..=high.y as i64 {
                for column in low.x as i64..=high.x as i64 {
                    members.entry((row, column)).or_default().push(index as u32);
                }
            }
        }
        Self { side, members }
    }

    fn facet_at(&self, facets: &[SurfaceTriangle], at: DVec2) -> Option<usize> {
        let square = (at / self.side).floor();
        let members = self.members.get(&(square.y as i64, square.x as i64))?;
        members.iter().map(|&index| index as usize).find(|&index| facet_contains(&facets[index], at))
    }
}

/// What of a facet, in plan, none of the triangles over it covers.
fn uncovered(facet: &SurfaceTriangle, over: &[[DVec2; 3]]) -> Vec<Vec<DVec2>> {
    let mut pieces = vec![facet.map(|corner| corner.truncate().as_dvec2()).to_vec()];
    for window in over {
        let reach = polygon::bounds(window);
        let mut left = Vec::with_capacity(pieces.len() + 2);
        for piece in pieces {
            let overlaps = || convex::intersection(&piece, window, SLIVER_M2).is_some();
            if polygon::bounds(&piece).meets(&reach) && overlaps() {
                polygon::cut_away(piece, window, &mut left);
            } else {
                left.push(piece);
            }
        }
        left.retain(|piece| polygon::doubled_area(piece) > 2.0 * SLIVER_M2);
        pieces = left;
    }
    pieces
}

fn add(left: &mut DrawMesh, piece: &[DVec2], facet: &SurfaceTriangle, like: DrawVertex) {
    let corners: Vec<Vec3> = piece.iter().map(|&at| at.as_vec2().extend(plane_z(facet, at) as f32)).collect();
    let ids: Vec<VertexId> = corners
        .iter()
        .map(|corner| left.vertex(DrawVertex { position: corner.to_array(), ..like }))
        .collect();
    for (pair, ids_of_pair) in corners[1..].windows(2).zip(ids[1..].windows(2)) {
        // Corners on one line, as a cut leaves them, make a triangle without area, which rounding may turn over.
        let area = (pair[0] - corners[0]).truncate().perp_dot((pair[1] - corners[0]).truncate());
        if area > 0.0 {
            left.triangle([ids[0], ids_of_pair[0], ids_of_pair[1]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::color::Srgba;
    use glam::Vec2;

    fn mesh(triangles: &[[Vec3; 3]]) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        for corners in triangles {
            let ids = corners.map(|at| {
                mesh.vertex(DrawVertex {
                    position: at.to_array(),
                    normal: [0.0, 0.0, 1.0],
                    uv: [0.0; 2],
                    color: Srgba::WHITE,
                })
            });
            mesh.triangle(ids);
        }
        mesh
    }

    fn plan_area(mesh: &DrawMesh) -> f32 {
        let area = |[a, b, c]: SurfaceTriangle| (b - a).truncate().perp_dot((c - a).truncate()) / 2.0;
        facets(mesh).map(area).sum()
    }

    #[test]
    fn what_is_left_and_what_lies_on_it_cover_the_ground_once() {
        for quarter in 0..4 {
            let at = |x: f32, y: f32| {
                let plan = (0..quarter).fold(Vec2::new(x, y), |at, _| at.perp());
                plan.extend(plan.x * 0.2 - plan.y * 0.1)
            };
            let ground = mesh(&[
                [at(0.0, 0.0), at(100.0, 0.0), at(100.0, 100.0)],
                [at(0.0, 0.0), at(100.0, 100.0), at(0.0, 100.0)],
                [at(100.0, 0.0), at(200.0, 0.0), at(100.0, 100.0)],
            ]);
            let road = mesh(&[
                [at(20.0, 5.0), at(80.0, 5.0), at(80.0, 15.0)],
                [at(20.0, 5.0), at(80.0, 15.0), at(30.0, 15.0)],
                [at(10.0, 60.0), at(30.0, 60.0), at(20.0, 80.0)],
            ]);
            let left = inlaid(&ground, [&road]);
            let total = plan_area(&left) + plan_area(&road);
            assert!((total - plan_area(&ground)).abs() < 0.01, "{total}");
            for [a, b, c] in facets(&left) {
                assert!((b - a).truncate().perp_dot((c - a).truncate()) > 0.0, "faces up");
                for corner in [a, b, c] {
                    assert!((corner.z - (corner.x * 0.2 - corner.y * 0.1)).abs() < 1e-3, "in its plane");
                }
            }
        }
    }

    #[test]
    fn ground_under_nothing_stays_as_it_is() {
        let ground = mesh(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
        assert_eq!(inlaid(&ground, []), ground);
    }
}
