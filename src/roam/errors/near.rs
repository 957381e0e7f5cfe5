//! The exact errors of the vertices with the smallest steps, several at a time.
//!
//! Nearly all vertices of a terrain split triangles of a few posts, where rows and spans would cost more than the posts. So
//! the same post of several triangles is measured at once. Vertices [`PERIOD`] columns apart have triangles of the same
//! shape; [`BlockPosts`] arranges a block's posts so that those of such vertices lie together:
//!
//! ```text
//! column      0 1 2 … 15 16 17 18 … 31 32 33 34 …
//! gathered   [0 16 32 48] [1 17 33 49] [2 18 34 50] … and a margin of a few columns either side
//! ```
//!
//! Heights are relative to the vertex. A single vertex is measured by the same arithmetic in one lane, with the same bits.

use std::ops::{Add, Mul, Sub};

use glam::Vec4;

use crate::errors::scan::larger;
use crate::graph::{Vertex, VertexKind};

/// The largest step that is treated here.
pub const LARGEST_STEP: i32 = 4;

/// Vertices this many columns apart have triangles of one shape, up to [`LARGEST_STEP`]: diagonals of that step alternate
/// every 8 columns.
pub const PERIOD: usize = 16;

/// Vertices measured at once.
pub const LANES: usize = 4;

/// Columns of a block.
pub const BLOCK_COLUMNS: usize = PERIOD * LANES;

/// Posts around a block that its triangles reach.
const MARGIN: usize = LARGEST_STEP as usize;

/// A number for one vertex, or for each of several.
trait Numbers: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self> {
    const ZERO: Self;

    fn abs(self) -> Self;

    fn or_larger(self, other: Self) -> Self;
}

impl Numbers for f32 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn or_larger(self, other: Self) -> Self {
        larger(self, other)
    }
}

impl Numbers for Vec4 {
    const ZERO: Self = Self::ZERO;

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn or_larger(self, other: Self) -> Self {
        // In this order a NaN in `other` is left out, as by `larger`.
        other.max(self)
    }
}

/// The error of a vertex with a step of at most [`LARGEST_STEP`], both of whose triangles are on the lattice, all
/// their posts with data. `heights` are the lattice's, `columns` to a row.
pub fn error(heights: &[f32], columns: usize, vertex: Vertex) -> f32 {
    let at = vertex.y as isize * columns as isize + vertex.x as isize;
    diamond_error(vertex, |dx: isize, dy: isize| heights[(at + dy * columns as isize + dx) as usize])
}

/// The posts of a block, those of equal triangles together.
pub struct BlockPosts {
    rows: Vec<[Vec4; PERIOD + 2 * MARGIN]>,
    first: Vertex,
}

impl BlockPosts {
    /// The posts of the block of `rows` rows and [`BLOCK_COLUMNS`] columns from vertex `first` on, whose column is a
    /// multiple of [`PERIOD`], and those around it. Posts beyond the lattice's borders repeat those on
    /// them.
    pub fn new(heights: &[f32], columns: usize, first: Vertex, rows: usize) -> Self {
        let last_row = heights.len() / columns - 1;
        let (west, south) = (first.x as usize, first.y as usize);
        let inside = west >= MARGIN && west + BLOCK_COLUMNS + MARGIN <= columns;
        let gather = |row: usize| {
            let row = (south + row).saturating_sub(MARGIN).min(last_row);
            let row = &heights[row * columns..][..columns];
            let mut gathered = [Vec4::ZERO; PERIOD + 2 * MARGIN];
            if inside {
                let posts = &row[west - MARGIN..][..BLOCK_COLUMNS + 2 * MARGIN];
                for (ahead, lanes) in gathered.iter_mut().enumerate() {
                    *lanes = Vec4::from_array(std::array::from_fn(|lane| posts[ahead + lane * PERIOD]));
                }
            } else {
                for (ahead, lanes) in gathered.iter_mut().enumerate() {
                    let column = |lane: usize| (west + lane * PERIOD + ahead).saturating_sub(MARGIN);
                    *lanes = Vec4::from_array(std::array::from_fn(|lane| row[column(lane).min(columns - 1)]));
                }
            }
            gathered
        };
        Self { rows: (0..rows + 2 * MARGIN).map(gather).collect(), first }
    }

    /// Measures all vertices of row `row` of the block with a step of at most [`LARGEST_STEP`]. `errors` are those
    /// of the row from the block's first column on; it may end before the block does.
    pub fn measure_row(&self, row: usize, errors: &mut [f32]) {
        for ahead in 0..PERIOD.min(errors.len()) {
            let vertex = Vertex::new(ahead as i32, self.first.y + row as i32);
            if (vertex.x | vertex.y) & (2 * LARGEST_STEP - 1) == 0 {
                continue;
            }
            let errors_of_lanes = diamond_error(vertex, |dx, dy| {
                let row = &self.rows[(row + MARGIN).wrapping_add_signed(dy)];
                row[(ahead + MARGIN).wrapping_add_signed(dx)]
            });
            for (lane, error) in errors_of_lanes.to_array().into_iter().enumerate() {
                if let Some(slot) = errors.get_mut(ahead + lane * PERIOD) {
                    *slot = error;
                }
            }
        }
    }
}

