//! Facts about the heights of a lattice from one pass over them, on all threads where there are many.

use rayon::prelude::*;

use crate::lattice::Lattice;
use sandtable_base::vectorized::vectorized;

/// Heights that a thread scans together: some tens of microseconds.
const SCANNED_TOGETHER: usize = 1 << 16;

/// Heights of which it is asked at once whether any is beyond a limit.
const LOOKED_AT_TOGETHER: usize = 1024;

/// Bounds that are moved in turn, so that none waits for the one before.
const LANES: usize = 32;

/// The least and the greatest height; (∞, −∞) where all are NaN.
pub(crate) fn range(heights: &[f32]) -> (f32, f32) {
    scanned(heights, range_of, wider)
}

/// How many heights are NaN.
pub(crate) fn missing(heights: &[f32]) -> usize {
    let count = |heights: &[f32]| {
        vectorized(
            #[inline(always)]
            || {
                // Few enough together that their count fits into 32 bits.
                let count = |few: &[f32]| few.iter().map(|height| u32::from(height.is_nan())).sum::<u32>();
                heights.chunks(SCANNED_TOGETHER).map(|few| count(few) as usize).sum::<usize>()
            },
        )
    };
    scanned(heights, count, |one, other| one + other)
}

/// The first height above `limit` or below `-limit`.
pub(crate) fn first_beyond(heights: &[f32], limit: f32) -> Option<f32> {
    let is_beyond = |height: &&f32| height.abs() > limit;
    // A loop that may end early is not vectorized: it looks where one is known to be.
    let any = |heights: &&[f32]| heights.iter().fold(false, |any, height| any | is_beyond(&height));
    let first = |heights: &[f32]| heights.iter().find(is_beyond).copied();
    scanned(heights, |heights| heights.chunks(LOOKED_AT_TOGETHER).find(any).and_then(first), Option::or)
}

/// What `scan` finds, joined in the order of the heights where threads share them.
fn scanned<T: Send>(
    heights: &[f32],
    scan: impl Fn(&[f32]) -> T + Sync,
    join: impl Fn(T, T) -> T + Send + Sync,
) -> T {
    // Small parts, as walks read them by the thousand, are scanned before another thread wakes.
    if heights.len() <= SCANNED_TOGETHER {
        return scan(heights);
    }
    let parts = heights.par_chunks(SCANNED_TOGETHER).map(&scan);
    parts.reduce_with(join).unwrap_or_else(|| scan(&[]))
}

fn range_of(heights: &[f32]) -> (f32, f32) {
    vectorized(
        #[inline(always)]
        || range_in_lanes(heights),
    )
}

#[inline(always)]
fn range_in_lanes(heights: &[f32]) -> (f32, f32) {
    let (mut lows, mut highs) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
    let (groups, rest) = heights.as_chunks::<LANES>();
    for group in groups {
        for lane in 0..LANES {
            (lows[lane], highs[lane]) = wider((lows[lane], highs[lane]), (group[lane], group[lane]));
        }
    }
    let all = lows.into_iter().zip(highs).chain(rest.iter().map(|&height| (height, height)));
    all.fold((f32::INFINITY, f32::NEG_INFINITY), wider)
}

/// A range that holds both. Comparisons with NaN are false; unlike `min` and `max` they are vectorized.
#[inline(always)]
fn wider(range: (f32, f32), other: (f32, f32)) -> (f32, f32) {
    let low = if other.0 < range.0 { other.0 } else { range.0 };
    (low, if other.1 > range.1 { other.1 } else { range.1 })
}

impl Lattice {
    /// The lowest and highest height of the held posts; finite unless these are a part without data.
    pub fn height_range(&self) -> (f32, f32) {
        range(self.held_heights())
    }

    /// The number of posts without data.
    pub fn missing_posts(&self) -> usize {
        missing(self.held_heights())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_heights_are_scanned_as_few_and_nan_is_none() {
        for count in [0, 1, 7, 8, 9, 1000, SCANNED_TOGETHER, SCANNED_TOGETHER * 3 + 5] {
            let height = |index: usize| match index.wrapping_mul(2_654_435_761) % 1000 {
                part if part < 100 => f32::NAN,
                part => part as f32 - 500.0,
            };
            let heights: Vec<f32> = (0..count).map(height).collect();
            let plain = heights.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &height| {
                (low.min(height), high.max(height))
            });
            assert_eq!(range(&heights), plain, "{count}");
            let holes = heights.iter().filter(|height| height.is_nan()).count();
            assert_eq!(missing(&heights), holes, "{count}");
            let found = heights.iter().find(|height| height.abs() > 450.0).copied();
            assert_eq!(first_beyond(&heights, 450.0), found, "{count}");
        }
        assert_eq!(range(&[f32::NAN; 20]), (f32::INFINITY, f32::NEG_INFINITY));
    }
}
