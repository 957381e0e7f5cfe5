//! Cuts many triangles out of a convex polygon.
//!
//! Each cut leaves more pieces, and the cuts to come meet few of them: a road that a thousand others cross is a thousand
//! pieces, and the next road meets one. So the pieces are kept by where they lie along the polygon, in a tree of stretches
//! (a segment tree, Bentley 1977), and a cut is held against those of its own stretches alone:
//!
//! ```text
//!  ├───────────────┬───────────────┤     a piece is held by the longest stretches that together are its own:
//!  ├───────┬───────┼───────┬───────┤     no more than two in each row
//!  ├───┬───┼───┬───┼───┬───┼───┬───┤
//!      └── piece ──┘
//! ```
//!
//! What is left, and its order, is the same as if each piece were held against each cut.

use glam::DVec2;

use sandtable_geom::convex::{self, ConvexClip};
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;

/// Overlaps and leftovers smaller than this are rounding, in square meters: a sliver of 10 m by 0.1 mm.
pub(crate) const SLIVER_M2: f64 = 1e-3;

/// Pieces smaller than this are dropped while a polygon is being cut: many of them may still lie side by side.
const NOTHING_M2: f64 = 1e-9;

/// Cuts for each stretch along the polygon: with fewer, keeping the stretches costs more than they save.
const CUTS_PER_STRETCH: usize = 8;

/// The most stretches: a megabyte of them.
const MOST_STRETCHES: usize = 1 << 15;

/// What `windows`, counter-clockwise and taken away in their order, leave of a convex counter-clockwise polygon: convex
/// pieces, counter-clockwise, without slivers. `None` where they leave all of it.
pub(crate) fn rest(
    polygon: &[DVec2],
    windows: &[[DVec2; 3]],
    clip: &mut ConvexClip,
) -> Option<Vec<Vec<DVec2>>> {
    let cuts: Vec<CutWindow<'_>> =
        windows.iter().filter_map(|window| CutWindow::new(polygon, window, clip)).collect();
    if cuts.is_empty() {
        return None;
    }
    let mut pieces = CutPieces::new(polygon, cuts.len(), clip);
    for cut in &cuts {
        pieces.cut(cut);
        if pieces.left == 0 {
            return Some(Vec::new());
        }
    }
    let mut left = pieces.into_outlines();
    left.retain(|piece| polygon::doubled_area(piece) > 2.0 * SLIVER_M2);
    Some(left)
}

/// Whether `window`, counter-clockwise, leaves nothing of a convex counter-clockwise polygon.
pub(crate) fn covers(window: &[DVec2; 3], polygon: &[DVec2]) -> bool {
    polygon.iter().all(|&at| convex::contains(window, at))
        && convex::intersection(polygon, window, SLIVER_M2).is_some()
}

/// A triangle that is taken away from a polygon.
struct CutWindow<'a> {
    window: &'a [DVec2; 3],
    /// What of the polygon it covers lies in this rectangle.
    region: Rect,
}

impl<'a> CutWindow<'a> {
    /// The cut of a convex polygon by `window`; `None` where they share no more than a sliver.
    fn new(polygon: &[DVec2], window: &'a [DVec2; 3], clip: &mut ConvexClip) -> Option<Self> {
        let shared = clip.intersection(polygon, window, SLIVER_M2)?;
        Some(Self { window, region: polygon::bounds(shared) })
    }
}

/// A piece of the polygon.
struct CutPiece {
    /// Empty where the piece was cut.
    outline: Vec<DVec2>,
    bounds: Rect,
    /// The first of the pieces that it was cut into and the one after their last; `None` where it was not cut.
    parts: Option<[usize; 2]>,
}

/// All pieces that there were.
struct CutPieces<'a> {
    /// The whole polygon first; each piece comes after the one that it was cut from.
    pieces: Vec<CutPiece>,
    /// How many are not cut.
    left: usize,
    stretches: Stretches,
    clip: &'a mut ConvexClip,
    /// Memory for the pieces near a cut, and for the parts of one of them.
    near: Vec<usize>,
    parts: Vec<Vec<DVec2>>,
}

impl<'a> CutPieces<'a> {
    /// The whole polygon, for so many cuts.
    fn new(polygon: &[DVec2], cuts: usize, clip: &'a mut ConvexClip) -> Self {
        let count = (cuts / CUTS_PER_STRETCH).next_power_of_two().min(MOST_STRETCHES);
        let stretches = Stretches::new(&polygon::bounds(polygon), count);
        let (near, parts) = (Vec::new(), Vec::new());
        let mut all = Self { pieces: Vec::new(), left: 0, stretches, clip, near, parts };
        all.add(polygon.to_vec());
        all
    }