/// The errors of vertices with the step and the shape of `vertex`; `post` returns their posts at an offset in columns and
/// rows.
#[inline(always)]
fn diamond_error<L: Numbers>(vertex: Vertex, post: impl Fn(isize, isize) -> L) -> L {
    let turned = |dx: isize, dy: isize| post(dy, dx);
    let mirrored = |dx: isize, dy: isize| post(-dx, dy);
    let rises = || {
        let [from, to] = vertex.hypotenuse();
        (to.x > from.x) == (to.y > from.y)
    };
    match (vertex.step(), vertex.kind()) {
        (1, VertexKind::EastEdge) => off_middle(post(0, 0), post(-1, 0), post(1, 0)),
        (1, VertexKind::NorthEdge) => off_middle(post(0, 0), post(0, -1), post(0, 1)),
        (1, VertexKind::Center) if rises() => center_of_step_one(post),
        (1, VertexKind::Center) => center_of_step_one(mirrored),
        (2, VertexKind::EastEdge) => edge::<2, L>(post),
        (2, VertexKind::NorthEdge) => edge::<2, L>(turned),
        (2, VertexKind::Center) if rises() => center::<2, L>(post),
        (2, VertexKind::Center) => center::<2, L>(mirrored),
        (_, VertexKind::EastEdge) => edge::<4, L>(post),
        (_, VertexKind::NorthEdge) => edge::<4, L>(turned),
        (_, VertexKind::Center) if rises() => center::<4, L>(post),
        (_, VertexKind::Center) => center::<4, L>(mirrored),
    }
}

/// How far a post is off the middle of two others: the mean of its differences to both.
#[inline(always)]
fn off_middle<L: Numbers>(post: L, one: L, other: L) -> L {
    (((post - one) + (post - other)) * 0.5).abs()
}

/// The hypotenuse rises from south-west to north-east; every post is the middle of two corners.
#[inline(always)]
fn center_of_step_one<L: Numbers>(post: impl Fn(isize, isize) -> L) -> L {
    let [south_west, south_east, north_west, north_east] =
        [post(-1, -1), post(1, -1), post(-1, 1), post(1, 1)];
    let across = off_middle(post(0, 0), south_west, north_east);
    let south = off_middle(post(0, -1), south_west, south_east);
    let north = off_middle(post(0, 1), north_west, north_east);
    let west = off_middle(post(-1, 0), south_west, north_west);
    let east = off_middle(post(1, 0), south_east, north_east);
    across.or_larger(south.or_larger(north)).or_larger(west.or_larger(east))
}

/// The hypotenuse runs east.
#[inline(always)]
fn edge<const STEP: isize, L: Numbers>(post: impl Fn(isize, isize) -> L) -> L {
    let at = post(0, 0);
    let (west, east) = (post(-STEP, 0) - at, post(STEP, 0) - at);
    let middle = (west + east) * 0.5;
    let per_column = (east - west) * (0.5 / STEP as f32);
    let per_row = [-STEP, STEP].map(|apex| ((post(0, apex) - at) - middle) * (1.0 / STEP as f32));
    let mut worst = middle.abs();
    for dy in 0..STEP {
        let reach = STEP - dy - isize::from(dy == 0);
        for dx in -reach..=reach {
            let along = middle + per_column * dx as f32;
            let south = (post(dx, -dy) - at) - (along + per_row[0] * dy as f32);
            worst = worst.or_larger(south.abs());
            if dy > 0 {
                let north = (post(dx, dy) - at) - (along + per_row[1] * dy as f32);
                worst = worst.or_larger(north.abs());
            }
        }
    }
    worst
}

/// The hypotenuse rises from south-west to north-east.
#[inline(always)]
fn center<const STEP: isize, L: Numbers>(post: impl Fn(isize, isize) -> L) -> L {
    let at = post(0, 0);
    let corner = |dx: isize, dy: isize| post(dx * STEP, dy * STEP) - at;
    let (south_west, north_east) = (corner(-1, -1), corner(1, 1));
    let middle = (south_west + north_east) * 0.5;
    let (south_east, north_west) = (corner(1, -1), corner(-1, 1));
    let scale = 0.5 / STEP as f32;
    let below = ((south_east - south_west) * scale, (north_east - south_east) * scale);
    let above = ((north_east - north_west) * scale, (north_west - south_west) * scale);
    let mut worst = L::ZERO;
    for dy in -STEP..=STEP {
        for (columns, (per_column, per_row)) in [(-STEP..dy, above), (dy..STEP + 1, below)] {
            let row = middle + per_row * dy as f32;
            for dx in columns {
                let off = (post(dx, dy) - at) - (row + per_column * dx as f32);
                worst = worst.or_larger(off.abs());
            }
        }
    }
    worst
}
