//! Lines of equal value on a grid, by marching squares (Lorensen and Cline 1987, in the plane).
//!
//! ```text
//!   a ──top── b      a line enters a cell where values rise above the level on the way round it (up) and leaves it
//!   │         │      where they fall below it (down), so that higher values are on its left as one looks along it,
//!  left     right    X right and Y down
//!   │         │
//!   d ─bottom─ c
//! ```

use glam::DVec2;
use rayon::prelude::*;

/// Values in rows, X right and Y down; NaN is a void.
pub struct ValueGrid<'a> {
    /// Values in a row.
    pub columns: usize,
    /// Row by row.
    pub values: &'a [f32],
}

/// A line at `level` times the interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Isoline {
    /// The number of intervals above 0.
    pub level: i64,
    /// In columns and rows; the first is repeated at the end of a closed line.
    pub points: Vec<DVec2>,
}

impl Isoline {
    /// Whether it is a ring.
    pub fn is_closed(&self) -> bool {
        self.points.len() > 3 && self.points.first() == self.points.last()
    }
}

/// A line's way through one cell; the edges are numbered over the grid.
struct CellPassage {
    level: i64,
    enters: usize,
    leaves: usize,
    enters_at: DVec2,
    leaves_at: DVec2,
}

/// The lines at whole multiples of `interval`, each in one piece between voids. Cells for which `is_open` is false, that
/// touch a void, or that more than `most` lines cross are void. Empty where `interval` is not positive. Cells are looked at on
/// all threads; the lines are the same for any number of them.
pub fn isolines(
    grid: &ValueGrid<'_>,
    interval: f32,
    most: usize,
    is_open: impl Fn(usize, usize) -> bool + Sync,
) -> Vec<Isoline> {
    let columns = grid.columns;
    if columns < 2 || interval.is_nan() || interval <= 0.0 {
        return Vec::new();
    }
    let rows = grid.values.len() / columns;
    let of_row = |row: usize| {
        let mut passages = Vec::new();
        for column in 0..columns - 1 {
            let at = |x: usize, y: usize| grid.values[(row + y) * columns + column + x] / interval;
            let corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            if !corners.iter().all(|value| value.is_finite()) {
                continue;
            }
            let low = corners.iter().copied().fold(f32::MAX, f32::min).floor() as i64;
            let high = corners.iter().copied().fold(f32::MIN, f32::max).floor() as i64;
            if high > low && (high - low) as usize <= most && is_open(column, row) {
                (low + 1..=high)
                    .for_each(|level| pass(level, corners, (column, row), columns, &mut passages));
            }
        }
        passages
    };
    linked((0..rows.saturating_sub(1)).into_par_iter().flat_map_iter(of_row).collect())
}

/// Adds the ways of the line at `level` through a cell.
fn pass(
    level: i64,
    corners: [f32; 4],
    (column, row): (usize, usize),
    columns: usize,
    out: &mut Vec<CellPassage>,
) {
    let threshold = level as f32;
    let is_high = corners.map(|value| value >= threshold);
    let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let edge = |side: usize| match side {
        0 => (row * columns + column) * 2,
        1 => (row * columns + column + 1) * 2 + 1,
        2 => ((row + 1) * columns + column) * 2,
        _ => (row * columns + column) * 2 + 1,
    };
    let corner = |index: usize| DVec2::new(column as f64 + places[index].0, row as f64 + places[index].1);
    let crossing = |side: usize| {
        let (from, to) = (side, (side + 1) % 4);
        // In the same direction from both cells beside the edge, so that both find the same point.
        let (low, high) = if from < to && side != 2 { (from, to) } else { (to, from) };
        let part = (threshold - corners[low]) / (corners[high] - corners[low]);
        corner(low).lerp(corner(high), f64::from(part.clamp(0.0, 1.0)))
    };
    let ups: Vec<usize> = (0..4).filter(|&side| !is_high[side] && is_high[(side + 1) % 4]).collect();
    let downs: Vec<usize> = (0..4).filter(|&side| is_high[side] && !is_high[(side + 1) % 4]).collect();
    let is_joined = corners.iter().sum::<f32>() * 0.25 >= threshold;
    for &up in &ups {
        // Of a saddle's two, the line round the high corner after `up` or, where the high corners are one, round the low
        // corner before it.
        let next = (1..4).map(|step| (up + if is_joined { 4 - step } else { step }) % 4);
        let Some(down) = next.into_iter().find(|side| downs.contains(side)) else { continue };
        out.push(CellPassage {
            level,
            enters: edge(up),
            leaves: edge(down),
            enters_at: crossing(up),
            leaves_at: crossing(down),
        });
    }
}

