//! The exact error of every vertex: a bound.
//!
//! The error of a triangle is exact: the largest vertical distance between its plane and any post it covers,
//! not only at the middle of its hypotenuse, because a midpoint error is no bound (asked for 5 m, midpoint
//! errors leave 7 to 10 m). The error of a vertex is that of the triangles it splits.
//!
//! Two cases make an error infinite, so that refinement goes down to the posts: a triangle that covers both
//! data and no data, and one that is not exact over a pinned post (see [`Lattice::pin`]).
//!
//! Cost: every triangle of every level scans its posts, 2·log₂(patch) visits a post, at 10 to 20 ns each.

use rayon::prelude::*;

use crate::roam::bintree::Triangle;
use crate::roam::errors::ErrorMap;
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::terrain::lattice::{Lattice, Post};

/// Pinned ground may be off by this many metres: rounding of f32 heights, nothing a picture shows.
const PINNED_SLACK_M: f32 = 1e-3;

impl ErrorMap {
    /// Measures `lattice`; in parallel over patches, the same for any number of threads.
    pub fn exact(lattice: &Lattice, layout: &Layout) -> Self {
        let patches: Vec<Vertex> = layout.patches().collect();
        let measured: Vec<Vec<(u32, f32)>> =
            patches.par_iter().map(|&corner| measure_patch(lattice, layout, corner)).collect();
        let mut errors = vec![0f32; layout.vertex_count()];
        for (index, error) in measured.into_iter().flatten() {
            let slot = &mut errors[index as usize];
            *slot = slot.max(error);
        }
        Self::raised(errors, layout)
    }
}

/// The split vertices of one patch's triangles with the triangles' errors.
fn measure_patch(lattice: &Lattice, layout: &Layout, corner: Vertex) -> Vec<(u32, f32)> {
    let mut found = Vec::with_capacity(2 * (layout.patch() * layout.patch()) as usize);
    let mut stack: Vec<Triangle> = Triangle::roots(corner, layout.patch()).to_vec();
    while let Some(triangle) = stack.pop() {
        if triangle.is_finest() {
            continue;
        }
        let error = triangle_error(lattice, layout, &triangle);
        found.push((layout.index(triangle.split_vertex()) as u32, error));
        stack.extend(triangle.split());
    }
    found
}

/// The largest vertical distance in metres between a triangle's plane and the posts it covers.
///
/// Infinite where it covers both data and no data, or where it is off a pinned post; 0 where it covers no
/// data at all or has no area.
pub fn triangle_error(lattice: &Lattice, layout: &Layout, triangle: &Triangle) -> f32 {
    let posts = triangle.corners().map(|vertex| layout.post(vertex));
    let Some(plane) = Plane::through(lattice, posts) else {
        return 0.0;
    };
    let mut seen = Seen::default();
    for row in RowSpans::of(posts) {
        seen.scan(lattice, &plane, row);
    }
    seen.error()
}

/// A triangle's plane over the lattice, in posts and metres, told from the triangle's first corner: so its rounding
/// does not depend on where the lattice begins, and a part of a terrain has the errors of the whole.
struct Plane {
    from: (f64, f64),
    at_from: f64,
    per_column: f64,
    per_row: f64,
}

impl Plane {
    /// `None` where the posts lie on a line. Heights without data make every distance NaN.
    fn through(lattice: &Lattice, [a, b, c]: [Post; 3]) -> Option<Self> {
        let point =
            |post: Post| (f64::from(post.column), f64::from(post.row), f64::from(lattice.height(post)));
        let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (point(a), point(b), point(c));
        let doubled_area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        if doubled_area == 0.0 {
            return None;
        }
        let per_column = ((bz - az) * (cy - ay) - (cz - az) * (by - ay)) / doubled_area;
        let per_row = ((cz - az) * (bx - ax) - (bz - az) * (cx - ax)) / doubled_area;
        Some(Self { from: (ax, ay), at_from: az, per_column, per_row })
    }
}

/// What a triangle was found to cover.
#[derive(Default)]
struct Seen {
    worst: f32,
    data: bool,
    no_data: bool,
    worst_pinned: f32,
}

impl Seen {
    fn scan(&mut self, lattice: &Lattice, plane: &Plane, span: RowSpan) {
        let first = lattice.index(Post { column: span.first, row: span.row });
        let start = plane.at_from + plane.per_row * (f64::from(span.row) - plane.from.1);
        for offset in 0..=(span.last - span.first) {
            let post = Post { column: span.first + offset, row: span.row };
            let height = lattice.heights()[first + offset as usize];
            if height.is_nan() {
                self.no_data = true;
                continue;
            }
            self.data = true;
            let along = plane.per_column * (f64::from(post.column) - plane.from.0);
            let off = (f64::from(height) - (start + along)).abs() as f32;
            self.worst = self.worst.max(off);
            if lattice.is_pinned(post) {
                self.worst_pinned = self.worst_pinned.max(off);
            }
        }
    }

    fn error(&self) -> f32 {
        let torn = self.data && self.no_data;
        if torn || self.worst_pinned > PINNED_SLACK_M { f32::INFINITY } else { self.worst }
    }
}

/// The posts of one row that a triangle covers, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct RowSpan {
    row: u32,
    first: u32,
    last: u32,
}

