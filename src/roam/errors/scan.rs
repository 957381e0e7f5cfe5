//! Scanning the posts under a triangle of plain ground.
//!
//! A bintree triangle has one of three shapes. Rows of posts run east, so each shape is a span of every row that grows or
//! shrinks by whole posts, and nothing is clipped or divided:
//!
//! ```text
//!   Corner: legs along       Upright: hypotenuse       Aslant: hypotenuse
//!   rows and columns         along a row               along a column
//!   o                             A                      o
//!   │ ╲                         ╱   ╲                    │ ╲
//!   A───o                     o───────o                  │   A
//!                                                        │ ╱
//!                                                        o
//! ```
//!
//! Heights are relative to the apex A and all is f32, eight posts at a time: legs are powers of two, so gradients are exact
//! but for one subtraction. The distances are within one part in a million of the relief under the triangle of the true
//! ones; constant ground has exactly 0.

use std::ops::Range;

use crate::bintree::Triangle;
use crate::errors::survey::is_plain;
use crate::graph::Vertex;
use sandtable_base::vectorized::vectorized;
use sandtable_terrain::lattice::Lattice;

/// Posts that are measured together.
const LANES: usize = 8;

/// How many columns each lane is ahead of the first.
const COLUMNS_AHEAD: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The largest distance yet of each lane.
pub type Worst = [f32; LANES];

/// Rows between two tests whether a tolerance is exceeded.
const ROWS_PER_TEST: i32 = 8;

/// Whether posts on the hypotenuse count. The second triangle of a diamond may leave them to the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hypotenuse {
    /// They count.
    Included,
    /// They do not.
    Excluded,
}

/// Signs give the direction from the apex to the triangle.
#[derive(Clone, Copy, Debug)]
enum ScanShape {
    /// Legs of `leg` cells.
    Corner { east: i32, north: i32, leg: i32 },
    /// The hypotenuse runs east, `reach` rows away.
    Upright { north: i32, reach: i32 },
    /// The hypotenuse runs north, `reach` columns away.
    Aslant { east: i32, reach: i32 },
}

/// A triangle whose corners all are posts.
#[derive(Clone, Copy, Debug)]
pub struct PostTriangle<'a> {
    /// Those that the lattice holds.
    heights: &'a [f32],
    /// Held posts per row.
    columns: usize,
    /// The index that column 0 of row 0 has among the held posts, or would have.
    origin: isize,
    apex: (i32, i32),
    apex_height: f32,
    per_column: f32,
    per_row: f32,
    shape: ScanShape,
}

impl<'a> PostTriangle<'a> {
    /// The triangle over a lattice, which holds the posts under it; `None` where it reaches beyond the lattice's border.
    #[inline]
    pub fn new(lattice: &'a Lattice, triangle: &Triangle) -> Option<Self> {
        let (columns, rows) = (lattice.columns() as i32, lattice.rows() as i32);
        if triangle.corners().iter().any(|corner| corner.x >= columns || corner.y >= rows) {
            return None;
        }
        let (heights, held) = (lattice.held_heights(), lattice.held());
        let stride = held.width();
        let origin = -((held.first.row as usize * stride + held.first.column as usize) as isize);
        let index = |corner: Vertex| origin + (corner.y as usize * stride + corner.x as usize) as isize;
        let height = |corner: Vertex| heights[index(corner) as usize];
        let apex_height = height(triangle.apex);
        let (left, right) = (height(triangle.left) - apex_height, height(triangle.right) - apex_height);
        let at = |corner: Vertex| (corner.x, corner.y);
        let (apex, from, to) = (at(triangle.apex), at(triangle.left), at(triangle.right));
        let (shape, per_column, per_row) = if from.1 == to.1 {
            let reach = (from.1 - apex.1).abs();
            let north = (from.1 - apex.1).signum();
            let scale = 0.5 / reach as f32;
            let rise = if to.0 > from.0 { right - left } else { left - right };
            (ScanShape::Upright { north, reach }, rise * scale, (left + right) * (scale * north as f32))
        } else if from.0 == to.0 {
            let reach = (from.0 - apex.0).abs();
            let east = (from.0 - apex.0).signum();
            let scale = 0.5 / reach as f32;
            let rise = if to.1 > from.1 { right - left } else { left - right };
            (ScanShape::Aslant { east, reach }, (left + right) * (scale * east as f32), rise * scale)
        } else {
            let ((ahead, along), (aside, across)) = if from.1 == apex.1 {
                ((from.0, left), (to.1, right))
            } else {
                ((to.0, right), (from.1, left))
            };
            let (east, north) = ((ahead - apex.0).signum(), (aside - apex.1).signum());
            let leg = (ahead - apex.0).abs();
            let scale = 1.0 / leg as f32;
            (
                ScanShape::Corner { east, north, leg },
                along * (scale * east as f32),
                across * (scale * north as f32),
            )
        };
        Some(Self { heights, columns: stride, origin, apex, apex_height, per_column, per_row, shape })
    }

    /// The rows of posts it covers, counted from the apex, or from the south where the hypotenuse runs north.
    pub fn rows(&self) -> i32 {
        match self.shape {
            ScanShape::Corner { leg, .. } => leg + 1,
            ScanShape::Upright { reach, .. } => reach + 1,
            ScanShape::Aslant { reach, .. } => 2 * reach + 1,
        }
    }

