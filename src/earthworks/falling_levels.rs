//! Falling water levels: the nearest series of levels that never rises.
//!
//! Ground along a river rises in places by measurement error alone. The nearest levels that never rise, by least squares,
//! are found by pooling neighbors that rise until none does (isotonic regression; Ayer, Brunk, Ewing, Reid and Silverman
//! 1955). Levels that already fall are kept to the last bit, so a waterfall stays as steep as it is.
//!
//! ```text
//!   ground  ──╮    ╭─╮                 falling  ──╮
//!             ╰────╯ ╰──╮                         ╰────────╮    one level for the pit and the bump:
//!                       ╰───                               ╰──  neither cut to the pit nor dammed by the bump
//! ```
//!
//! The running minimum alone, which many tools take, cuts the whole river below a pit as deep as that pit.

/// A level with its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedLevel {
    /// Meters.
    pub level_m: f64,
    /// Above 0; the meters of river that have this level.
    pub weight: f64,
}

/// Neighbors with one level.
struct Pool {
    sum: f64,
    weight: f64,
    count: usize,
}

impl Pool {
    fn mean(&self) -> f64 {
        self.sum / self.weight
    }
}

/// The series nearest to `levels`, in downstream order, of those that never rise; one value for each.
///
/// Levels must be finite and weights above 0. Costs a step a level.
pub fn fit_falling(levels: &[WeightedLevel]) -> Vec<f64> {
    let mut pools: Vec<Pool> = Vec::new();
    for level in levels {
        let mut pool = Pool { sum: level.level_m * level.weight, weight: level.weight, count: 1 };
        while let Some(before) = pools.pop_if(|before| before.mean() < pool.mean()) {
            pool = Pool {
                sum: before.sum + pool.sum,
                weight: before.weight + pool.weight,
                count: before.count + pool.count,
            };
        }
        pools.push(pool);
    }
    let mut fitted = Vec::with_capacity(levels.len());
    for pool in &pools {
        // A level alone in its pool is kept, since a product and a quotient of it round.
        let level_m = if pool.count == 1 { levels[fitted.len()].level_m } else { pool.mean() };
        fitted.extend(std::iter::repeat_n(level_m, pool.count));
    }
    lower_to_minimum(&mut fitted);
    fitted
}

/// Lowers each of `levels` to the lowest before it.
fn lower_to_minimum(levels: &mut [f64]) {
    let mut lowest = f64::INFINITY;
    for level in levels {
        lowest = lowest.min(*level);
        *level = lowest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fitted(levels: &[f64]) -> Vec<f64> {
        let weighted = |&level_m: &f64| WeightedLevel { level_m, weight: 1.0 };
        fit_falling(&levels.iter().map(weighted).collect::<Vec<_>>())
    }

    #[test]
    fn a_waterfall_is_kept_and_a_pit_is_shared() {
        assert_eq!(fitted(&[90.3, 90.1, 70.7, 70.2]), [90.3, 90.1, 70.7, 70.2]);
        assert_eq!(fitted(&[9.0, 4.0, 8.0, 3.0]), [9.0, 6.0, 6.0, 3.0]);
    }

    #[test]
    fn the_longer_stretch_decides() {
        let levels =
            [WeightedLevel { level_m: 4.0, weight: 3.0 }, WeightedLevel { level_m: 8.0, weight: 1.0 }];
        assert_eq!(fit_falling(&levels), [5.0, 5.0]);
    }

    proptest! {
        #[test]
        fn the_fit_never_rises_and_no_shifted_series_is_nearer(
            levels in prop::collection::vec((-50.0..50.0f64, 0.1..9.0f64), 1..60),
            shift in -0.5..0.5f64,
        ) {
            let weighted: Vec<WeightedLevel> =
                levels.iter().map(|&(level_m, weight)| WeightedLevel { level_m, weight }).collect();
            let fitted = fit_falling(&weighted);
            prop_assert!(fitted.windows(2).all(|pair| pair[1] <= pair[0]));
            let distance = |series: &[f64]| -> f64 {
                weighted.iter().zip(series).map(|(at, level)| at.weight * (at.level_m - level).powi(2)).sum()
            };
            for from in 0..fitted.len() {
                let mut other = fitted.clone();
                other[from..].iter_mut().for_each(|level| *level += shift);
                lower_to_minimum(&mut other);
                prop_assert!(distance(&other) >= distance(&fitted) - 1e-9);
            }
        }
    }
}
