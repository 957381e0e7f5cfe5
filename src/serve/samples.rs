//! Positions at equal distances along a path: the `samples` of a request.

use glam::DVec2;

use crate::coordinates::AxisOrder;
use sandtable_geom::geodesic::Geodesic;

/// `count` positions at equal distances along the path through `vertices`, both ends included.
///
/// Between latitudes and longitudes the path is the geodesic on the WGS 84 ellipsoid, between x,y the straight line.
/// With fewer than two vertices or a count below two, the vertices are returned.
pub fn along_path(axes: AxisOrder, vertices: &[DVec2], count: usize) -> Vec<DVec2> {
    if vertices.len() < 2 || count < 2 {
        return vertices.to_vec();
    }
    let legs: Vec<PathLeg> = vertices.windows(2).map(|pair| PathLeg::new(axes, pair[0], pair[1])).collect();
    let total: f64 = legs.iter().map(PathLeg::length).sum();
    let mut samples = Vec::with_capacity(count);
    let (mut leg, mut passed) = (0, 0.0);
    for index in 0..count - 1 {
        let along = total * (index as f64 / (count - 1) as f64);
        while leg + 1 < legs.len() && along >= passed + legs[leg].length() {
            passed += legs[leg].length();
            leg += 1;
        }
        samples.push(legs[leg].at(along - passed));
    }
    samples.extend(vertices.last());
    samples
}

/// The path between two vertices.
enum PathLeg {
    Geodesic(Geodesic),
    Straight { start: DVec2, end: DVec2 },
}

impl PathLeg {
    fn new(axes: AxisOrder, start: DVec2, end: DVec2) -> Self {
        match axes {
            AxisOrder::LatLng => Self::Geodesic(Geodesic::between(start, end)),
            AxisOrder::Xy => Self::Straight { start, end },
        }
    }

    fn length(&self) -> f64 {
        match self {
            Self::Geodesic(geodesic) => geodesic.length_m(),
            Self::Straight { start, end } => start.distance(*end),
        }
    }

    fn at(&self, along: f64) -> DVec2 {
        match self {
            Self::Geodesic(geodesic) => geodesic.at(along),
            Self::Straight { start, .. } if self.length() == 0.0 => *start,
            Self::Straight { start, end } => start.lerp(*end, along / self.length()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_equally_far_apart_along_the_path_and_keep_its_ends() {
        let path = [DVec2::ZERO, DVec2::new(30.0, 0.0), DVec2::new(30.0, 0.0), DVec2::new(30.0, 10.0)];
        let samples = along_path(AxisOrder::Xy, &path, 5);
        let expected = [(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (30.0, 0.0), (30.0, 10.0)];
        assert_eq!(samples, expected.map(|(x, y)| DVec2::new(x, y)));
        let point = [DVec2::ONE; 3];
        assert_eq!(along_path(AxisOrder::Xy, &point, 4), vec![DVec2::ONE; 4], "a path of no length");
    }

    #[test]
    fn on_the_earth_they_follow_the_geodesic() {
        let path = [DVec2::new(-1.0, 60.0), DVec2::new(1.0, 60.0)];
        let samples = along_path(AxisOrder::LatLng, &path, 3);
        assert!(samples[1].x.abs() < 1e-12 && samples[1].y > 60.003, "the middle lies north of the parallel");
        assert_eq!((samples[0], samples[2]), (path[0], path[1]));
    }
}
