//! Quadrics: the squared distances of a point from many planes at once (Garland and Heckbert, "Surface Simplification
//! Using Quadric Error Metrics", 1997).
//!
//! Squared distances are summed without weights, so that the sum is never below the greatest: weights by area would
//! remove long thin strips.

use glam::DVec3;

/// The sum of squared distances from a set of planes, as a quadratic function of position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Quadric {
    /// Upper triangle of Σ n nᵀ: xx, xy, xz, yy, yz, zz.
    squares: [f64; 6],
    /// Σ d · n.
    linear: DVec3,
    /// Σ d².
    constant: f64,
}

impl Quadric {
    /// The plane through `point` with unit `normal`.
    pub(super) fn plane(normal: DVec3, point: DVec3) -> Self {
        let distance = -normal.dot(point);
        let DVec3 { x, y, z } = normal;
        Self {
            squares: [x * x, x * y, x * z, y * y, y * z, z * z],
            linear: normal * distance,
            constant: distance * distance,
        }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            squares: std::array::from_fn(|index| self.squares[index] + other.squares[index]),
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
        }
    }

    /// The sum of the squared distances of `point` from the planes, at least 0; 0 where there are none.
    pub(super) fn squared_distances(&self, point: DVec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.squares;
        let DVec3 { x, y, z } = point;
        let product =
            DVec3::new(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z);
        (product.dot(point) + 2.0 * self.linear.dot(point) + self.constant).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_all_planes_are_squared_and_summed() {
        let floor = Quadric::plane(DVec3::Z, DVec3::new(7.0, 3.0, 2.0));
        assert!((floor.squared_distances(DVec3::new(-4.0, 9.0, 5.0)) - 9.0).abs() < 1e-12);
        let wall = Quadric::plane(DVec3::X, DVec3::ZERO);
        let both = floor.plus(&wall).squared_distances(DVec3::new(2.0, 0.0, 5.0));
        assert!((both - 13.0).abs() < 1e-12);
    }

    #[test]
    fn without_planes_the_distance_is_zero() {
        assert_eq!(Quadric::default().squared_distances(DVec3::ONE), 0.0);
    }
}
