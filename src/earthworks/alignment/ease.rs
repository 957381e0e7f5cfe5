//! Vertical curves: kinks of a profile rounded, its grade kept.
//!
//! Each level becomes the mean of the profile over a window about its station. Over a kink between two grades that is a
//! parabola as long as the window, which is what road builders call a vertical curve. A mean of profiles that keep a
//! grade keeps it too. Toward the ends the window shrinks with the way that is left, so that the ends stay where they
//! are, and the grade is kept there as well: what the shrinking adds on one side of the mean it takes on the other.

/// The levels of a profile with its kinks rounded over `window_m` meters; stations rise from 0, levels are finite.
pub fn eased(stations_m: &[f64], levels_m: &[f64], window_m: f64) -> Vec<f64> {
    let profile = EasedProfile::new(stations_m, levels_m);
    let length_m = stations_m[stations_m.len() - 1];
    let ease = |(&station, &level): (&f64, &f64)| {
        let half = (window_m / 2.0).min(station).min(length_m - station);
        // A thinner window has no more than the rounding of two sums between its sides.
        if half < 1e-3 { level } else { profile.mean(station - half, station + half) }
    };
    stations_m.iter().zip(levels_m).map(ease).collect()
}

/// A profile that is straight between its stations.
struct EasedProfile<'a> {
    stations_m: &'a [f64],
    levels_m: &'a [f64],
    /// The area under the profile from its start to each station, above its first level.
    areas: Vec<f64>,
}

impl<'a> EasedProfile<'a> {
    fn new(stations_m: &'a [f64], levels_m: &'a [f64]) -> Self {
        let mut areas = vec![0.0];
        let mut area = 0.0;
        for (stations, levels) in stations_m.windows(2).zip(levels_m.windows(2)) {
            area += (stations[1] - stations[0]) * ((levels[0] + levels[1]) / 2.0 - levels_m[0]);
            areas.push(area);
        }
        Self { stations_m, levels_m, areas }
    }

    fn area_to(&self, station: f64) -> f64 {
        let after = self.stations_m.partition_point(|&at| at < station).clamp(1, self.stations_m.len() - 1);
        let (from, to) = (self.stations_m[after - 1], self.stations_m[after]);
        let (low, high) =
            (self.levels_m[after - 1] - self.levels_m[0], self.levels_m[after] - self.levels_m[0]);
        let along = station - from;
        let part = if to > from { along / (to - from) } else { 0.0 };
        self.areas[after - 1] + along * (low + (high - low) * part / 2.0)
    }

    fn mean(&self, from: f64, to: f64) -> f64 {
        self.levels_m[0] + (self.area_to(to) - self.area_to(from)) / (to - from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_crest_becomes_a_parabola_between_its_tangents() {
        let stations: Vec<f64> = (0..=200).map(f64::from).collect();
        let levels: Vec<f64> = stations.iter().map(|at| 5.0 - 0.05 * (at - 100.0).abs()).collect();
        let curve = eased(&stations, &levels, 40.0);
        for (at, level) in stations.iter().zip(&curve) {
            let x = (at - 100.0).abs();
            let parabola = if x < 20.0 { 5.0 - 0.05 * (10.0 + x * x / 40.0) } else { 5.0 - 0.05 * x };
            assert!((level - parabola).abs() < 1e-9, "{level} at {at}");
        }
    }

    proptest! {
        #[test]
        fn the_grade_is_kept_and_the_ends_stay(
            steps in prop::collection::vec((0.01..30.0f64, -0.1..0.1f64), 1..60),
            window_m in 1.0..200.0f64,
        ) {
            let (mut stations, mut levels) = (vec![0.0], vec![500.0]);
            for (run, grade) in steps {
                stations.push(stations[stations.len() - 1] + run);
                levels.push(levels[levels.len() - 1] + run * grade);
            }
            let curve = eased(&stations, &levels, window_m);
            let last = levels.len() - 1;
            prop_assert_eq!((curve[0], curve[last]), (levels[0], levels[last]));
            for (at, level) in stations.windows(2).zip(curve.windows(2)) {
                prop_assert!((level[1] - level[0]).abs() <= 0.1 * (at[1] - at[0]) + 1e-6);
            }
        }
    }
}
