//! Gaps in the ground that a vehicle crosses: ditches no wider than its `gap_m` from rim to rim count as closed.
//!
//! The ground is closed along its rows, columns and diagonals (Serra 1982): each line of posts is raised where too few posts
//! lie between two higher ones for the vehicle to sink in, and the highest of the four lines counts, so that a ditch is
//! closed across whatever its direction, to 8 % of its width. The work needs posts closer than half the gap: on coarser
//! ground nothing changes.

use rayon::prelude::*;

use sandtable_terrain::lattice::{Lattice, Post};

/// The most posts from rim to rim that are closed, so that shards need no more ground around them than the catalog says.
const MOST_POSTS: usize = 8;

/// Steps by column and row of the lines along which ground is closed.
const LINES: [(usize, isize); 4] = [(1, 0), (0, 1), (1, 1), (1, -1)];

/// The ground with the gaps closed that a vehicle crosses; `None` where no gap is narrow enough to be one.
pub(crate) fn closed(ground: &Lattice, gap_m: f64) -> Option<Lattice> {
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let cell = ground.cell();
    let lengths = LINES.map(|(east, north)| {
        let step_m = libm::hypot(east as f64 * cell.x, north as f64 * cell.y);
        // A gap of `length` steps from rim to rim has one post fewer at its bottom.
        ((gap_m / step_m * (1.0 + 1e-9)) as usize).min(MOST_POSTS)
    });
    if lengths.iter().all(|&length| length < 2) {
        return None;
    }
    let heights = ground.heights();
    let mut raised = ground.clone();
    let closed_row = |row: usize| {
        let mut line = heights[row * columns..][..columns].to_vec();
        for (column, value) in line.iter_mut().enumerate().filter(|(_, value)| !value.is_nan()) {
            for (&(east, north), &length) in LINES.iter().zip(&lengths) {
                let post = |step: isize| {
                    let column = column.checked_add_signed(step * east as isize)?;
                    let row = row.checked_add_signed(step * north)?;
                    let height = (column < columns && row < rows).then(|| heights[row * columns + column])?;
                    (!height.is_nan()).then_some(height)
                };
                *value = value.max(closed_height(post, length));
            }
        }
        line
    };
    // A block of rows at a time bounds the memory.
    for first in (0..rows).step_by(64) {
        let block: Vec<Vec<f32>> = (first..(first + 64).min(rows)).into_par_iter().map(closed_row).collect();
        for (line, row) in block.into_iter().zip(first..) {
            let post = Post { column: 0, row: row as u32 };
            raised.heights_mut(post, columns as u32 - 1).copy_from_slice(&line);
        }
    }
    Some(raised)
}

/// The height of step 0 of a line, closed over gaps of up to `length` steps from rim to rim: the least of the maxima of the
/// windows of `length` posts that hold it. The line ends where there is no post; where no window fits, the ground stays.
fn closed_height(post: impl Fn(isize) -> Option<f32>, length: usize) -> f32 {
    let own = post(0).unwrap_or(f32::NEG_INFINITY);
    // The highest of so many posts on either side.
    let mut highest = [[own; MOST_POSTS]; 2];
    for (side, highest) in highest.iter_mut().enumerate() {
        for count in 1..length {
            let step = if side == 0 { -(count as isize) } else { count as isize };
            highest[count] = highest[count - 1].max(post(step).unwrap_or(f32::INFINITY));
        }
    }
    let windows = (0..length).map(|count| highest[0][count].max(highest[1][length - 1 - count]));
    let closed = windows.fold(f32::INFINITY, f32::min);
    if closed.is_finite() { closed } else { own }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::movement::going::{Going, RESTRICTED, SEVERELY_RESTRICTED, UNRESTRICTED};
    use crate::movement::vehicle::Vehicle;
    use crate::test_land::shaped;

    /// Ground of half a meter with a ditch 2 m deep of so many posts at its bottom, which runs to the north.
    fn ditch(bottom: u32) -> crate::land::Land {
        shaped(24, 12, 0.5, |column, _| if (10..10 + bottom).contains(&column) { -2.0 } else { 0.0 })
    }

    #[test]
    fn ditches_up_to_the_gap_from_rim_to_rim_are_closed_and_wider_ones_are_not() {
        for bottom in 1..6 {
            let land = ditch(bottom);
            let width_m = f64::from(bottom + 1) * 0.5;
            for gap_m in [0.5, 1.0, 1.4, 1.5, 2.0, 2.5, 3.5] {
                let least = match closed(&land.ground, gap_m) {
                    Some(closed) => closed.heights().iter().copied().fold(f32::INFINITY, f32::min),
                    None => -2.0,
                };
                assert_eq!(least, if width_m <= gap_m { 0.0 } else { -2.0 }, "{width_m} m by {gap_m}");
            }
        }
    }

    #[test]
    fn ditches_of_any_direction_are_closed_and_banks_and_slopes_stay() {
        let slanted =
            shaped(30, 30, 0.5, |column, row| if column == row || column == row + 1 { -2.0 } else { 1.0 });
        let closed_ground = closed(&slanted.ground, 1.5).expect("closed");
        let inner = slanted.ground.posts().filter(|post| post.grid().min_element() > 3.0);
        let inner = inner.filter(|post| post.grid().max_element() < 26.0);
        assert!(inner.map(|post| closed_ground.height(post)).all(|height| height == 1.0));
        let bank = shaped(30, 6, 0.5, |column, _| if column == 12 { 3.0 } else { column as f32 * 0.2 });
        let heights = closed(&bank.ground, 2.0).expect("closed");
        let low = |column: u32| heights.height(Post { column, row: 3 });
        assert_eq!((low(5), low(12), low(20)), (1.0, 3.0, 4.0));
    }

    #[test]
    fn a_vehicle_crosses_a_ditch_slowly_that_stops_another() {
        let code = |name: &str, bottom: u32| {
            let vehicle = Vehicle::built_in(name).expect("built in");
            let going = Going::new(&ditch(bottom), &vehicle).expect("memory");
            (going.codes[6 * 24 + 10], going.codes[6 * 24 + 3])
        };
        // Gaps of 2.5 m and of 0.5 m.
        assert_eq!(code("tracked", 3), (RESTRICTED, UNRESTRICTED));
        assert_eq!(code("truck", 3), (SEVERELY_RESTRICTED, UNRESTRICTED));
        assert_eq!(code("tracked", 6), (SEVERELY_RESTRICTED, UNRESTRICTED));
    }

    #[test]
    fn coarse_ground_and_ground_without_data_stay() {
        let coarse = shaped(9, 9, 10.0, |column, _| if column == 4 { -2.0 } else { 0.0 });
        assert!(closed(&coarse.ground, 2.5).is_none());
        let holes = shaped(9, 9, 0.5, |column, row| if column == 4 { f32::NAN } else { row as f32 });
        let closed_ground = closed(&holes.ground, 3.0).expect("closed");
        let nans = |heights: &[f32]| heights.iter().filter(|height| height.is_nan()).count();
        assert_eq!(nans(closed_ground.heights()), 9);
        assert!(closed(&shaped(2, 2, 0.5, |_, _| f32::NAN).ground, 10_000.0).is_some());
    }
}
