//! Circles, ellipses, their arcs and rectangles on the ground: positions whose distances from a center are meters on the
//! WGS 84 ellipsoid.
//!
//! Directions are degrees clockwise from north; a rotation turns a shape counterclockwise, as in NATO Vector Graphics.
//! Rings are not closed. Longitudes run on beyond ±180° where a shape crosses that meridian.

use glam::DVec2;

use crate::geodesic::Geodesic;

/// Vertices of a full turn: chords leave the arc by 0.03 % of the radius.
const TURN_VERTICES: f64 = 128.0;
/// The largest distance from a center, a quarter of the way to the other side of the Earth.
pub const MOST_REACH_M: f64 = 5e6;
/// Degrees of latitude beyond which nothing may reach: around a pole a ring is no ring of longitudes and latitudes.
const MOST_LATITUDE: f64 = 89.9;
/// No degree of latitude is shorter, in meters.
const LEAST_DEGREE_M: f64 = 110_500.0;

/// Why a shape cannot be laid on the ground.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GroundShapeError {
    /// A radius or width is zero, negative, no number or larger than 5000 km.
    #[error("a distance of {0} m is not between 0 and {MOST_REACH_M} m")]
    Distance(f64),
    /// An angle is no finite number.
    #[error("an angle of {0}° is no number")]
    Angle(f64),
    /// The center or a vertex is no place on Earth.
    #[error("longitude {0} and latitude {1} are no place on Earth")]
    Place(f64, f64),
    /// The shape holds a pole or nearly does.
    #[error("it reaches over a pole")]
    Pole,
    /// A line has too few vertices.
    #[error("it has less than two different vertices")]
    Short,
}

/// An ellipse on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundEllipse {
    /// Longitude and latitude, degrees.
    pub center: DVec2,
    /// Half of its axis to the east, and of that to the north, before it is rotated; meters.
    pub radii_m: DVec2,
    /// Counterclockwise, degrees.
    pub rotation_deg: f64,
}

/// The directions between two, clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionRange {
    start_deg: f64,
    /// More than 0, at most 360.
    sweep_deg: f64,
}

impl DirectionRange {
    /// The directions clockwise from `start_deg` to `end_deg`; all of them where the two are the same.
    ///
    /// # Errors
    /// An angle is no finite number.
    pub fn between(start_deg: f64, end_deg: f64) -> Result<Self, GroundShapeError> {
        let wrong = [start_deg, end_deg].into_iter().find(|angle| !is_angle(*angle));
        if let Some(angle) = wrong {
            return Err(GroundShapeError::Angle(angle));
        }
        let sweep_deg = (end_deg - start_deg).rem_euclid(360.0);
        Ok(Self { start_deg, sweep_deg: if sweep_deg == 0.0 { 360.0 } else { sweep_deg } })
    }

    /// Whether it holds every direction.
    pub fn is_full(&self) -> bool {
        self.sweep_deg == 360.0
    }

    /// The directions at which an arc has vertices, both ends among them.
    fn steps(self) -> impl DoubleEndedIterator<Item = f64> {
        // At most TURN_VERTICES.
        let count = (self.sweep_deg / 360.0 * TURN_VERTICES).ceil().max(1.0) as u32;
        (0..=count).map(move |step| self.start_deg + self.sweep_deg * f64::from(step) / f64::from(count))
    }
}

impl GroundEllipse {
    /// The circle of a radius in meters.
    pub fn circle(center: DVec2, radius_m: f64) -> Self {
        Self { center, radii_m: DVec2::splat(radius_m), rotation_deg: 0.0 }
    }

    /// Its ring, clockwise.
    ///
    /// # Errors
    /// [`GroundShapeError`]
    pub fn ring(&self) -> Result<Vec<DVec2>, GroundShapeError> {
        let mut ring = self.arc(DirectionRange { start_deg: 0.0, sweep_deg: 360.0 })?;
        ring.pop();
        Ok(ring)
    }

    /// Its part in `range`, whose directions are those before the rotation; clockwise, a line.
    ///
    /// # Errors
    /// [`GroundShapeError`]
    pub fn arc(&self, range: DirectionRange) -> Result<Vec<DVec2>, GroundShapeError> {
        self.check()?;
        let vertex = |direction: f64| {
            let (sin, cos) = libm::sincos(direction.to_radians());
            let (east, north) = (self.radii_m.x, self.radii_m.y);
            let radius_m = east * north / libm::hypot(east * cos, north * sin);
            reached(self.center, direction - self.rotation_deg, radius_m)
        };
        Ok(range.steps().map(vertex).collect())
    }