    fn add(&mut self, outline: Vec<DVec2>) {
        let bounds = polygon::bounds(&outline);
        self.stretches.hold(self.pieces.len(), &bounds);
        self.pieces.push(CutPiece { outline, bounds, parts: None });
        self.left += 1;
    }

    /// Takes away from all pieces what lies in a cut.
    fn cut(&mut self, cut: &CutWindow<'_>) {
        let (mut near, mut parts) = (std::mem::take(&mut self.near), std::mem::take(&mut self.parts));
        let is_left = |piece: usize| self.pieces[piece].parts.is_none();
        self.stretches.find_near(&cut.region, is_left, &mut near);
        for index in near.drain(..) {
            let piece = &mut self.pieces[index];
            let meets = piece.bounds.meets(&cut.region);
            if !meets || self.clip.intersection(&piece.outline, cut.window, SLIVER_M2).is_none() {
                continue;
            }
            polygon::cut_away(std::mem::take(&mut piece.outline), cut.window, &mut parts);
            self.left -= 1;
            let first = self.pieces.len();
            let is_something = |part: &Vec<DVec2>| polygon::doubled_area(part) > 2.0 * NOTHING_M2;
            parts.drain(..).filter(is_something).for_each(|part| self.add(part));
            self.pieces[index].parts = Some([first, self.pieces.len()]);
        }
        (self.near, self.parts) = (near, parts);
    }

    /// The outlines of the pieces that are left: the parts of each in its place.
    fn into_outlines(mut self) -> Vec<Vec<DVec2>> {
        let (mut outlines, mut next) = (Vec::with_capacity(self.left), vec![0]);
        while let Some(index) = next.pop() {
            match self.pieces[index].parts {
                Some([first, end]) => next.extend((first..end).rev()),
                None => outlines.push(std::mem::take(&mut self.pieces[index].outline)),
            }
        }
        outlines
    }
}

/// The stretches along a polygon, in rows of 1, 2, 4, … of equal length, each with the pieces that it holds.
struct Stretches {
    /// East or north, whichever way the polygon is longer.
    along: DVec2,
    start_m: f64,
    per_meter: f64,
    /// In the last row, a power of two.
    count: usize,
    /// The pieces of the first stretch of row `r` at 2ʳ, of the others after it.
    held: Vec<Vec<u32>>,
}

impl Stretches {
    fn new(bounds: &Rect, count: usize) -> Self {
        let size = bounds.size();
        let along = if size.x >= size.y { DVec2::X } else { DVec2::Y };
        let (start_m, per_meter) = (bounds.min.dot(along), count as f64 / size.dot(along));
        Self { along, start_m, per_meter, count, held: vec![Vec::new(); 2 * count] }
    }

    /// The numbers in `held` of the first and the last stretch of the last row that a rectangle meets.
    fn ends(&self, rect: &Rect) -> [usize; 2] {
        // What is no number is 0.
        let stretch = |at: DVec2| ((at.dot(self.along) - self.start_m) * self.per_meter) as usize;
        [rect.min, rect.max].map(|at| self.count + stretch(at).min(self.count - 1))
    }

    fn hold(&mut self, piece: usize, bounds: &Rect) {
        let [mut first, mut last] = self.ends(bounds);
        while first <= last {
            if first % 2 == 1 {
                self.held[first].push(piece as u32);
                first += 1;
            }
            if last % 2 == 0 {
                self.held[last].push(piece as u32);
                last -= 1;
            }
            (first, last) = (first / 2, last / 2);
        }
    }

