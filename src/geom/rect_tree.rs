//! Finds the rectangles that meet another one, among many: R-trees of `rstar`, bulk-loaded.
//!
//! Many rectangles are divided into strips along X, each a tree of its own: threads make them side by side, and a window meets
//! few of them.

use glam::DVec2;
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree, RTreeObject, SelectionFunction};

use crate::polygon;
use crate::rect::Rect;

/// A rectangle with its position in the list that a tree was made of.
type NumberedRect = GeomWithData<Rectangle<[f64; 2]>, usize>;

/// The rectangles of a strip: loading them takes a thread a millisecond or so.
const STRIP: usize = 4096;

/// The most strips: every one of them is looked at for every window.
const MOST_STRIPS: usize = 16;

/// Rectangles in trees.
#[derive(Clone, Debug)]
pub struct RectTree {
    strips: Vec<RTree<NumberedRect>>,
}

impl RectTree {
    /// The tree of `rects`, identified by their positions in it; empty ones and those with NaN are never found.
    pub fn new(rects: &[Rect]) -> Self {
        let entries = rects.iter().enumerate().filter(|(_, rect)| rect.min.cmple(rect.max).all());
        let entry = |(index, rect): (usize, &Rect)| {
            let corners = (rect.min.to_array(), rect.max.to_array());
            GeomWithData::new(Rectangle::from_corners(corners.0, corners.1), index)
        };
        let mut entries: Vec<NumberedRect> = entries.map(entry).collect();
        let strip = STRIP.max(entries.len().div_ceil(MOST_STRIPS));
        if entries.len() <= strip {
            return Self { strips: vec![RTree::bulk_load(entries)] };
        }
        let doubled_middle = |entry: &NumberedRect| entry.geom().lower()[0] + entry.geom().upper()[0];
        entries.par_sort_unstable_by(|a, b| doubled_middle(a).total_cmp(&doubled_middle(b)));
        Self { strips: entries.par_chunks(strip).map(|strip| RTree::bulk_load(strip.to_vec())).collect() }
    }

    /// The rectangles that meet `window`, each once, in an order of no meaning.
    pub fn meeting(&self, window: &Rect) -> impl Iterator<Item = usize> + '_ {
        let envelope = AABB::from_corners(window.min.to_array(), window.max.to_array());
        let near = move |strip| RTree::locate_in_envelope_intersecting(strip, &envelope);
        self.strips.iter().flat_map(near).map(|entry| entry.data)
    }

    /// The rectangles that meet a convex counter-clockwise polygon, each once, in an order of no meaning: of a slanted one far
    /// fewer than meet the rectangle around it.
    pub fn meeting_convex(&self, polygon: &[DVec2]) -> Vec<usize> {
        let (near, mut found) = (NearConvex::new(polygon), Vec::new());
        for strip in &self.strips {
            found.extend(strip.locate_with_selection_function(&near).map(|entry| entry.data));
        }
        found
    }

    /// The rectangles that meet `window`, in ascending order.
    pub fn meeting_in_order(&self, window: &Rect) -> Vec<usize> {
        let mut found: Vec<usize> = self.meeting(window).collect();
        found.sort_unstable();
        found
    }
}

/// Selects the rectangles that meet a convex polygon.
struct NearConvex {
    bounds: Rect,
    /// For each side the direction in which the polygon lies of it, and how far in that direction the side is.
    sides: Vec<(DVec2, f64)>,
}

impl NearConvex {
    fn new(polygon: &[DVec2]) -> Self {
        let side = |(from, to): (DVec2, DVec2)| {
            let inward = (to - from).perp();
            (inward, inward.dot(from))
        };
        Self { bounds: polygon::bounds(polygon), sides: polygon::edges(polygon).map(side).collect() }
    }
}

