//! The posts that lines pass: roads, bridges, walls.
//!
//! A thin line passes a chain of posts, each beside the next or diagonal to it, so that a wall has no gaps; a wide one
//! also all posts within half its width. Grid positions count from the larger lattice's first post, so that a part of the
//! ground gets the same posts as the whole. The work is bounded by the lattice, however far the line reaches beyond it.

use glam::{DVec2, Vec2Swizzles};

use sandtable_geom::segment::distance_squared;
use sandtable_terrain::lattice::Lattice;

/// Calls `mark` with the index of each post that a line of this width passes; some more than once.
pub fn along_line(ground: &Lattice, line: &[DVec2], width_m: f64, mut mark: impl FnMut(usize)) {
    let cell = ground.cell();
    let first = ground.first().grid();
    let grid = |at: DVec2| (at - ground.origin()) / cell;
    let mut post = |column: f64, row: f64| {
        let (column, row) = (column - first.x, row - first.y);
        let last = ground.last_grid();
        if column >= 0.0 && row >= 0.0 && column <= last.x && row <= last.y {
            mark(row as usize * ground.columns() as usize + column as usize);
        }
    };
    let is_sound = |at: &DVec2| at.is_finite() && at.abs().max_element() < 1e12;
    if line.len() == 1 && is_sound(&line[0]) {
        let at = grid(line[0]).round();
        post(at.x, at.y);
    }
    for ends in line.windows(2).filter(|ends| ends.iter().all(is_sound)) {
        let (from, to) = (grid(ends[0]), grid(ends[1]));
        for end in [from.round(), to.round()] {
            post(end.x, end.y);
        }
        let is_steep = (to.y - from.y).abs() > (to.x - from.x).abs();
        let (from, to) = if is_steep { (from.yx(), to.yx()) } else { (from, to) };
        let (from, to) = if from.x > to.x { (to, from) } else { (from, to) };
        let (least, greatest) = match is_steep {
            true => (first.y, first.y + ground.last_grid().y),
            false => (first.x, first.x + ground.last_grid().x),
        };
        let mut along = from.x.round().max(least);
        while along <= to.x.round().min(greatest) {
            let share =
                if to.x > from.x { ((along - from.x) / (to.x - from.x)).clamp(0.0, 1.0) } else { 0.0 };
            let across = (from.y + (to.y - from.y) * share).round();
            if is_steep {
                post(across, along)
            } else {
                post(along, across)
            }
            along += 1.0;
        }
        band(ground, [ends[0], ends[1]], width_m, &mut post);
    }
}

/// The posts within half the width of a segment, row by row.
fn band(ground: &Lattice, [from, to]: [DVec2; 2], width_m: f64, post: &mut impl FnMut(f64, f64)) {
    let (cell, half) = (ground.cell(), width_m / 2.0);
    if !(half >= cell.min_element() / 2.0 && half < 1e6) {
        return;
    }
    let (from, to) = (from - ground.origin(), to - ground.origin());
    let first = ground.first().grid();
    let last = first + ground.last_grid();
    let low = ((from.y.min(to.y) - half) / cell.y).ceil().max(first.y);
    let high = ((from.y.max(to.y) + half) / cell.y).floor().min(last.y);
    let mut row = low;
    while row <= high {
        let y = row * cell.y;
        let rise = to.y - from.y;
        let share = |y: f64| if rise == 0.0 { None } else { Some(((y - from.y) / rise).clamp(0.0, 1.0)) };
        let x = |y: f64, otherwise: f64| share(y).map_or(otherwise, |share| from.x + (to.x - from.x) * share);
        let ends = [x(y - half, from.x), x(y + half, to.x)];
        let mut column = ((ends[0].min(ends[1]) - half) / cell.x).ceil().max(first.x);
        let end = ((ends[0].max(ends[1]) + half) / cell.x).floor().min(last.x);
        while column <= end {
            if distance_squared((from, to), DVec2::new(column * cell.x, y)) <= half * half {
                post(column, row);
            }
            column += 1.0;
        }
        row += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::flat;
    use std::collections::BTreeSet;

    fn passed(line: &[DVec2], width_m: f64) -> BTreeSet<usize> {
        let land = flat(5, 4, 10.0);
        let mut posts = BTreeSet::new();
        along_line(&land.ground, line, width_m, |index| {
            posts.insert(index);
        });
        posts
    }

    #[test]
    fn a_thin_line_passes_a_chain_of_posts_and_ends_at_the_border() {
        let line = [DVec2::new(0.0, 0.0), DVec2::new(1e9, 1e9)];
        assert_eq!(passed(&line, 0.0), [0, 6, 12, 18].into());
        assert_eq!(passed(&[DVec2::new(f64::NAN, 0.0), DVec2::ZERO], 0.0), BTreeSet::new());
        assert_eq!(passed(&[DVec2::new(21.0, 14.0); 2], 0.0), [7].into());
    }

    #[test]
    fn a_wide_line_passes_all_posts_within_half_its_width() {
        let line = [DVec2::new(10.0, 12.0), DVec2::new(20.0, 12.0)];
        // Rows 1 and 2 are 2 m and 8 m off; row 0 is 12 m off.
        assert_eq!(passed(&line, 18.0), [6, 7, 11, 12].into());
    }
}
