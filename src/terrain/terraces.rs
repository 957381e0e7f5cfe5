//! Heights without the terraces of models that hold whole meters.
//!
//! Rounding turns a gentle slope into terraces, whose edges shading and contours would show as if they were there. The
//! true height of a post lies within half a step of the rounded one, so each post may be anywhere in that interval: the
//! heights are smoothed over ever smaller neighborhoods, and each is kept in its interval. What is higher than a step stays
//! where it is, a river's bank as well as a peak.

use rayon::prelude::*;

use crate::lattice::Lattice;
use sandtable_raster::raster::SampleFloat;

/// Half the widths of the neighborhoods, in posts: a much wider terrace keeps a level middle. Wider neighborhoods first
/// leave more of it behind than they level.
const REACHES: [usize; 8] = [4, 4, 2, 2, 1, 1, 1, 1];

/// Whether all heights that are numbers are whole: those of a model that was rounded.
pub fn are_whole<T: SampleFloat>(heights: &[T]) -> bool {
    let whole = |height: f64| height.is_nan() || height.fract() == 0.0;
    heights.iter().all(|&height| whole(height.into()))
}

/// The lattice with heights that are within half of `step_m` of its own, and smooth. Posts for which `is_fixed` (by index,
/// as [`Lattice::heights`]) keep their heights, and so do pinned ones.
///
/// Time is linear in the number of posts, some 15 ns each on one thread; memory is three heights a post.
pub fn without_terraces(
    lattice: &Lattice,
    step_m: f32,
    is_fixed: &(dyn Fn(usize) -> bool + Sync),
) -> Lattice {
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    let own = lattice.heights();
    let lowest = lattice.height_range().0;
    let mut heights: Vec<f32> = vec![0.0; own.len()];
    let by_row = |heights: &mut Vec<f32>, fill: &(dyn Fn(usize, &mut [f32]) + Sync)| {
        heights.par_chunks_exact_mut(columns).enumerate().for_each(|(row, line)| fill(row, line));
    };
    by_row(&mut heights, &|row, line| line.copy_from_slice(&lattice.filled_row(row as u32, lowest)));
    let mut along: Vec<f32> = vec![0.0; own.len()];
    for reach in REACHES {
        by_row(&mut along, &|row, line| mean_along(&heights[row * columns..][..columns], reach, line));
        by_row(&mut heights, &|row, line| {
            let near = row.saturating_sub(reach)..(row + reach + 1).min(rows);
            let share = 1.0 / near.len() as f32;
            line.fill(0.0);
            for row in near {
                let other = &along[row * columns..][..columns];
                line.iter_mut().zip(other).for_each(|(sum, value)| *sum += value * share);
            }
            let first = row * columns;
            for (index, (height, &own)) in (first..).zip(line.iter_mut().zip(&own[first..][..columns])) {
                if !own.is_nan() {
                    let is_kept =
                        is_fixed(index) || lattice.pinned().get(index).is_some_and(|pinned| *pinned);
                    *height =
                        if is_kept { own } else { height.clamp(own - 0.5 * step_m, own + 0.5 * step_m) };
                }
            }
        });
    }
    heights
        .par_iter_mut()
        .zip(own)
        .filter(|(_, own)| own.is_nan())
        .for_each(|(height, _)| *height = f32::NAN);
    lattice.with_heights(heights)
}

/// The means of the values within `reach` of each.
fn mean_along(values: &[f32], reach: usize, means: &mut [f32]) {
    let count = values.len();
    // In f64, so that what is added to the sum is taken from it again.
    let mut sum: f64 = values[..reach.min(count)].iter().map(|&value| f64::from(value)).sum();
    for (index, mean) in means.iter_mut().enumerate() {
        if let Some(&entering) = values.get(index + reach) {
            sum += f64::from(entering);
        }
        if let Some(leaving) = index.checked_sub(reach + 1) {
            sum -= f64::from(values[leaving]);
        }
        let near = (index + reach + 1).min(count) - index.saturating_sub(reach);
        *mean = (sum / near as f64) as f32;
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
}
