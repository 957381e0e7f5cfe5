//! The slopes of the ground at its posts.

use std::iter::once;

use glam::{DVec2, Vec2};

use crate::lattice::{Lattice, Post};

/// How many posts away the neighbors are from which slopes of earthworks on a densified lattice come. One shows a narrow
/// batter's edges as teeth; more would round the edge of a road that is four posts wide.
const WORKS_STEP: i64 = 2;

/// The rise over run from which the ground between posts of earthworks is a wall's: steeper than batters are, where one
/// side alone is.
const WALL_SLOPE: f32 = 2.5;

impl Lattice {
    /// The slopes at a post, rise per meter eastward and northward, by the weights of Horn (1981) over the eight
    /// neighbors, as `gdaldem` and most hillshades have them. Missing neighbors take the post's own height. Zero where the
    /// post has no data.
    ///
    /// On a densified lattice the neighbors of a post of the land are as far away as measured posts are: nearer ones lie on
    /// the planes between these, and would show the planes rather than the land. Pinned neighbors do not count there; the
    /// land is taken to continue straight from the opposite side. The neighbors of a pinned post and of those next to it
    /// are `WORKS_STEP` posts away: a batter's edges run aslant between posts, and slopes from post to post would show
    /// how each post lies to them, as teeth. What stands or falls like a wall beside them does not count either.
    pub fn slopes(&self, post: Post) -> Vec2 {
        let own = self.height(post);
        if own.is_nan() {
            return Vec2::ZERO;
        }
        let is_land = self.doublings() > 0 && !self.is_beside_works(post);
        let step = match self.doublings() {
            0 => 1,
            doublings if is_land => 1 << doublings,
            _ => WORKS_STEP,
        };
        let at = |east: i64, north: i64| -> f32 {
            let (east, north) = (east * step, north * step);
            let (there, opposite) = (self.beside(post, east, north), self.beside(post, -east, -north));
            let is_other = |other: Post| match (is_land, self.doublings()) {
                (true, _) => self.is_pinned(other),
                (false, 0) => false,
                (false, _) => {
                    let run_m = (self.cell() * DVec2::new(east as f64, north as f64)).length() as f32;
                    (self.height(other) - own).abs() > WALL_SLOPE * run_m
                }
            };
            let height = match (is_other(there), is_other(opposite)) {
                (true, false) => 2.0 * own - self.height(opposite),
                (true, true) if is_land => own,
                _ => self.height(there),
            };
            if height.is_nan() { own } else { height }
        };
        let east = (at(1, 1) + 2.0 * at(1, 0) + at(1, -1)) - (at(-1, 1) + 2.0 * at(-1, 0) + at(-1, -1));
        let north = (at(1, 1) + 2.0 * at(0, 1) + at(-1, 1)) - (at(1, -1) + 2.0 * at(0, -1) + at(-1, -1));
        let (low, high) = (self.beside(post, -step, -step), self.beside(post, step, step));
        let span = |low: u32, high: u32| 4.0 * (high - low) as f32;
        Vec2::new(
            east / (span(low.column, high.column) * self.cell().x as f32),
            north / (span(low.row, high.row) * self.cell().y as f32),
        )
    }

    /// Whether the post or one at most `WORKS_STEP` posts away is pinned.
    fn is_beside_works(&self, post: Post) -> bool {
        let columns = post.column.saturating_sub(WORKS_STEP as u32)
            ..=post.column.saturating_add(WORKS_STEP as u32).min(self.columns() - 1);
        let first = post.row.saturating_sub(WORKS_STEP as u32);
        let last = post.row.saturating_add(WORKS_STEP as u32).min(self.rows() - 1);
        (first..=last).any(|row| {
            let line = row as usize * self.columns() as usize;
            self.pinned()[line + *columns.start() as usize..=line + *columns.end() as usize].contains(&true)
        })
    }

    /// [`Lattice::slopes`] of the posts of a row, many times faster where the lattice is not densified.
    pub fn slopes_of_row(&self, row: u32) -> Vec<Vec2> {
        let posts = (0..self.columns()).map(|column| Post { column, row });
        if self.doublings() > 0 || row == 0 || row + 1 == self.rows() {
            return posts.map(|post| self.slopes(post)).collect();
        }
        let all = self.heights();
        let line = |row: u32| &all[row as usize * self.columns() as usize..][..self.columns() as usize];
        let span = (self.cell().as_vec2() * 8.0).to_array();
        let windows = line(row - 1).windows(3).zip(line(row).windows(3)).zip(line(row + 1).windows(3));
        let inner = windows.map(|((south, own), north)| {
            let east = (north[2] + 2.0 * own[2] + south[2]) - (north[0] + 2.0 * own[0] + south[0]);
            let up = (north[2] + 2.0 * north[1] + north[0]) - (south[2] + 2.0 * south[1] + south[0]);
            // NaN where any of the nine posts has no data.
            Vec2::new(east / span[0], up / span[1]) + 0.0 * own[1]
        });
        let mut slopes: Vec<Vec2> = once(Vec2::NAN).chain(inner).chain(once(Vec2::NAN)).collect();
        for (slopes, post) in slopes.iter_mut().zip(posts).filter(|(slopes, _)| slopes.is_nan()) {
            *slopes = self.slopes(post);
        }
        slopes
    }

    /// The post `east` columns and `north` rows away, or the last one in that direction.
    fn beside(&self, post: Post, east: i64, north: i64) -> Post {
        let column = (i64::from(post.column) + east).clamp(0, i64::from(self.columns()) - 1);
        let row = (i64::from(post.row) + north).clamp(0, i64::from(self.rows()) - 1);
        Post { column: column as u32, row: row as u32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::tests::plane;

    #[test]
    fn slopes_of_a_plane_are_exact_inside_and_at_the_border() {
        let lattice = plane();
        for post in lattice.posts() {
            assert!((lattice.slopes(post) - Vec2::new(0.2, -0.2)).length() < 1e-6, "{post:?}");
        }
    }

    #[test]
    fn slopes_of_a_row_are_those_of_its_posts_to_the_last_bit() {
        for columns in [2, 3, 9] {
            let height =
                |index: u32| if index % 23 == 7 { f32::NAN } else { (index * 7919 % 101) as f32 / 7.0 };
            let heights = (0..columns * 12).map(height).collect();
            let lattice = Lattice::new(DVec2::ZERO, DVec2::new(9.77, 3.1), columns, heights).expect("sound");
            for row in 0..12 {
                let slopes = (0..columns).map(|column| lattice.slopes(Post { column, row }));
                assert_eq!(lattice.slopes_of_row(row), slopes.collect::<Vec<_>>());
            }
        }
    }
}
