//! Plane regions and their boolean operations, by `geo`.
//!
//! A region is any number of polygons with holes that do not overlap. Operations snap vertices to a grid of about a
//! 2³¹th of the extent of what they are given, 10 µm for a city, so results are exact to that and slivers of that width
//! may stay behind; [`Region::triangles`] leaves out what has no area beyond it.

use geo::algorithm::bool_ops::{BooleanOps, FillRule, OpType};
use geo::{Area, BoundingRect, ConvexHull, MultiPolygon};
use glam::DVec2;

use crate::geom::polygon;
use crate::geom::rect::Rect;

/// Triangles smaller than this are what snapping left, not a part of anything: a square of 0.3 mm.
const SLIVER: f64 = 1e-7;

/// A region of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    polygons: MultiPolygon<f64>,
}

impl Default for Region {
    /// The empty region.
    fn default() -> Self {
        Self { polygons: MultiPolygon(Vec::new()) }
    }
}

impl Region {
    /// What at least one of the counter-clockwise `rings` covers.
    pub fn covered<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>) -> Self {
        Self::wound(rings.into_iter().map(ring).collect())
    }

    /// What an odd number of `rings` run around, whichever way each runs and however they cross.
    pub fn enclosed<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>) -> Self {
        let nothing = MultiPolygon::<f64>(Vec::new());
        let all = MultiPolygon(rings.into_iter().map(ring).collect());
        Self { polygons: all.boolean_op_with_fill_rule(&nothing, OpType::Union, FillRule::EvenOdd) }
    }

    /// The rings of its polygons, the outer one of each before its holes; none closed by repeating its first vertex.
    pub fn rings(&self) -> Vec<Vec<Vec<DVec2>>> {
        let points =
            |ring: &geo::LineString| ring.0.iter().skip(1).map(|at| DVec2::new(at.x, at.y)).collect();
        let of = |polygon: &geo::Polygon| {
            std::iter::once(polygon.exterior()).chain(polygon.interiors()).map(points).collect()
        };
        self.polygons.iter().map(of).collect()
    }

    /// What at least two of `regions` cover.
    pub fn covered_twice<'a>(regions: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut polygons: Vec<_> =
            regions.into_iter().flat_map(|region| region.polygons.iter().cloned()).collect();
        let Some(bounds) = MultiPolygon(polygons.clone()).bounding_rect() else { return Self::default() };
        // A clockwise frame around all takes one from every count, and what is still positive was covered twice.
        let (low, high) = (bounds.min(), bounds.max());
        let frame = [(low.x, low.y), (low.x, high.y), (high.x, high.y), (high.x, low.y)];
        polygons.push(geo::Polygon::new(geo::LineString::from_iter(frame), Vec::new()));
        Self::wound(polygons)
    }

    /// The convex hull of points; empty where they lie on a line.
    pub fn hull(points: &[DVec2]) -> Self {
        let points: geo::MultiPoint = points.iter().map(|at| (at.x, at.y)).collect();
        let hull = points.convex_hull();
        if hull.unsigned_area() > SLIVER {
            Self { polygons: MultiPolygon(vec![hull]) }
        } else {
            Self::default()
        }
    }

    /// What either covers.
    pub fn or(&self, other: &Self) -> Self {
        self.operation(other, OpType::Union)
    }

    /// What this covers and the other does not.
    pub fn without(&self, other: &Self) -> Self {
        self.operation(other, OpType::Difference)
    }

    /// What all of `regions` cover together.
    pub fn any_of<'a>(regions: impl IntoIterator<Item = &'a Self>) -> Self {
        Self::wound(regions.into_iter().flat_map(|region| region.polygons.iter().cloned()).collect())
    }

    /// Its connected parts.
    pub fn parts(&self) -> impl Iterator<Item = Self> + '_ {
        self.polygons.iter().map(|polygon| Self { polygons: MultiPolygon(vec![polygon.clone()]) })
    }

    /// Whether it covers nothing.
    pub fn is_empty(&self) -> bool {
        self.polygons.0.is_empty()
    }

    /// Its area.
    pub fn area(&self) -> f64 {
        self.polygons.unsigned_area()
    }

    /// The smallest rectangle around it; empty where the region is.
    pub fn bounds(&self) -> Rect {
        let corners = self.polygons.bounding_rect().map(|bounds| [bounds.min(), bounds.max()]);
        Rect::around(corners.into_iter().flatten().map(|corner| DVec2::new(corner.x, corner.y)))
    }

    /// It in counter-clockwise triangles.
    pub fn triangles(&self) -> Vec<[DVec2; 3]> {
        let points = |ring: &geo::LineString| {
            ring.0.iter().skip(1).map(|at| DVec2::new(at.x, at.y)).collect::<Vec<_>>()
        };
        self.polygons
            .iter()
            .flat_map(|polygon| {
                let holes: Vec<_> = polygon.interiors().iter().map(points).collect();
                polygon::triangulate(&points(polygon.exterior()), &holes)
            })
            .filter(|[a, b, c]| (b - a).perp_dot(c - a) > 2.0 * SLIVER)
            .collect()
    }

    /// What a positive number of turns of the rings runs around.
    fn wound(polygons: Vec<geo::Polygon>) -> Self {
        let nothing = MultiPolygon::<f64>(Vec::new());
        let all = MultiPolygon(polygons);
        Self { polygons: all.boolean_op_with_fill_rule(&nothing, OpType::Union, FillRule::Positive) }
    }

    fn operation(&self, other: &Self, operation: OpType) -> Self {
        if other.is_empty() {
            return self.clone();
        }
        Self { polygons: self.polygons.boolean_op(&other.polygons, operation) }
    }
}

