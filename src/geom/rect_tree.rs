//! Finds the rectangles that meet another one, among many: an R-tree of `rstar`, bulk-loaded.

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::geom::rect::Rect;

/// Rectangles in a tree.
#[derive(Clone, Debug)]
pub struct RectTree {
    /// Each rectangle with its position in the list that the tree was made of.
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
}

impl RectTree {
    /// The tree of `rects`, identified by their positions in it; empty ones and those with NaN are never found.
    pub fn new(rects: &[Rect]) -> Self {
        let entries = rects.iter().enumerate().filter(|(_, rect)| rect.min.cmple(rect.max).all());
        let entry = |(index, rect): (usize, &Rect)| {
            let corners = (rect.min.to_array(), rect.max.to_array());
            GeomWithData::new(Rectangle::from_corners(corners.0, corners.1), index)
        };
        Self { tree: RTree::bulk_load(entries.map(entry).collect()) }
    }

    /// The rectangles that meet `window`, each once, in an order of no meaning.
    pub fn meeting(&self, window: &Rect) -> impl Iterator<Item = usize> + '_ {
        let envelope = AABB::from_corners(window.min.to_array(), window.max.to_array());
        self.tree.locate_in_envelope_intersecting(&envelope).map(|entry| entry.data)
    }

    /// The rectangles that meet `window`, in ascending order.
    pub fn meeting_in_order(&self, window: &Rect) -> Vec<usize> {
        let mut found: Vec<usize> = self.meeting(window).collect();
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    #[test]
    fn nothing_is_found_among_nothing() {
        let everything = Rect { min: DVec2::splat(-1e300), max: DVec2::splat(1e300) };
        assert_eq!(RectTree::new(&[]).meeting(&everything).count(), 0);
        assert_eq!(RectTree::new(&[Rect::EMPTY; 20]).meeting(&everything).count(), 0);
        let unknown = Rect { min: DVec2::NAN, max: DVec2::ONE };
        assert_eq!(RectTree::new(&[unknown; 20]).meeting(&everything).count(), 0);
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
