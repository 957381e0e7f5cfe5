//! Interpolates triangles to the heights of cells, row by row: x and z where a row of cell centers enters and leaves a
//! triangle are taken along its edges, and between the two z is linear.
//!
//! ```text
//!            c             at row y:  x and z on edge ac (left), x and z on edge bc (right)
//!           ╱ ╲
//!   row ───L───R───        every center from L to R:  z = zL + (x − xL) · (zR − zL) / (xR − xL)
//!         ╱     ╲
//!        a ───── b
//! ```
//!
//! An edge is always taken from its lower end to its upper one, so that both its triangles get the very same crossing:
//! no center falls between them. Heights are means of the corners at every step and stay in their range, however thin
//! the triangle is; the gradient of its plane, the usual way, has no bound there.

use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::gridding::tin::Tin;
use sandtable_raster::cell_grid::CellGrid;

/// Rows per task: many, so that few triangles lie in two; few, so that all cores are busy to the end.
const BAND_ROWS: usize = 16;

/// The positions of cells' centers, from the sites' origin.
pub(super) struct CellCenters {
    /// The x of columns, rising.
    pub x: Vec<f64>,
    /// The y of rows, falling.
    pub y: Vec<f64>,
    per_cell: f64,
}

impl CellCenters {
    pub fn new(grid: &CellGrid, origin: DVec2) -> Self {
        let corner = grid.corner() - origin;
        let cell = grid.cell();
        let x = (0..grid.width()).map(|column| corner.x + (f64::from(column) + 0.5) * cell);
        let y = (0..grid.height()).map(|row| corner.y - (f64::from(row) + 0.5) * cell);
        Self { x: x.collect(), y: y.collect(), per_cell: cell.recip() }
    }

    pub fn len(&self) -> usize {
        self.x.len() * self.y.len()
    }

    /// The columns whose centers lie from `low` to `high`, both included.
    pub fn columns_between(&self, low: f64, high: f64) -> Range<usize> {
        self.between(self.x.len(), |column| self.x[column], low, high)
    }

    /// The rows whose centers lie from `low` to `high`, both included.
    pub fn rows_between(&self, low: f64, high: f64) -> Range<usize> {
        self.between(self.y.len(), |row| -self.y[row], -high, -low)
    }

    /// The indices whose positions, which rise, lie from `low` to `high`.
    fn between(&self, count: usize, position: impl Fn(usize) -> f64, low: f64, high: f64) -> Range<usize> {
        // The division only guesses; the comparison with the centers themselves decides.
        let guess = |at: f64| ((at - position(0)) * self.per_cell) as usize;
        let mut first = guess(low).min(count);
        while first > 0 && position(first - 1) >= low {
            first -= 1;
        }
        while first < count && position(first) < low {
            first += 1;
        }
        let mut end = guess(high).saturating_add(1).clamp(first, count);
        while end > first && position(end - 1) > high {
            end -= 1;
        }
        while end < count && position(end) <= high {
            end += 1;
        }
        first..end
    }
}

/// The x of a side at height `y`, which lies between its ends: twice the same, or both ends of a level side.
pub(super) fn crossing(from: DVec2, to: DVec2, y: f64) -> (f64, f64) {
    let (low, high) = if from.y <= to.y { (from, to) } else { (to, from) };
    if low.y == high.y {
        return (low.x.min(high.x), low.x.max(high.x));
    }
    let x = cut(low.extend(0.0), high.extend(0.0), y).0;
    (x, x)
}

/// The x and z of an edge from its lower to its upper end at height `y`; at an end exactly the end's.
fn cut(low: DVec3, high: DVec3, y: f64) -> (f64, f64) {
    if y == high.y {
        return (high.x, high.z);
    }
    let part = (y - low.y) / (high.y - low.y);
    (low.x + part * (high.x - low.x), low.z + part * (high.z - low.z))
}

/// Sets every cell whose center lies in a triangle to the triangle's height there; other cells stay.
///
/// A center on an edge takes the height of the later of its triangles, which is the same but for rounding.
pub(super) fn fill(tin: &Tin, cells: &CellCenters, out: &mut [f64]) {
    let width = cells.x.len();
    let bands = bands(tin, cells);
    out.par_chunks_mut(BAND_ROWS * width).zip(bands.par_iter()).enumerate().for_each(
        |(band, (out, triangles))| {
            let rows = band * BAND_ROWS..(band + 1) * BAND_ROWS;
            for &triangle in triangles {
                fill_triangle(tin.corners(triangle as usize), cells, &rows, out);
            }
        },
    );
}

/// The triangles that meet each band of rows, in their order.
fn bands(tin: &Tin, cells: &CellCenters) -> Vec<Vec<u32>> {
    let count = cells.y.len().div_ceil(BAND_ROWS);
    let mut bands = vec![Vec::with_capacity(tin.triangles.len() / count + 1); count];
    for index in 0..tin.triangles.len() {
        let [a, b, c] = tin.corners(index).map(|corner| corner.y);
        let rows = cells.rows_between(a.min(b).min(c), a.max(b).max(c));
        if !rows.is_empty() {
            for band in &mut bands[rows.start / BAND_ROWS..=(rows.end - 1) / BAND_ROWS] {
                band.push(index as u32);
            }
        }
    }
    bands
}

fn fill_triangle(corners: [DVec3; 3], cells: &CellCenters, band: &Range<usize>, out: &mut [f64]) {
    let mut by_y = corners;
    by_y.sort_by(|a, b| a.y.total_cmp(&b.y));
    let [low, middle, high] = by_y;
    let rows = cells.rows_between(low.y, high.y);
    for row in rows.start.max(band.start)..rows.end.min(band.end) {
        let y = cells.y[row];
        let (long, short) = if low.y == high.y {
            // No area, but its row must not be left out: it is a neighbor's border.
            ((low.x, low.z), (high.x, high.z))
        } else if y < middle.y || middle.y == high.y {
            (cut(low, high, y), if low.y == middle.y { (middle.x, middle.z) } else { cut(low, middle, y) })
        } else {
            (cut(low, high, y), cut(middle, high, y))
        };
        let (left, right) = if long.0 <= short.0 { (long, short) } else { (short, long) };
        let columns = cells.columns_between(left.0, right.0);
        let slope = if right.0 > left.0 { (right.1 - left.1) / (right.0 - left.0) } else { 0.0 };
        let start = (row - band.start) * cells.x.len();
        let out = &mut out[start + columns.start..start + columns.end];
        for (height, &x) in out.iter_mut().zip(&cells.x[columns]) {
            *height = left.1 + (x - left.0) * slope;
        }
    }
}
