//! Earthworks: changes to the ground, with the volumes they move.

use glam::DVec2;

use crate::geom::polygon;
use crate::geom::rect::Rect;
use crate::terrain::lattice::{Lattice, Post};

/// Earth moved, in cubic metres, each post standing for one cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Volumes {
    /// Taken away.
    pub cut_m3: f64,
    /// Put on.
    pub fill_m3: f64,
}

/// Levels the ground within a polygon to `level_m`, so that what lies there is perfectly flat.
///
/// Every corner of every cell that the polygon touches is set to the level and pinned; posts without data get
/// it too. `rings` are the outer ring and its holes in world coordinates.
pub fn level(lattice: &mut Lattice, rings: &[Vec<DVec2>], level_m: f32) -> Volumes {
    let mut volumes = Volumes::default();
    let cell_area = lattice.cell().x * lattice.cell().y;
    for post in posts_touched(lattice, rings) {
        let rise = f64::from(level_m) - f64::from(lattice.height(post));
        if rise > 0.0 {
            volumes.fill_m3 += rise * cell_area;
        } else if rise < 0.0 {
            volumes.cut_m3 -= rise * cell_area;
        }
        lattice.pin(post, level_m);
    }
    volumes
}

/// The corners of all cells that the polygon touches, in row order.
fn posts_touched(lattice: &Lattice, rings: &[Vec<DVec2>]) -> Vec<Post> {
    let touched = cells_touched(lattice, rings);
    let columns = lattice.columns() as usize - 1;
    let is_touched = |column: i64, row: i64| {
        let inside = column >= 0 && row >= 0 && (column as usize) < columns;
        inside && touched.get(row as usize * columns + column as usize).copied().unwrap_or(false)
    };
    lattice
        .posts()
        .filter(|post| {
            let (column, row) = (i64::from(post.column), i64::from(post.row));
            [(0, 0), (-1, 0), (0, -1), (-1, -1)].iter().any(|&(x, y)| is_touched(column + x, row + y))
        })
        .collect()
}

/// One flag a cell, row by row.
fn cells_touched(lattice: &Lattice, rings: &[Vec<DVec2>]) -> Vec<bool> {
    let (columns, rows) = (lattice.columns() as usize - 1, lattice.rows() as usize - 1);
    let mut touched = vec![false; columns * rows];
    let to_grid = |point: DVec2| point / lattice.cell();
    for (from, to) in rings.iter().flat_map(|ring| polygon::edges(ring)) {
        mark_line(&mut touched, (columns, rows), to_grid(from), to_grid(to));
    }
    let bounds = rings.iter().flatten().fold(Rect::EMPTY, |rect, &point| rect.with(to_grid(point)));
    let span = |low: f64, high: f64, count: usize| {
        (low.floor().max(0.0) as usize).min(count)..(high.ceil().max(0.0) as usize).min(count)
    };
    for row in span(bounds.min.y, bounds.max.y, rows) {
        for column in span(bounds.min.x, bounds.max.x, columns) {
            let center = DVec2::new(column as f64 + 0.5, row as f64 + 0.5) * lattice.cell();
            let cell = &mut touched[row * columns + column];
            *cell = *cell || polygon::contains(rings.iter().map(Vec::as_slice), center);
        }
    }
    touched
}

/// Marks the cells that a line in grid coordinates passes through, row by row of cells.
fn mark_line(touched: &mut [bool], (columns, rows): (usize, usize), from: DVec2, to: DVec2) {
    let (low, high) = if from.y <= to.y { (from, to) } else { (to, from) };
    let first_row = low.y.floor().max(0.0);
    let last_row = high.y.floor().min(rows as f64 - 1.0);
    let x_at = |y: f64| {
        let part = if high.y > low.y { ((y - low.y) / (high.y - low.y)).clamp(0.0, 1.0) } else { 0.0 };
        low.x + (high.x - low.x) * part
    };
    let mut row = first_row;
    while row <= last_row {
        let (enter, leave) = if high.y > low.y { (x_at(row), x_at(row + 1.0)) } else { (low.x, high.x) };
        let first = enter.min(leave).floor().max(0.0);
        let last = enter.max(leave).floor().min(columns as f64 - 1.0);
        let mut column = first;
        while column <= last {
            touched[row as usize * columns + column as usize] = true;
            column += 1.0;
        }
        row += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope() -> Lattice {
        let heights = (0..121).map(|index| (index % 11) as f32).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 11, heights).expect("sound")
    }

    #[test]
    fn the_whole_polygon_lies_on_level_cells() {
        let mut lattice = slope();
        let ring = vec![DVec2::new(32.0, 32.0), DVec2::new(58.0, 41.0), DVec2::new(44.0, 67.0)];
        level(&mut lattice, std::slice::from_ref(&ring), 5.0);
        for step in 0..200 {
            let (from, to) = polygon::edges(&ring).nth(step % 3).expect("three edges");
            let at = from.lerp(to, f64::from(step as u32 / 3) / 66.0).lerp(DVec2::new(44.0, 45.0), 0.001);
            let (cell, _) = lattice.cell_at(at).expect("inside");
            assert_eq!(lattice.corner_heights(cell), [5.0; 4], "at {at}");
        }
        assert_eq!(lattice.height(Post { column: 9, row: 9 }), 9.0);
    }

    #[test]
    fn volumes_count_what_was_moved() {
        let mut lattice = slope();
        let cell = vec![DVec2::new(31.0, 31.0), DVec2::new(39.0, 31.0), DVec2::new(35.0, 39.0)];
        let volumes = level(&mut lattice, &[cell], 3.0);
        assert_eq!(volumes, Volumes { cut_m3: 200.0, fill_m3: 0.0 });
    }

    #[test]
    fn a_polygon_outside_the_ground_changes_nothing() {
        let mut lattice = slope();
        let ring = vec![DVec2::new(-90.0, -90.0), DVec2::new(-50.0, -90.0), DVec2::new(-60.0, -40.0)];
        assert_eq!(level(&mut lattice, &[ring], 3.0), Volumes::default());
    }
}
