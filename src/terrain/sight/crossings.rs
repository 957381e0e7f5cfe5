//! Crossings of a straight line over the ground with the edges of its finest triangles.
//!
//! Between two crossings the ground is one plane, so a function of the ground along the line is known exactly when it is
//! known at the crossings: profiles, lines of sight and viewsheds all use this walk.
//!
//! The line is cut where it meets a column of posts, a row of posts, and the one diagonal of each cell that it passes:
//!
//! ```text
//!  o───────o──────b        from `a` to `b`: a column, then a diagonal, then a row of posts …
//!  │ ╲     │   ╱ ╱│
//!  │   ╲   │ ╱ ╱  │
//!  │     ╲ │╱╱    │
//!  a────────────  o
//! ```
//!
//! The part of the line at which it meets a column or a row is one division, never a sum over the columns before: a walk
//! that begins halfway meets the same crossings to the last bit. A line may begin and end anywhere; only its part on the
//! lattice is walked, so even a line from far away meets no more crossings than the lattice has columns, rows and cells on
//! it.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::cell_triangle::Diagonal;
use crate::lattice::{Lattice, Post};

/// The error of a position on a line, in cells: rounding alone, some 1e-10 on the largest lattices that memory holds. A
/// position nearer than this to a line of posts may lie on either side of it.
pub(crate) const POSITION_ERROR: f64 = 1e-8;

/// A crossing of a line with an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCrossing {
    /// How far along the line, 0 at its start and 1 at its end.
    pub part: f64,
    /// The grid position.
    pub grid: DVec2,
    /// The height of the ground in meters, on the edge that is crossed; NaN where that edge has no data.
    pub height_m: f64,
}

/// A part of a line: where it begins and ends, 0..=1.
pub(crate) type LinePart = (f64, f64);

/// Visits every crossing of the line `from`..`to` with edges of the finest triangles, in order, ends excluded, until
/// `visit` breaks. Both ends are grid positions and may lie off the lattice, where there are no crossings; a line that is
/// not finite has none at all.
///
/// A line along an edge crosses the posts on it; a crossing at a post is visited once. Costs three crossings a cell.
pub fn crossings<B>(
    lattice: &Lattice,
    from: DVec2,
    to: DVec2,
    visit: impl FnMut(LineCrossing) -> ControlFlow<B>,
) -> ControlFlow<B> {
    match part_on(lattice, from, to) {
        Some(part) => crossings_within(lattice, (from, to), part, visit),
        None => ControlFlow::Continue(()),
    }
}

/// The part of the line on the lattice, its border included; `None` where there is none, or the line is not finite. It
/// begins and ends at the very parts of the crossings with the border.
fn part_on(lattice: &Lattice, from: DVec2, to: DVec2) -> Option<LinePart> {
    if !(from.is_finite() && to.is_finite() && (to - from).is_finite()) {
        return None;
    }
    let last = lattice.last_grid();
    let (columns, rows) = (part_between(from.x, to.x, last.x)?, part_between(from.y, to.y, last.y)?);
    let part = (columns.0.max(rows.0), columns.1.min(rows.1));
    (part.0 <= part.1).then_some(part)
}

/// The part of a coordinate that runs `from`..`to` within 0..=`last`.
fn part_between(from: f64, to: f64, last: f64) -> Option<LinePart> {
    let is_inside = |at: f64| (0.0..=last).contains(&at);
    if from == to {
        return is_inside(from).then_some((0.0, 1.0));
    }
    let (near, far) = if to > from { (0.0, last) } else { (last, 0.0) };
    let part = |line: f64| (line - from) / (to - from);
    let first = if is_inside(from) { 0.0 } else { part(near) };
    let last = if is_inside(to) { 1.0 } else { part(far) };
    let all = 0.0..=1.0;
    (all.contains(&first) && all.contains(&last)).then_some((first, last))
}

/// An edge of a cell's border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CellEdge {
    /// Along this column of posts.
    Column(f64),
    /// Along this row of posts.
    Row(f64),
    /// Two at once, at the post of this column and row.
    Post(DVec2),
}

