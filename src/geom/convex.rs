//! Convex polygons, counter-clockwise: containment, overlap, intersection, clipped lines and the convex hull.

use glam::DVec2;

use crate::polygon;

/// Polygons that reach less deep into one another than this touch, in meters. Polygons with a common edge do not overlap;
/// over a kilometer of it this depth makes no more than a thousandth of a square meter.
const TOUCHING_M: f64 = 1e-6;

/// Whether no corner of the ring turns inward.
pub fn is_convex(ring: &[DVec2]) -> bool {
    let corner = |index: usize| ring[index % ring.len()];
    (0..ring.len()).all(|index| {
        let (before, at, after) = (corner(index), corner(index + 1), corner(index + 2));
        (at - before).perp_dot(after - at) >= 0.0
    })
}

/// Whether `point` lies in a convex polygon or on its border.
pub fn contains(polygon: &[DVec2], point: DVec2) -> bool {
    polygon::edges(polygon).all(|(from, to)| (to - from).perp_dot(point - from) >= 0.0)
}

/// Whether `point` lies in a convex polygon, or less than a touch outside.
pub fn touches(polygon: &[DVec2], point: DVec2) -> bool {
    polygon::edges(polygon).all(|(from, to)| {
        let along = to - from;
        along.perp_dot(point - from) >= -TOUCHING_M * along.length()
    })
}

/// Whether two convex polygons overlap by more than a touch. Where they do not, the line through a side of one separates
/// them (the separating axis theorem).
pub fn overlap(one: &[DVec2], other: &[DVec2]) -> bool {
    !separates(one, other) && !separates(other, one)
}

/// Whether all of `other` lies outside one side of `one`.
fn separates(one: &[DVec2], other: &[DVec2]) -> bool {
    polygon::edges(one).any(|(from, to)| {
        let along = to - from;
        // Most sides separate nothing, which a bound on their length tells.
        let most = TOUCHING_M * along.abs().element_sum();
        if other.iter().any(|&point| along.perp_dot(point - from) > most) {
            return false;
        }
        let (length, touching) = (along.length(), TOUCHING_M * along.length());
        // Clipping repeats corners, and an edge between two of them has no direction.
        length > TOUCHING_M && other.iter().all(|&point| along.perp_dot(point - from) <= touching)
    })
}

/// The intersection of two convex polygons, counter-clockwise; `None` where its area is no more than `least`.
pub fn intersection(one: &[DVec2], other: &[DVec2], least: f64) -> Option<Vec<DVec2>> {
    let mut clip = ConvexClip::default();
    clip.intersection(one, other, least).is_some().then_some(clip.piece)
}

/// Memory for intersections, to be used again and again.
#[derive(Clone, Debug, Default)]
pub struct ConvexClip {
    piece: Vec<DVec2>,
    scratch: Vec<DVec2>,
}

impl ConvexClip {
    /// As [`intersection`].
    pub fn intersection(&mut self, one: &[DVec2], other: &[DVec2], least: f64) -> Option<&[DVec2]> {
        if !overlap(one, other) {
            return None;
        }
        self.piece.clear();
        self.piece.extend_from_slice(one);
        polygon::clip_convex(&mut self.piece, &mut self.scratch, other);
        let is_more = self.piece.len() > 2 && polygon::doubled_area(&self.piece) > 2.0 * least;
        is_more.then_some(&self.piece)
    }
}

/// The parts, 0..=1, between which the line `from`..`to` lies in a convex polygon or no farther beside it than `beside`
/// (Cyrus and Beck 1978); `None` where it does not.
pub fn clip_line(polygon: &[DVec2], (from, to): (DVec2, DVec2), beside: f64) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (start, end) in polygon::edges(polygon) {
        let along = end - start;
        let slack = beside * along.length();
        let (first, last) = (along.perp_dot(from - start) + slack, along.perp_dot(to - start) + slack);
        if first < 0.0 && last < 0.0 {
            return None;
        }
        if first < 0.0 {
            enter = enter.max(first / (first - last));
        } else if last < 0.0 {
            leave = leave.min(first / (first - last));
        }
    }
    (enter < leave).then_some((enter, leave))
}

/// The convex hull of `points`, counter-clockwise, without corners on its sides (the monotone chain of Andrew 1979);
/// empty where they lie on a line.
pub fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    let mut hull = left_turns(sorted.iter().copied());
    hull.pop();
    hull.extend(left_turns(sorted.iter().rev().copied()));
    hull.pop();
    if hull.len() > 2 { hull } else { Vec::new() }
}

/// The points at which the shortest line from the first of sorted points to the last, with all others on its left, turns
/// left; both ends included.
pub fn left_turns(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
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
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn polygons_with_a_common_edge_touch_and_crossing_ones_overlap() {
        let triangle = |corners: [(f64, f64); 3]| corners.map(DVec2::from);
        let one = triangle([(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)]);
        assert!(!overlap(&one, &triangle([(10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])));
        assert!(!overlap(&one, &triangle([(6.0, 6.0), (9.0, 6.0), (6.0, 9.0)])), "boxes alone overlap");
        assert!(overlap(&one, &triangle([(4.0, 4.0), (9.0, 4.0), (4.0, 9.0)])));
        assert!(overlap(&one, &one));
        let [a, b, c] = one;
        assert!(overlap(&[a, b, b, c], &one), "a repeated corner is no side");
    }

    #[test]
    fn a_hull_has_only_the_outermost_points() {
        let points = [(0.0, 0.0), (4.0, 0.0), (2.0, 0.0), (2.0, 1.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)];
        let hull = hull(&points.map(DVec2::from));
        assert_eq!(hull, [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(DVec2::from));
        assert!(super::hull(&[DVec2::ZERO, DVec2::ONE, DVec2::ONE * 2.0]).is_empty());
        assert!(super::hull(&[DVec2::ZERO]).is_empty() && super::hull(&[]).is_empty());
    }

    #[test]
    fn a_line_is_clipped_to_a_triangle_and_passes_beside_it() {
        let triangle = [DVec2::ZERO, DVec2::X * 4.0, DVec2::Y * 4.0];
        let line = |y: f64| (DVec2::new(-4.0, y), DVec2::new(12.0, y));
        assert_eq!(clip_line(&triangle, line(1.0), 0.0), Some((0.25, 0.4375)));
        assert_eq!(clip_line(&triangle, line(-0.5), 0.0), None);
        assert!(clip_line(&triangle, line(-0.5), 1.0).is_some());
        assert!(contains(&triangle, DVec2::new(2.0, 2.0)) && !contains(&triangle, DVec2::splat(2.1)));
    }

    #[test]
    fn a_ring_with_a_dent_is_not_convex() {
        let ring = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0)].map(DVec2::from);
        assert!(!is_convex(&ring) && is_convex(&ring[..3]));
    }

    proptest! {
        #[test]
        fn two_triangles_overlap_where_they_have_a_common_area(
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