impl SelectionFunction<NumberedRect> for &NearConvex {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 2]>) -> bool {
        let [min, max] = [envelope.lower(), envelope.upper()].map(DVec2::from);
        // Outside a side lies all of a rectangle whose corner farthest inward does.
        let is_inside = |&(inward, least): &(DVec2, f64)| {
            let farthest = DVec2::select(inward.cmpgt(DVec2::ZERO), max, min);
            inward.dot(farthest) >= least
        };
        Rect { min, max }.meets(&self.bounds) && self.sides.iter().all(is_inside)
    }

    fn should_unpack_leaf(&self, leaf: &NumberedRect) -> bool {
        self.should_unpack_parent(&leaf.envelope())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex;
    use proptest::prelude::*;

    #[test]
    fn nothing_is_found_among_nothing() {
        let everything = Rect { min: DVec2::splat(-1e300), max: DVec2::splat(1e300) };
        assert_eq!(RectTree::new(&[]).meeting(&everything).count(), 0);
        assert_eq!(RectTree::new(&[Rect::EMPTY; 20]).meeting(&everything).count(), 0);
        let unknown = Rect { min: DVec2::NAN, max: DVec2::ONE };
        assert_eq!(RectTree::new(&[unknown; 20]).meeting(&everything).count(), 0);
    }

    #[test]
    fn a_slanted_strip_meets_the_squares_along_it_alone() {
        let square = |x: u32, y: u32| {
            let min = DVec2::new(f64::from(x), f64::from(y));
            Rect { min, max: min + 0.9 }
        };
        let squares: Vec<Rect> = (0..100).flat_map(|y| (0..100).map(move |x| square(x, y))).collect();
        let tree = RectTree::new(&squares);
        for quarter in 0..4 {
            let turned = |at: DVec2| (0..quarter).fold(at - 50.0, |at, _| at.perp()) + 50.0;
            let strip =
                [(0.5, 0.45), (99.5, 99.45), (99.5, 99.5), (0.5, 0.5)].map(|at| turned(DVec2::from(at)));
            let mut found = tree.meeting_convex(&strip);
            found.sort_unstable();
            let corners = |rect: &Rect| {
                let [min, max] = [rect.min, rect.max];
                [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
            };
            let meet =
                |index: &usize| convex::intersection(&strip, &corners(&squares[*index]), 0.0).is_some();
            let expected: Vec<usize> = (0..squares.len()).filter(meet).collect();
            assert!(expected.iter().all(|index| found.contains(index)), "{quarter}");
            // Those that it touches at a corner may be found as well; the rectangle around it meets all ten thousand.
            assert!(found.len() <= 2 * expected.len(), "{} for {}", found.len(), expected.len());
        }
    }

    #[test]
    fn in_many_strips_as_much_is_found_as_in_one() {
        let rects: Vec<Rect> = (0..3 * STRIP as u32 + 1)
            .map(|index| {
                let min = DVec2::new(f64::from(index * 7919 % 1009), f64::from(index * 104_729 % 997));
                Rect { min, max: min + DVec2::new(f64::from(index % 40), f64::from(index % 9)) }
            })
            .collect();
        let tree = RectTree::new(&rects);
        assert_eq!(tree.strips.len(), 4);
        for corner in [0.0, 300.0, 700.0] {
            let window = Rect { min: DVec2::splat(corner), max: DVec2::splat(corner + 200.0) };
            let expected: Vec<usize> =
                (0..rects.len()).filter(|&index| rects[index].meets(&window)).collect();
            assert_eq!(tree.meeting_in_order(&window), expected);
        }
    }

    proptest! {
        #[test]
        fn the_rectangles_that_meet_the_window_are_found_and_no_others(
            corners in prop::collection::vec((-100.0..100.0, -100.0..100.0, 0.0..60.0, 0.0..9.0), 0..300),
            window in (-120.0..120.0, -120.0..120.0, 0.0..80.0, 0.0..80.0),
        ) {
            let rect = |(x, y, width, height): (f64, f64, f64, f64)| {
                Rect { min: DVec2::new(x, y), max: DVec2::new(x + width, y + height) }
            };
            let rects: Vec<Rect> = corners.into_iter().map(rect).collect();
            let window = rect(window);
            let expected: Vec<usize> = (0..rects.len()).filter(|&index| rects[index].meets(&window)).collect();
            prop_assert_eq!(RectTree::new(&rects).meeting_in_order(&window), expected);
        }
    }
}