/// The passages as lines. Every edge is entered and left by one passage of a level at most.
fn linked(mut passages: Vec<CellPassage>) -> Vec<Isoline> {
    passages.sort_by_key(|passage| (passage.level, passage.enters));
    let find = |level: i64, edge: usize| {
        passages.binary_search_by_key(&(level, edge), |passage| (passage.level, passage.enters)).ok()
    };
    let next: Vec<Option<usize>> =
        passages.iter().map(|passage| find(passage.level, passage.leaves)).collect();
    let mut has_before = vec![false; passages.len()];
    next.iter().flatten().for_each(|&index| has_before[index] = true);
    let mut used = vec![false; passages.len()];
    let mut lines = Vec::new();
    // Open lines from their starts, then what is left: rings.
    let starts = (0..passages.len()).filter(|&index| !has_before[index]).chain(0..passages.len());
    for start in starts {
        if used[start] {
            continue;
        }
        let mut points = vec![passages[start].enters_at];
        let mut here = Some(start);
        while let Some(index) = here.filter(|&index| !std::mem::replace(&mut used[index], true)) {
            points.push(passages[index].leaves_at);
            here = next[index];
        }
        if let (true, Some(first)) = (here == Some(start), points.first().copied()) {
            *points.last_mut().expect("it has its first point") = first;
        }
        lines.push(Isoline { level: passages[start].level, points });
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hill(columns: usize, rows: usize, sign: f32) -> Vec<f32> {
        let height = |n: usize| {
            let (x, y) = ((n % columns) as f32 - 20.3, (n / columns) as f32 - 15.7);
            sign * (40.0 - (x * x + y * y).sqrt())
        };
        (0..columns * rows).map(height).collect()
    }

    #[test]
    fn a_cone_has_a_ring_a_level_of_its_radius_with_the_higher_ground_on_its_left() {
        for sign in [1.0, -1.0] {
            let values = hill(41, 32, sign);
            let lines = isolines(&ValueGrid { columns: 41, values: &values }, 5.0, 9, |_, _| true);
            let rings: Vec<&Isoline> = lines.iter().filter(|line| line.is_closed()).collect();
            assert_eq!(rings.len(), 3, "radii 5, 10 and 15");
            for ring in rings {
                let radius = 40.0 - (ring.level as f64 * 5.0 * f64::from(sign));
                let center = DVec2::new(20.3, 15.7);
                assert!(ring.points.iter().all(|at| (at.distance(center) - radius).abs() < 0.2));
                for leg in ring.points.windows(2) {
                    let along = leg[1] - leg[0];
                    let up = DVec2::new(along.y, -along.x);
                    let inward = (center - leg[0]).dot(up) * f64::from(sign);
                    assert!(inward >= 0.0, "{inward}");
                }
            }
        }
    }

    #[test]
    fn voids_closed_cells_and_steep_cells_break_lines() {
        let values = hill(41, 32, 1.0);
        let grid = ValueGrid { columns: 41, values: &values };
        let count = |lines: Vec<Isoline>| lines.iter().filter(|line| line.is_closed()).count();
        assert_eq!(count(isolines(&grid, 5.0, 9, |column, _| column != 20)), 0);
        assert!(isolines(&grid, 0.1, 3, |_, _| true).is_empty());
        let mut holed = values.clone();
        holed[16 * 41 + 25] = f32::NAN;
        assert_eq!(count(isolines(&ValueGrid { columns: 41, values: &holed }, 5.0, 9, |_, _| true)), 2);
        assert!(isolines(&grid, 0.0, 9, |_, _| true).is_empty());
    }

    #[test]
    fn a_saddle_joins_what_its_middle_joins() {
        for (middle, count) in [(1.0, 2), (-1.0, 2)] {
            let values = [2.0, -2.0 + middle, -2.0 + middle, 2.0];
            let lines = isolines(&ValueGrid { columns: 2, values: &values }, 100.0, 9, |_, _| true);
            assert_eq!(lines.len(), count);
            assert!(lines.iter().all(|line| line.points.len() == 2 && line.level == 0));
        }
    }
}
