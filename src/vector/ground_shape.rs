//! Circles, ellipses and their parts on the ground, as vertices in longitude and latitude on WGS 84.

use glam::DVec2;

use sandtable_geom::geodesic::Geodesic;

/// Vertices of a full circle: a side of a circle of 100 km is 4.9 km, and misses it by 30 m.
const SIDES: f64 = 128.0;
/// Farther lies no place of an overlay: a quarter of a meridian, meters.
pub(crate) const FARTHEST_M: f64 = 1e7;

/// The place in a direction from another, degrees clockwise from north, meters; longitudes go on beyond ±180°, as the shape does.
pub(crate) fn offset(center: DVec2, bearing_deg: f64, distance_m: f64) -> DVec2 {
    let mut at = Geodesic::toward(center, bearing_deg, distance_m).at(distance_m);
    at.x += ((center.x - at.x) / 360.0).round() * 360.0;
    at
}

/// A circle's outline.
pub(crate) fn circle(center: DVec2, radius_m: f64) -> Vec<DVec2> {
    arc(center, radius_m, [0.0, 360.0])
}

/// The places at a distance from the first direction clockwise to the second, degrees.
pub(crate) fn arc(center: DVec2, radius_m: f64, [start_deg, end_deg]: [f64; 2]) -> Vec<DVec2> {
    let span = clockwise(start_deg, end_deg);
    let sides = (SIDES * span / 360.0).ceil().clamp(1.0, SIDES);
    let at = |side: f64| offset(center, start_deg + span * side / sides, radius_m);
    let ends_where_it_starts = span >= 360.0;
    (0..=sides as u32 - u32::from(ends_where_it_starts)).map(|side| at(f64::from(side))).collect()
}

/// The outline between two arcs; of a full turn, and without an inner radius, the outer circle or sector.
pub(crate) fn arc_band(center: DVec2, [inner_m, outer_m]: [f64; 2], angles_deg: [f64; 2]) -> Vec<Vec<DVec2>> {
    let is_full = clockwise(angles_deg[0], angles_deg[1]) >= 360.0;
    let outer = arc(center, outer_m, angles_deg);
    match (is_full, inner_m > 0.0) {
        (true, true) => vec![outer, arc(center, inner_m, angles_deg)],
        (true, false) => vec![outer],
        (false, true) => {
            vec![outer.into_iter().chain(arc(center, inner_m, angles_deg).into_iter().rev()).collect()]
        }
        (false, false) => vec![outer.into_iter().chain([center]).collect()],
    }
}

/// An ellipse's outline: `axes_m` are its half axes, the first in the direction `rotation_deg`, clockwise from north.
pub(crate) fn ellipse(center: DVec2, axes_m: [f64; 2], rotation_deg: f64) -> Vec<DVec2> {
    let at = |side: u32| {
        let angle = f64::from(side) / SIDES * std::f64::consts::TAU;
        let [along, across] = [axes_m[0] * libm::cos(angle), axes_m[1] * libm::sin(angle)];
        let bearing = libm::atan2(across, along).to_degrees();
        offset(center, rotation_deg + bearing, libm::hypot(along, across))
    };
    (0..SIDES as u32).map(at).collect()
}

/// The outline of a strip of a width along a line; `None` for a line without length.
pub(crate) fn corridor(line: &[DVec2], width_m: f64) -> Option<Vec<DVec2>> {
    let plane = LocalPlane::at(*line.first()?);
    let points = plane.points(line);
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (at, normal) in points.iter().zip(normals(&points)?) {
        left.push(*at + normal * width_m * 0.5);
        right.push(*at - normal * width_m * 0.5);
    }
    left.extend(right.into_iter().rev());
    Some(left.into_iter().map(|at| plane.place(at)).collect())
}

/// The outline of an arrow along a line, its head as wide as is stated and as long, its shaft half as wide; `None` for a line
/// without length.
pub(crate) fn arrow(line: &[DVec2], width_m: f64) -> Option<Vec<DVec2>> {
    let plane = LocalPlane::at(*line.first()?);
    let mut points = plane.points(line);
    let tip = points.pop()?;
    let before = *points.last()?;
    let along = (tip - before).try_normalize()?;
    let neck = tip - along * width_m.min((tip - before).length() * 0.8);
    points.push(neck);
    let normals = normals(&points)?;
    let side =
        |share: f64| points.iter().zip(&normals).map(move |(at, normal)| *at + *normal * width_m * share);
    let wing = along.perp() * width_m * 0.5;
    let outline = side(0.25).chain([neck + wing, tip, neck - wing]);
    let right: Vec<DVec2> = side(-0.25).collect();
    Some(outline.chain(right.into_iter().rev()).map(|at| plane.place(at)).collect())
}

