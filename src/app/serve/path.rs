//! Places at equal distances along a path: the `samples` of a request.

use glam::DVec2;

use crate::app::serve::places::{AxisOrder, Coordinates};
use crate::geom::geodesic::Geodesic;

/// `count` places along the path through `vertices`, the first at its start and the last at its end, all as far from
/// the next as along the path.
///
/// Between latitudes and longitudes the way is the geodesic on the WGS 84 ellipsoid, between x,y the straight line.
/// Needs two vertices and a count of two; with fewer, the vertices come back.
pub fn samples(coordinates: &Coordinates, vertices: &[DVec2], count: usize) -> Vec<DVec2> {
    if vertices.len() < 2 || count < 2 {
        return vertices.to_vec();
    }
    let legs: Vec<PathLeg> =
        vertices.windows(2).map(|pair| PathLeg::between(coordinates.axes, pair[0], pair[1])).collect();
    let total: f64 = legs.iter().map(PathLeg::length).sum();
    let mut places = Vec::with_capacity(count);
    let (mut leg, mut behind) = (0, 0.0);
    for index in 0..count - 1 {
        let along = total * (index as f64 / (count - 1) as f64);
        while leg + 1 < legs.len() && along >= behind + legs[leg].length() {
            behind += legs[leg].length();
            leg += 1;
        }
        places.push(legs[leg].at(along - behind));
    }
    places.extend(vertices.last());
    places
}

/// The way from one vertex to the next.
enum PathLeg {
    Geodesic(Geodesic),
    Straight { start: DVec2, end: DVec2 },
}

impl PathLeg {
    fn between(axes: AxisOrder, start: DVec2, end: DVec2) -> Self {
        match axes {
            AxisOrder::LatLng => Self::Geodesic(Geodesic::between(start, end)),
            AxisOrder::Xy => Self::Straight { start, end },
        }
    }

    fn length(&self) -> f64 {
        match self {
            Self::Geodesic(way) => way.length_m(),
            Self::Straight { start, end } => start.distance(*end),
        }
    }

    fn at(&self, along: f64) -> DVec2 {
        match self {
            Self::Geodesic(way) => way.at(along),
            Self::Straight { start, end } => {
                let length = start.distance(*end);
                if length == 0.0 { *start } else { start.lerp(*end, along / length) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::crs::Crs;

    #[test]
    fn samples_are_equally_far_apart_along_the_path_and_keep_its_ends() {
        let coordinates = Coordinates { crs: Crs::local(), axes: AxisOrder::Xy };
        let path = [DVec2::ZERO, DVec2::new(30.0, 0.0), DVec2::new(30.0, 0.0), DVec2::new(30.0, 10.0)];
        let places = samples(&coordinates, &path, 5);
        let expected = [(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (30.0, 0.0), (30.0, 10.0)];
        assert_eq!(places, expected.map(|(x, y)| DVec2::new(x, y)));
        let still = [DVec2::ONE; 3];
        assert_eq!(samples(&coordinates, &still, 4), vec![DVec2::ONE; 4], "a path of no length");
    }

    #[test]
    fn on_the_earth_they_follow_the_geodesic() {
        let coordinates = Coordinates { crs: Crs::wgs84(), axes: AxisOrder::LatLng };
        let path = [DVec2::new(-1.0, 60.0), DVec2::new(1.0, 60.0)];
        let places = samples(&coordinates, &path, 3);
        assert!(places[1].x.abs() < 1e-12 && places[1].y > 60.003, "the middle lies north of the parallel");
        assert_eq!((places[0], places[2]), (path[0], path[1]));
    }
}
