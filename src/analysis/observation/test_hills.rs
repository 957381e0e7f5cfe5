//! Lands for the tests of the family: squares of posts 10 m apart.

use glam::DVec2;

use crate::land::Land;
use crate::test_land::bare;

/// The south-west post.
pub(crate) const ORIGIN: DVec2 = DVec2::new(500_000.0, 4_000_000.0);

/// A land of `side` × `side` posts with these heights by column and row.
pub(crate) fn land(side: u32, height: impl Fn(u32, u32) -> f32) -> Land {
    let heights = (0..side * side).map(|index| height(index % side, index / side)).collect();
    bare((ORIGIN, DVec2::splat(10.0)), side, heights)
}

/// Hills of some 12 m with a hole around column 10, row 17.
pub(crate) fn ripples(column: u32, row: u32) -> f32 {
    let (x, y) = (f64::from(column), f64::from(row));
    if column.abs_diff(10) < 2 && row.abs_diff(17) < 2 {
        return f32::NAN;
    }
    (6.0 * libm::sin(x * 0.9) * libm::cos(y * 0.7) + 6.0 * libm::sin(x * 0.31 + y * 0.43)) as f32
}

/// Map coordinates of a column and row, whole or not.
pub(crate) fn at(column: f64, row: f64) -> DVec2 {
    ORIGIN + DVec2::new(column, row) * 10.0
}