/// The crossing with an edge of a cell's border, at the part of the line where it meets the edge's column or row.
#[inline]
pub(crate) fn crossing_at(
    lattice: &Lattice,
    (from, to): (DVec2, DVec2),
    part: f64,
    edge: CellEdge,
) -> LineCrossing {
    match edge {
        CellEdge::Column(column) => on_column(lattice, part, column, from.y + (to.y - from.y) * part),
        CellEdge::Row(row) => on_row(lattice, part, from.x + (to.x - from.x) * part, row),
        CellEdge::Post(grid) => {
            LineCrossing { part, grid, height_m: f64::from(lattice.height(Post::at_grid(grid))) }
        }
    }
}

fn crossings_within<B>(
    lattice: &Lattice,
    ends: (DVec2, DVec2),
    (first, through): LinePart,
    mut visit: impl FnMut(LineCrossing) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let (from, to) = ends;
    let mut last = first;
    let mut columns = PostLines::new(from.x, to.x, lattice.columns());
    let mut rows = PostLines::new(from.y, to.y, lattice.rows());
    columns.skip_before(first);
    rows.skip_before(first);
    loop {
        let next = columns.part.min(rows.part).min(1.0);
        if let Some(crossing) = diagonal_between(lattice, ends, (last, next.min(through))) {
            visit(crossing)?;
        }
        if next >= 1.0 || next > through {
            return ControlFlow::Continue(());
        }
        let edge = match (columns.part == next, rows.part == next) {
            (true, true) => CellEdge::Post(DVec2::new(columns.line, rows.line)),
            (true, false) => CellEdge::Column(columns.line),
            _ => CellEdge::Row(rows.line),
        };
        visit(crossing_at(lattice, ends, next, edge))?;
        for lines in [&mut columns, &mut rows] {
            if lines.part == next {
                lines.advance();
            }
        }
        last = next;
    }
}

/// The lines of posts of a lattice that one coordinate passes, in order.
struct PostLines {
    start: f64,
    length: f64,
    step: f64,
    /// The lattice's last line.
    most: f64,
    /// The next line.
    line: f64,
    /// The part at which it is met; infinite where there is none.
    part: f64,
}

impl PostLines {
    /// From the first line after the line's start.
    fn new(from: f64, to: f64, count: u32) -> Self {
        let (length, most) = (to - from, f64::from(count - 1));
        let (line, step) = if length > 0.0 {
            ((from.floor() + 1.0).max(0.0), 1.0)
        } else {
            ((from.ceil() - 1.0).min(most), -1.0)
        };
        let mut lines = Self { start: from, length, step, most, line, part: 0.0 };
        lines.meet();
        lines
    }

    fn advance(&mut self) {
        self.line += self.step;
        self.meet();
    }

    fn meet(&mut self) {
        let exists = self.length != 0.0 && self.line >= 0.0 && self.line <= self.most;
        self.part = if exists { (self.line - self.start) / self.length } else { f64::INFINITY };
    }

    fn skip_before(&mut self, part: f64) {
        while self.part < part {
            self.advance();
        }
    }
}

/// On the column of posts `column`, at `y` rows.
fn on_column(lattice: &Lattice, part: f64, column: f64, y: f64) -> LineCrossing {
    let y = y.clamp(0.0, f64::from(lattice.rows() - 1));
    let south = Post { column: column as u32, row: (y as u32).min(lattice.rows() - 2) };
    let height_m = between(lattice, south, south.offset(0, 1), y - f64::from(south.row));
    LineCrossing { part, grid: DVec2::new(column, y), height_m }
}

/// On the row of posts `row`, at `x` columns.
fn on_row(lattice: &Lattice, part: f64, x: f64, row: f64) -> LineCrossing {
    let x = x.clamp(0.0, f64::from(lattice.columns() - 1));
    let west = Post { column: (x as u32).min(lattice.columns() - 2), row: row as u32 };
    let height_m = between(lattice, west, west.offset(1, 0), x - f64::from(west.column));
    LineCrossing { part, grid: DVec2::new(x, row), height_m }
}

