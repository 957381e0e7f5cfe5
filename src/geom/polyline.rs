//! A polyline with stations: distance along it, from its start.

use glam::DVec2;

use crate::profile::leg_end;
use crate::rect::Rect;

/// Vertices nearer to each other than this are one, in meters: files that mean one point write the same numbers, up to
/// the rounding of a change of system.
const SAME_VERTEX_M: f64 = 0.01;

/// A vertex to the centimeter, the same for vertices that mean one point.
pub type VertexKey = (i64, i64);

/// The key of the vertex at `at`.
pub fn vertex_key(at: DVec2) -> VertexKey {
    let key = (at / SAME_VERTEX_M).round();
    (key.x as i64, key.y as i64)
}

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

    /// Whether it ends where it begins, round something.
    pub fn is_closed(&self) -> bool {
        self.points.len() > 3 && self.points.first() == self.points.last()
    }

    /// The first and the last vertex.
    pub fn ends(&self) -> [DVec2; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }

    /// The legs from vertex to vertex.
    pub fn legs(&self) -> impl ExactSizeIterator<Item = [DVec2; 2]> + '_ {
        self.points.windows(2).map(|ends| [ends[0], ends[1]])
    }

    /// The point at `station`, clamped to the line's ends.
    pub fn at(&self, station: f64) -> DVec2 {
        let after = leg_end(&self.stations, station);
        let (from, to) = (self.stations[after - 1], self.stations[after]);
        let part = ((station - from) / (to - from)).clamp(0.0, 1.0);
        self.points[after - 1].lerp(self.points[after], part)
    }

    /// The points at two stations, the first not above the second, and the vertices between them.
    pub fn between(&self, from: f64, to: f64) -> Vec<DVec2> {
        let first = self.stations.partition_point(|&station| station <= from);
        let past = self.stations.partition_point(|&station| station < to);
        let inner = self.points.get(first..past).unwrap_or_default();
        std::iter::once(self.at(from)).chain(inner.iter().copied()).chain([self.at(to)]).collect()
    }

    /// The line from one station to another; `None` where less than `merge_m` lies between them. See [`Polyline::new`].
    pub fn slice(&self, from: f64, to: f64, merge_m: f64) -> Option<Self> {
        Self::new(self.between(from, to), merge_m)
    }

    /// The parts within `rect`.
    pub fn clip(&self, rect: &Rect) -> Vec<Self> {
        let mut parts: Vec<Vec<DVec2>> = Vec::new();
        for [from, to] in self.legs() {
            let Some((from, to)) = rect.clip_line(from, to).filter(|(from, to)| from != to) else { continue };
            match parts.last_mut() {
                Some(part) if part.last() == Some(&from) => part.push(to),
                _ => parts.push(vec![from, to]),
            }
        }
        parts.into_iter().filter_map(|part| Self::new(part, 0.0)).collect()
    }

    /// The stations at which the line first enters and last leaves `rect`; `None` where it passes by.
    pub fn range_within(&self, rect: &Rect) -> Option<[f64; 2]> {
        let clipped = |(leg, [from, to]): (usize, [DVec2; 2])| Some((leg, rect.clip_line(from, to)?));
        let station = |leg: usize, at: DVec2| self.stations[leg] + self.points[leg].distance(at);
        let (first, (enter, _)) = self.legs().enumerate().find_map(clipped)?;
        let (last, (_, leave)) = self.legs().enumerate().filter_map(clipped).last()?;
        Some([station(first, enter), station(last, leave)])
    }
}

/// The indices of the `points` that are vertices of the line through them: those farther than `merge_m` from the vertex
/// before.
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
    fn a_slice_has_the_vertices_between_its_ends() {
        let line = Polyline::new([DVec2::ZERO, DVec2::X * 3.0, DVec2::new(3.0, 4.0)], 0.0).expect("a line");
        assert_eq!(line.between(1.0, 5.0), [DVec2::X, DVec2::X * 3.0, DVec2::new(3.0, 2.0)]);
        assert_eq!(line.slice(3.0, 7.0, 0.0).expect("a line").points(), &line.points()[1..]);
        assert_eq!(line.slice(3.0, 3.0, 0.0), None);
    }

    #[test]
    fn a_clipped_line_has_a_part_for_every_visit() {
        let zigzag = [(-1.0, 1.0), (3.0, 1.0), (3.0, 2.0), (-1.0, 2.0)].map(DVec2::from);
        let line = Polyline::new(zigzag, 0.0).expect("a line");
        let square = Rect { min: DVec2::ZERO, max: DVec2::splat(2.0) };
        let part = |x: [f64; 2], y: f64| x.map(|x| DVec2::new(x, y)).to_vec();
        let parts: Vec<Vec<DVec2>> = line.clip(&square).iter().map(|part| part.points().to_vec()).collect();
        assert_eq!(parts, [part([0.0, 2.0], 1.0), part([2.0, 0.0], 2.0)]);
        assert_eq!(line.range_within(&square), Some([1.0, 8.0]));
        let south = Rect { min: DVec2::ZERO, max: DVec2::new(2.0, 1.5) };
        assert_eq!(line.range_within(&south), Some([1.0, 3.0]));
    }

    #[test]
    fn a_line_that_stays_in_place_is_none() {
        assert_eq!(Polyline::new([DVec2::ONE, DVec2::ONE, DVec2::ONE], 1e-6), None);
    }
}
