//! Heights without the terraces of models that hold whole meters.
//!
//! Rounding turns a gentle slope into terraces, whose edges shading and contours would show as if they were there. The
//! true height of a post lies within half a step of the rounded one, so each post may be anywhere in that interval: the
//! heights are smoothed over ever smaller neighborhoods, and each is kept in its interval. What is higher than a step stays
//! where it is, a river's bank as well as a peak.

use std::ops::Range;

use rayon::prelude::*;

use crate::lattice::{HIGHEST_M, Lattice, Post};
use sandtable_base::vectorized::vectorized;
use sandtable_raster::raster::SampleFloat;

/// Half the widths of the neighborhoods, in posts: a much wider terrace keeps a level middle. Wider neighborhoods first
/// leave more of it behind than they level.
const REACHES: [usize; 8] = [4, 4, 2, 2, 1, 1, 1, 1];

/// Whether all heights that are numbers are whole: those of a model that was rounded.
pub fn are_whole<T: SampleFloat>(heights: &[T]) -> bool {
    /// Heights that a thread looks at before it sees whether another has found one that is not whole.
    const TOGETHER: usize = 1 << 14;
    // Of numbers that i64 holds this is the fraction's test without a call; all beyond it are whole, but for infinity.
    let is_small_whole = |height: f64| (height as i64) as f64 == height;
    let is_whole = |height: f64| is_small_whole(height) || height.is_nan() || height.fract() == 0.0;
    heights.par_chunks(TOGETHER).all(|heights| heights.iter().all(|&height| is_whole(height.into())))
}

/// The rows and columns of posts of a tile, which is smoothed as one: with its surroundings it fits a processor's own memory.
const TILE_ROWS: usize = 128;
const TILE_COLUMNS: usize = 256;

/// The lattice with heights that are within half of `step_m` of its own, and smooth. Posts for which `is_fixed` (by index,
/// as [`Lattice::heights`]) keep their heights, and so do pinned ones.
///
/// Time is linear in the number of posts, some 15 ns each on one thread; memory is one height a post.
pub fn without_terraces(
    lattice: &Lattice,
    step_m: f32,
    is_fixed: &(dyn Fn(usize) -> bool + Sync),
) -> Lattice {
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    let lowest = lattice.height_range().0;
    let mut heights: Vec<f32> = vec![0.0; lattice.heights().len()];
    heights.par_chunks_mut(TILE_ROWS * columns).with_max_len(1).enumerate().for_each(|(band, smooth)| {
        let first = band * TILE_ROWS;
        smooth_band(lattice, lowest, first..(first + TILE_ROWS).min(rows), step_m, is_fixed, smooth);
    });
    lattice.with_heights(heights)
}

/// The rows `wanted` of [`without_terraces`], as a part of the lattice that has no pins; `lowest` is the lowest height of the
/// lattice, meters.
///
/// # Panics
/// Where a row lies outside the lattice, or there are fewer than two.
pub fn rows_without_terraces(
    lattice: &Lattice,
    lowest: f32,
    wanted: Range<usize>,
    step_m: f32,
    is_fixed: &(dyn Fn(usize) -> bool + Sync),
) -> Lattice {
    let mut heights = vec![0.0; wanted.len() * lattice.columns() as usize];
    let south = Post { row: lattice.first().row + wanted.start as u32, ..lattice.first() };
    for first in wanted.clone().step_by(TILE_ROWS) {
        let rows = first..(first + TILE_ROWS).min(wanted.end);
        let begin = (first - wanted.start) * lattice.columns() as usize;
        smooth_band(lattice, lowest, rows, step_m, is_fixed, &mut heights[begin..]);
    }
    // The mean of heights at the bound may be rounded to one beyond it.
    heights.iter_mut().for_each(|height| *height = height.clamp(-HIGHEST_M, HIGHEST_M));
    Lattice::part((lattice.origin(), lattice.cell()), south, lattice.columns(), heights)
        .expect("the heights of a lattice, two rows or more")
}

