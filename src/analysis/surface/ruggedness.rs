//! How uneven the ground is around a post: four measures over a square of posts.
//!
//! Sums and extremes are taken down the columns first and along the row then, always in the same order from the
//! square's own corner, so that a part of the land gives the same bits as the whole. A square with `2r + 1` posts a side
//! costs `4r + 2` additions.

use rayon::prelude::*;

use super::window::{GradientMethod, WindowGradient, by_window};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Outcome, OutcomeRaster, PostValues};
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// Ruggedness at each post; no data where the square reaches beyond the border or holds a post without data.
///
/// # Errors
/// [`AnalysisError::Argument`] where `radius` is not whole, or is not 1 with `tri`.
pub(crate) fn ruggedness(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let (ground, radius) = (&*land.ground, arguments.posts("radius")?);
    let (name, unit, values) = match &*arguments.word("measure") {
        "tpi" => ("topographic position", "m", position(ground, radius, stop)?),
        "vrm" => ("vector ruggedness", "", vector_ruggedness(ground, radius, stop)?),
        "roughness" => ("roughness", "m", roughness(ground, radius, stop)?),
        _ if radius != 1 => {
            let problem = format!("is {radius}, but `tri` compares a post with its eight neighbors; state 1");
            return Err(AnalysisError::argument("radius", problem));
        }
        _ => ("terrain ruggedness", "m", by_window(ground, stop, riley)?),
    };
    let raster = OutcomeRaster { name, unit, values: PostValues::Numbers(values), classes: Vec::new() };
    Ok(Outcome { raster: Some(raster), ..Outcome::default() })
}

/// The root of the summed squares of the differences from eight neighbors (Riley 1999), meters.
fn riley(window: &[f32; 9]) -> f32 {
    window.iter().map(|height| (height - window[4]) * (height - window[4])).sum::<f32>().sqrt()
}

/// The height above the mean of the square's other posts (Weiss 2001), meters.
fn position(ground: &Lattice, radius: usize, stop: &StopFlag) -> Result<Vec<f32>, AnalysisError> {
    let others = ((2 * radius + 1) * (2 * radius + 1) - 1) as f64;
    let heights = ground.heights();
    let sum = |sum: f64, height: f32| sum + f64::from(height);
    over_squares(ground, heights, radius, stop, (0.0, sum, |a, b| a + b), |index, sum: f64| {
        let own = f64::from(heights[index]);
        (own - (sum - own) / others) as f32
    })
}

/// The difference of the highest post and the lowest (Wilson et al. 2007), meters.
fn roughness(ground: &Lattice, radius: usize, stop: &StopFlag) -> Result<Vec<f32>, AnalysisError> {
    let none = [f32::INFINITY, f32::NEG_INFINITY];
    let join = |[low, high]: [f32; 2], [other_low, other_high]: [f32; 2]| {
        [lower(low, other_low), higher(high, other_high)]
    };
    let grow = move |range: [f32; 2], height: f32| join(range, [height, height]);
    over_squares(ground, ground.heights(), radius, stop, (none, grow, join), |_, [low, high]| high - low)
}

/// The lower of two numbers; NaN where one is.
fn lower(a: f32, b: f32) -> f32 {
    if a < b || a.is_nan() { a } else { b }
}

/// The higher of two numbers; NaN where one is.
fn higher(a: f32, b: f32) -> f32 {
    if a > b || a.is_nan() { a } else { b }
}

/// 1 less the length of the mean of unit normals (Sappington, Longshore and Thompson 2007), 0..=1.
fn vector_ruggedness(ground: &Lattice, radius: usize, stop: &StopFlag) -> Result<Vec<f32>, AnalysisError> {
    check_memory(ground.heights().len() as u64 * 12, "the normals of the ground", "name a smaller `extent`")?;
    let gradient = WindowGradient::new(ground, GradientMethod::Horn);
    let east = by_window(ground, stop, |window| gradient.of(window)[0])?;
    let north = by_window(ground, stop, |window| gradient.of(window)[1])?;
    let slopes: Vec<[f32; 2]> = east.into_par_iter().zip(north).map(|(east, north)| [east, north]).collect();
    let posts = ((2 * radius + 1) * (2 * radius + 1)) as f64;
    let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let sum = move |sum: [f64; 3], slopes: [f32; 2]| {
        let [east, north] = slopes.map(f64::from);
        let up = 1.0 / (1.0 + east * east + north * north).sqrt();
        add(sum, [east * up, north * up, up])
    };
    over_squares(ground, &slopes, radius, stop, ([0.0; 3], sum, add), |_, [east, north, up]| {
        let length = (east * east + north * north + up * up).sqrt();
        // Rounding may make the mean longer than 1 by a bit; NaN stays.
        let ruggedness = 1.0 - length / posts;
        if ruggedness < 0.0 { 0.0 } else { ruggedness as f32 }
    })
}