    /// Column and row of the south-west and north-east corner of the posts covered.
    pub fn bounds(&self) -> ((i32, i32), (i32, i32)) {
        let (x, y) = self.apex;
        let reach_to = |from: i32, by: i32| (from.min(from + by), from.max(from + by));
        let ((west, east), (south, north)) = match self.shape {
            ScanShape::Corner { east, north, leg } => (reach_to(x, east * leg), reach_to(y, north * leg)),
            ScanShape::Upright { north, reach } => ((x - reach, x + reach), reach_to(y, north * reach)),
            ScanShape::Aslant { east, reach } => (reach_to(x, east * reach), (y - reach, y + reach)),
        };
        ((west, south), (east, north))
    }

    /// Whether all posts covered are plain: have data and are not pinned.
    pub fn is_plain(&self, pinned: &[bool]) -> bool {
        let mut plain = true;
        self.spans(0..self.rows(), Hypotenuse::Included, |row, first, length| {
            let posts = self.posts(row, first, length);
            plain &= is_plain(&self.heights[posts.clone()], &pinned[posts]);
        });
        plain
    }

    /// Measures the posts of the given rows, all of them plain.
    pub fn scan(&self, rows: Range<i32>, hypotenuse: Hypotenuse, worst: &mut Worst) {
        vectorized(
            #[inline(always)]
            || self.spans(rows, hypotenuse, |row, first, length| self.scan_span(row, first, length, worst)),
        );
    }

    /// Whether any post, all of them plain, is farther off than `tolerance_m`.
    pub fn exceeds(&self, tolerance_m: f32) -> bool {
        let mut worst = Worst::default();
        (0..self.rows()).step_by(ROWS_PER_TEST as usize).any(|first| {
            let rows = first..(first + ROWS_PER_TEST).min(self.rows());
            self.scan(rows, Hypotenuse::Included, &mut worst);
            largest(&worst) > tolerance_m
        })
    }

    /// Calls `visit` with row, first column and number of posts for each of the given rows.
    #[inline(always)]
    fn spans(&self, rows: Range<i32>, hypotenuse: Hypotenuse, mut visit: impl FnMut(i32, i32, i32)) {
        let (x, y) = self.apex;
        let excluded = i32::from(hypotenuse == Hypotenuse::Excluded);
        match self.shape {
            ScanShape::Corner { east, north, leg } => {
                for up in rows {
                    let reach = leg - up - excluded;
                    visit(y + north * up, if east > 0 { x } else { x - reach }, reach + 1);
                }
            }
            ScanShape::Upright { north, reach } => {
                for up in rows.start..rows.end.min(reach + 1 - excluded) {
                    visit(y + north * up, x - up, 2 * up + 1);
                }
            }
            ScanShape::Aslant { east, reach } => {
                for up in rows {
                    let (near, far) = ((up - reach).abs(), reach - excluded);
                    visit(y - reach + up, if east > 0 { x + near } else { x - far }, far - near + 1);
                }
            }
        }
    }

    fn posts(&self, row: i32, first: i32, length: i32) -> Range<usize> {
        let start = (self.origin + (row as usize * self.columns + first as usize) as isize) as usize;
        start..start + length.max(0) as usize
    }

    #[inline(always)]
    fn scan_span(&self, row: i32, first: i32, length: i32, worst: &mut Worst) {
        let posts = &self.heights[self.posts(row, first, length)];
        let start =
            self.per_column * (first - self.apex.0) as f32 + self.per_row * (row - self.apex.1) as f32;
        let off = |at: usize| {
            let plane = start + self.per_column * (at as i32 as f32);
            ((posts[at] - self.apex_height) - plane).abs()
        };
        if posts.len() < LANES {
            // Of four to seven posts the last four overlap the first.
            let half = LANES / 2;
            if posts.len() < half {
                for (at, worst) in worst.iter_mut().enumerate().take(posts.len()) {
                    *worst = larger(*worst, off(at));
                }
                return;
            }
            let (first, last) = worst.split_at_mut(half);
            let rest = posts.len() - half;
            for (lane, (first, last)) in first.iter_mut().zip(last).enumerate() {
                *first = larger(*first, off(lane));
                *last = larger(*last, off(rest + lane));
            }
            return;
        }
        // The last eight overlap those before: a post measured twice is as far off as it was.
        let whole = posts.len() / LANES;
        for group in (0..whole).map(|group| group * LANES).chain([posts.len() - LANES]) {
            let heights: &[f32; LANES] = posts[group..group + LANES].first_chunk().expect("eight posts");
            let ahead = group as i32 as f32;
            for lane in 0..LANES {
                let plane = start + self.per_column * (ahead + COLUMNS_AHEAD[lane]);
                worst[lane] = larger(worst[lane], ((heights[lane] - self.apex_height) - plane).abs());
            }
        }
    }
}

/// The larger of two numbers that are not NaN, in one instruction, where `f32::max` tests for NaN.
#[inline(always)]
pub fn larger(one: f32, other: f32) -> f32 {
    if other > one { other } else { one }
}

/// The largest of all lanes.
pub fn largest(worst: &Worst) -> f32 {
    worst.iter().copied().fold(0.0, larger)
}
