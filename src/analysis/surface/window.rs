//! Values of posts from the heights of their 3 × 3 windows, row by row.
//!
//! ```text
//!   w[6] w[7] w[8]   north
//!   w[3] w[4] w[5]
//!   w[0] w[1] w[2]   south
//! ```
//!
//! A post at the border, or with one of the nine heights missing, has no data, as `gdaldem` leaves it without
//! `-compute_edges`. The loop over a row is written for the compiler to vectorize.

use std::ops::{Add, Sub};

use glam::DVec2;
use rayon::prelude::*;

use crate::error::AnalysisError;
use sandtable_base::vectorized::vectorized;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The heights of a window, row by row from the south-west, meters.
pub(super) type WindowHeights = [f32; 9];

/// How slopes follow from a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GradientMethod {
    /// From eight neighbors with weights 1-2-1 (Horn 1981).
    Horn,
    /// From four neighbors (Zevenbergen and Thorne 1987).
    ZevenbergenThorne,
}

impl GradientMethod {
    /// The method of the parameter `method`.
    pub(super) fn of(word: &str) -> Self {
        if word == "zevenbergen-thorne" { Self::ZevenbergenThorne } else { Self::Horn }
    }
}

/// The gradient of windows on a lattice.
#[derive(Clone, Copy, Debug)]
pub(super) struct WindowGradient {
    method: GradientMethod,
    per_east: f32,
    per_north: f32,
    cell: DVec2,
}

impl WindowGradient {
    /// For the windows of a lattice.
    pub(super) fn new(lattice: &Lattice, method: GradientMethod) -> Self {
        let cells = if method == GradientMethod::Horn { 8.0 } else { 2.0 };
        let cell = lattice.cell() * cells;
        Self { method, per_east: (1.0 / cell.x) as f32, per_north: (1.0 / cell.y) as f32, cell }
    }

    /// [`WindowGradient::of`] with sums that are exact.
    #[inline(always)]
    pub(super) fn exact(&self, w: &WindowHeights) -> [f64; 2] {
        let [east, north] = self.differences(w.map(f64::from));
        [east / self.cell.x, north / self.cell.y]
    }

    /// The rise per meter eastward and northward.
    #[inline(always)]
    pub(super) fn of(&self, w: &WindowHeights) -> [f32; 2] {
        let [east, north] = self.differences(*w);
        [east * self.per_east, north * self.per_north]
    }

    /// The weighted sums of differences of heights eastward and northward.
    #[inline(always)]
    fn differences<T: Copy + Add<Output = T> + Sub<Output = T>>(&self, w: [T; 9]) -> [T; 2] {
        let twice = |difference: T| difference + difference;
        match self.method {
            GradientMethod::Horn => [
                (w[2] - w[0]) + twice(w[5] - w[3]) + (w[8] - w[6]),
                (w[6] - w[0]) + twice(w[7] - w[1]) + (w[8] - w[2]),
            ],
            GradientMethod::ZevenbergenThorne => [w[5] - w[3], w[7] - w[1]],
        }
    }
}

/// The value of each post that has a whole window; NaN for the others.
///
/// # Errors
/// [`AnalysisError::Stopped`].
pub(super) fn by_window(
    lattice: &Lattice,
    stop: &StopFlag,
    value: impl Fn(&WindowHeights) -> f32 + Sync,
) -> Result<Vec<f32>, AnalysisError> {
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    let heights = lattice.heights();
    let mut values = vec![f32::NAN; heights.len()];
    values.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
        if row == 0 || row + 1 >= rows || columns < 3 || stop.is_stopped() {
            return;
        }
        let line = |row: usize| &heights[row * columns..][..columns];
        let lines = [line(row - 1), line(row), line(row + 1)];
        vectorized(
            #[inline(always)]
            || row_of_windows(lines, &mut values[1..columns - 1], &value),
        );
    });
    if stop.is_stopped() { Err(AnalysisError::Stopped) } else { Ok(values) }
}

/// The values of the posts of a row but the first and the last, from its heights and those of the rows south and north of it.
#[inline(always)]
fn row_of_windows(
    [south, own, north]: [&[f32]; 3],
    values: &mut [f32],
    value: &impl Fn(&WindowHeights) -> f32,
) {
    let count = values.len();
    let [sw, s, se] = [0, 1, 2].map(|by| &south[by..by + count]);
    let [w, o, e] = [0, 1, 2].map(|by| &own[by..by + count]);
    let [nw, n, ne] = [0, 1, 2].map(|by| &north[by..by + count]);
    for at in 0..count {
        let window = [sw[at], s[at], se[at], w[at], o[at], e[at], nw[at], n[at], ne[at]];
        // Heights are finite or NaN: 0, or NaN where one is missing.
        let lack: f32 = window.iter().map(|height| height * 0.0).sum();
        values[at] = value(&window) + lack;
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::land::Land;
    use crate::outcome::Outcome;
    use crate::test_land::{bare, run_kind, values_of};

    /// Bare land with posts `cell` meters apart.
    pub(in crate::surface) fn land(cell: DVec2, columns: u32, heights: Vec<f32>) -> Land {
        bare((DVec2::new(1000.0, 2000.0), cell), columns, heights)
    }

    /// The outcome of a kind with words and numbers stated.
    pub(in crate::surface) fn outcome(
        land: &Land,
        kind: &str,
        words: &[(&str, &str)],
        numbers: &[(&str, f64)],
    ) -> Result<Outcome, AnalysisError> {
        let words = words.iter().map(|&(name, word)| (name, ArgumentValue::Word(word.to_owned())));
        let numbers = numbers.iter().map(|&(name, number)| (name, ArgumentValue::Number(number)));
        run_kind(kind, land, words.chain(numbers))
    }

    /// The values of a kind's raster.
    pub(in crate::surface) fn values(
        land: &Land,
        kind: &str,
        words: &[(&str, &str)],
        numbers: &[(&str, f64)],
    ) -> Vec<f32> {
        let raster = outcome(land, kind, words, numbers).expect("an outcome").raster.expect("a raster");
        values_of(&raster)
    }

    #[test]
    fn posts_at_the_border_and_around_a_hole_have_no_data() {
        let mut heights = vec![3.0; 49];
        heights[16] = f32::NAN;
        let land = land(DVec2::ONE, 7, heights);
        let sums = by_window(&land.ground, &StopFlag::default(), |window| window.iter().sum());
        let sums = sums.expect("not stopped");
        let holds: Vec<usize> = (0..49).filter(|&index| !sums[index].is_nan()).collect();
        // Of the inner 5 × 5 those beyond column 3 or row 3.
        assert_eq!(holds, [11, 12, 18, 19, 25, 26, 29, 30, 31, 32, 33, 36, 37, 38, 39, 40]);
        assert!(holds.iter().all(|&index| sums[index] == 27.0));
    }

    #[test]
    fn lattices_of_two_rows_or_columns_have_no_data_at_all() {
        for columns in [2, 6] {
            let land = land(DVec2::ONE, columns, vec![1.0; 12]);
            assert!(values(&land, "slope", &[], &[]).iter().all(|value| value.is_nan()));
        }
    }
}
