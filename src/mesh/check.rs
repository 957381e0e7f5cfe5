//! The checks that a terrain mesh must pass: indices in range, upward triangles, no edge used twice in one direction,
//! no T-junction, and the expected area; and those of a solid: closed, with normals that point outward.
//!
//! At a T-junction a border edge, which belongs to a single triangle, has another border vertex inside it; so only the
//! border needs to be searched.

use std::collections::HashMap;

use glam::{DVec2, DVec3, Vec3};

use crate::sink::VertexId;
use crate::trimesh::TriMesh;

/// The measures of a sound mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSummary {
    /// Sum of the triangles' areas seen from above, in square meters.
    pub plan_area_m2: f64,
    /// Edges that belong to one triangle only.
    pub border_edges: usize,
}

/// The first flaw of a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum Flaw {
    #[error("triangle {triangle} uses vertex {vertex}, but there are only {count} vertices")]
    Index { triangle: usize, vertex: usize, count: usize },
    #[error("vertex {0} is not finite")]
    NotFinite(usize),
    #[error("triangle {triangle} has a plan area of {area_m2} m²; it must be positive")]
    Orientation { triangle: usize, area_m2: f64 },
    #[error("the edge from vertex {0} to vertex {1} belongs to two triangles on the same side")]
    Overlap(usize, usize),
    #[error("vertex {vertex} lies inside the edge from vertex {from} to vertex {to}: a T-junction")]
    TJunction { vertex: usize, from: usize, to: usize },
    #[error("the triangles cover {found_m2} m² instead of {expected_m2} m²")]
    Area { found_m2: f64, expected_m2: f64 },
    #[error("the edge from vertex {0} to vertex {1} belongs to one triangle only: the solid is open")]
    Open(usize, usize),
    #[error("triangle {0} has no area")]
    Degenerate(usize),
    #[error("the solid holds {0} cubic units; it must be positive")]
    InsideOut(f64),
}

/// Checks that `mesh` is conforming and faces up.
///
/// # Errors
/// The first [`Flaw`] found.
pub fn check(mesh: &TriMesh) -> Result<MeshSummary, Flaw> {
    check_indices(mesh)?;
    let plan_area_m2 = check_orientation(mesh)?;
    let border = border_edges(mesh)?;
    check_t_junctions(mesh, &border)?;
    Ok(MeshSummary { plan_area_m2, border_edges: border.len() })
}

/// [`check`]; besides, the plan area must be `expected_m2` within one part in a million.
///
/// # Errors
/// The first [`Flaw`] found.
pub fn check_with_area(mesh: &TriMesh, expected_m2: f64) -> Result<MeshSummary, Flaw> {
    let summary = check(mesh)?;
    let found_m2 = summary.plan_area_m2;
    if (found_m2 - expected_m2).abs() > expected_m2.abs() * 1e-6 {
        return Err(Flaw::Area { found_m2, expected_m2 });
    }
    Ok(summary)
}

/// Checks that `mesh` bounds a solid: every edge belongs to two triangles, one in either direction, no triangle is without
/// area, and the normals point outward. Returns its volume in cubed units of the positions.
///
/// # Errors
/// The first [`Flaw`] found.
pub fn check_solid(mesh: &TriMesh) -> Result<f64, Flaw> {
    check_indices(mesh)?;
    let mut volume = 0.0;
    for triangle in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
        if (b - a).cross(c - a) == DVec3::ZERO {
            return Err(Flaw::Degenerate(triangle));
        }
        volume += a.dot(b.cross(c)) / 6.0;
    }
    if let Some(&(from, to)) = border_edges(mesh)?.first() {
        return Err(Flaw::Open(from.index(), to.index()));
    }
    if volume > 0.0 { Ok(volume) } else { Err(Flaw::InsideOut(volume)) }
}

fn check_indices(mesh: &TriMesh) -> Result<(), Flaw> {
    let count = mesh.positions.len();
    if let Some(vertex) = mesh.positions.iter().position(|position| !position.is_finite()) {
        return Err(Flaw::NotFinite(vertex));
    }
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(id) = corners.iter().find(|id| id.index() >= count) {
            return Err(Flaw::Index { triangle, vertex: id.index(), count });
        }
    }
    Ok(())
}

fn check_orientation(mesh: &TriMesh) -> Result<f64, Flaw> {
    let mut sum = 0.0;
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|id| plan(mesh, id));
        let area_m2 = (b - a).perp_dot(c - a) / 2.0;
        if area_m2 <= 0.0 {
            return Err(Flaw::Orientation { triangle, area_m2 });
        }
        sum += area_m2;
    }
    Ok(sum)
}

