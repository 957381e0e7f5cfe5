//! Where a straight line over the ground crosses the edges of its finest triangles.
//!
//! Between two crossings the ground is one plane, so a function of the ground along the line is known exactly when it
//! is known at the crossings: profiles, lines of sight and viewsheds all stand on this walk.
//!
//! The line is cut where it meets a column of posts, a row of posts, and the one diagonal of each cell that it passes
//! through:
//!
//! ```text
//!  o───────o──────b        from `a` to `b`: a column, then a diagonal, then a row of posts …
//!  │ ╲     │   ╱ ╱│
//!  │   ╲   │ ╱ ╱  │
//!  │     ╲ │╱╱    │
//!  a────────────  o
//! ```
//!
//! The part of the line at which it meets a column or a row is one division, never a sum over the columns before: whoever
//! begins half-way meets the same crossings to the last bit. A line may begin and end anywhere; only what lies on the lattice is walked, so that even one from far away
//! meets no more crossings than the lattice has columns, rows and cells for it.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::query::Diagonal;

/// How exactly a position on a line is known, in cells; it is off by rounding alone, some 1e-10 on the largest lattices
/// that memory holds. What lies nearer than this to a line of posts may lie on either side of it.
pub(in crate::terrain) const POSITION_ERROR: f64 = 1e-8;

/// A place on a line where the ground bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCrossing {
    /// How far along the line, 0 at its start and 1 at its end.
    pub part: f64,
    /// Grid position: columns and rows of posts from the lattice's first.
    pub grid: DVec2,
    /// The height of the ground there in meters, on the edge that is crossed; NaN where that edge has no data.
    pub height_m: f64,
}

/// The parts of a line between which it is walked: from the first to the second, 0..=1.
pub(in crate::terrain) type LinePart = (f64, f64);

/// Visits every crossing of the line `from`..`to` with edges of the finest triangles, in order, ends excluded, until
/// `visit` breaks. Both ends are grid positions and may lie off the lattice, where there are no crossings; a line that
/// is not finite has none at all.
///
/// A line along an edge crosses the posts on it; a crossing at a post is visited once. Costs three crossings a cell.
pub fn crossings<B>(
    lattice: &Lattice,
    from: DVec2,
    to: DVec2,
    visit: impl FnMut(LineCrossing) -> ControlFlow<B>,
) -> ControlFlow<B> {
    match parts_on(lattice, from, to) {
        Some(parts) => crossings_within(lattice, from, to, parts, visit),
        None => ControlFlow::Continue(()),
    }
}

/// The parts of the line between which it lies on the lattice, its border included; `None` where it does not, or is not
/// finite. Where the line comes in or leaves, the part is that of the crossing with the border.
fn parts_on(lattice: &Lattice, from: DVec2, to: DVec2) -> Option<LinePart> {
    if !(from.is_finite() && to.is_finite() && (to - from).is_finite()) {
        return None;
    }
    let columns = parts_between(from.x, to.x, f64::from(lattice.columns() - 1))?;
    let rows = parts_between(from.y, to.y, f64::from(lattice.rows() - 1))?;
    let parts = (columns.0.max(rows.0), columns.1.min(rows.1));
    (parts.0 <= parts.1).then_some(parts)
}

/// The parts between which a coordinate that runs `from`..`to` lies within 0..=`last`.
fn parts_between(from: f64, to: f64, last: f64) -> Option<LinePart> {
    let inside = |at: f64| (0.0..=last).contains(&at);
    if from == to {
        return inside(from).then_some((0.0, 1.0));
    }
    let (near, far) = if to > from { (0.0, last) } else { (last, 0.0) };
    let part = |line: f64| (line - from) / (to - from);
    let first = if inside(from) { 0.0 } else { part(near) };
    let last = if inside(to) { 1.0 } else { part(far) };
    let all = 0.0..=1.0;
    (all.contains(&first) && all.contains(&last)).then_some((first, last))
}

/// Which edge a line crosses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::terrain) enum CellEdge {
    /// Along this column of posts.
    Column(f64),
    /// Along this row of posts.
    Row(f64),
    /// Two at once, at the post of this column and row.
    Post(DVec2),
}

