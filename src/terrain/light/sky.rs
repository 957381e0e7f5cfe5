//! The share of the sky that is seen: the mean over sixteen directions of cos² of the horizon's angle, which is the
//! light of a uniform sky on a level surface.
//!
//! Skylight changes smoothly, so that it needs no full resolution, and a far ridge needs less than a near one. The ground is
//! a pyramid of lattices of mean heights, each with cells twice as wide as the one before. On each the few posts around a post
//! are looked at, about as far as two cells of the next. On the coarsest, of at most 513 posts a side, the horizon is also the
//! steepest line to any post behind, on the upper convex hull of the profile so far: a constant cost per post. The highest
//! horizon counts, direction by direction.
//!
//! ```text
//!   eye    near posts     posts of the next lattice        hull of the coarsest
//!    •     . . . .        :       :       :       :        |               |               |  …
//! ```

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use crate::light::field::{CoarseField, Mean};
use crate::returned_memory::returned_zeros;
use sandtable_base::vectorized::vectorized;

/// The most cells along a side of the finest lattice.
const MOST_NEAR_CELLS: usize = 2048;

/// The most cells along a side of the lattice of hulls.
const MOST_HULL_CELLS: usize = 512;

/// As many posts as this, counted along rows and columns, are looked at on each lattice.
const NEAR_POSTS: isize = 4;

/// Rows that a thread computes together; those of coarser lattices between two portions are computed twice.
const PORTION: usize = 64;

/// Columns and rows from post to post along a profile.
const DIRECTIONS: [(isize, isize); 16] = [
    (1, 0),
    (2, 1),
    (1, 1),
    (1, 2),
    (0, 1),
    (-1, 2),
    (-1, 1),
    (-2, 1),
    (-1, 0),
    (-2, -1),
    (-1, -1),
    (-1, -2),
    (0, -1),
    (1, -2),
    (1, -1),
    (2, -1),
];

/// The visible share of the sky for pictures that show every 2^`level`-th post of `heights`, 0..=1; 1 where there is no data.
pub fn visibility(heights: &CoarseField, level: u32) -> CoarseField<'static> {
    let shown = heights.factor(MOST_HULL_CELLS).min(1 << level.min(16));
    let finest = match heights.factor(MOST_NEAR_CELLS).max(shown) {
        1 => heights.clone(),
        every => heights.reduced(every, &Mean),
    };
    let mut coarser = Vec::new();
    while let Some(field) = coarser.last().or(Some(&finest)).filter(|field| field.factor(MOST_HULL_CELLS) > 1)
    {
        coarser.push(field.reduced(2, &Mean));
    }
    let hulls: Vec<CoarseField> = {
        let field = coarser.last().unwrap_or(&finest);
        DIRECTIONS.par_iter().with_max_len(1).map(|&direction| hull_sky(field, direction)).collect()
    };
    let fields: Vec<&CoarseField> = std::iter::once(&finest).chain(&coarser).collect();
    let columns = finest.columns;
    let mut sky: Vec<f32> = returned_zeros(finest.values.len());
    // A thread that is done takes the next portion, one at a time.
    sky.par_chunks_mut(PORTION * columns).with_max_len(1).enumerate().for_each(|(portion, sky)| {
        let first = portion * PORTION;
        let rows = first..first + sky.len() / columns;
        for (&direction, hull) in DIRECTIONS.iter().zip(&hulls) {
            let open = open_rows(&fields, hull, direction, rows.clone());
            sky.iter_mut().zip(open).for_each(|(sky, open)| *sky += open / DIRECTIONS.len() as f32);
        }
    });
    CoarseField { values: Cow::Owned(sky), ..finest }
}

/// cos² of the horizon's angle at the posts of some rows of the first of `fields`, each of which has half the cells of the one
/// before; `hull` is that of all posts of the last.
fn open_rows(
    fields: &[&CoarseField],
    hull: &CoarseField,
    direction: (isize, isize),
    rows: Range<usize>,
) -> Vec<f32> {
    let [field, coarser @ ..] = fields else { return Vec::new() };
    let mut open = vec![0.0; rows.len() * field.columns];
    let [first, columns] = [rows.start / 2, coarser.first().map_or(0, |field| field.columns)];
    let behind = open_rows(coarser, hull, direction, first..(rows.end - 1).div_ceil(2) + 1);
    let line = |row: usize| &behind[(row - first) * columns..][..columns];
    let mut between = vec![0.0; columns];
    for (row, open) in rows.zip(open.chunks_exact_mut(field.columns)) {
        vectorized(
            #[inline(always)]
            || {
                raise_horizon(field, row, direction, open);
                open.iter_mut().for_each(|rise| *rise = open_above(*rise));
                if coarser.is_empty() {
                    open.iter_mut().zip(hull.line(row)).for_each(|(own, hull)| *own = own.min(*hull));
                    return;
                }
                between.copy_from_slice(line(row / 2));
                if row % 2 > 0 {
                    let north = line(row / 2 + 1);
                    between.iter_mut().zip(north).for_each(|(value, north)| *value += (north - *value) * 0.5);
                }
                lower_to(open, &between);
            },
        );
    }
    open
}