fn border_edges(mesh: &TriMesh) -> Result<Vec<(VertexId, VertexId)>, Flaw> {
    let mut directed = HashMap::with_capacity(mesh.triangles.len() * 3);
    for (triangle, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for edge in [(a, b), (b, c), (c, a)] {
            if directed.insert(edge, triangle).is_some() {
                return Err(Flaw::Overlap(edge.0.index(), edge.1.index()));
            }
        }
    }
    let mut border: Vec<_> =
        directed.keys().copied().filter(|&(from, to)| !directed.contains_key(&(to, from))).collect();
    border.sort_unstable();
    Ok(border)
}

fn check_t_junctions(mesh: &TriMesh, border: &[(VertexId, VertexId)]) -> Result<(), Flaw> {
    let mut by_x: Vec<VertexId> = border.iter().map(|edge| edge.0).collect();
    by_x.sort_unstable_by(|&a, &b| plan(mesh, a).x.total_cmp(&plan(mesh, b).x).then(a.cmp(&b)));
    by_x.dedup();
    for &(from, to) in border {
        let (start, end) = (plan(mesh, from), plan(mesh, to));
        let (low, high) = (start.min(end), start.max(end));
        let first = by_x.partition_point(|&id| plan(mesh, id).x < low.x);
        let within = by_x[first..]
            .iter()
            .take_while(|&&id| plan(mesh, id).x <= high.x)
            .find(|&&id| id != from && id != to && lies_within(plan(mesh, id), start, end));
        if let Some(&vertex) = within {
            return Err(Flaw::TJunction { vertex: vertex.index(), from: from.index(), to: to.index() });
        }
    }
    Ok(())
}

fn lies_within(point: DVec2, start: DVec2, end: DVec2) -> bool {
    let along = end - start;
    let offset = point - start;
    let station = offset.dot(along) / along.length_squared();
    let aside = along.perp_dot(offset).abs() / along.length();
    (0.0..=1.0).contains(&station) && aside <= along.length() * 1e-6
}

fn plan(mesh: &TriMesh, id: VertexId) -> DVec2 {
    mesh.positions[id.index()].truncate().as_dvec2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sink::MeshSink;

    fn mesh(points: &[(f32, f32)], triangles: &[[u32; 3]]) -> TriMesh {
        let mut mesh = TriMesh::default();
        for &(x, y) in points {
            mesh.vertex(Vec3::new(x, y, 0.0));
        }
        for &corners in triangles {
            mesh.triangle(corners.map(VertexId));
        }
        mesh
    }

    const SQUARE: [(f32, f32); 5] = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0)];

    #[test]
    fn a_square_of_two_triangles_is_sound() {
        let square = mesh(&SQUARE, &[[0, 1, 2], [0, 2, 3]]);
        let summary = check_with_area(&square, 4.0).expect("sound");
        assert_eq!(summary.border_edges, 4);
    }

    #[test]
    fn a_t_junction_is_found() {
        let torn = mesh(&SQUARE, &[[0, 1, 2], [0, 4, 3], [4, 2, 3]]);
        assert!(matches!(check(&torn), Err(Flaw::TJunction { vertex: 4, .. })));
    }

    #[test]
    fn a_triangle_facing_down_and_a_doubled_one_are_found() {
        assert!(matches!(check(&mesh(&SQUARE, &[[0, 2, 1]])), Err(Flaw::Orientation { .. })));
        assert!(matches!(check(&mesh(&SQUARE, &[[0, 1, 2], [0, 1, 4]])), Err(Flaw::Overlap(0, 1))));
    }

    #[test]
    fn a_missing_piece_is_found_by_its_area() {
        let half = mesh(&SQUARE, &[[0, 1, 2]]);
        assert!(matches!(check_with_area(&half, 4.0), Err(Flaw::Area { .. })));
    }

    #[test]
    fn a_tetrahedron_is_a_solid_and_an_open_or_an_everted_one_is_none() {
        let mut solid =
            mesh(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        solid.vertex(Vec3::Z);
        assert!((check_solid(&solid).expect("closed") - 1.0 / 6.0).abs() < 1e-12);
        let mut everted = solid.clone();
        everted.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
        assert!(matches!(check_solid(&everted), Err(Flaw::InsideOut(_))));
        solid.triangles.pop();
        assert!(matches!(check_solid(&solid), Err(Flaw::Open(..))));
    }
}