/// The rows `wanted` of the smooth heights, into `smooth`.
fn smooth_band(
    lattice: &Lattice,
    lowest: f32,
    wanted: Range<usize>,
    step_m: f32,
    is_fixed: &(dyn Fn(usize) -> bool + Sync),
    smooth: &mut [f32],
) {
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    let own = lattice.heights();
    let around = surroundings(wanted.clone(), rows);
    let filled: Vec<Vec<f32>> = around.clone().map(|row| lattice.filled_row(row as u32, lowest)).collect();
    let reach_of = |row: usize, column: usize| {
        let index = row * columns + column;
        let is_kept = || is_fixed(index) || lattice.pinned().get(index).is_some_and(|pinned| *pinned);
        match own[index].is_nan() {
            true => f32::INFINITY,
            false if is_kept() => 0.0,
            false => 0.5 * step_m,
        }
    };
    let mut tile = SmoothedTile::default();
    for west in (0..columns).step_by(TILE_COLUMNS) {
        let wanted_columns = west..(west + TILE_COLUMNS).min(columns);
        let block =
            PostBlock { rows: around.clone(), columns: surroundings(wanted_columns.clone(), columns) };
        tile.fill(&block, &filled, reach_of);
        tile.smooth(block, [rows, columns]);
        for (row, line) in wanted.clone().zip(smooth.chunks_exact_mut(columns)) {
            let line = &mut line[wanted_columns.clone()];
            line.copy_from_slice(tile.heights_of(row, wanted_columns.clone()));
            let own = &own[row * columns..][wanted_columns.clone()];
            let holes = line.iter_mut().zip(own).filter(|(_, own)| own.is_nan());
            holes.for_each(|(height, _)| *height = f32::NAN);
        }
    }
}

/// The rows, or columns, of `count` on which those in `wanted` depend.
fn surroundings(wanted: Range<usize>, count: usize) -> Range<usize> {
    const ALL: usize = {
        let (mut sum, mut at) = (0, 0);
        while at < REACHES.len() {
            sum += REACHES[at];
            at += 1;
        }
        sum
    };
    wanted.start.saturating_sub(ALL)..(wanted.end + ALL).min(count)
}

/// Those of `range`, of `count`, of which all within `reach` lie in it, or beyond the border.
fn inner(range: &Range<usize>, reach: usize, count: usize) -> Range<usize> {
    let start = if range.start == 0 { 0 } else { range.start + reach };
    start..if range.end == count { count } else { range.end - reach }
}

/// Rows and columns of posts.
#[derive(Clone, Debug, Default)]
struct PostBlock {
    rows: Range<usize>,
    columns: Range<usize>,
}

/// The heights of a block of posts while they are smoothed. Memory is kept from tile to tile.
#[derive(Default)]
struct SmoothedTile {
    block: PostBlock,
    /// The heights of the model, row by row.
    own: Vec<f32>,
    /// How far each may move, meters.
    most_m: Vec<f32>,
    heights: Vec<f32>,
    /// Means along the rows.
    along: Vec<f32>,
}

impl SmoothedTile {
    /// Begins with the heights of a block: `rows` has those of the block's rows, from the lattice's first column on.
    fn fill(&mut self, block: &PostBlock, rows: &[Vec<f32>], most_m: impl Fn(usize, usize) -> f32) {
        self.block = block.clone();
        self.own.clear();
        self.most_m.clear();
        for (row, line) in block.rows.clone().zip(rows) {
            self.own.extend_from_slice(&line[block.columns.clone()]);
            self.most_m.extend(block.columns.clone().map(|column| most_m(row, column)));
        }
        self.heights.clone_from(&self.own);
        self.along.resize(self.own.len(), 0.0);
    }

    /// The place in the buffers of posts of a row.
    fn place(&self, row: usize, columns: Range<usize>) -> Range<usize> {
        let first = (row - self.block.rows.start) * self.block.columns.len();
        first + columns.start - self.block.columns.start..first + columns.end - self.block.columns.start
    }

    fn heights_of(&self, row: usize, columns: Range<usize>) -> &[f32] {
        &self.heights[self.place(row, columns)]
    }