/// The height `part` of the way from one post to another; at a post, that post's alone.
fn between(lattice: &Lattice, from: Post, to: Post, part: f64) -> f64 {
    let (low, high) = (f64::from(lattice.height(from)), f64::from(lattice.height(to)));
    if part == 0.0 {
        low
    } else if part == 1.0 {
        high
    } else {
        low + (high - low) * part
    }
}

/// The crossing with the diagonal of the one cell that the line passes in a part of it, if it crosses it inside.
#[inline]
pub(crate) fn diagonal_between(
    lattice: &Lattice,
    (from, to): (DVec2, DVec2),
    (first, last): LinePart,
) -> Option<LineCrossing> {
    let middle = Post::at_grid(from.lerp(to, 0.5 * (first + last)));
    let cell =
        Post { column: middle.column.min(lattice.columns() - 2), row: middle.row.min(lattice.rows() - 2) };
    let corner = cell.grid();
    let (start, along) = (from - corner, to - from);
    let is_rising = Diagonal::of_cell(cell) == Diagonal::Rising;
    // On the rising diagonal x − y = 0, on the falling one x + y = 1.
    let (offset, slope) = if is_rising {
        (start.x - start.y, along.x - along.y)
    } else {
        (start.x + start.y - 1.0, along.x + along.y)
    };
    let part = -offset / slope;
    if !(part > first && part < last) {
        return None;
    }
    let grid = from + along * part;
    let x = (grid.x - corner.x).clamp(0.0, 1.0);
    let [sw, se, nw, ne] = lattice.corner_heights(cell).map(f64::from);
    let height_m = if is_rising { sw + (ne - sw) * x } else { nw + (se - nw) * x };
    Some(LineCrossing { part, grid, height_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::{Interpolation, ground_height};

    fn rough(columns: u32, rows: u32) -> Lattice {
        let height = |index: u32| ((index * 7919) % 101) as f32;
        let heights = (0..columns * rows).map(height).collect();
        Lattice::new(DVec2::ZERO, DVec2::new(10.0, 20.0), columns, heights).expect("sound")
    }

    fn walked(lattice: &Lattice, from: DVec2, to: DVec2) -> Vec<LineCrossing> {
        let mut found = Vec::new();
        let _ = crossings(lattice, from, to, |crossing| {
            found.push(crossing);
            ControlFlow::<()>::Continue(())
        });
        found
    }

    #[test]
    fn the_ground_is_planar_at_crossings_and_straight_between_them() {
        let lattice = rough(9, 7);
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..500 {
            let mut place = || DVec2::new(random() * 8.0, random() * 6.0);
            let (from, to) = (place(), place());
            let ground = |part: f64| {
                let at = from.lerp(to, part) * lattice.cell();
                ground_height(&lattice, Interpolation::Planar, at).height_m().expect("inside")
            };
            let mut parts = vec![(0.0, ground(0.0))];
            parts
                .extend(walked(&lattice, from, to).iter().map(|crossing| (crossing.part, crossing.height_m)));
            parts.push((1.0, ground(1.0)));
            for pair in parts.windows(2) {
                let [(a, low), (b, high)] = [pair[0], pair[1]];
                assert!(a <= b && (ground(b) - high).abs() < 1e-6, "{from} {to} at {b}");
                assert!(
                    (ground(0.5 * (a + b)) - 0.5 * (low + high)).abs() < 1e-6,
                    "{from} {to} between {a} and {b}"
                );
            }
        }
    }

    #[test]
    fn a_line_through_posts_meets_each_once() {
        let lattice = rough(5, 5);
        let along = walked(&lattice, DVec2::new(0.0, 2.0), DVec2::new(4.0, 2.0));
        assert_eq!(along.iter().map(|crossing| crossing.grid.x).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
        let diagonal = walked(&lattice, DVec2::new(4.0, 0.0), DVec2::new(0.0, 4.0));
        assert!(diagonal.iter().all(|crossing| (crossing.grid.x + crossing.grid.y - 4.0).abs() < 1e-12));
        assert_eq!(diagonal.iter().filter(|crossing| crossing.grid.x.fract() == 0.0).count(), 3);
    }
}
