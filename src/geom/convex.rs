//! Convex polygons, counter-clockwise: whether two overlap, and what both cover.

use glam::DVec2;

use crate::geom::polygon;

/// Polygons that reach less deep into one another than this touch, in meters: what shares an edge does not overlap, and
/// over a kilometer of it this depth makes no more than a thousandth of a square meter.
const TOUCHING_M: f64 = 1e-6;

/// Whether two convex polygons overlap by more than a touch: some line through a side of one has the other behind it
/// where they do not (the theorem of separating axes).
pub fn overlap(one: &[DVec2], other: &[DVec2]) -> bool {
    !parts(one, other) && !parts(other, one)
}

/// Whether all of `other` lies outside one side of `one`.
fn parts(one: &[DVec2], other: &[DVec2]) -> bool {
    polygon::edges(one).any(|(from, to)| {
        let along = to - from;
        let (length, touching) = (along.length(), TOUCHING_M * along.length());
        // Clipping leaves corners twice, and what lies between such two has no direction.
        length > TOUCHING_M && other.iter().all(|&point| along.perp_dot(point - from) <= touching)
    })
}

/// Whether `point` lies in a convex polygon, or less than a touch outside.
pub fn contains(polygon: &[DVec2], point: DVec2) -> bool {
    polygon::edges(polygon).all(|(from, to)| {
        let along = to - from;
        along.perp_dot(point - from) >= -TOUCHING_M * along.length()
    })
}

/// What two convex polygons share, counter-clockwise; `None` where they do not overlap by more than `least`, an area.
pub fn shared(one: &[DVec2], other: &[DVec2], least: f64) -> Option<Vec<DVec2>> {
    if !overlap(one, other) {
        return None;
    }
    let (mut piece, mut scratch) = (one.to_vec(), Vec::new());
    polygon::clip_convex(&mut piece, &mut scratch, other);
    (piece.len() > 2 && polygon::doubled_area(&piece) > 2.0 * least).then_some(piece)
}

/// The convex hull of `points`, counter-clockwise, without corners on its sides (the monotone chain of Andrew 1979);
/// empty where they lie on a line.
pub fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    let mut hull = chain(sorted.iter().copied());
    hull.extend(chain(sorted.iter().rev().copied()));
    if hull.len() > 2 { hull } else { Vec::new() }
}

/// The side of the hull from the first of the sorted points to the last, without the last.
fn chain(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut chain: Vec<DVec2> = Vec::new();
    for point in points {
        while let [.., before, last] = chain[..] {
            if (last - before).perp_dot(point - last) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain.pop();
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_shares_an_edge_touches_and_what_lies_across_overlaps() {
        let triangle = |corners: [(f64, f64); 3]| corners.map(DVec2::from);
        let one = triangle([(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)]);
        assert!(!overlap(&one, &triangle([(10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])));
        assert!(!overlap(&one, &triangle([(6.0, 6.0), (9.0, 6.0), (6.0, 9.0)])), "boxes alone overlap");
        assert!(overlap(&one, &triangle([(4.0, 4.0), (9.0, 4.0), (4.0, 9.0)])));
        assert!(overlap(&one, &one));
        let [a, b, c] = one;
        assert!(overlap(&[a, b, b, c], &one), "a corner that stands twice is no side");
    }

    #[test]
    fn a_hull_has_the_outermost_points_only() {
        let points = [(0.0, 0.0), (4.0, 0.0), (2.0, 0.0), (2.0, 1.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)];
        let hull = hull(&points.map(DVec2::from));
        assert_eq!(hull, [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(DVec2::from));
        assert!(super::hull(&[DVec2::ZERO, DVec2::ONE, DVec2::ONE * 2.0]).is_empty());
        assert!(super::hull(&[DVec2::ZERO]).is_empty() && super::hull(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn two_triangles_overlap_where_they_share_an_area(
            corners in prop::array::uniform6((0.0..20.0, 0.0..20.0)),
        ) {
            let counter_clockwise = |[a, b, c]: [DVec2; 3]| {
                if (b - a).perp_dot(c - a) > 0.0 { [a, b, c] } else { [a, c, b] }
            };
            let [a, b, c, d, e, f] = corners.map(DVec2::from);
            let (one, other) = (counter_clockwise([a, b, c]), counter_clockwise([d, e, f]));
            let (mut shared, mut scratch) = (one.to_vec(), Vec::new());
            polygon::clip_convex(&mut shared, &mut scratch, &other);
            let area = if shared.len() < 3 { 0.0 } else { polygon::doubled_area(&shared) / 2.0 };
            prop_assert!(overlap(&one, &other) || area < 1e-3, "{area}");
            prop_assert!(!overlap(&one, &other) || area > 0.0);
        }
    }
}
