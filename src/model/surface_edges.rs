//! The edges of a soup, and the quadrics of its points.

use glam::DVec3;

use crate::geom::triangle;
use crate::model::quadric::Quadric;
use crate::model::soup::{PointId, Soup, WedgeId};

/// An edge of the surface, `a` below `b`.
pub(super) struct SurfaceEdge {
    pub a: PointId,
    pub b: PointId,
    /// Whether the surface, a material, a texture or a smooth patch ends here: other than two triangles meet, or they
    /// meet with different wedges.
    is_seam: bool,
    triangle: u32,
}

/// A side of a triangle, its points rising.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct TriangleSide {
    points: [PointId; 2],
    wedges: [WedgeId; 2],
    triangle: u32,
}

/// Every edge once, in a fixed order.
pub(super) fn edges(soup: &Soup) -> Vec<SurfaceEdge> {
    let mut sides: Vec<TriangleSide> = Vec::with_capacity(soup.triangles.len() * 3);
    for (triangle, &[a, b, c]) in (0..).zip(&soup.triangles) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let [start, end] = [from, to].map(|id| soup.wedge(id).point);
            sides.push(if start < end {
                TriangleSide { points: [start, end], wedges: [from, to], triangle }
            } else {
                TriangleSide { points: [end, start], wedges: [to, from], triangle }
            });
        }
    }
    sides.sort_unstable();
    let is_smooth = |sides: &[TriangleSide]| matches!(sides, [a, b] if a.wedges == b.wedges);
    let edge = |sides: &[TriangleSide]| {
        let TriangleSide { points: [a, b], triangle, .. } = sides[0];
        SurfaceEdge { a, b, is_seam: !is_smooth(sides), triangle }
    };
    sides.chunk_by(|one, other| one.points == other.points).map(edge).collect()
}

/// For each point the planes of its triangles and, upright on the surface, of its seams.
pub(super) fn quadrics(soup: &Soup, edges: &[SurfaceEdge]) -> Vec<Quadric> {
    let mut quadrics = vec![Quadric::default(); soup.points.len()];
    let mut add = |points: &[PointId], normal: Option<DVec3>| {
        let Some(normal) = normal else { return };
        let plane = Quadric::plane(normal, soup.position(points[0]));
        for point in points {
            quadrics[point.0 as usize] = quadrics[point.0 as usize].plus(&plane);
        }
    };
    let normal = |triangle: u32| triangle::normal(soup.corner_positions(triangle));
    for triangle in 0..soup.triangles.len() as u32 {
        add(&soup.corners(triangle), normal(triangle).try_normalize());
    }
    for edge in edges.iter().filter(|edge| edge.is_seam) {
        let along = soup.position(edge.b) - soup.position(edge.a);
        add(&[edge.a, edge.b], along.cross(normal(edge.triangle)).try_normalize());
    }
    quadrics
}
