//! Finds the rectangles that meet another one, among many.
//!
//! The rectangles are put in the order of a curve that fills the plane (Morton 1966), so that neighbors in the order
//! lie near each other, and eight in a row get a rectangle around them, eight of those another, up to one around all:
//!
//! ```text
//!   around all   ┌───────────────┐
//!   level 1      ┌───────┐┌──────┐
//!   level 0      ▪▪▪▪▪▪▪▪▪▪▪▪▪▪▪▪▪    in the curve's order
//! ```
//!
//! Sizes may differ as they like: unlike a grid of squares, a lake among footpaths costs one entry. Making it takes
//! n log n steps, a question about log n and as many as it finds.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::geom::rect::Rect;

/// How many rectangles have one around them. Eight fill two cache lines' worth of tests; four or sixteen are as fast.
const FAN: usize = 8;

/// Rectangles in a tree.
#[derive(Clone, Debug)]
pub struct RectTree {
    /// Level 0 holds the rectangles in the curve's order; the last level at most [`FAN`].
    levels: Vec<Vec<Rect>>,
    /// Which rectangle stands at a place of level 0.
    order: Vec<u32>,
}

impl RectTree {
    /// The tree of `rects`, which are called by their place in it; empty ones are never found.
    ///
    /// # Panics
    /// Where there are 2³² or more.
    pub fn new(rects: &[Rect]) -> Self {
        let count = u32::try_from(rects.len()).expect("fewer rectangles than 2^32");
        let all = rects
            .iter()
            .filter(|rect| !rect.is_empty())
            .fold(Rect::EMPTY, |all, rect| all.with(rect.min).with(rect.max));
        let mut order: Vec<(u64, u32)> =
            (0..count).map(|index| (code(&rects[index as usize], &all), index)).collect();
        order.par_sort_unstable();
        let order: Vec<u32> = order.into_iter().map(|(_, index)| index).collect();
        let mut levels = vec![order.iter().map(|&index| rects[index as usize]).collect::<Vec<_>>()];
        while let Some(last) = levels.last().filter(|last| last.len() > FAN) {
            levels.push(last.chunks(FAN).map(around).collect());
        }
        Self { levels, order }
    }

    /// Calls `found` with the rectangles that meet `window`, each once, in the tree's order, until it breaks.
    pub fn visit(&self, window: &Rect, found: &mut impl FnMut(usize) -> ControlFlow<()>) {
        let top = self.levels.len() - 1;
        // Whether it was broken off is known to who broke it off.
        let _ = self.visit_level((top, 0), self.levels[top].len(), window, found);
    }

    /// The rectangles that meet `window` and of which `wanted` holds, from the least up.
    pub fn found(&self, window: &Rect, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut found = Vec::new();
        self.visit(window, &mut |index| {
            found.extend(wanted(index).then_some(index));
            ControlFlow::Continue(())
        });
        found.sort_unstable();
        found
    }

    /// Visits `count` places of a level from `first` on.
    fn visit_level(
        &self,
        (level, first): (usize, usize),
        count: usize,
        window: &Rect,
        found: &mut impl FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        for place in first..first + count {
            if !self.levels[level][place].meets(window) {
                continue;
            }
            if level == 0 {
                found(self.order[place] as usize)?;
            } else {
                let below = place * FAN;
                let count = FAN.min(self.levels[level - 1].len() - below);
                self.visit_level((level - 1, below), count, window, found)?;
            }
        }
        ControlFlow::Continue(())
    }
}

fn around(rects: &[Rect]) -> Rect {
    let some = rects.iter().filter(|rect| !rect.is_empty());
    some.fold(Rect::EMPTY, |all, rect| all.with(rect.min).with(rect.max))
}

/// Where a rectangle's middle lies along the curve through `all`.
fn code(rect: &Rect, all: &Rect) -> u64 {
    let part = (rect.center() - all.min) / all.size();
    // Casting gives 0 for a middle that is not a number.
    let step = |part: f64| (part * f64::from(u32::MAX)) as u32;
    spread(step(part.x)) | spread(step(part.y)) << 1
}

/// A number's bits with room for another's between them.
fn spread(number: u32) -> u64 {
    let mut bits = u64::from(number);
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    #[test]
    fn nothing_is_found_among_nothing() {
        let everything = Rect { min: DVec2::splat(-1e300), max: DVec2::splat(1e300) };
        assert!(RectTree::new(&[]).found(&everything, |_| true).is_empty());
        assert!(RectTree::new(&[Rect::EMPTY; 20]).found(&everything, |_| true).is_empty());
    }

    proptest! {
        #[test]
        fn what_meets_is_found_and_nothing_else(
            corners in prop::collection::vec((-100.0..100.0, -100.0..100.0, 0.0..60.0, 0.0..9.0), 0..300),
            window in (-120.0..120.0, -120.0..120.0, 0.0..80.0, 0.0..80.0),
        ) {
            let rect = |(x, y, width, height): (f64, f64, f64, f64)| {
                Rect { min: DVec2::new(x, y), max: DVec2::new(x + width, y + height) }
            };
            let rects: Vec<Rect> = corners.into_iter().map(rect).collect();
            let window = rect(window);
            let expected: Vec<usize> = (0..rects.len()).filter(|&index| rects[index].meets(&window)).collect();
            let tree = RectTree::new(&rects);
            prop_assert_eq!(&tree.found(&window, |_| true), &expected);
            let mut first = None;
            tree.visit(&window, &mut |index| {
                assert_eq!(first.replace(index), None, "it was broken off");
                ControlFlow::Break(())
            });
            prop_assert_eq!(first.is_some(), !expected.is_empty());
        }
    }
}
