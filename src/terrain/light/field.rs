//! Values at every n-th post of a lattice.

use std::borrow::Cow;

use glam::Vec2;
use rayon::prelude::*;

use crate::lattice::Lattice;
use crate::returned_memory::returned_zeros;
use sandtable_base::vectorized::vectorized;

/// Values at every `every`-th post of a lattice, row by row from the south-west. The last row and the last column may
/// lie beyond the lattice's border.
#[derive(Clone, Debug)]
pub struct CoarseField<'a> {
    pub columns: usize,
    pub rows: usize,
    pub every: usize,
    /// Meters between values, eastward and northward.
    pub cell: Vec2,
    pub values: Cow<'a, [f32]>,
}

/// The way in which the values around a post are reduced to one.
pub trait Reduction: Sync {
    /// What is collected of several values.
    type Sum: Copy + Send + Sync;
    /// Of no value.
    const NONE: Self::Sum;
    /// How many posts west and south of every `by`-th one count to it; `by / 2` east and north of it do.
    fn before(by: usize) -> usize;
    /// Adds a value that lies `north` posts north.
    fn add(&self, sum: Self::Sum, value: f32, north: f32) -> Self::Sum;
    /// Adds the sum of a column that lies `east` posts east.
    fn join(&self, sum: Self::Sum, column: Self::Sum, east: f32) -> Self::Sum;
    /// The one value.
    fn value(&self, sum: Self::Sum) -> f32;
}

/// The mean of the values that are not NaN; NaN where all are.
pub struct Mean;

impl Reduction for Mean {
    type Sum = Vec2;
    const NONE: Vec2 = Vec2::ZERO;

    fn before(by: usize) -> usize {
        by / 2
    }

    #[inline(always)]
    fn add(&self, sum: Vec2, value: f32, _north: f32) -> Vec2 {
        sum + if value.is_nan() { Vec2::ZERO } else { Vec2::new(value, 1.0) }
    }

    #[inline(always)]
    fn join(&self, sum: Vec2, column: Vec2, _east: f32) -> Vec2 {
        sum + column
    }

    #[inline(always)]
    fn value(&self, sum: Vec2) -> f32 {
        sum.x / sum.y
    }
}

impl<'a> CoarseField<'a> {
    /// The heights of all posts.
    pub fn of_heights(lattice: &'a Lattice) -> Self {
        Self {
            columns: lattice.columns() as usize,
            rows: lattice.rows() as usize,
            every: 1,
            cell: lattice.cell().as_vec2(),
            values: Cow::Borrowed(lattice.heights()),
        }
    }

    /// The factor by which the field must be reduced to have at most `most` cells along its longer side.
    pub fn factor(&self, most: usize) -> usize {
        (self.columns.max(self.rows) - 1).div_ceil(most).max(1)
    }

    /// The field at every `by`-th of its values, each reduced from those around it.
    pub fn reduced<R: Reduction>(&self, by: usize, reduction: &R) -> CoarseField<'static> {
        /// Rows that a thread takes at a time.
        const ROWS_AT_ONCE: usize = 32;
        let [columns, rows] = [self.columns, self.rows].map(|count| (count - 1).div_ceil(by) + 1);
        let mut values = returned_zeros(columns * rows);
        values.par_chunks_exact_mut(columns).with_max_len(ROWS_AT_ONCE).enumerate().for_each(
            |(row, values)| {
                let mut sums = vec![R::NONE; self.columns];
                for (from, north) in around::<R>(row, by, self.rows) {
                    vectorized(
                        #[inline(always)]
                        || add_line(reduction, &mut sums, self.line(from), north),
                    );
                }
                let joined = |column: usize| {
                    around::<R>(column, by, self.columns)
                        .fold(R::NONE, |sum, (from, east)| reduction.join(sum, sums[from], east))
                };
                // Between the borders as many columns count to each value.
                let before = R::before(by);
                let inner = 1..self.columns.saturating_sub(by / 2).div_ceil(by).clamp(1, columns);
                for column in (0..inner.start).chain(inner.end..columns) {
                    values[column] = reduction.value(joined(column));
                }
                if !inner.is_empty() {
                    join_columns(reduction, &mut values[inner], &sums[by - before..], (by, before));
                }
            },
        );
        let cell = self.cell * by as f32;
        CoarseField { columns, rows, every: self.every * by, cell, values: Cow::Owned(values) }
    }

    /// One row of values.
    pub fn line(&self, row: usize) -> &[f32] {
        &self.values[row * self.columns..][..self.columns]
    }

    /// The values along a row of a field `times` as fine, linear between values; of the first `count` columns.
    pub fn finer_row(&self, row: usize, times: usize, count: usize) -> Vec<f32> {
        let share = 1.0 / times as f32;
        let south = self.line(row / times);
        let part = (row % times) as f32 * share;
        let mut line = south.to_vec();
        if part > 0.0 {
            let north = self.line(row / times + 1);
            line.iter_mut().zip(north).for_each(|(value, north)| *value += (north - *value) * part);
        }
        if times == 1 {
            return line;
        }
        line.push(line[line.len() - 1]);
        let mut finer = vec![0.0; count];
        if times == 2 {
            vectorized(
                #[inline(always)]
                || refine(&mut finer, &line),
            );
            return finer;
        }
        for (finer, pair) in finer.chunks_mut(times).zip(line.windows(2)) {
            for (step, finer) in finer.iter_mut().enumerate() {
                *finer = pair[0] + (pair[1] - pair[0]) * (step as f32 * share);
            }
        }
        finer
    }
}

