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