    /// Smooths all posts whose surroundings are in the block; `known` is the block, and shrinks; the lattice has `rows` and
    /// `columns`.
    fn smooth(&mut self, mut known: PostBlock, [rows, columns]: [usize; 2]) {
        for reach in REACHES {
            let next = PostBlock {
                rows: inner(&known.rows, reach, rows),
                columns: inner(&known.columns, reach, columns),
            };
            for row in known.rows.clone() {
                let from = self.place(row, known.columns.clone());
                let to = self.place(row, next.columns.clone());
                let before = to.start - from.start;
                mean_along(&self.heights[from], reach, before, &mut self.along[to]);
            }
            for row in next.rows.clone() {
                let to = self.place(row, next.columns.clone());
                let near = row.saturating_sub(reach)..(row + reach + 1).min(rows);
                let [first, stride] =
                    [self.place(near.start, next.columns.clone()).start, self.block.columns.len()];
                let around = self.along[first..].chunks(stride).take(near.len());
                let line = &mut self.heights[to.clone()];
                let (own, most_m) = (&self.own[to.clone()], &self.most_m[to]);
                vectorized(
                    #[inline(always)]
                    || kept_mean(line, around, own, most_m),
                );
            }
            known = next;
        }
    }
}

/// The means of rows of values, as many as `heights` holds of each, kept within `most_m` of `own`.
#[inline(always)]
fn kept_mean<'a>(
    heights: &mut [f32],
    rows: impl ExactSizeIterator<Item = &'a [f32]>,
    own: &[f32],
    most_m: &[f32],
) {
    let share = 1.0 / rows.len() as f32;
    heights.fill(0.0);
    for row in rows {
        for (sum, value) in heights.iter_mut().zip(row) {
            *sum += value * share;
        }
    }
    for ((height, own), most_m) in heights.iter_mut().zip(own).zip(most_m) {
        *height = height.max(own - most_m).min(own + most_m);
    }
}

/// The means of the values within `reach` of each, from value number `first` on.
fn mean_along(values: &[f32], reach: usize, first: usize, means: &mut [f32]) {
    let mean = |index: usize| {
        let near = &values[index.saturating_sub(reach)..(index + reach + 1).min(values.len())];
        // In f64, in which sums of so few values are exact.
        (near.iter().map(|&value| f64::from(value)).sum::<f64>() / near.len() as f64) as f32
    };
    // Those at the ends have fewer around them.
    let whole = reach.max(first)..values.len().saturating_sub(reach).min(first + means.len());
    let (start, end) = (whole.start - first, whole.end.max(whole.start).min(first + means.len()) - first);
    let start = start.min(end);
    (0..start).chain(end..means.len()).for_each(|at| means[at] = mean(first + at));
    let means = &mut means[start..end];
    if means.is_empty() {
        return;
    }
    let values = &values[first + start - reach..];
    vectorized(
        #[inline(always)]
        || match reach {
            1 => whole_means::<3>(values, means),
            2 => whole_means::<5>(values, means),
            _ => whole_means::<9>(values, means),
        },
    );
}