    fn check(&self) -> Result<(), GroundShapeError> {
        check_reach(self.center, self.radii_m.max_element())?;
        check_reach(self.center, self.radii_m.min_element())?;
        if is_angle(self.rotation_deg) { Ok(()) } else { Err(GroundShapeError::Angle(self.rotation_deg)) }
    }

    /// The corners of the rectangle around the ellipse whose sides are its axes' directions, clockwise from north-east before
    /// the rotation.
    ///
    /// # Errors
    /// [`GroundShapeError`]
    pub fn rectangle(&self) -> Result<Vec<DVec2>, GroundShapeError> {
        self.check()?;
        let half = self.radii_m;
        check_reach(self.center, half.length())?;
        let corner = |(east, north): (f64, f64)| {
            let direction = libm::atan2(east, north).to_degrees();
            reached(self.center, direction - self.rotation_deg, half.length())
        };
        Ok([(half.x, half.y), (half.x, -half.y), (-half.x, -half.y), (-half.x, half.y)].map(corner).to_vec())
    }
}

/// The rings of the area between two circles within `range`: of a full turn the outer circle and the inner one as a hole,
/// else one ring. `radii_m` are the inner radius, which may be 0, and the outer one.
///
/// # Errors
/// [`GroundShapeError`]
pub fn arc_band(
    center: DVec2,
    radii_m: [f64; 2],
    range: DirectionRange,
) -> Result<Vec<Vec<DVec2>>, GroundShapeError> {
    let [inner_m, outer_m] = radii_m;
    if !(0.0..outer_m).contains(&inner_m) {
        return Err(GroundShapeError::Distance(inner_m));
    }
    let outer = GroundEllipse::circle(center, outer_m);
    let inner = GroundEllipse::circle(center, inner_m);
    match (range.is_full(), inner_m > 0.0) {
        (true, true) => Ok(vec![outer.ring()?, inner.ring()?]),
        (true, false) => Ok(vec![outer.ring()?]),
        (false, true) => {
            let mut ring = outer.arc(range)?;
            ring.extend(inner.arc(range)?.into_iter().rev());
            Ok(vec![ring])
        }
        (false, false) => {
            let mut ring = outer.arc(range)?;
            ring.push(center);
            Ok(vec![ring])
        }
    }
}

/// Whether an angle in degrees is one: a number of some turns at most.
fn is_angle(degrees: f64) -> bool {
    degrees.abs() < 1e6
}

/// The position `distance_m` meters from `start`, its longitude within 180° of that of `start`.
pub(crate) fn reached(start: DVec2, direction_deg: f64, distance_m: f64) -> DVec2 {
    let end = Geodesic::toward(start, direction_deg, distance_m).end();
    DVec2::new(beside(end.x, start.x), end.y)
}

/// The longitude that is `longitude` and within 180° of `other`.
pub(crate) fn beside(longitude: f64, other: f64) -> f64 {
    // Both are checked to be within ±540°.
    longitude - 360.0 * ((longitude - other) / 360.0).round()
}

