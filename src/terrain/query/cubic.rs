//! Heights by cubic convolution over sixteen posts (Keys 1981, *Cubic convolution interpolation for digital image
//! processing*, IEEE Transactions on Acoustics, Speech and Signal Processing 29), with a = −1/2: along each axis the spline
//! of Catmull and Rom.
//!
//! ```text
//!  ·   ·   ·   ·      at part t of the way from post 0 to post 1, 0..=1, the weights of the posts −1, 0, 1, 2 are
//!  ·   0 ─ 1   ·        (−t + 2t² − t³)/2,  (2 − 5t² + 3t³)/2,  (t + 4t² − 3t³)/2,  (−t² + t³)/2
//!  ·   │ x │   ·
//!  ·   · ─ ·   ·      along both axes: sixteen products
//!  ·   ·   ·   ·
//! ```
//!
//! It is exact on planes and on quadratic surfaces, and its slopes are continuous. A post beyond the border continues the
//! parabola through the three posts beside it (Keys' boundary condition), or their straight line where there are two, so that
//! this holds at the border too.
//!
//! Eight of the products may be negative, so that it overshoots: a height may lie above the highest or below the lowest of the
//! sixteen posts by up to 9/32 of what these differ, and is then lower or higher than any post around.

use glam::{DVec2, UVec2};

/// The height at `grid`, a position in posts within `0..=size − 1`; NaN where a post with a weight is.
///
/// On a post it is that post's own height, and level posts give their level, both to the last bit.
pub fn cubic(grid: DVec2, size: UVec2, height: impl Fn(u32, u32) -> f64) -> f64 {
    let (columns, rows) = (CubicAxis::new(grid.x, size.x), CubicAxis::new(grid.y, size.y));
    let near = height(columns.nearest, rows.nearest);
    let mut above_near = 0.0;
    for (row, down) in rows.weights() {
        for (column, across) in columns.weights() {
            above_near += across * down * (height(column, row) - near);
        }
    }
    near + above_near
}

/// The posts along one axis that a height is made of.
struct CubicAxis {
    /// The post that lies nearest.
    nearest: u32,
    /// The first post with a weight.
    first: u32,
    /// The weights of that post and of the next ones.
    weights: [f64; 4],
}

impl CubicAxis {
    /// At a position within `0..=count − 1`.
    fn new(at: f64, count: u32) -> Self {
        let last = count - 1;
        let own = (at as u32).min(last.saturating_sub(1));
        let part = at - f64::from(own);
        let nearest = if part < 0.5 { own } else { own + 1 };
        if last == 0 {
            return Self { nearest: 0, first: 0, weights: [1.0, 0.0, 0.0, 0.0] };
        }
        let [before, here, next, beyond] = kernel(part);
        let first = own.saturating_sub(1).min(last.saturating_sub(3));
        let mut axis = Self { nearest, first, weights: [0.0; 4] };
        axis.add(own, here);
        axis.add(own + 1, next);
        match own.checked_sub(1) {
            Some(post) => axis.add(post, before),
            None => axis.add_continued([0, 1, 2].map(|post| post.min(last)), before),
        }
        match own + 2 {
            post if post <= last => axis.add(post, beyond),
            _ => axis.add_continued([last, last - 1, last.saturating_sub(2)], beyond),
        }
        axis
    }

    fn add(&mut self, post: u32, weight: f64) {
        self.weights[(post - self.first) as usize] += weight;
    }

    /// Adds the weight of the post before the first of `posts`, which continues their parabola; of two posts, the last of
    /// which is repeated, their straight line.
    fn add_continued(&mut self, posts: [u32; 3], weight: f64) {
        let factors = if posts[1] == posts[2] { [2.0, -1.0, 0.0] } else { [3.0, -3.0, 1.0] };
        posts.into_iter().zip(factors).for_each(|(post, factor)| self.add(post, factor * weight));
    }

    /// The posts that have a weight.
    fn weights(&self) -> impl Iterator<Item = (u32, f64)> {
        (self.first..).zip(self.weights).filter(|(_, weight)| *weight != 0.0)
    }
}

/// The weights of four posts in a row at a part of the way from the second to the third.
fn kernel(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t + 2.0 * t2 - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places between, on and beside the posts of a grid.
    fn places(size: UVec2) -> impl Iterator<Item = DVec2> {
        let last = (size - 1).as_dvec2();
        (0..=20)
            .flat_map(move |x| (0..=20).map(move |y| DVec2::new(f64::from(x), f64::from(y)) / 20.0 * last))
    }

    #[test]
    fn a_quadratic_surface_is_kept_up_to_the_border() {
        let surface =
            |x: f64, y: f64| 3.0 + 2.0 * x - y + 0.5 * x * x - 0.75 * y * y + 0.25 * x * y * (x - y);
        for size in [UVec2::new(7, 5), UVec2::new(3, 4), UVec2::splat(9)] {
            let post = |column: u32, row: u32| surface(column.into(), row.into());
            for at in places(size) {
                let found = cubic(at, size, post);
                assert!((found - surface(at.x, at.y)).abs() < 1e-9, "{at} of {size}: {found}");
            }
        }
    }

    #[test]
    fn two_posts_give_their_straight_line_and_one_its_height() {
        for at in places(UVec2::splat(2)) {
            let found = cubic(at, UVec2::splat(2), |column, row| f64::from(10 * column + row));
            assert!((found - (10.0 * at.x + at.y)).abs() < 1e-12, "{at}: {found}");
        }
        assert_eq!(cubic(DVec2::ZERO, UVec2::ONE, |_, _| 7.0), 7.0);
    }

    #[test]
    fn posts_and_level_ground_are_kept_to_the_last_bit() {
        let rough = |column: u32, row: u32| 371.1 + f64::from((column * 7919 + row * 104_729) % 101) / 3.0;
        for (column, row) in (0..6).flat_map(|column| (0..6).map(move |row| (column, row))) {
            let at = DVec2::new(column.into(), row.into());
            assert_eq!(cubic(at, UVec2::splat(6), rough), rough(column, row), "{at}");
        }
        assert!(places(UVec2::splat(6)).all(|at| cubic(at, UVec2::splat(6), |_, _| 371.1) == 371.1));
    }

    #[test]
    fn a_step_overshoots_by_no_more_than_the_bound() {
        // The worst case of 9/32: in the middle, high where the weight is positive.
        let size = UVec2::splat(4);
        let checkered = |column: u32, row: u32| {
            let inner = |post: u32| (1..=2).contains(&post);
            if inner(column) == inner(row) { 1.0 } else { 0.0 }
        };
        let found = cubic(DVec2::splat(1.5), size, checkered);
        assert!((found - (1.0 + 9.0 / 32.0)).abs() < 1e-12, "{found}");
        let most = places(size).map(|at| cubic(at, size, |column, row| f64::from((column + row) % 2)));
        assert!(most.fold(0.0, f64::max) <= 1.0 + 9.0 / 32.0);
    }

    #[test]
    fn a_hole_counts_where_it_has_a_weight_and_nowhere_else() {
        let holed = |column: u32, row: u32| if (column, row) == (0, 0) { f64::NAN } else { 1.0 };
        let at = |x: f64, y: f64| cubic(DVec2::new(x, y), UVec2::splat(6), holed);
        assert!(at(1.5, 1.5).is_nan() && at(0.0, 0.0).is_nan());
        assert_eq!([at(2.5, 1.5), at(1.5, 2.0), at(1.0, 1.0)], [1.0; 3]);
    }
}