/// The means of each `COUNT` values on end.
#[inline(always)]
fn whole_means<const COUNT: usize>(values: &[f32], means: &mut [f32]) {
    /// Sums that are made together.
    const TOGETHER: usize = 64;
    for (block, means) in means.chunks_mut(TOGETHER).enumerate() {
        let mut sums = [0.0f64; TOGETHER];
        for offset in 0..COUNT {
            let values = &values[block * TOGETHER + offset..];
            for (sum, &value) in sums[..means.len()].iter_mut().zip(values) {
                *sum += f64::from(value);
            }
        }
        for (mean, sum) in means.iter_mut().zip(sums) {
            *mean = (sum / COUNT as f64) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn lattice(height: impl Fn(f32, f32) -> f32) -> Lattice {
        let heights = (0..120 * 90).map(|index| height((index % 120) as f32, (index / 120) as f32)).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(30.0), 120, heights).expect("sound")
    }

    fn slope(x: f32, y: f32) -> f32 {
        0.13 * x + 0.04 * y + 2.0 * libm::sinf(x * 0.06)
    }

    #[test]
    fn a_rounded_slope_is_smooth_again_and_within_its_rounding() {
        let rounded = lattice(|x, y| slope(x, y).round());
        let smooth = without_terraces(&rounded, 1.0, &|_| false);
        let pairs = || smooth.heights().iter().zip(rounded.heights());
        assert!(pairs().all(|(smooth, rounded)| (smooth - rounded).abs() <= 0.5));
        let bumps = |lattice: &Lattice| -> f32 {
            let bend = |line: &[f32]| (line[0] - 2.0 * line[1] + line[2]).abs();
            lattice.heights().chunks(120).flat_map(|row| row.windows(3).map(bend)).sum()
        };
        assert!(bumps(&smooth) < 0.1 * bumps(&rounded), "{} of {}", bumps(&smooth), bumps(&rounded));
        let error = |lattice: &Lattice| -> f32 {
            let exact = (0..120 * 90).map(|index| slope((index % 120) as f32, (index / 120) as f32));
            lattice.heights().iter().zip(exact).map(|(height, exact)| (height - exact).abs()).sum()
        };
        assert!(error(&smooth) < 0.4 * error(&rounded), "{} of {}", error(&smooth), error(&rounded));
    }

    #[test]
    fn peaks_and_fixed_posts_and_holes_stay() {
        let peak = lattice(|x, y| match (x as u32, y as u32) {
            (60, 45) => 40.0,
            (20, 20) => f32::NAN,
            _ => slope(x, y).round(),
        });
        let smooth = without_terraces(&peak, 1.0, &|index| index == 7);
        assert!(smooth.heights()[45 * 120 + 60] >= 39.5);
        assert_eq!(smooth.heights()[7], peak.heights()[7]);
        assert!(smooth.heights()[20 * 120 + 20].is_nan());
        assert_eq!(smooth.heights().iter().filter(|height| height.is_nan()).count(), 1);
    }

    /// All rows, then all columns, by the definition.
    fn smoothed_whole(lattice: &Lattice, is_fixed: impl Fn(usize) -> bool) -> Vec<f32> {
        let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
        let own = lattice.heights();
        let mut heights = own.to_vec();
        for reach in REACHES {
            let near = |at: usize, count: usize| at.saturating_sub(reach)..(at + reach + 1).min(count);
            let along: Vec<f32> = (0..own.len())
                .map(|index| {
                    let near = near(index % columns, columns);
                    let row = &heights[index / columns * columns..];
                    (row[near.clone()].iter().map(|&z| f64::from(z)).sum::<f64>() / near.len() as f64) as f32
                })
                .collect();
            for (index, height) in heights.iter_mut().enumerate() {
                let near = near(index / columns, rows);
                let share = 1.0 / near.len() as f32;
                let mean = near.fold(0.0, |sum, row| sum + along[row * columns + index % columns] * share);
                let own = own[index];
                *height = if is_fixed(index) { own } else { mean.clamp(own - 0.5, own + 0.5) };
            }
        }
        heights
    }

    #[test]
    fn ground_at_the_bound_of_heights_stays_within_it() {
        for height in [HIGHEST_M, -HIGHEST_M, HIGHEST_M - 1.0] {
            let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 40, vec![height; 40 * 40]).expect("sound");
            let part = rows_without_terraces(&lattice, height, 3..30, 1.0, &|_| false);
            assert!(
                part.heights()
                    .iter()
                    .all(|smooth| smooth.abs() <= HIGHEST_M && (smooth - height).abs() <= 1.0)
            );
        }
    }

    #[test]
    fn tiles_leave_no_seams() {
        let is_fixed = |index: usize| index % 97 == 3;
        for [columns, rows] in [[600, 300], [3, 200], [290, 2], [256, 128], [257, 129]] {
            let height = |index: u32| {
                let (x, y) = (index % columns, index / columns);
                (slope(x as f32, y as f32) + ((x * 7919 + y * 104_729) % 13) as f32 * 0.2).round()
            };
            let heights = (0..columns * rows).map(height).collect();
            let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(30.0), columns, heights).expect("sound");
            let smooth = without_terraces(&lattice, 1.0, &is_fixed);
            assert!(smooth.heights() == smoothed_whole(&lattice, is_fixed), "{columns} × {rows}");
            let some = (rows as usize / 3)..(rows as usize / 3 + 2);
            let part =
                rows_without_terraces(&lattice, lattice.height_range().0, some.clone(), 1.0, &is_fixed);
            let places = some.start * columns as usize..some.end * columns as usize;
            assert_eq!(part.heights(), &smooth.heights()[places], "{columns} × {rows}");
        }
    }
}