/// The value of each post from a square of samples around it, `radius` posts to each side: `grow` takes a sample in,
/// `join` puts parts together. NaN where the square reaches beyond the lattice.
fn over_squares<S: Copy + Sync, T: Copy + Send + Sync>(
    ground: &Lattice,
    samples: &[S],
    radius: usize,
    stop: &StopFlag,
    (none, grow, join): (T, impl Fn(T, S) -> T + Sync, impl Fn(T, T) -> T + Sync),
    value: impl Fn(usize, T) -> f32 + Sync,
) -> Result<Vec<f32>, AnalysisError> {
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let mut values = vec![f32::NAN; samples.len()];
    values.par_chunks_mut(columns).enumerate().for_each_init(
        || vec![none; columns],
        |down, (row, values)| {
            if row < radius || row + radius >= rows || columns <= 2 * radius || stop.is_stopped() {
                return;
            }
            down.fill(none);
            for other in row - radius..=row + radius {
                let line = &samples[other * columns..][..columns];
                down.iter_mut().zip(line).for_each(|(down, &sample)| *down = grow(*down, sample));
            }
            for (column, parts) in (radius..).zip(down.windows(2 * radius + 1)) {
                let all = parts.iter().fold(none, |all, &part| join(all, part));
                values[column] = value(row * columns + column, all);
            }
        },
    );
    if stop.is_stopped() { Err(AnalysisError::Stopped) } else { Ok(values) }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::window::tests::{land, outcome, values};

    fn rough(columns: u32, rows: u32) -> Vec<f32> {
        (0..columns * rows).map(|index| (index * 7919 % 101) as f32 * 0.37).collect()
    }

    #[test]
    fn position_and_roughness_are_those_of_a_loop_over_the_square() {
        let heights = rough(17, 13);
        let land = land(DVec2::splat(4.0), 17, heights.clone());
        let position = values(&land, "ruggedness", &[("measure", "tpi")], &[("radius", 3.0)]);
        let roughness = values(&land, "ruggedness", &[("measure", "roughness")], &[("radius", 3.0)]);
        for (index, &own) in heights.iter().enumerate() {
            let (column, row) = (index % 17, index / 17);
            if !(3..14).contains(&column) || !(3..10).contains(&row) {
                assert!(position[index].is_nan() && roughness[index].is_nan());
                continue;
            }
            let square = |at: &usize| {
                at % 17 + 3 >= column && at % 17 <= column + 3 && at / 17 + 3 >= row && at / 17 <= row + 3
            };
            let around: Vec<f32> = (0..heights.len()).filter(square).map(|at| heights[at]).collect();
            assert_eq!(around.len(), 49);
            let mean = (around.iter().sum::<f32>() - own) / 48.0;
            assert!((position[index] - (own - mean)).abs() < 1e-4);
            let (low, high) = around.iter().fold((f32::MAX, f32::MIN), |(a, b), &h| (a.min(h), b.max(h)));
            assert_eq!(roughness[index], high - low);
        }
    }

    #[test]
    fn a_plane_has_no_vector_ruggedness_and_a_roof_has_that_of_its_normals() {
        let plane = (0..49u8).map(|index| f32::from(index % 7) * 3.0).collect();
        let flat = values(&land(DVec2::ONE, 7, plane), "ruggedness", &[("measure", "vrm")], &[]);
        assert!(flat[24].abs() < 1e-6 && flat[8].is_nan(), "{flat:?}");
        // A roof of slope 1: normals (∓1, 0, 1)/√2 beside the ridge and (0, 0, 1) on it.
        let roof = (0..49u8).map(|index| 3.0 - f32::from((index % 7).abs_diff(3))).collect();
        let rugged = values(&land(DVec2::ONE, 7, roof), "ruggedness", &[("measure", "vrm")], &[]);
        let up = (2.0 / 2f32.sqrt() + 1.0) / 3.0;
        assert!((rugged[24] - (1.0 - up)).abs() < 1e-6, "{}", rugged[24]);
    }

    #[test]
    fn a_hole_empties_the_squares_that_hold_it_and_a_square_wider_than_the_land_all() {
        let mut heights = rough(9, 9);
        heights[0] = f32::NAN;
        let land = land(DVec2::ONE, 9, heights);
        for measure in ["tpi", "roughness"] {
            let values = values(&land, "ruggedness", &[("measure", measure)], &[("radius", 2.0)]);
            assert!(values[20].is_nan() && !values[21].is_nan() && !values[29].is_nan(), "{measure}");
        }
        let none = values(&land, "ruggedness", &[("measure", "tpi")], &[("radius", 100.0)]);
        assert!(none.iter().all(|value| value.is_nan()));
    }

    #[test]
    fn a_radius_that_is_not_whole_or_not_for_the_measure_is_an_error() {
        let land = land(DVec2::ONE, 9, rough(9, 9));
        for (measure, radius) in [("tpi", 1.5), ("tri", 2.0)] {
            let error = outcome(&land, "ruggedness", &[("measure", measure)], &[("radius", radius)]);
            assert_eq!(error.err().and_then(|error| error.key()), Some("radius"));
        }
    }
}