/// Checks that a distance from a place reaches no pole.
pub(crate) fn check_reach(place: DVec2, distance_m: f64) -> Result<(), GroundShapeError> {
    if !(place.x.abs() <= 360.0 && place.y.abs() <= 90.0) {
        return Err(GroundShapeError::Place(place.x, place.y));
    }
    if !(distance_m > 0.0 && distance_m <= MOST_REACH_M) {
        return Err(GroundShapeError::Distance(distance_m));
    }
    if place.y.abs() + distance_m / LEAST_DEGREE_M > MOST_LATITUDE {
        Err(GroundShapeError::Pole)
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(center: DVec2, at: DVec2) -> Geodesic {
        Geodesic::between(center, at)
    }

    const CENTER: DVec2 = DVec2::new(17.0, 60.0);

    #[test]
    fn every_vertex_of_a_circle_has_its_radius() {
        for center in [CENTER, DVec2::new(0.0, 0.0), DVec2::new(-84.2, 36.3), DVec2::new(179.99, -51.0)] {
            for radius_m in [1.0, 5000.0, 1e6] {
                let ring = GroundEllipse::circle(center, radius_m).ring().expect("it fits");
                assert_eq!(ring.len(), 128);
                for &at in &ring {
                    let length_m = from(center, at).length_m();
                    assert!((length_m - radius_m).abs() < 1e-6 * radius_m.max(1.0), "{length_m}");
                    assert!((at.x - center.x).abs() < 90.0, "beside the center: {at}");
                }
            }
        }
    }

    #[test]
    fn an_ellipse_lies_along_its_axes_and_rotates_counterclockwise() {
        let flat = GroundEllipse { center: CENTER, radii_m: DVec2::new(4000.0, 1000.0), rotation_deg: 0.0 };
        let ring = flat.ring().expect("it fits");
        assert!((from(CENTER, ring[0]).length_m() - 1000.0).abs() < 1e-3, "to the north");
        assert!((from(CENTER, ring[32]).length_m() - 4000.0).abs() < 1e-3, "to the east");
        let turned = GroundEllipse { rotation_deg: 30.0, ..flat }.ring().expect("it fits");
        let axis = from(CENTER, turned[32]);
        assert!(
            (axis.length_m() - 4000.0).abs() < 1e-3 && (axis.bearing_deg() - 60.0).abs() < 1e-6,
            "{axis:?}"
        );
    }

    #[test]
    fn arcs_run_clockwise_over_north() {
        let range = DirectionRange::between(315.0, 5.0).expect("numbers");
        let arc = GroundEllipse::circle(CENTER, 2e4).arc(range).expect("it fits");
        let bearings: Vec<f64> =
            arc.iter().map(|&at| from(CENTER, at).bearing_deg().rem_euclid(360.0)).collect();
        assert!((bearings[0] - 315.0).abs() < 1e-6 && (bearings[bearings.len() - 1] - 5.0).abs() < 1e-6);
        assert_eq!(arc.len(), 1 + 18, "50 of 360 degrees");
        let full = DirectionRange::between(0.0, 360.0).expect("numbers");
        assert!(full.is_full());
    }

    #[test]
    fn an_arc_band_is_a_ring_of_two_arcs_or_two_circles() {
        let part = DirectionRange::between(315.0, 5.0).expect("numbers");
        let full = DirectionRange::between(0.0, 360.0).expect("numbers");
        let band = |radii_m, range| {
            arc_band(CENTER, radii_m, range).map(|rings| rings.iter().map(Vec::len).collect())
        };
        assert_eq!(band([2e4, 3e4], part), Ok(vec![38]));
        assert_eq!(band([0.0, 3e4], part), Ok(vec![20]));
        assert_eq!(band([2e4, 3e4], full), Ok(vec![128, 128]));
        assert_eq!(band([0.0, 3e4], full), Ok(vec![128]));
        assert_eq!(band([3e4, 2e4], part), Err(GroundShapeError::Distance(3e4)));
    }

    #[test]
    fn a_rectangle_has_the_diagonal_of_its_sides() {
        let sides = GroundEllipse { center: CENTER, radii_m: DVec2::new(3000.0, 4000.0), rotation_deg: 90.0 };
        let corners = sides.rectangle().expect("it fits");
        assert_eq!(corners.len(), 4);
        assert!(corners.iter().all(|&at| (from(CENTER, at).length_m() - 5000.0).abs() < 1e-6));
        // Turned by a quarter counterclockwise, the long sides run east and west.
        let (west, east) = (corners[0], corners[1]);
        assert!(
            west.x < CENTER.x && east.x > CENTER.x && west.y > CENTER.y && east.y > CENTER.y,
            "{corners:?}"
        );
    }

    #[test]
    fn what_no_ground_holds_is_refused() {
        let ring =
            |center: DVec2, radius_m: f64| GroundEllipse::circle(center, radius_m).ring().expect_err("none");
        for radius_m in [0.0, -1.0, 1e300, f64::INFINITY] {
            assert_eq!(ring(CENTER, radius_m), GroundShapeError::Distance(radius_m));
        }
        assert!(matches!(ring(CENTER, f64::NAN), GroundShapeError::Distance(_)));
        assert_eq!(ring(DVec2::new(0.0, 89.0), 2e5), GroundShapeError::Pole);
        assert!(matches!(ring(DVec2::new(0.0, 91.0), 1.0), GroundShapeError::Place(..)));
        assert!(matches!(ring(DVec2::NAN, 1.0), GroundShapeError::Place(..)));
        assert!(DirectionRange::between(f64::NAN, 0.0).is_err());
        let turned = GroundEllipse { rotation_deg: f64::INFINITY, ..GroundEllipse::circle(CENTER, 1.0) };
        assert!(matches!(turned.ring(), Err(GroundShapeError::Angle(_))));
    }
}
