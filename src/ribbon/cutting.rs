//! Cuts many triangles out of a convex polygon.
//!
//! Each cut leaves more pieces, and each piece must be held against the cuts to come: with the square of their number, which
//! a road that a thousand others cross would feel. So a piece is first compared by rectangles, and a polygon with many cuts
//! is parted across its length, each part with the cuts that lie in it:
//!
//! ```text
//!  ┌──┬─┬──┬───┬─┬───┐          ┌──┬─┬──┐ ┌───┬─┬───┐
//!  │  │▓│  │ ▓ │▓│   │    ──►   │  │▓│  │ │ ▓ │▓│   │      from here each half by itself
//!  └──┴─┴──┴───┴─┴───┘          └──┴─┴──┘ └───┴─┴───┘
//! ```

use glam::DVec2;

use crate::geom::convex;
use crate::geom::polygon;
use crate::geom::rect::Rect;

/// Overlaps and leftovers smaller than this are rounding, in square meters: a sliver of 10 m by 0.1 mm.
pub(in crate::ribbon) const SLIVER_M2: f64 = 1e-3;

/// Pieces smaller than this are dropped while a polygon is being cut: many of them may still lie side by side.
const NOTHING_M2: f64 = 1e-9;

/// A polygon with more cuts than this is parted. Fewer would part the triangles of common scenes, whose pieces then have
/// corners more than they need; more make the comparison of every piece with every cut felt.
const MOST_TOGETHER: usize = 4096;

/// A polygon whose parts still hold more than this share of its cuts is not parted: they lie all over each other.
const MOST_SHARED: f64 = 0.75;

/// A triangle that is taken away from a polygon.
struct CutWindow {
    window: [DVec2; 3],
    /// What of the polygon it covers lies in this rectangle.
    region: Rect,
}

/// A piece of the polygon.
struct CutPiece {
    outline: Vec<DVec2>,
    bounds: Rect,
}

impl CutWindow {
    /// The cut of a convex polygon by `window`; `None` where they share no more than a sliver.
    fn new(polygon: &[DVec2], window: [DVec2; 3]) -> Option<Self> {
        let shared = convex::intersection(polygon, &window, SLIVER_M2)?;
        Some(Self { window, region: polygon::bounds(&shared) })
    }
}

impl CutPiece {
    fn new(outline: Vec<DVec2>) -> Self {
        Self { bounds: polygon::bounds(&outline), outline }
    }
}

/// What `windows`, counter-clockwise and taken away in their order, leave of a convex counter-clockwise polygon: convex
/// pieces, counter-clockwise, without slivers. `None` where they leave all of it.
pub(in crate::ribbon) fn rest(
    polygon: &[DVec2],
    windows: impl IntoIterator<Item = [DVec2; 3]>,
) -> Option<Vec<Vec<DVec2>>> {
    let mut cuts = windows.into_iter().filter_map(|window| CutWindow::new(polygon, window));
    let mut pieces = outside(vec![CutPiece::new(polygon.to_vec())], &cuts.next()?);
    for cut in cuts.by_ref().take(MOST_TOGETHER) {
        pieces = outside(pieces, &cut);
        if pieces.is_empty() {
            return Some(Vec::new());
        }
    }
    let more: Vec<CutWindow> = cuts.collect();
    let more: Vec<&CutWindow> = more.iter().collect();
    let mut left = Vec::new();
    pieces.into_iter().for_each(|piece| part(piece, &more, &mut left));
    left.retain(|piece| polygon::doubled_area(piece) > 2.0 * SLIVER_M2);
    Some(left)
}

/// Parts a piece until it has few cuts, and adds what these leave to `left`.
fn part(piece: CutPiece, cuts: &[&CutWindow], left: &mut Vec<Vec<DVec2>>) {
    let meeting = |piece: &CutPiece| -> Vec<&CutWindow> {
        cuts.iter().copied().filter(|cut| cut.region.meets(&piece.bounds)).collect()
    };
    let own = meeting(&piece);
    if own.len() > MOST_TOGETHER {
        let halves = halves(&piece, &own);
        let most = (own.len() as f64 * MOST_SHARED) as usize;
        if halves.iter().all(|half| half.outline.len() > 2 && meeting(half).len() <= most) {
            halves.into_iter().for_each(|half| part(half, &own, left));
            return;
        }
    }
    let mut pieces = vec![piece];
    for cut in own {
        if pieces.is_empty() {
            return;
        }
        pieces = outside(pieces, cut);
    }
    left.extend(pieces.into_iter().map(|piece| piece.outline));
}

/// The two parts of a piece on either side of the line across it, midway along its cuts.
fn halves(piece: &CutPiece, cuts: &[&CutWindow]) -> [CutPiece; 2] {
    let size = piece.bounds.size();
    let along = if size.x >= size.y { DVec2::X } else { DVec2::Y };
    let mut places: Vec<f64> = cuts.iter().map(|cut| cut.region.center().dot(along)).collect();
    let middle = places.len() / 2;
    let at = along * *places.select_nth_unstable_by(middle, f64::total_cmp).1;
    let ends = (at, at + along.perp());
    [ends, (ends.1, ends.0)].map(|line| {
        let mut half = piece.outline.clone();
        polygon::clip_half_plane(&mut half, &mut Vec::new(), line);
        CutPiece::new(half)
    })
}

/// The parts of pieces that lie outside a cut.
fn outside(pieces: Vec<CutPiece>, cut: &CutWindow) -> Vec<CutPiece> {
    let mut outside = Vec::with_capacity(pieces.len() + 2);
    let mut parts = Vec::new();
    for piece in pieces {
        let meets = piece.bounds.meets(&cut.region);
        if meets && convex::intersection(&piece.outline, &cut.window, SLIVER_M2).is_some() {
            polygon::cut_away(piece.outline, &cut.window, &mut parts);
            let kept = parts.drain(..).filter(|part| polygon::doubled_area(part) > 2.0 * NOTHING_M2);
            outside.extend(kept.map(CutPiece::new));
        } else {
            outside.push(piece);
        }
    }
    outside
}

#[cfg(test)]
mod tests {
    use super::*;

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
                let left = rest(&strip.map(turn), bands(count).map(|band| band.map(turn))).expect("cut");
                assert!((area_m2(&left) - 36.0 * count as f64).abs() < 1e-6 * length, "{}", area_m2(&left));
                assert!(left.iter().all(|piece| convex::is_convex(piece)));
                assert!(left.len() < 4 * count, "{} pieces of {count}", left.len());
            }
        }
    }

    #[test]
    fn cuts_all_over_each_other_leave_nothing_and_cuts_beside_it_all() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(DVec2::from);
        let corner = [(-20.0, -20.0), (30.0, -20.0), (-20.0, 30.0)].map(DVec2::from);
        let all = [(-20.0, -20.0), (40.0, -20.0), (-20.0, 40.0)].map(DVec2::from);
        assert_eq!(rest(&square, [corner, all, corner]), Some(Vec::new()));
        let nearly = std::iter::repeat_n(corner, 1000);
        assert!(rest(&square, nearly.clone()).is_some_and(|left| area_m2(&left) < 100.0));
        assert_eq!(rest(&square, nearly.chain([all])), Some(Vec::new()));
        assert_eq!(rest(&square, [all.map(|at| at + DVec2::splat(100.0))]), None);
    }
}
