//! The plane of a triangle of posts, in posts and meters.
//!
//! It is measured from the triangle's first corner, so that its rounding does not depend on where the lattice begins, and a
//! part of a terrain has the errors of the whole.

use sandtable_terrain::lattice::{Lattice, Post};

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

    /// Its height by column along one row, meters.
    #[inline]
    pub fn along(&self, row: u32) -> impl Fn(u32) -> f64 {
        let start = self.height + self.per_row * (f64::from(row) - self.row);
        move |column| start + self.per_column * (f64::from(column) - self.column)
    }

    /// Its height at a post, meters.
    #[inline]
    pub fn height(&self, post: Post) -> f64 {
        self.along(post.row)(post.column)
    }
}
