//! Profiles: values along a line, straight between stations.

use crate::simplify::simplified;

/// A piecewise-linear value over stations: at least two, finite, never falling. NaN is no value.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    stations: Vec<f64>,
    values: Vec<f64>,
}

impl Profile {
    /// The profile of `values` at `stations`; `None` where these are not as many, fewer than two, not finite or falling.
    pub fn new(stations: Vec<f64>, values: Vec<f64>) -> Option<Self> {
        let is_rising = stations.windows(2).all(|pair| pair[0] <= pair[1]);
        let is_valid = stations.len() == values.len() && stations.len() >= 2 && is_rising;
        (is_valid && stations.iter().all(|station| station.is_finite())).then_some(Self { stations, values })
    }

    /// The straight profile over `length` from one value to another.
    pub fn straight(length: f64, ends: [f64; 2]) -> Self {
        Self { stations: vec![0.0, length], values: ends.to_vec() }
    }

    /// The stations.
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// The value at each station.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The first and the last station.
    pub fn span(&self) -> [f64; 2] {
        [self.stations[0], self.stations[self.stations.len() - 1]]
    }

    /// The value at `station`; see [`value_at`].
    pub fn at(&self, station: f64) -> f64 {
        value_at(&self.stations, &self.values, station)
    }

    /// The profile from one station to another, with stations from 0; backward where `to` is the lower. Stations within
    /// `merge` of either end are dropped, and the slice is at least `merge` long.
    pub fn slice(&self, from: f64, to: f64, merge: f64) -> Self {
        let (low, high) = (from.min(to), from.max(to).max(from.min(to) + merge));
        let inner = self.stations.iter().copied().filter(|at| *at > low + merge && *at < high - merge);
        let mut inner: Vec<f64> = std::iter::once(low).chain(inner).chain([high]).collect();
        if to < from {
            inner.reverse();
        }
        let values = inner.iter().map(|&at| self.at(at)).collect();
        Self { stations: inner.into_iter().map(|at| (at - from).abs()).collect(), values }
    }

    /// The profile from its end to its start, with stations from 0.
    pub fn reversed(&self) -> Self {
        let end = self.stations[self.stations.len() - 1];
        let stations = self.stations.iter().rev().map(|station| end - station).collect();
        Self { stations, values: self.values.iter().rev().copied().collect() }
    }

    /// Adds `station`, where it lies between the ends and is none of the profile's, with the value there.
    pub fn insert(&mut self, station: f64) {
        let place = self.stations.partition_point(|&at| at < station);
        if place > 0 && self.stations.get(place).is_some_and(|&at| at > station) {
            self.values.insert(place, self.at(station));
            self.stations.insert(place, station);
        }
    }

    /// The stations, both ends among them, between which straight lines keep within `slack` of the values (Douglas and
    /// Peucker 1973).
    pub fn bends(&self, slack: f64) -> Vec<f64> {
        let (stations, values) = (&self.stations, &self.values);
        let off = |from: usize, to: usize, index: usize| {
            let run = stations[to] - stations[from];
            let part = if run > 0.0 { (stations[index] - stations[from]) / run } else { 0.0 };
            (values[index] - (values[from] + (values[to] - values[from]) * part)).abs()
        };
        simplified(stations.len(), slack, off).into_iter().map(|index| stations[index]).collect()
    }

    /// The steepest rise or fall, of those over more than `least_run`.
    pub fn steepest(&self, least_run: f64) -> f64 {
        let steps = self.stations.windows(2).zip(self.values.windows(2));
        let grade = |(at, value): (&[f64], &[f64])| {
            let run = at[1] - at[0];
            if run > least_run { ((value[1] - value[0]) / run).abs() } else { 0.0 }
        };
        steps.map(grade).fold(0.0, f64::max)
    }

    /// The steepest rise or fall over stretches `base` long, as value by run, with the station where that stretch begins.
    /// `None` where no stretch of that length has values all along.
    pub fn steepest_over(&self, base: f64) -> Option<(f64, f64)> {
        let [first, last] = self.span();
        // A straight profile is steepest over a stretch that begins or ends at one of its stations.
        let starts = self.stations.iter().flat_map(|&at| [at, at - base]);
        let starts = starts.filter(|&from| from >= first && from + base <= last);
        let grade = |from: f64| (((self.at(from + base) - self.at(from)) / base).abs(), from);
        // A NaN is less than any number.
        starts
            .map(grade)
            .filter(|(grade, _)| grade.is_finite())
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)))
    }

    /// The means over windows of `window` about each station, narrower toward the ends, which keep their values.
    ///
    /// Over a kink between two grades that is a parabola as long as the window, and a mean of profiles that keep a grade
    /// keeps it too; the narrowing adds on one side of the mean what it takes on the other.
    pub fn smoothed(&self, window: f64) -> Self {
        let length = self.stations[self.stations.len() - 1];
        let areas = self.areas();
        let mean = |from: f64, to: f64| {
            self.values[0] + (self.area_to(&areas, to) - self.area_to(&areas, from)) / (to - from)
        };
        let smooth = |(&station, &value): (&f64, &f64)| {
            let half = (window / 2.0).min(station).min(length - station);
            // A narrower window has little more than rounding between its sides.
            if half < 1e-3 { value } else { mean(station - half, station + half) }
        };
        let values = self.stations.iter().zip(&self.values).map(smooth).collect();
        Self { stations: self.stations.clone(), values }
    }

    /// The area under the profile from its start to each station, above its first value.
    fn areas(&self) -> Vec<f64> {
        let steps = self.stations.windows(2).zip(self.values.windows(2));
        let area = |area: &mut f64, (at, value): (&[f64], &[f64])| {
            *area += (at[1] - at[0]) * ((value[0] + value[1]) / 2.0 - self.values[0]);
            Some(*area)
        };
        std::iter::once(0.0).chain(steps.scan(0.0, area)).collect()
    }

    fn area_to(&self, areas: &[f64], station: f64) -> f64 {
        let after = leg_end(&self.stations, station);
        let (from, to) = (self.stations[after - 1], self.stations[after]);
        let (low, high) = (self.values[after - 1] - self.values[0], self.values[after] - self.values[0]);
        let along = station - from;
        let part = if to > from { along / (to - from) } else { 0.0 };
        areas[after - 1] + along * (low + (high - low) * part / 2.0)
    }
}