/// Adds the values of a line to the sums of their columns.
#[inline(always)]
fn add_line<R: Reduction>(reduction: &R, sums: &mut [R::Sum], line: &[f32], north: f32) {
    for (sum, &value) in sums.iter_mut().zip(line) {
        *sum = reduction.add(*sum, value, north);
    }
}

/// Sets values, each from the sums of `before` columns before its own, of its own and of half of `by` after it; the first of
/// `sums` is the first that counts to the first value.
fn join_columns<R: Reduction>(
    reduction: &R,
    values: &mut [f32],
    sums: &[R::Sum],
    (by, before): (usize, usize),
) {
    for (value, first) in values.iter_mut().zip((0..).step_by(by)) {
        let counting = sums[first..=first + before + by / 2].iter().zip(0i32..);
        let joined = counting
            .fold(R::NONE, |sum, (column, at)| reduction.join(sum, *column, (at - before as i32) as f32));
        *value = reduction.value(joined);
    }
}

/// The values of a line twice as fine.
#[inline(always)]
fn refine(finer: &mut [f32], line: &[f32]) {
    let (pairs, rest) = finer.as_chunks_mut::<2>();
    for (finer, (from, to)) in pairs.iter_mut().zip(line.iter().zip(&line[1..])) {
        *finer = [*from, from + (to - from) * 0.5];
    }
    rest.iter_mut().zip(&line[pairs.len()..]).for_each(|(finer, from)| *finer = *from);
}

/// The indices below `count` that count to the `at`-th `by`-th one, and how far beyond it each lies; at least the last.
fn around<R: Reduction>(at: usize, by: usize, count: usize) -> impl Iterator<Item = (usize, f32)> {
    let (center, last) = (at * by, count - 1);
    let from = center.saturating_sub(R::before(by)).min(last)..=(center + by / 2).min(last);
    from.map(move |index| (index, index as f32 - center as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(columns: usize, rows: usize) -> CoarseField<'static> {
        let value = |index: usize| (index % columns) as f32 * 3.0 + (index / columns) as f32;
        let values = (0..columns * rows).map(value).collect::<Vec<_>>().into();
        CoarseField { columns, rows, every: 1, cell: Vec2::new(10.0, 20.0), values }
    }

    #[test]
    fn a_plane_reduced_and_made_finer_is_the_plane_away_from_the_border() {
        for (columns, rows, by) in [(41, 33, 2), (40, 31, 3), (42, 42, 4)] {
            let fine = plane(columns, rows);
            let coarse = fine.reduced(by, &Mean);
            assert_eq!(coarse.cell, fine.cell * by as f32);
            for row in by..rows - 2 * by {
                let line = coarse.finer_row(row, by, columns);
                assert_eq!(line.len(), columns);
                let pairs = line.iter().zip(fine.line(row)).take(columns - 2 * by).skip(by);
                assert!(pairs.into_iter().all(|(value, exact)| (value - exact).abs() < 1e-4), "{row}, {by}");
            }
        }
    }

    #[test]
    fn every_value_is_the_mean_of_those_around_it_at_the_borders_too() {
        for (columns, rows) in [(1, 1), (2, 5), (3, 2), (17, 9), (64, 33), (131, 7)] {
            let mut fine = plane(columns, rows);
            fine.values.to_mut().iter_mut().step_by(7).for_each(|value| *value = f32::NAN);
            for by in 1..9 {
                let coarse = fine.reduced(by, &Mean);
                for (at, value) in coarse.values.iter().enumerate() {
                    let (column, row) = (at % coarse.columns, at / coarse.columns);
                    let sum_of = |from: usize| {
                        let south = around::<Mean>(row, by, rows);
                        south.fold(Mean::NONE, |sum, (row, _)| Mean.add(sum, fine.line(row)[from], 0.0))
                    };
                    let plain = around::<Mean>(column, by, columns)
                        .fold(Mean::NONE, |sum, (from, east)| Mean.join(sum, sum_of(from), east));
                    let same = value.to_bits() == Mean.value(plain).to_bits() || value.is_nan();
                    assert!(
                        same && value.is_nan() == Mean.value(plain).is_nan(),
                        "{columns}×{rows} {by}: {at}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_mean_leaves_out_what_has_no_data() {
        let mut fine = plane(9, 9);
        fine.values.to_mut()[0..3].fill(f32::NAN);
        fine.values.to_mut()[9..12].fill(f32::NAN);
        let coarse = fine.reduced(2, &Mean);
        assert!(coarse.values[0].is_nan());
        assert_eq!(coarse.values[1], 9.5, "of column 3 in rows 0 and 1");
    }
}
