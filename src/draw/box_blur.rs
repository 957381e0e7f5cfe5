//! The means of squares around the values of a map.
//!
//! Rows first, then columns; each sum is added up from the south-west on, whole rows of values at a time, so that it has the
//! same bits however many are added at once.

use rayon::prelude::*;

use sandtable_base::vectorized::vectorized;

/// A map of rows of `columns` values with each value replaced by the mean of the square around it that reaches `reach` values
/// far, as far as that lies on the map. Spread over all threads; the same for any number of them.
pub fn box_blurred(map: &[f32], columns: usize, reach: usize) -> Vec<f32> {
    let rows = map.len() / columns.max(1);
    let mut along = vec![0.0; map.len()];
    along.par_chunks_exact_mut(columns.max(1)).zip(map.par_chunks_exact(columns.max(1))).for_each(
        |(means, line)| {
            vectorized(
                #[inline(always)]
                || sum_along(means, line, reach),
            );
            for (place, mean) in means.iter_mut().enumerate() {
                *mean /= near(place, reach, columns).len() as f32;
            }
        },
    );
    let mut blurred = vec![0.0; map.len()];
    blurred.par_chunks_exact_mut(columns.max(1)).enumerate().for_each(|(row, means)| {
        let around = near(row, reach, rows);
        let count = around.len() as f32;
        vectorized(
            #[inline(always)]
            || {
                for line in along[around.start * columns..around.end * columns].chunks_exact(columns) {
                    add(means, line);
                }
                means.iter_mut().for_each(|mean| *mean /= count);
            },
        );
    });
    blurred
}

/// The places of `count` that lie up to `reach` from one.
fn near(place: usize, reach: usize, count: usize) -> std::ops::Range<usize> {
    place.saturating_sub(reach)..(place + reach + 1).min(count)
}

/// Adds up to each value of `sums` those of `line` up to `reach` places from it, the first of them first.
#[inline(always)]
fn sum_along(sums: &mut [f32], line: &[f32], reach: usize) {
    for before in (1..=reach.min(line.len())).rev() {
        add(&mut sums[before..], line);
    }
    for after in 0..=reach.min(line.len()) {
        add(sums, &line[after..]);
    }
}

/// Adds values to sums, as far as both reach.
#[inline(always)]
fn add(sums: &mut [f32], values: &[f32]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_added_up_place_by_place_whatever_the_reach() {
        let (columns, rows) = (23, 17);
        let value = |index: usize| ((index * 7919) % 101) as f32 * 0.37 - 11.0;
        let map: Vec<f32> = (0..columns * rows).map(value).collect();
        for reach in [0, 1, 5, 16, 40] {
            let mean = |values: Vec<f32>| values.iter().sum::<f32>() / values.len() as f32;
            let along = |index: usize| {
                let (column, first) = (index % columns, index / columns * columns);
                mean(near(column, reach, columns).map(|at| map[first + at]).collect())
            };
            let along: Vec<f32> = (0..map.len()).map(along).collect();
            let across = |index: usize| {
                let (column, row) = (index % columns, index / columns);
                mean(near(row, reach, rows).map(|at| along[at * columns + column]).collect())
            };
            let plain: Vec<f32> = (0..map.len()).map(across).collect();
            assert_eq!(box_blurred(&map, columns, reach), plain, "{reach}");
        }
        assert!(box_blurred(&[], 0, 3).is_empty());
    }
}
