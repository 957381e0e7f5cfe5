//! Quadrics: the squared distances of a point from many planes at once (Garland and Heckbert, "Surface Simplification
//! Using Quadric Error Metrics", 1997), and the edges of a soup, whose planes keep borders and seams in place.
//!
//! Squared distances are summed without weights, so that the sum is never below the greatest: weights by area would
//! remove long thin strips.

use glam::DVec3;

use crate::soup::{PointId, Soup, WedgeId};
use sandtable_geom::triangle;

/// The sum of squared distances from a set of planes, as a quadratic function of position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Quadric {
    /// Upper triangle of Σ n nᵀ: xx, xy, xz, yy, yz, zz.
    squares: [f64; 6],
    /// Σ d · n.
    linear: DVec3,
    /// Σ d².
    constant: f64,
}

impl Quadric {
    /// The plane through `point` with unit `normal`.
    pub(super) fn plane(normal: DVec3, point: DVec3) -> Self {
        let distance = -normal.dot(point);
        let DVec3 { x, y, z } = normal;
        Self {
            squares: [x * x, x * y, x * z, y * y, y * z, z * z],
            linear: normal * distance,
            constant: distance * distance,
        }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            squares: std::array::from_fn(|index| self.squares[index] + other.squares[index]),
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
        }
    }

    /// The sum of the squared distances of `point` from the planes, at least 0; 0 where there are none.
    pub(super) fn squared_distances(&self, point: DVec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.squares;
        let DVec3 { x, y, z } = point;
        let product =
            DVec3::new(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z);
        (product.dot(point) + 2.0 * self.linear.dot(point) + self.constant).max(0.0)
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_all_planes_are_squared_and_summed() {
        let floor = Quadric::plane(DVec3::Z, DVec3::new(7.0, 3.0, 2.0));
        assert!((floor.squared_distances(DVec3::new(-4.0, 9.0, 5.0)) - 9.0).abs() < 1e-12);
        let wall = Quadric::plane(DVec3::X, DVec3::ZERO);
        let both = floor.plus(&wall).squared_distances(DVec3::new(2.0, 0.0, 5.0));
        assert!((both - 13.0).abs() < 1e-12);
    }

    #[test]
    fn without_planes_the_distance_is_zero() {
        assert_eq!(Quadric::default().squared_distances(DVec3::ONE), 0.0);
    }
}
