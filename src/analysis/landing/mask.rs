//! Masks: how high the ground rises before each post in one direction.
//!
//! The ground ahead is a chain of posts, the nearest one to the line in each row or column. A chain is walked from its far
//! end with the upper hull of what was passed: the highest rise from a post is the tangent to that hull (Andrew 1979), so a
//! chain takes a time proportional to its length, however far the ground masks.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use sandtable_geom::azimuth::heading;
use sandtable_terrain::lattice::Lattice;

/// The greatest tangent of the rise from each post to the ground in the direction of an azimuth in degrees clockwise from
/// north: minus infinity where no ground lies ahead, NaN where the post has no data.
pub(crate) fn mask_tangents(ground: &Lattice, azimuth_deg: f64) -> Vec<f32> {
    let chains = MaskChains::new(ground, azimuth_deg);
    let heights = ground.heights();
    let masks: Vec<AtomicU32> = (0..heights.len()).map(|_| AtomicU32::new(f32::NAN.to_bits())).collect();
    chains.numbers().into_par_iter().for_each_init(Vec::new, |hull: &mut Vec<(f64, f64)>, number| {
        hull.clear();
        for along in chains.far_to_near() {
            let Some(index) = chains.post(number, along) else { continue };
            if heights[index].is_nan() {
                continue;
            }
            let here = (along as f64 * chains.step_m, f64::from(heights[index]));
            let rise = |(at, height): (f64, f64)| (height - here.1) / (at - here.0).abs();
            while hull.len() > 1 && rise(hull[hull.len() - 2]) >= rise(hull[hull.len() - 1]) {
                hull.pop();
            }
            let mask = hull.last().map_or(f64::NEG_INFINITY, |&top| rise(top)) as f32;
            masks[index].store(mask.to_bits(), Ordering::Relaxed);
            hull.push(here);
        }
    });
    masks.into_iter().map(|bits| f32::from_bits(bits.into_inner())).collect()
}

/// Parallel chains of posts: each post belongs to one.
struct MaskChains {
    columns: usize,
    rows: usize,
    /// Whether a chain has a post in each row, else in each column.
    is_by_rows: bool,
    /// Whether the far end is that of the greatest row or column.
    is_rising: bool,
    /// How far each row lies aside from the first, in columns, or the reverse.
    aside: Vec<i64>,
    /// Meters from one post of a chain to the next.
    step_m: f64,
}

impl MaskChains {
    fn new(ground: &Lattice, azimuth_deg: f64) -> Self {
        let toward = heading(azimuth_deg) / ground.cell();
        let is_by_rows = toward.y.abs() >= toward.x.abs();
        let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
        let (slant, count, is_rising) = match is_by_rows {
            true => (toward.x / toward.y, rows, toward.y > 0.0),
            false => (toward.y / toward.x, columns, toward.x > 0.0),
        };
        let step = if is_by_rows { DVec2::new(slant, 1.0) } else { DVec2::new(1.0, slant) };
        Self {
            columns,
            rows,
            is_by_rows,
            is_rising,
            aside: (0..count).map(|along| (slant * along as f64).round() as i64).collect(),
            step_m: (step * ground.cell()).length(),
        }
    }

    /// The numbers of the chains: where they pass the first row or column.
    fn numbers(&self) -> std::ops::Range<i64> {
        let across = if self.is_by_rows { self.columns } else { self.rows } as i64;
        let [least, greatest] =
            [self.aside.iter().min(), self.aside.iter().max()].map(|end| *end.unwrap_or(&0));
        -greatest..across - least
    }

    fn far_to_near(&self) -> impl Iterator<Item = usize> + use<> {
        let (count, is_rising) = (self.aside.len(), self.is_rising);
        (0..count).map(move |index| if is_rising { count - 1 - index } else { index })
    }

    fn post(&self, number: i64, along: usize) -> Option<usize> {
        let across = usize::try_from(number + self.aside[along]).ok()?;
        let (column, row) = if self.is_by_rows { (across, along) } else { (along, across) };
        (column < self.columns && row < self.rows).then_some(row * self.columns + column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::{bare, shaped};

    #[test]
    fn a_wall_to_the_east_masks_by_its_height_over_its_distance() {
        let land = shaped(6, 3, 10.0, |column, _| [0.0, 0.0, 1.0, 9.0, 0.0, 0.0][column as usize]);
        let masks = mask_tangents(&land.ground, 90.0);
        assert_eq!(masks[..6], [0.3, 0.45, 0.8, -0.45, 0.0, f32::NEG_INFINITY]);
        let behind = mask_tangents(&land.ground, 270.0);
        assert_eq!((behind[0], behind[4], behind[5]), (f32::NEG_INFINITY, 0.9, 0.45));
    }

    #[test]
    fn masks_are_the_greatest_rise_along_the_chain_of_nearest_posts() {
        let (columns, rows, cell) = (23_i64, 17_i64, DVec2::new(10.0, 8.0));
        let mut heights: Vec<f32> =
            (0..columns * rows).map(|index| ((index * 37 + index * index % 101) % 53) as f32).collect();
        heights[60] = f32::NAN;
        let land = bare((DVec2::ZERO, cell), columns as u32, heights.clone());
        for azimuth in [0.0, 17.0, 45.0, 100.0, 151.0, 200.0, 284.0, 359.0] {
            let found = mask_tangents(&land.ground, azimuth);
            let (east, north) = (azimuth.to_radians().sin() / cell.x, azimuth.to_radians().cos() / cell.y);
            for (index, &found) in found.iter().enumerate() {
                let (column, row) = (index as i64 % columns, index as i64 / columns);
                let mut wanted = f64::NEG_INFINITY;
                for (other, &height) in heights.iter().enumerate().filter(|(_, height)| !height.is_nan()) {
                    let (c, r) = (other as i64 % columns, other as i64 / columns);
                    let (is_in_chain, steps, slant) = if north.abs() >= east.abs() {
                        let slant = east / north;
                        let aside = |row: i64| (slant * row as f64).round() as i64;
                        (c - aside(r) == column - aside(row), (r - row) as f64 * north.signum(), slant)
                    } else {
                        let slant = north / east;
                        let aside = |column: i64| (slant * column as f64).round() as i64;
                        (r - aside(c) == row - aside(column), (c - column) as f64 * east.signum(), slant)
                    };
                    let step = if north.abs() >= east.abs() {
                        DVec2::new(slant * cell.x, cell.y).length()
                    } else {
                        DVec2::new(cell.x, slant * cell.y).length()
                    };
                    if is_in_chain && steps > 0.0 {
                        wanted = wanted.max(f64::from(height - heights[index]) / (steps * step));
                    }
                }
                let is_equal = match heights[index].is_nan() {
                    true => found.is_nan(),
                    false => wanted == f64::from(found) || (wanted - f64::from(found)).abs() < 1e-6,
                };
                assert!(is_equal, "{azimuth} {index}: {found} {wanted}");
            }
        }
    }
}