/// The index of the station at which the leg with `station` ends: 1 before the first, the last after it.
pub fn leg_end(stations: &[f64], station: f64) -> usize {
    stations.partition_point(|&at| at < station).clamp(1, stations.len() - 1)
}

/// The value at `station`, straight between `stations`, of which there are at least two; that of the nearer end beyond
/// them, and exactly the given one at a given station. NaN beside a NaN.
pub fn value_at(stations: &[f64], values: &[f64], station: f64) -> f64 {
    let after = leg_end(stations, station);
    let (from, to) = (stations[after - 1], stations[after]);
    let part = if to > from { ((station - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
    let (low, high) = (values[after - 1], values[after]);
    if part < 1.0 { low * (1.0 - part) + high * part } else { high }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn profile(points: &[(f64, f64)]) -> Profile {
        let (stations, values) = points.iter().copied().unzip();
        Profile::new(stations, values).expect("stations rise")
    }

    #[test]
    fn the_steepest_stretch_is_found_wherever_its_ends_are() {
        let stations = vec![0.0, 40.0, 50.0, 65.0, 200.0];
        let ground = Profile::new(stations, vec![0.0, 0.0, 5.0, 5.5, 5.5]).expect("stations rise");
        let (grade, from) = ground.steepest_over(20.0).expect("there is ground");
        assert!((grade - (5.0 + 10.0 / 30.0) / 20.0).abs() < 1e-12 && from == 40.0, "{grade} {from}");
        assert_eq!(ground.steepest_over(201.0), None);
        let hole = Profile::new(vec![0.0, 10.0, 20.0], vec![1.0, f64::NAN, 2.0]).expect("stations rise");
        assert_eq!(hole.steepest_over(5.0), None);
    }

    #[test]
    fn a_profile_is_straight_between_its_stations_and_level_beyond() {
        let hill = profile(&[(0.0, 1.0), (10.0, 6.0), (30.0, 0.1)]);
        assert_eq!([-5.0, 0.0, 10.0, 30.0, 99.0].map(|at| hill.at(at)), [1.0, 1.0, 6.0, 0.1, 0.1]);
        assert!((hill.at(4.0) - 3.0).abs() < 1e-12);
        assert_eq!(hill.steepest(0.0), 0.5);
        assert_eq!(hill.steepest(10.0), 5.9 / 20.0);
    }

    #[test]
    fn stations_that_fall_or_are_too_few_make_no_profile() {
        assert_eq!(Profile::new(vec![0.0, 2.0, 1.0], vec![0.0; 3]), None);
        assert_eq!(Profile::new(vec![0.0, f64::NAN], vec![0.0; 2]), None);
        assert_eq!(Profile::new(vec![0.0], vec![0.0]), None);
        assert_eq!(Profile::new(vec![0.0, 1.0], vec![0.0; 3]), None);
    }

    #[test]
    fn a_slice_runs_from_its_first_station_to_its_second() {
        let hill = profile(&[(0.0, 0.0), (10.0, 5.0), (30.0, 0.0)]);
        assert_eq!(hill.slice(4.0, 20.0, 0.0), profile(&[(0.0, 2.0), (6.0, 5.0), (16.0, 2.5)]));
        assert_eq!(hill.slice(20.0, 4.0, 0.0), profile(&[(0.0, 2.5), (10.0, 5.0), (16.0, 2.0)]));
        assert_eq!(hill.slice(4.0, 10.5, 1.0).stations(), [0.0, 6.5]);
    }

    #[test]
    fn a_crest_becomes_a_parabola_between_its_tangents() {
        let stations: Vec<f64> = (0..=200).map(f64::from).collect();
        let levels: Vec<f64> = stations.iter().map(|at| 5.0 - 0.05 * (at - 100.0).abs()).collect();
        let curve = Profile::new(stations, levels).expect("stations rise").smoothed(40.0);
        for (at, level) in curve.stations().iter().zip(curve.values()) {
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
            let curve = Profile::new(stations, levels.clone()).expect("stations rise").smoothed(window_m);
            let last = levels.len() - 1;
            prop_assert_eq!((curve.values()[0], curve.values()[last]), (levels[0], levels[last]));
            for (at, level) in curve.stations().windows(2).zip(curve.values().windows(2)) {
                prop_assert!((level[1] - level[0]).abs() <= 0.1 * (at[1] - at[0]) + 1e-6);
            }
        }
    }
}
