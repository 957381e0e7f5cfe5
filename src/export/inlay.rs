//! Cuts out the ground under draped features.
//!
//! Drapes were cut along the ground's triangles, so each of their triangles lies in one of the ground. Each triangle of
//! the ground loses, in plan, the drape triangles in it; the rest keeps its plane. Ground and drapes then cover every
//! place once, and no program shows one through the other.

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_geom::convex;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_terrain::triangle_surface::{SurfaceTriangle, facet_contains, plane_z};

/// The smallest piece that is kept, in square meters: rounding to f32 makes smaller ones out of nothing.
const SLIVER_M2: f64 = 1e-4;

/// `ground` without the area that the triangles of `drapes` cover; both in world space.
pub fn cut_out<'a>(ground: &DrawMesh, drapes: impl IntoIterator<Item = &'a DrawMesh>) -> DrawMesh {
    let facets: Vec<SurfaceTriangle> = facets(ground).collect();
    let drapes = drapes_by_facet(&facets, drapes);
    let pieces: Vec<Option<Vec<Vec<DVec2>>>> = facets
        .par_iter()
        .zip(&drapes)
        .map(|(facet, drapes)| (!drapes.is_empty()).then(|| uncovered(facet, drapes)))
        .collect();
    let mut rest = DrawMesh::default();
    let mut kept: Vec<Option<VertexId>> = vec![None; ground.vertices.len()];
    for ((ids, facet), pieces) in ground.triangles.iter().zip(&facets).zip(pieces) {
        match pieces {
            None => {
                let ids = ids.map(|id| {
                    *kept[id.index()].get_or_insert_with(|| rest.vertex(ground.vertices[id.index()]))
                });
                rest.triangle(ids);
            }
            Some(pieces) => {
                let template = ground.vertices[ids[0].index()];
                pieces.iter().for_each(|piece| add_piece(&mut rest, piece, facet, template));
            }
        }
    }
    rest
}

fn facets(mesh: &DrawMesh) -> impl Iterator<Item = SurfaceTriangle> + '_ {
    let corner = |id: VertexId| Vec3::from(mesh.vertices[id.index()].position);
    mesh.triangles.iter().map(move |ids| ids.map(corner))
}

/// For each facet the drape triangles in it, in plan.
fn drapes_by_facet<'a>(
    facets: &[SurfaceTriangle],
    drapes: impl IntoIterator<Item = &'a DrawMesh>,
) -> Vec<Vec<[DVec2; 3]>> {
    let rects: Vec<Rect> = facets.iter().map(|facet| polygon::bounds(&plan(facet))).collect();
    let tree = RectTree::new(&rects);
    let mut by_facet = vec![Vec::new(); facets.len()];
    for triangle in drapes.into_iter().flat_map(self::facets) {
        let [a, b, c] = plan(&triangle);
        let center = (a + b + c) / 3.0;
        let around = Rect { min: center, max: center };
        let containing = tree.meeting(&around).filter(|&index| facet_contains(&facets[index], center));
        if let Some(facet) = containing.min() {
            by_facet[facet].push([a, b, c]);
        }
    }
    by_facet
}

fn plan(triangle: &SurfaceTriangle) -> [DVec2; 3] {
    triangle.map(|corner| corner.truncate().as_dvec2())
}

/// The parts of a facet, in plan, that none of `drapes` covers.
fn uncovered(facet: &SurfaceTriangle, drapes: &[[DVec2; 3]]) -> Vec<Vec<DVec2>> {
    let mut pieces = vec![plan(facet).to_vec()];
    for drape in drapes {
        let mut rest = Vec::with_capacity(pieces.len() + 2);
        for piece in pieces {
            if convex::intersection(&piece, drape, SLIVER_M2).is_some() {
                polygon::cut_away(piece, drape, &mut rest);
            } else {
                rest.push(piece);
            }
        }
        rest.retain(|piece| polygon::doubled_area(piece) > 2.0 * SLIVER_M2);
        pieces = rest;
    }
    pieces
}

/// Adds a convex piece of `facet` as a fan of triangles; its vertices are like `template` but for the position.
fn add_piece(mesh: &mut DrawMesh, piece: &[DVec2], facet: &SurfaceTriangle, template: DrawVertex) {
    let corner = |&at: &DVec2| at.as_vec2().extend(plane_z(facet, at) as f32);
    let corners: Vec<Vec3> = piece.iter().map(corner).collect();
    let vertex = |corner: &Vec3| mesh.vertex(DrawVertex { position: corner.to_array(), ..template });
    let ids: Vec<VertexId> = corners.iter().map(vertex).collect();
    for next in 2..corners.len() {
        let [a, b, c] = [0, next - 1, next].map(|index| corners[index].truncate());
        // Cuts leave corners on one line; rounding may turn such a triangle over.
        if (b - a).perp_dot(c - a) > 0.0 {
            mesh.triangle([ids[0], ids[next - 1], ids[next]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use sandtable_draw::color::Srgba;

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
    fn the_rest_and_the_drapes_cover_the_ground_once() {
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
            let left = cut_out(&ground, [&road]);
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
    fn ground_without_drapes_is_unchanged() {
        let ground = mesh(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
        assert_eq!(cut_out(&ground, []), ground);
    }
}
