//! The plane of a triangle of posts, in posts and meters.
//!
//! It is measured from the triangle's first corner, so that its rounding does not depend on where the lattice begins, and a
//! part of a terrain has the errors of the whole.

use crate::terrain::lattice::{Lattice, Post};

/// A plane over the posts of a lattice.
#[derive(Clone, Copy, Debug)]
pub struct PostPlane {
    column: f64,
    row: f64,
    height: f64,
    /// Meters up per column eastward.
    pub per_column: f64,
    per_row: f64,
}

impl PostPlane {
    /// The plane through three posts; `None` where they lie on a line. Posts without data make every height NaN.
    pub fn new(lattice: &Lattice, [a, b, c]: [Post; 3]) -> Option<Self> {
        let point =
            |post: Post| (f64::from(post.column), f64::from(post.row), f64::from(lattice.height(post)));
        let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (point(a), point(b), point(c));
        let doubled_area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        if doubled_area == 0.0 {
            return None;
        }
        let per_column = ((bz - az) * (cy - ay) - (cz - az) * (by - ay)) / doubled_area;
        let per_row = ((cz - az) * (bx - ax) - (bz - az) * (cx - ax)) / doubled_area;
        Some(Self { column: ax, row: ay, height: az, per_column, per_row })
    }

    /// Whether all three posts have data.
    pub fn has_data(&self) -> bool {
        (self.height + self.per_column + self.per_row).is_finite()
    }

    /// The plane along one row.
    #[inline]
    pub fn along(&self, row: u32) -> RowLine {
        let start = self.height + self.per_row * (f64::from(row) - self.row);
        RowLine { column: self.column, start, per_column: self.per_column }
    }

    /// Its height at a post, meters.
    #[inline]
    pub fn height(&self, post: Post) -> f64 {
        self.along(post.row).height(post.column)
    }
}

/// A plane along one row of posts.
#[derive(Clone, Copy, Debug)]
pub struct RowLine {
    column: f64,
    start: f64,
    per_column: f64,
}

impl RowLine {
    /// Its height at a column, meters.
    #[inline]
    pub fn height(&self, column: u32) -> f64 {
        self.start + self.per_column * (f64::from(column) - self.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn a_plane_has_its_posts_heights_and_none_on_a_line_or_over_no_data() {
        let mut heights: Vec<f32> = (0..16).map(|at| (at % 4 * 3 + at / 4 * 7) as f32).collect();
        heights[15] = f32::NAN;
        let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 4, heights).expect("sound");
        let post = |column, row| Post { column, row };
        let plane = PostPlane::new(&lattice, [post(0, 1), post(2, 0), post(3, 2)]).expect("no line");
        assert!(plane.has_data());
        for post in [post(0, 1), post(2, 0), post(3, 2), post(1, 1), post(2, 1), post(0, 3)] {
            assert!((plane.height(post) - f64::from(lattice.height(post))).abs() < 1e-12, "{post:?}");
        }
        assert!(PostPlane::new(&lattice, [post(0, 0), post(1, 1), post(2, 2)]).is_none());
        let torn = PostPlane::new(&lattice, [post(0, 0), post(1, 0), post(3, 3)]).expect("no line");
        assert!(!torn.has_data());
    }
}