/// The crossing with an edge of a cell's border, at the part of the line where it meets the edge's column or row.
#[inline]
pub(in crate::terrain) fn crossing_at(
    lattice: &Lattice,
    (from, to): (DVec2, DVec2),
    part: f64,
    edge: CellEdge,
) -> LineCrossing {
    match edge {
        CellEdge::Column(column) => on_column(lattice, part, column, from.y + (to.y - from.y) * part),
        CellEdge::Row(row) => on_row(lattice, part, from.x + (to.x - from.x) * part, row),
        CellEdge::Post(post) => at_post(lattice, part, post),
    }
}

fn crossings_within<B>(
    lattice: &Lattice,
    from: DVec2,
    to: DVec2,
    (first, through): LinePart,
    mut visit: impl FnMut(LineCrossing) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let mut last = first;
    let mut columns = PostLines::new(from.x, to.x, lattice.columns());
    let mut rows = PostLines::new(from.y, to.y, lattice.rows());
    columns.pass(first);
    rows.pass(first);
    loop {
        let next = columns.part.min(rows.part).min(1.0);
        if let Some(crossing) = diagonal_between(lattice, from, to, (last, next.min(through))) {
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
        visit(crossing_at(lattice, (from, to), next, edge))?;
        if columns.part == next {
            columns.advance();
        }
        if rows.part == next {
            rows.advance();
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
    /// Where it is met; beyond 1 where there is none.
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
        let is_there = self.length != 0.0 && self.line >= 0.0 && self.line <= self.most;
        self.part = if is_there { (self.line - self.start) / self.length } else { f64::INFINITY };
    }

    /// Leaves out the lines that are met before `part`.
    fn pass(&mut self, part: f64) {
        while self.part < part {
            self.advance();
        }
    }
}

fn at_post(lattice: &Lattice, part: f64, grid: DVec2) -> LineCrossing {
    let post = Post { column: grid.x as u32, row: grid.y as u32 };
    LineCrossing { part, grid, height_m: f64::from(lattice.height(post)) }
}

/// On the column of posts `column`, at `y` rows.
fn on_column(lattice: &Lattice, part: f64, column: f64, y: f64) -> LineCrossing {
    let y = y.clamp(0.0, f64::from(lattice.rows() - 1));
    let south = Post { column: column as u32, row: (y as u32).min(lattice.rows() - 2) };
    let north = Post { row: south.row + 1, ..south };
    let height_m = between(lattice, south, north, y - f64::from(south.row));
    LineCrossing { part, grid: DVec2::new(column, y), height_m }
}

/// On the row of posts `row`, at `x` columns.
fn on_row(lattice: &Lattice, part: f64, x: f64, row: f64) -> LineCrossing {
    let x = x.clamp(0.0, f64::from(lattice.columns() - 1));
    let west = Post { column: (x as u32).min(lattice.columns() - 2), row: row as u32 };
    let east = Post { column: west.column + 1, ..west };
    let height_m = between(lattice, west, east, x - f64::from(west.column));
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

/// The crossing with the diagonal of the cell that the line passes between two parts of it, if it crosses it inside.
#[inline]
pub(in crate::terrain) fn diagonal_between(
    lattice: &Lattice,
    from: DVec2,
    to: DVec2,
    (first, last): LinePart,
) -> Option<LineCrossing> {
    let middle = from.lerp(to, 0.5 * (first + last));
    // Casting rounds down, and what is below 0 becomes 0.
    let cell = Post {
        column: (middle.x as u32).min(lattice.columns() - 2),
        row: (middle.y as u32).min(lattice.rows() - 2),
    };
    let corner = DVec2::new(f64::from(cell.column), f64::from(cell.row));
    let (start, along) = (from - corner, to - from);
    let rising = Diagonal::of_cell(u64::from(cell.column), u64::from(cell.row)) == Diagonal::Rising;
    // On the rising diagonal x − y = 0, on the falling one x + y = 1.
    let (offset, slope) = if rising {
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
    let height_m = if rising { sw + (ne - sw) * x } else { nw + (se - nw) * x };
    Some(LineCrossing { part, grid, height_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::query::{Interpolation, ground_height};

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
    fn between_crossings_the_ground_is_straight_and_on_them_it_is_the_planar_one() {
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