/// Lowers values to those of a row with half the cells where these are less, linear between them.
#[inline(always)]
fn lower_to(open: &mut [f32], coarse: &[f32]) {
    let (pairs, rest) = open.as_chunks_mut::<2>();
    for (pair, coarse) in pairs.iter_mut().zip(coarse.windows(2)) {
        pair[0] = pair[0].min(coarse[0]);
        pair[1] = pair[1].min(coarse[0] + (coarse[1] - coarse[0]) * 0.5);
    }
    for (own, coarse) in rest.iter_mut().zip(&coarse[pairs.len()..]) {
        *own = own.min(*coarse);
    }
}

/// cos² of the angle of a horizon that rises by `rise` per meter.
#[inline(always)]
fn open_above(rise: f32) -> f32 {
    1.0 / (1.0 + rise * rise)
}

/// Raises the steepest rise from each post of a row to those shortly behind it.
#[inline(always)]
fn raise_horizon(heights: &CoarseField, row: usize, (east, north): (isize, isize), steepest: &mut [f32]) {
    let own = heights.line(row);
    let aside = east.unsigned_abs();
    for step in 1..=(NEAR_POSTS / (east.abs() + north.abs())).max(1) {
        let Some(behind) = row.checked_add_signed(-step * north).filter(|&row| row < heights.rows) else {
            return;
        };
        let shift = (aside * step as usize).min(own.len());
        let (here, there) = if east > 0 { (shift, 0) } else { (0, shift) };
        let per_meter = 1.0 / (step as f32 * step_m(heights, (east, north)));
        let pairs = own[here..].iter().zip(&heights.line(behind)[there..]);
        for (steepest, (own, behind)) in steepest[here..].iter_mut().zip(pairs) {
            *steepest = steepest.max((behind - own) * per_meter);
        }
    }
}

/// Meters from post to post along a profile.
fn step_m(heights: &CoarseField, (east, north): (isize, isize)) -> f32 {
    libm::hypotf(heights.cell.x * east as f32, heights.cell.y * north as f32)
}

/// cos² of the horizon's angle at every post by all posts behind it, looking back against `direction`.
fn hull_sky(heights: &CoarseField, direction: (isize, isize)) -> CoarseField<'static> {
    let (columns, rows) = (heights.columns as isize, heights.rows as isize);
    let (east, north) = direction;
    let step_m = step_m(heights, direction);
    let values: &[f32] = &heights.values;
    let mut open = vec![1.0; values.len()];
    let mut hull: Vec<(f32, f32)> = Vec::new();
    for row in 0..rows {
        let begins_here = !(0..rows).contains(&(row - north));
        let starts = if begins_here {
            0..columns
        } else if east > 0 {
            0..east.min(columns)
        } else {
            (columns + east).max(0)..columns
        };
        for column in starts {
            hull.clear();
            let posts = steps_within(column, east, columns).min(steps_within(row, north, rows));
            for post in 0..posts {
                let index = ((row + post * north) * columns + column + post * east) as usize;
                let height = values[index];
                if !height.is_nan() {
                    open[index] = open_above(extend_hull(&mut hull, (post as f32 * step_m, height)));
                }
            }
        }
    }
    CoarseField { values: Cow::Owned(open), ..*heights }
}

/// How many of `at`, `at + step`, `at + 2 step`, … lie from 0 to below `count`, where `at` does.
fn steps_within(at: isize, step: isize, count: isize) -> isize {
    match step {
        0 => isize::MAX,
        1.. => (count - 1 - at) / step + 1,
        _ => at / -step + 1,
    }
}

/// Adds a profile point to the upper hull; returns the rise per meter of the horizon behind it, at least 0.
fn extend_hull(hull: &mut Vec<(f32, f32)>, here: (f32, f32)) -> f32 {
    let rise_to = |behind: (f32, f32)| (behind.1 - here.1) / (here.0 - behind.0);
    let mut rise = hull.last().map_or(0.0, |&behind| rise_to(behind));
    while let [.., farther, _] = hull[..]
        && rise_to(farther) >= rise
    {
        rise = rise_to(farther);
        hull.pop();
    }
    hull.push(here);
    rise.max(0.0)
}