/// The rows of a triangle of posts, from the south.
struct RowSpans {
    corners: [(i64, i64); 3],
    row: i64,
    last_row: i64,
}

impl RowSpans {
    fn of(posts: [Post; 3]) -> Self {
        let corners = posts.map(|post| (i64::from(post.column), i64::from(post.row)));
        let rows = corners.map(|corner| corner.1);
        Self { corners, row: rows[0].min(rows[1]).min(rows[2]), last_row: rows[0].max(rows[1]).max(rows[2]) }
    }
}

impl Iterator for RowSpans {
    type Item = RowSpan;

    fn next(&mut self) -> Option<RowSpan> {
        while self.row <= self.last_row {
            let row = self.row;
            self.row += 1;
            let (mut first, mut last) = (i64::MAX, i64::MIN);
            for side in 0..3 {
                let (from, to) = (self.corners[side], self.corners[(side + 1) % 3]);
                let (low, high) = if from.1 <= to.1 { (from, to) } else { (to, from) };
                if row < low.1 || row > high.1 {
                    continue;
                }
                if low.1 == high.1 {
                    first = first.min(low.0.min(high.0));
                    last = last.max(low.0.max(high.0));
                    continue;
                }
                let (rise, run) = (high.1 - low.1, (high.0 - low.0) * (row - low.1));
                first = first.min(low.0 + run.div_euclid(rise) + i64::from(run.rem_euclid(rise) != 0));
                last = last.max(low.0 + run.div_euclid(rise));
            }
            if first <= last {
                return Some(RowSpan { row: row as u32, first: first as u32, last: last as u32 });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn hilly(columns: u32, rows: u32) -> Lattice {
        let heights = (0..columns * rows)
            .map(|index| {
                let (x, y) = ((index % columns) as f32, (index / columns) as f32);
                libm::sinf(x * 0.7) * 5.0 + libm::cosf(y * 0.45 + x * 0.2) * 9.0
            })
            .collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights).expect("sound")
    }

    /// The error by testing every post against the triangle, the slow and obvious way.
    fn plain_error(lattice: &Lattice, layout: &Layout, triangle: &Triangle) -> f32 {
        let posts = triangle.corners().map(|vertex| layout.post(vertex));
        let [a, b, c] = posts.map(|post| {
            glam::DVec3::new(f64::from(post.column), f64::from(post.row), f64::from(lattice.height(post)))
        });
        let normal = (b - a).cross(c - a);
        if normal.z == 0.0 {
            return 0.0;
        }
        let mut worst = 0f32;
        for post in lattice.posts() {
            let at = DVec2::new(f64::from(post.column), f64::from(post.row));
            let inside = [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(from, to)| (to.truncate() - from.truncate()).perp_dot(at - from.truncate()) >= 0.0);
            if inside {
                let z = a.z - normal.truncate().dot(at - a.truncate()) / normal.z;
                worst = worst.max((f64::from(lattice.height(post)) - z).abs() as f32);
            }
        }
        worst
    }

    #[test]
    fn scanned_errors_equal_the_plain_ones_across_the_border_too() {
        let lattice = hilly(21, 14);
        let layout = Layout::new(21, 14, 8).expect("sound");
        for corner in layout.patches() {
            let mut stack = Triangle::roots(corner, layout.patch()).to_vec();
            while let Some(triangle) = stack.pop().filter(|triangle| !triangle.is_finest()) {
                let (found, plain) =
                    (triangle_error(&lattice, &layout, &triangle), plain_error(&lattice, &layout, &triangle));
                assert!((found - plain).abs() < 1e-4, "{triangle:?}: {found} against {plain}");
                stack.extend(triangle.split());
            }
        }
    }

    #[test]
    fn errors_never_shrink_towards_the_roots() {
        let lattice = hilly(50, 37);
        let layout = Layout::new(50, 37, 16).expect("sound");
        ErrorMap::exact(&lattice, &layout).check(&layout).expect("monotone");
    }

    #[test]
    fn flat_ground_has_no_error_and_a_hole_an_infinite_one() {
        let mut heights = vec![3.0; 17 * 17];
        let layout = Layout::new(17, 17, 16).expect("sound");
        let make =
            |heights: &[f32]| Lattice::new(DVec2::ZERO, DVec2::ONE, 17, heights.to_vec()).expect("sound");
        let center = Vertex::new(8, 8);
        assert_eq!(ErrorMap::exact(&make(&heights), &layout).at(&layout, center), 0.0);
        heights[5 * 17 + 5] = f32::NAN;
        assert_eq!(ErrorMap::exact(&make(&heights), &layout).at(&layout, center), f32::INFINITY);
    }

    #[test]
    fn ground_that_is_pinned_is_refined_to_its_posts() {
        let mut lattice = hilly(17, 17);
        lattice.pin(Post { column: 4, row: 4 }, 50.0);
        let layout = Layout::new(17, 17, 16).expect("sound");
        let map = ErrorMap::exact(&lattice, &layout);
        assert_eq!(map.at(&layout, Vertex::new(4, 4)), f32::INFINITY);
        assert!(map.at(&layout, Vertex::new(12, 12)).is_finite());
    }
}
