//! Plane regions: polygons with holes that any rings enclose, by `geo`.
//!
//! Operations snap vertices to a grid of about a 2³¹th of the extent of their input, 10 µm for a city: results are exact
//! to that, and slivers of that width may remain.

use geo::MultiPolygon;
use geo::algorithm::bool_ops::{BooleanOps, FillRule, OpType};
use glam::DVec2;

/// The rings of a polygon, the outer one before its holes; none repeats its first vertex at its end.
pub type PolygonRings = Vec<Vec<DVec2>>;

/// The polygons of the points that an odd number of `rings` run around, whichever way each runs and however they cross.
pub fn even_odd<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>) -> Vec<PolygonRings> {
    resolve(rings, FillRule::EvenOdd)
}

/// The polygons of the points that at least one of the counter-clockwise `rings` runs around.
pub fn union<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>) -> Vec<PolygonRings> {
    resolve(rings, FillRule::Positive)
}

fn resolve<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>, rule: FillRule) -> Vec<PolygonRings> {
    let polygon =
        |ring: &[DVec2]| geo::Polygon::new(ring.iter().map(|at| (at.x, at.y)).collect(), Vec::new());
    let all = MultiPolygon(rings.into_iter().map(polygon).collect());
    let nothing = MultiPolygon::<f64>(Vec::new());
    let resolved = all.boolean_op_with_fill_rule(&nothing, OpType::Union, rule);
    let points = |ring: &geo::LineString| ring.0.iter().skip(1).map(|at| DVec2::new(at.x, at.y)).collect();
    let rings = |polygon: &geo::Polygon| {
        std::iter::once(polygon.exterior()).chain(polygon.interiors()).map(points).collect()
    };
    resolved.iter().map(rings).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polygon::doubled_area;

    fn rect(x: f64, y: f64, width: f64, height: f64) -> [DVec2; 4] {
        let corner = DVec2::new(x, y);
        [corner, corner + DVec2::X * width, corner + DVec2::new(width, height), corner + DVec2::Y * height]
    }

    fn area(polygons: &[PolygonRings]) -> f64 {
        polygons.iter().flatten().map(|ring| doubled_area(ring) / 2.0).sum::<f64>().abs()
    }

    #[test]
    fn overlapping_rings_are_covered_once() {
        let (a, b) = (rect(0.0, 0.0, 10.0, 10.0), rect(5.0, 0.0, 10.0, 10.0));
        assert!((area(&union([&a[..], &b[..]])) - 150.0).abs() < 1e-6);
        assert!(union([]).is_empty() && even_odd([]).is_empty());
    }

    #[test]
    fn a_ring_across_itself_encloses_both_lobes_and_a_ring_in_a_ring_is_a_hole() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let bow = [at(0.0, 0.0), at(10.0, 10.0), at(10.0, 0.0), at(0.0, 10.0)];
        let lobes = even_odd([&bow[..]]);
        assert_eq!(lobes.len(), 2);
        assert!((area(&lobes) - 50.0).abs() < 1e-6);
        let (outer, inner) = (rect(0.0, 0.0, 10.0, 10.0), rect(4.0, 4.0, 2.0, 2.0));
        let holed = even_odd([&outer[..], &inner[..]]);
        assert_eq!((holed.len(), holed[0].len(), holed[0][1].len()), (1, 2, 4));
    }
}