    /// Sets `near`, which is empty, to the pieces that share a stretch with a rectangle and for which `is_left` holds, in ascending
    /// order; others are forgotten.
    fn find_near(&mut self, rect: &Rect, is_left: impl Fn(usize) -> bool, near: &mut Vec<usize>) {
        let [mut first, mut last] = self.ends(rect);
        while first > 0 {
            for held in &mut self.held[first..=last] {
                held.retain(|&piece| is_left(piece as usize));
                near.extend(held.iter().map(|&piece| piece as usize));
            }
            (first, last) = (first / 2, last / 2);
        }
        near.sort_unstable();
        near.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area_m2(pieces: &[Vec<DVec2>]) -> f64 {
        pieces.iter().map(|piece| polygon::doubled_area(piece) / 2.0).sum()
    }

    /// Bands across a strip, each of two triangles.
    fn bands(count: usize) -> impl Iterator<Item = [DVec2; 3]> {
        let band = |index: usize| {
            let [low, high] = [0.0, 4.0].map(|beside| 10.0 * index as f64 + beside);
            let at = |x: f64, y: f64| DVec2::new(x, y);
            [[at(low, -9.0), at(high, -9.0), at(high, 99.0)], [at(low, -9.0), at(high, 99.0), at(low, 99.0)]]
        };
        (0..count).flat_map(band)
    }

    #[test]
    fn a_strip_that_many_bands_cross_keeps_what_is_between_them() {
        for count in [5, 90, 2000] {
            let length = 10.0 * count as f64;
            let strip = [(0.0, 0.0), (length, 0.0), (length, 6.0), (0.0, 6.0)].map(DVec2::from);
            for turned in 0..4 {
                let turn = |at: DVec2| (0..turned).fold(at, |at, _| at.perp());
                let windows: Vec<_> = bands(count).map(|band| band.map(turn)).collect();
                let left = rest(&strip.map(turn), &windows).expect("cut");
                assert!((area_m2(&left) - 36.0 * count as f64).abs() < 1e-6 * length, "{}", area_m2(&left));
                assert!(left.iter().all(|piece| convex::is_convex(piece)));
                assert!(left.len() < 4 * count, "{} pieces of {count}", left.len());
            }
        }
    }

    fn rest(polygon: &[DVec2], windows: &[[DVec2; 3]]) -> Option<Vec<Vec<DVec2>>> {
        super::rest(polygon, windows, &mut ConvexClip::default())
    }

    /// What cuts leave where each piece is held against each cut.
    fn rest_by_all_pairs(polygon: &[DVec2], windows: &[[DVec2; 3]]) -> Option<Vec<Vec<DVec2>>> {
        let mut clip = ConvexClip::default();
        let cuts: Vec<_> =
            windows.iter().filter_map(|window| CutWindow::new(polygon, window, &mut clip)).collect();
        let mut pieces = vec![polygon.to_vec()];
        for cut in &cuts {
            let mut outside = Vec::new();
            for piece in pieces {
                let meets = polygon::bounds(&piece).meets(&cut.region);
                if meets && convex::intersection(&piece, cut.window, SLIVER_M2).is_some() {
                    polygon::cut_away(piece, cut.window, &mut outside);
                } else {
                    outside.push(piece);
                }
            }
            pieces = outside;
            pieces.retain(|piece| polygon::doubled_area(piece) > 2.0 * NOTHING_M2);
        }
        pieces.retain(|piece| polygon::doubled_area(piece) > 2.0 * SLIVER_M2);
        (!cuts.is_empty()).then_some(pieces)
    }

    proptest! {
        #[test]
        fn what_is_left_is_what_comparing_all_pairs_leaves(
            corners in prop::collection::vec(prop::array::uniform3((0.0..100.0, 0.0..60.0)), 0..120),
            smaller in 1.0..80.0f64,
        ) {
            let counter_clockwise = |corners: [(f64, f64); 3]| {
                let [a, b, c] = corners.map(DVec2::from);
                // Small ones, so that something is left.
                let [b, c] = [b, c].map(|at: DVec2| a + (at - a) / smaller);
                if (b - a).perp_dot(c - a) > 0.0 { [a, b, c] } else { [a, c, b] }
            };
            let windows: Vec<[DVec2; 3]> = corners.into_iter().map(counter_clockwise).collect();
            let polygon = [(0.0, 0.0), (100.0, 20.0), (90.0, 60.0), (5.0, 30.0)].map(DVec2::from);
            prop_assert_eq!(rest(&polygon, &windows), rest_by_all_pairs(&polygon, &windows));
        }
    }

    #[test]
    fn cuts_all_over_each_other_leave_nothing_and_cuts_beside_it_all() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(DVec2::from);
        let corner = [(-20.0, -20.0), (30.0, -20.0), (-20.0, 30.0)].map(DVec2::from);
        let all = [(-20.0, -20.0), (40.0, -20.0), (-20.0, 40.0)].map(DVec2::from);
        assert_eq!(rest(&square, &[corner, all, corner]), Some(Vec::new()));
        let nearly = vec![corner; 1000];
        assert!(rest(&square, &nearly).is_some_and(|left| area_m2(&left) < 100.0));
        assert_eq!(rest(&square, &[nearly, vec![all]].concat()), Some(Vec::new()));
        assert_eq!(rest(&square, &[all.map(|at| at + DVec2::splat(100.0))]), None);
    }
}
