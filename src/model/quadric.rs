//! Quadrics: the squared distances of a point from many planes at once (Garland and Heckbert, "Surface
//! Simplification Using Quadric Error Metrics", 1997).
//!
//! Planes are weighted with the area that lies in them, so that the way a face is cut into triangles does not
//! show, and the sum is divided by all weights: what comes out is a mean squared distance in the model's units.

use glam::DVec3;

/// The planes of a surface around a point, as a quadratic function of position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Quadric {
    /// Upper triangle of Σ weight · n nᵀ: xx, xy, xz, yy, yz, zz.
    squares: [f64; 6],
    /// Σ weight · d · n.
    linear: DVec3,
    /// Σ weight · d².
    constant: f64,
    weight: f64,
}

impl Quadric {
    /// The plane through `point` with unit `normal`.
    pub(super) fn plane(normal: DVec3, point: DVec3, weight: f64) -> Self {
        let distance = -normal.dot(point);
        let DVec3 { x, y, z } = normal;
        Self {
            squares: [x * x, x * y, x * z, y * y, y * z, z * z].map(|product| product * weight),
            linear: normal * (distance * weight),
            constant: distance * distance * weight,
            weight,
        }
    }

    /// Both surfaces' planes together.
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            squares: std::array::from_fn(|index| self.squares[index] + other.squares[index]),
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
            weight: self.weight + other.weight,
        }
    }

    /// The mean squared distance of `point` from the planes, at least 0; 0 where there are none.
    pub(super) fn squared_distance(&self, point: DVec3) -> f64 {
        if self.weight <= 0.0 {
            return 0.0;
        }
        let [xx, xy, xz, yy, yz, zz] = self.squares;
        let DVec3 { x, y, z } = point;
        let product =
            DVec3::new(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z);
        ((product.dot(point) + 2.0 * self.linear.dot(point) + self.constant) / self.weight).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_from_one_plane_is_squared_and_from_two_averaged_by_weight() {
        let floor = Quadric::plane(DVec3::Z, DVec3::new(7.0, 3.0, 2.0), 5.0);
        assert!((floor.squared_distance(DVec3::new(-4.0, 9.0, 5.0)) - 9.0).abs() < 1e-12);
        let wall = Quadric::plane(DVec3::X, DVec3::ZERO, 15.0);
        let both = floor.plus(&wall).squared_distance(DVec3::new(1.0, 0.0, 5.0));
        assert!((both - (9.0 * 5.0 + 1.0 * 15.0) / 20.0).abs() < 1e-12);
    }

    #[test]
    fn without_planes_every_point_is_good() {
        assert_eq!(Quadric::default().squared_distance(DVec3::ONE), 0.0);
    }
}
