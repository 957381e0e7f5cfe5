//! Positions along a row of a warped raster: exact where it is cheap, interpolated where that is as good.
//!
//! Projecting every cell costs more than resampling it. Map projections are smooth, so the row is cut into pieces, and a
//! parabola through three exact positions replaces the projection on each; two more exact positions between them check
//! it. A piece that fails is halved, down to a few cells that are all exact. The positions depend on the row alone: they
//! are the same for every number of threads.

use std::ops::Range;

use glam::DVec2;

/// The largest error of a parabola in source samples: a millimeter at a cliff of a kilometer between two samples.
/// A tenth of it would double the exact positions and change no result that shows.
const TOLERANCE: f64 = 1e-6;

/// Pieces start at this many cells: few enough that two checks a piece cannot overlook a fold of the map.
const LONGEST_PIECE: usize = 256;

/// Pieces of fewer cells are not worth interpolating.
const SHORTEST_PIECE: usize = 8;

/// The positions of `count` indices, NaN where `exact` has none.
pub fn positions(count: usize, exact: &impl Fn(usize) -> Option<DVec2>) -> Vec<DVec2> {
    positions_within(count, 0..count, exact)
}

/// Those of some of the `count` indices: the same bits, at the cost of the pieces that they lie in.
pub(crate) fn positions_within(
    count: usize,
    indices: Range<usize>,
    exact: &impl Fn(usize) -> Option<DVec2>,
) -> Vec<DVec2> {
    let first = indices.start / LONGEST_PIECE * LONGEST_PIECE;
    let end = indices.end.next_multiple_of(LONGEST_PIECE).min(count);
    let mut row = vec![DVec2::NAN; end.saturating_sub(first)];
    for (piece, row) in row.chunks_mut(LONGEST_PIECE).enumerate() {
        fill_piece(row, first + piece * LONGEST_PIECE, exact);
    }
    row.truncate(indices.end - first);
    row.drain(..indices.start - first);
    row
}

/// Fills a piece whose first index is `first`.
fn fill_piece(piece: &mut [DVec2], first: usize, exact: &impl Fn(usize) -> Option<DVec2>) {
    let last = first + piece.len() - 1;
    if last - first < SHORTEST_PIECE {
        for (position, index) in piece.iter_mut().zip(first..) {
            *position = exact(index).unwrap_or(DVec2::NAN);
        }
        return;
    }
    let middle = first + (last - first) / 2;
    let parabola = Parabola::through([first, middle, last].map(|index| (index, exact(index))));
    let is_close = |parabola: &Parabola| {
        [first + (middle - first) / 2, middle + (last - middle) / 2].into_iter().all(|index| {
            exact(index).is_some_and(|position| position.distance(parabola.at(index)) <= TOLERANCE)
        })
    };
    if let Some(parabola) = parabola.filter(is_close) {
        for (position, index) in piece.iter_mut().zip(first..) {
            *position = parabola.at(index);
        }
        return;
    }
    let (left, right) = piece.split_at_mut(middle - first + 1);
    fill_piece(left, first, exact);
    fill_piece(right, middle + 1, exact);
}

/// A parabola by Newton's divided differences.
struct Parabola {
    origin: f64,
    middle: f64,
    value: DVec2,
    slope: DVec2,
    bend: DVec2,
}

impl Parabola {
    /// `None` where one of the three has no position.
    fn through([a, b, c]: [(usize, Option<DVec2>); 3]) -> Option<Self> {
        let (at_a, at_b, at_c) = (a.0 as f64, b.0 as f64, c.0 as f64);
        let (value, second, third) = (a.1?, b.1?, c.1?);
        let slope = (second - value) / (at_b - at_a);
        let later = (third - second) / (at_c - at_b);
        Some(Self { origin: at_a, middle: at_b, value, slope, bend: (later - slope) / (at_c - at_a) })
    }

    fn at(&self, index: usize) -> DVec2 {
        let (from_origin, from_middle) = (index as f64 - self.origin, index as f64 - self.middle);
        self.value + (self.slope + self.bend * from_middle) * from_origin
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_smooth_row_is_met_with_few_exact_positions() {
        let calls = Cell::new(0);
        let curve = |index: usize| DVec2::new(index as f64, libm::sin(index as f64 * 1e-4) * 100.0);
        let exact = |index: usize| {
            calls.set(calls.get() + 1);
            Some(curve(index))
        };
        for (index, position) in positions(3000, &exact).iter().enumerate() {
            assert!(position.distance(curve(index)) <= 2.0 * TOLERANCE, "{index}");
        }
        assert!(calls.get() < 600, "{} exact positions", calls.get());
    }

    #[test]
    fn some_positions_of_a_row_are_those_of_the_whole_to_the_last_bit() {
        let exact = |index: usize| Some(DVec2::new(libm::exp(index as f64 * 1e-3), index as f64));
        let whole = positions(1111, &exact);
        for range in [0..1111, 0..1, 255..257, 256..512, 300..301, 1110..1111, 700..700] {
            assert_eq!(positions_within(1111, range.clone(), &exact), whole[range]);
        }
    }

    #[test]
    fn positions_that_do_not_exist_stay_nan() {
        let row = positions(100, &|index| (index >= 37).then(|| DVec2::splat(index as f64)));
        assert!(row[..37].iter().all(|position| position.is_nan()));
        assert!(row[37..].iter().enumerate().all(|(i, p)| p.distance(DVec2::splat(i as f64 + 37.0)) < 1e-9));
    }
}
