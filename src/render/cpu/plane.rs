//! Functions linear over the picture.

use glam::DVec3;

/// `x·right + y·down + start` at pixel position `(x, y)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScreenPlane {
    pub right: f64,
    pub down: f64,
    pub start: f64,
}

impl ScreenPlane {
    /// The plane whose coefficients are the components of `vector`; `None` where one is not finite.
    fn from_vector(vector: DVec3) -> Option<Self> {
        vector.is_finite().then_some(Self { right: vector.x, down: vector.y, start: vector.z })
    }

    pub fn at(&self, position: [f32; 2]) -> f64 {
        self.right * f64::from(position[0]) + self.down * f64::from(position[1]) + self.start
    }
}

#[derive(Clone, Copy, Debug)]
pub struct TrianglePlanes {
    /// The nearness; see `screen`.
    pub nearness: ScreenPlane,
    /// The barycentric weight of the second corner; in perspective divided by `w`.
    pub second: ScreenPlane,
    /// The barycentric weight of the third corner; in perspective divided by `w`.
    pub third: ScreenPlane,
    /// Whether the corners run counter-clockwise as seen.
    pub faces_eye: bool,
    /// Whether rays are parallel.
    is_parallel: bool,
}

impl TrianglePlanes {
    /// The planes of a triangle in perspective with corners `(x·w, y·w, w)`; `None` where it is seen edge-on or a corner is not
    /// finite. A point of the triangle on the picture, `p = (x, y, 1)`, is `w · p = Σ λᵢ cornerᵢ`, so that `λᵢ / w = Bᵢ
    /// · p` with the rows `Bᵢ` of the inverse of the corners' matrix. Differences of corners are taken first, since a
    /// distant triangle is small beside its distance.
    pub fn from_corners([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let volume = a.dot(normal);
        Some(Self {
            // A volume of 0 divides to infinity or NaN.
            nearness: ScreenPlane::from_vector(normal / volume)?,
            second: ScreenPlane::from_vector(ac.cross(a) / volume)?,
            third: ScreenPlane::from_vector(a.cross(ab) / volume)?,
            faces_eye: volume < 0.0,
            is_parallel: false,
        })
    }

    /// The planes of a triangle seen by parallel rays, with corners `(x, y, 1)` of the given nearness; `None` as above.
    pub fn from_parallel(corners: [DVec3; 3], nearness: [f64; 3]) -> Option<Self> {
        let planes = Self::from_corners(corners)?;
        let [first, second, third] = nearness;
        let (second, third) = (second - first, third - first);
        let along =
            |part: fn(&ScreenPlane) -> f64| second * part(&planes.second) + third * part(&planes.third);
        let nearness = ScreenPlane {
            right: along(|plane| plane.right),
            down: along(|plane| plane.down),
            start: first + along(|plane| plane.start),
        };
        Some(Self { nearness, is_parallel: true, ..planes })
    }

    /// The divisor of the planes of weights at a pixel position, with its change from pixel to pixel: the nearness in
    /// perspective, else 1.
    pub fn divisor(&self) -> ScreenPlane {
        if self.is_parallel { ScreenPlane { right: 0.0, down: 0.0, start: 1.0 } } else { self.nearness }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 3] =
        [DVec3::new(100.0, 50.0, 10.0), DVec3::new(900.0, 4000.0, 20.0), DVec3::new(9000.0, 600.0, 30.0)];

    #[test]
    fn each_corner_has_its_own_depth_and_share() {
        let planes = TrianglePlanes::from_corners(CORNERS).expect("a sound triangle");
        for (index, corner) in CORNERS.into_iter().enumerate() {
            let at = [(corner.x / corner.z) as f32, (corner.y / corner.z) as f32];
            let depth = 1.0 / planes.nearness.at(at);
            assert!((depth - corner.z).abs() < 1e-4);
            assert!((planes.second.at(at) * depth - f64::from(index == 1)).abs() < 1e-5);
            assert!((planes.third.at(at) * depth - f64::from(index == 2)).abs() < 1e-5);
        }
    }

    #[test]
    fn shares_are_perspective_correct_halfway_along_an_edge() {
        let planes = TrianglePlanes::from_corners(CORNERS).expect("a sound triangle");
        let middle = (CORNERS[1] + CORNERS[2]) / 2.0;
        let at = [(middle.x / middle.z) as f32, (middle.y / middle.z) as f32];
        let depth = 1.0 / planes.nearness.at(at);
        assert!((depth - 25.0).abs() < 1e-4);
        assert!((planes.second.at(at) * depth - 0.5).abs() < 1e-5);
    }

    #[test]
    fn triangles_without_area_or_with_infinite_corners_have_no_planes() {
        let [a, b, _] = CORNERS;
        assert!(TrianglePlanes::from_corners([a, b, b]).is_none());
        assert!(TrianglePlanes::from_corners([a, b, DVec3::splat(f64::INFINITY)]).is_none());
        assert!(TrianglePlanes::from_corners([a, b, DVec3::NAN]).is_none());
    }

    #[test]
    fn with_parallel_rays_weights_and_nearness_are_even_over_the_picture() {
        let corners = [(10.0, 5.0), (90.0, 20.0), (30.0, 80.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
        let planes = TrianglePlanes::from_parallel(corners, [1.2, 1.6, 1.9]).expect("a sound triangle");
        for (corner, expected) in corners.iter().zip([[1.2, 0.0, 0.0], [1.6, 1.0, 0.0], [1.9, 0.0, 1.0]]) {
            let at = [corner.x as f32, corner.y as f32];
            let found = [planes.nearness, planes.second, planes.third].map(|plane| plane.at(at));
            assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-9));
            assert_eq!(planes.divisor().at(at), 1.0);
        }
    }
}
