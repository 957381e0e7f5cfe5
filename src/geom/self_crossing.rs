//! Counts how often rings cross themselves and each other: resolving such rings takes time and memory for each
//! crossing.

use glam::DVec2;

use crate::polygon::edges;
use crate::rect::Rect;
use crate::rect_tree::RectTree;
use crate::segment;

/// Rings of fewer edges are compared edge by edge: a tree costs more.
const FEW_EDGES: usize = 32;

/// The most pairs of edges near each other that are looked at for each crossing that is allowed.
const PAIRS_PER_CROSSING: usize = 64;

/// The number of crossings of the edges of `rings`, which are closed and do not repeat their first vertex; `None` for more
/// than `most`, and where too many edges are near each other to count their crossings.
///
/// Edges that only share a vertex do not cross. Time grows with the pairs of edges whose boxes meet, of which no more are
/// looked at than 64 for each of `most`.
pub fn count_crossings<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>, most: usize) -> Option<usize> {
    let all: Vec<(DVec2, DVec2)> = rings.into_iter().flat_map(edges).collect();
    let is_crossing = |one: usize, other: usize| {
        let ((a, b), (c, d)) = (all[one], all[other]);
        let is_chained = a == c || a == d || b == c || b == d;
        !is_chained && segment::crossing((a, b), (c, d)).is_some()
    };
    let mut crossings = 0;
    if all.len() < FEW_EDGES {
        let pairs = (1..all.len()).flat_map(|one| (0..one).map(move |other| (one, other)));
        crossings = pairs.filter(|&(one, other)| is_crossing(one, other)).count();
        return (crossings <= most).then_some(crossings);
    }
    let rects: Vec<Rect> = all.iter().map(|&(from, to)| Rect::around([from, to])).collect();
    let tree = RectTree::new(&rects);
    let mut pairs = most.saturating_mul(PAIRS_PER_CROSSING).max(PAIRS_PER_CROSSING * all.len());
    for (one, rect) in rects.iter().enumerate() {
        for other in tree.meeting(rect).filter(|&other| other < one) {
            pairs = pairs.checked_sub(1)?;
            crossings += usize::from(is_crossing(one, other));
            if crossings > most {
                return None;
            }
        }
    }
    Some(crossings)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every vertex of a regular polygon joined to the one `step` further on.
    fn star(count: usize, step: usize) -> Vec<DVec2> {
        let at = |index: usize| {
            let angle = (index * step % count) as f64 / count as f64 * std::f64::consts::TAU;
            DVec2::from_angle(angle) * 100.0
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn a_star_crosses_itself_as_often_as_its_points_and_step_say() {
        for (count, step) in [(5, 2), (7, 3), (31, 7), (101, 20)] {
            let ring = star(count, step);
            let expected = count * (step - 1);
            assert_eq!(count_crossings([&ring[..]], 1 << 20), Some(expected), "{count} {step}");
            assert_eq!(count_crossings([&ring[..]], expected), Some(expected));
            assert_eq!(count_crossings([&ring[..]], expected - 1), None);
        }
    }

    #[test]
    fn plain_rings_cross_nothing_and_rings_that_overlap_cross_twice() {
        let ring = star(1000, 1);
        assert_eq!(count_crossings([&ring[..]], 0), Some(0));
        let moved: Vec<DVec2> = ring.iter().map(|&at| at + DVec2::new(50.0, 0.01)).collect();
        assert_eq!(count_crossings([&ring[..], &moved[..]], 2), Some(2));
        assert_eq!(count_crossings([], 0), Some(0));
    }
}