fn ring(points: &[DVec2]) -> geo::Polygon {
    geo::Polygon::new(points.iter().map(|at| (at.x, at.y)).collect(), Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(x: f64, y: f64, width: f64, height: f64) -> [DVec2; 4] {
        let corner = DVec2::new(x, y);
        [corner, corner + DVec2::X * width, corner + DVec2::new(width, height), corner + DVec2::Y * height]
    }

    fn region(x: f64, y: f64, width: f64, height: f64) -> Region {
        Region::covered([&rect(x, y, width, height)[..]])
    }

    #[test]
    fn what_two_cover_is_what_they_share() {
        let roads =
            [region(0.0, 40.0, 100.0, 10.0), region(40.0, 0.0, 10.0, 100.0), region(70.0, 0.0, 5.0, 100.0)];
        let crossings = Region::covered_twice(&roads);
        assert!((crossings.area() - 150.0).abs() < 1e-6, "{}", crossings.area());
        assert_eq!(crossings.parts().count(), 2);
        assert!(Region::covered_twice([&roads[0]]).is_empty());
    }

    #[test]
    fn overlapping_rings_are_covered_once() {
        let (a, b) = (rect(0.0, 0.0, 10.0, 10.0), rect(5.0, 0.0, 10.0, 10.0));
        assert!((Region::covered([&a[..], &b[..]]).area() - 150.0).abs() < 1e-6);
    }

    #[test]
    fn triangles_cover_what_the_region_does() {
        let ring = region(0.0, 0.0, 30.0, 30.0).without(&region(10.0, 10.0, 10.0, 10.0));
        let triangles = ring.triangles();
        let area: f64 = triangles.iter().map(|[a, b, c]| (b - a).perp_dot(c - a) / 2.0).sum();
        assert!((area - 800.0).abs() < 1e-6 && (ring.area() - 800.0).abs() < 1e-6);
        assert!(triangles.iter().all(|[a, b, c]| (b - a).perp_dot(c - a) > 0.0));
        assert_eq!(ring.bounds(), Rect { min: DVec2::ZERO, max: DVec2::splat(30.0) });
    }

    #[test]
    fn a_ring_that_crosses_itself_encloses_both_its_lobes_and_a_ring_in_a_ring_is_a_hole() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let bow = [at(0.0, 0.0), at(10.0, 10.0), at(10.0, 0.0), at(0.0, 10.0)];
        let lobes = Region::enclosed([&bow[..]]);
        assert_eq!(lobes.rings().len(), 2);
        assert!((lobes.area() - 50.0).abs() < 1e-6);
        let (outer, inner) = (rect(0.0, 0.0, 10.0, 10.0), rect(4.0, 4.0, 2.0, 2.0));
        let holed = Region::enclosed([&outer[..], &inner[..]]).rings();
        assert_eq!((holed.len(), holed[0].len(), holed[0][1].len()), (1, 2, 4));
    }

    #[test]
    fn nothing_stays_nothing() {
        let nothing = Region::default();
        assert!(nothing.or(&nothing).is_empty() && nothing.without(&region(0.0, 0.0, 1.0, 1.0)).is_empty());
        assert!(Region::hull(&[DVec2::ZERO, DVec2::X, DVec2::X * 2.0]).is_empty());
        assert!(nothing.bounds().is_empty() && nothing.triangles().is_empty());
    }
}
