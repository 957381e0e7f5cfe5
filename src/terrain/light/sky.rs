//! The share of the sky that is seen: the mean over sixteen directions of cos² of the horizon's angle, which is the
//! light of a uniform sky on a level surface.
//!
//! The horizon in a direction is the steepest line to a post behind, on the upper convex hull of the profile so far: a
//! constant cost per post. Skylight changes smoothly, so that it needs no full resolution. Hulls are built on a lattice
//! of at most 1025 posts a side, of mean heights; the posts within about two of its cells are looked at on a lattice of
//! up to 2049. The higher of the two horizons counts, direction by direction.

use std::borrow::Cow;

use rayon::prelude::*;

use crate::light::field::{CoarseField, Mean};

/// The most cells along a side of the lattice of distant horizons.
const MOST_FAR_CELLS: usize = 1024;

/// The most cells along a side of the lattice of near horizons.
const MOST_NEAR_CELLS: usize = 2048;

/// As many posts as this, counted along rows and columns, are looked at on the finer lattice.
const NEAR_POSTS: isize = 4;

/// Directions computed together: more share out better over many threads, fewer hold fewer fields.
const TOGETHER: usize = 4;

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

/// The visible share of the sky, 0..=1; 1 where there is no data.
pub fn visibility(heights: &CoarseField) -> CoarseField<'static> {
    let near = match heights.factor(MOST_NEAR_CELLS) {
        1 => heights.clone(),
        factor => heights.reduced(factor, &Mean),
    };
    let factor = near.factor(MOST_FAR_CELLS);
    let far = near.reduced(factor, &Mean);
    let mut sky = vec![0.0; near.values.len()];
    for directions in DIRECTIONS.chunks(TOGETHER) {
        let far: Vec<_> = directions.par_iter().map(|&direction| distant_sky(&far, direction)).collect();
        sky.par_chunks_exact_mut(near.columns).enumerate().for_each(|(row, sky)| {
            let mut steepest = vec![0.0; near.columns];
            for (&direction, far) in directions.iter().zip(&far) {
                steepest.fill(0.0);
                raise_horizon(&near, row, direction, &mut steepest);
                let far = far.finer_row(row, factor, near.columns);
                for ((sky, far), &rise) in sky.iter_mut().zip(far).zip(&steepest) {
                    *sky += far.min(open_above(rise)) / DIRECTIONS.len() as f32;
                }
            }
        });
    }
    CoarseField { values: Cow::Owned(sky), ..near }
}

/// cos² of the angle of a horizon that rises by `rise` per meter.
fn open_above(rise: f32) -> f32 {
    1.0 / (1.0 + rise * rise)
}

/// Raises the steepest rise from each post of a row to those shortly behind it.
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

/// cos² of the horizon's angle at every post, looking back against `direction`.
fn distant_sky(heights: &CoarseField, direction: (isize, isize)) -> CoarseField<'static> {
    let (columns, rows) = (heights.columns as isize, heights.rows as isize);
    let (east, north) = direction;
    let step_m = step_m(heights, direction);
    let mut open = vec![1.0; heights.values.len()];
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
                let height = heights.values[index];
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
