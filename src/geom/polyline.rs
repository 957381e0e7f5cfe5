//! A polyline with stations: distance along it, from its start.

use glam::DVec2;

/// A line of at least two distinct vertices with the station of each.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    points: Vec<DVec2>,
    stations: Vec<f64>,
}

impl Polyline {
    /// The line through `points`; vertices nearer than `merge_m` to the one before are dropped, so that every
    /// segment has a direction. `None` where fewer than two vertices remain or one is not finite.
    pub fn new(points: impl IntoIterator<Item = DVec2>, merge_m: f64) -> Option<Self> {
        let given: Vec<DVec2> = points.into_iter().collect();
        if !given.iter().all(|point| point.is_finite()) {
            return None;
        }
        let mut line = Self { points: Vec::new(), stations: Vec::new() };
        for point in kept(&given, merge_m).into_iter().map(|index| given[index]) {
            let step = line.points.last().map_or(0.0, |last| last.distance(point));
            line.stations.push(line.stations.last().map_or(0.0, |station| station + step));
            line.points.push(point);
        }
        (line.points.len() >= 2).then_some(line)
    }

    /// The vertices.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Distance from the start to each vertex, in the points' unit.
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// The length of the line.
    pub fn length(&self) -> f64 {
        self.stations[self.stations.len() - 1]
    }

    /// The line from its end to its start.
    pub fn reversed(&self) -> Self {
        let length = self.length();
        Self {
            points: self.points.iter().rev().copied().collect(),
            stations: self.stations.iter().rev().map(|station| length - station).collect(),
        }
    }

    /// The point at `station`, clamped to the line's ends.
    pub fn at(&self, station: f64) -> DVec2 {
        let after =
            self.stations.partition_point(|&reached| reached < station).clamp(1, self.points.len() - 1);
        let (from, to) = (self.stations[after - 1], self.stations[after]);
        let part = ((station - from) / (to - from)).clamp(0.0, 1.0);
        self.points[after - 1].lerp(self.points[after], part)
    }
}

/// Which of `points` are vertices of the line through them: those further than `merge_m` from the vertex before. What
/// is known of every point is so known of every vertex.
pub fn kept(points: &[DVec2], merge_m: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(points.len());
    for (index, point) in points.iter().enumerate() {
        if kept.last().is_none_or(|&last| points[last].distance(*point) > merge_m) {
            kept.push(index);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_measure_the_way_along_the_line() {
        let line = Polyline::new([DVec2::ZERO, DVec2::X * 3.0, DVec2::new(3.0, 4.0)], 0.0).expect("a line");
        assert_eq!(line.stations(), [0.0, 3.0, 7.0]);
        assert_eq!(line.at(5.0), DVec2::new(3.0, 2.0));
        assert_eq!(line.at(99.0), DVec2::new(3.0, 4.0));
    }

    #[test]
    fn a_reversed_line_measures_from_its_other_end() {
        let line = Polyline::new([DVec2::ZERO, DVec2::X * 3.0, DVec2::new(3.0, 4.0)], 0.0).expect("a line");
        assert_eq!(line.reversed().stations(), [0.0, 4.0, 7.0]);
        assert_eq!(line.reversed().at(5.0), line.at(2.0));
    }

    #[test]
    fn a_line_that_stays_in_place_is_none() {
        assert_eq!(Polyline::new([DVec2::ONE, DVec2::ONE, DVec2::ONE], 1e-6), None);
    }
}
