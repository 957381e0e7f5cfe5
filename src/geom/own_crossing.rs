//! Crossings of a line or a ring with itself.

use glam::DVec2;

use crate::rect::Rect;
use crate::rect_tree::RectTree;
use crate::segment;

/// A place where two legs of one line cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnCrossing {
    /// The place.
    pub at: DVec2,
    /// The vertices at which the two legs start, the lower one first.
    pub legs: [usize; 2],
}

/// The most pairs of legs near each other that are looked at for each leg: bounds the time for hostile lines.
const PAIRS_PER_LEG: usize = 64;

/// A crossing nearer to a leg's end than this share of the leg touches it there.
const TOUCH: f64 = 1e-9;

/// The first crossing of a line with itself, or of a ring, whose last vertex is joined to its first. `None` where it has
/// none, where its legs only touch or lie on one another, and where more legs lie near each other than are looked at, 64
/// for each.
pub fn own_crossing(points: &[DVec2], is_ring: bool) -> Option<OwnCrossing> {
    let count = points.len();
    let legs = if is_ring { count } else { count.saturating_sub(1) };
    let leg = |index: usize| (points[index], points[(index + 1) % count]);
    let rects: Vec<Rect> = (0..legs).map(|index| Rect::around([leg(index).0, leg(index).1])).collect();
    let tree = RectTree::new(&rects);
    let mut pairs = PAIRS_PER_LEG * legs;
    for (one, rect) in rects.iter().enumerate() {
        let mut first: Option<OwnCrossing> = None;
        for other in tree.meeting(rect).filter(|&other| other > one) {
            pairs = pairs.checked_sub(1)?;
            let (a, b) = (leg(one), leg(other));
            let Some(parts) = segment::crossing(a, b) else { continue };
            let is_inside = parts.iter().all(|part| (TOUCH..=1.0 - TOUCH).contains(part));
            if is_inside && first.is_none_or(|first| other < first.legs[1]) {
                first = Some(OwnCrossing { at: a.0.lerp(a.1, parts[0]), legs: [one, other] });
            }
        }
        if first.is_some() {
            return first;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f64, f64)]) -> Vec<DVec2> {
        all.iter().map(|&at| DVec2::from(at)).collect()
    }

    #[test]
    fn a_bow_tie_crosses_itself_in_its_middle_and_as_a_line_does_not() {
        for quarter in 0..4 {
            let turned = |at: DVec2| (0..quarter).fold(at, |at, _| at.perp());
            let tie: Vec<DVec2> = points(&[(0.0, 0.0), (8.0, 0.0), (0.0, 8.0), (8.0, 8.0)]);
            let tie: Vec<DVec2> = tie.into_iter().map(turned).collect();
            let found = own_crossing(&tie, true).expect("a crossing");
            assert_eq!((found.at, found.legs), (turned(DVec2::splat(4.0)), [1, 3]));
            assert_eq!(own_crossing(&tie, false), None, "its last leg is not there");
        }
    }

    #[test]
    fn a_loop_crosses_and_what_only_touches_does_not() {
        let loop_of = points(&[(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (4.0, 5.0), (4.0, -5.0)]);
        assert_eq!(own_crossing(&loop_of, false).map(|found| found.at), Some(DVec2::new(4.0, 0.0)));
        let lollipop = points(&[(0.0, 0.0), (5.0, 0.0), (9.0, 3.0), (9.0, -3.0), (5.0, 0.0)]);
        assert_eq!(own_crossing(&lollipop, false), None);
        assert_eq!(own_crossing(&points(&[(0.0, 0.0), (5.0, 0.0), (0.0, 0.0)]), true), None);
        assert_eq!(own_crossing(&[], true), None);
    }

    #[test]
    fn a_long_ring_is_searched_in_little_time() {
        let ring: Vec<DVec2> = (0..100_000)
            .map(|index| DVec2::from_angle(f64::from(index) / 100_000.0 * 6.25) * 900.0)
            .collect();
        assert_eq!(own_crossing(&ring, true), None);
    }
}