/// The normal to the left of each point of a line, longer where it bends, up to twice; `None` where two points are one.
fn normals(points: &[DVec2]) -> Option<Vec<DVec2>> {
    let legs: Vec<DVec2> =
        points.windows(2).map(|pair| (pair[1] - pair[0]).try_normalize()).collect::<Option<_>>()?;
    let (first, last) = (*legs.first()?, *legs.last()?);
    let bends = legs.windows(2).map(|pair| {
        let middle = (pair[0].perp() + pair[1].perp()).try_normalize().unwrap_or(pair[0].perp());
        middle / middle.dot(pair[0].perp()).max(0.5)
    });
    Some([first.perp()].into_iter().chain(bends).chain([last.perp()]).collect())
}

/// A plane in meters round a place.
struct LocalPlane {
    origin: DVec2,
    /// Meters of a degree east and north.
    degree_m: DVec2,
}

impl LocalPlane {
    fn at(origin: DVec2) -> Self {
        /// A sphere as large as WGS 84 is on average: widths of strips are right to a third of a per cent.
        const RADIUS_M: f64 = 6_371_008.8;
        let north = RADIUS_M.to_radians();
        Self { origin, degree_m: DVec2::new(north * libm::cos(origin.y.to_radians()).max(1e-6), north) }
    }

    fn points(&self, places: &[DVec2]) -> Vec<DVec2> {
        let mut points: Vec<DVec2> = places.iter().map(|at| (*at - self.origin) * self.degree_m).collect();
        points.dedup();
        points
    }

    fn place(&self, at: DVec2) -> DVec2 {
        self.origin + at / self.degree_m
    }
}

/// The degrees from a direction clockwise to another, above 0 and up to 360.
fn clockwise(start_deg: f64, end_deg: f64) -> f64 {
    let span = (end_deg - start_deg).rem_euclid(360.0);
    if span == 0.0 { 360.0 } else { span }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance_m(from: DVec2, to: DVec2) -> f64 {
        Geodesic::between(from, to).length_m()
    }

    #[test]
    fn a_circle_has_its_radius_everywhere_also_across_the_date_line() {
        for center in [DVec2::new(15.0, 48.0), DVec2::new(179.9, -17.0), DVec2::new(-60.0, 80.0)] {
            let ring = circle(center, 50_000.0);
            assert_eq!(ring.len(), 128);
            assert!(ring.iter().all(|at| (distance_m(center, *at) - 50_000.0).abs() < 1e-3));
            let steps = ring.windows(2).map(|pair| (pair[1].x - pair[0].x).abs());
            assert!(steps.fold(0.0, f64::max) < 10.0, "{center}");
        }
    }

    #[test]
    fn arcs_run_clockwise_through_north() {
        let center = DVec2::new(10.0, 60.0);
        let places = arc(center, 1000.0, [350.0, 10.0]);
        assert!(places.len() > 5 && places.iter().all(|at| at.y > center.y));
        assert!(places[0].x < center.x && places[places.len() - 1].x > center.x);
        let band = arc_band(center, [500.0, 1000.0], [0.0, 90.0]);
        assert_eq!(band.len(), 1);
        assert!(band[0].iter().all(|at| (499.9..1000.1).contains(&distance_m(center, *at))));
        assert_eq!(arc_band(center, [500.0, 1000.0], [0.0, 360.0]).len(), 2);
        assert_eq!(arc_band(center, [0.0, 1000.0], [0.0, 90.0])[0].last(), Some(&center));
    }

    #[test]
    fn corridors_and_arrows_are_as_wide_as_stated() {
        let line = [DVec2::new(15.0, 60.0), DVec2::new(15.2, 60.0), DVec2::new(15.2, 60.1)];
        let strip = corridor(&line, 1000.0).expect("a line");
        assert_eq!(strip.len(), 6);
        assert!((distance_m(strip[0], strip[5]) - 1000.0).abs() < 5.0);
        let arrow = arrow(&line, 1000.0).expect("a line");
        assert_eq!(arrow.len(), 9);
        assert!(arrow.iter().any(|at| distance_m(*at, line[2]) < 0.01), "the tip is the last point");
        assert!(corridor(&line[..1], 10.0).is_none() && corridor(&[line[0], line[0]], 10.0).is_none());
    }

    #[test]
    fn an_ellipse_is_as_long_as_its_axes() {
        let center = DVec2::new(10.0, 60.0);
        let ring = ellipse(center, [2000.0, 500.0], 30.0);
        let far = ring.iter().map(|at| distance_m(center, *at)).fold(0.0, f64::max);
        let near = ring.iter().map(|at| distance_m(center, *at)).fold(f64::INFINITY, f64::min);
        assert!((far - 2000.0).abs() < 1e-3 && (near - 500.0).abs() < 1e-3, "{far} {near}");
        let along = offset(center, 30.0, 2000.0);
        assert!(ring.iter().any(|at| distance_m(*at, along) < 1e-3));
    }
}
