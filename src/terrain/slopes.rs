//! The slopes of the ground at its posts.

use glam::{DVec2, Vec2};

use crate::lattice::{Lattice, Post};

/// How many posts away the neighbors are from which slopes of earthworks on a densified lattice come. One shows a narrow
/// batter's edges as teeth; more would round the edge of a road that is four posts wide.
const WORKS_STEP: i64 = 2;

/// The rise over run from which the ground between posts of earthworks is a wall's: steeper than batters are, where one
/// side alone is.
const WALL_SLOPE: f32 = 2.5;

/// The columns eastward and the rows northward of the eight neighbors; each is four places from the opposite one.
const AROUND: [(i64, i64); 8] = [(1, 1), (1, 0), (1, -1), (0, 1), (-1, -1), (-1, 0), (-1, 1), (0, -1)];

/// What neighbors count for in slopes.
#[derive(Clone, Copy)]
enum SlopeWeights {
    /// Those of Horn (1981): what lies aside counts for half of what lies in line.
    Horn,
    /// Those of the cubic B-spline over the posts: what lies aside counts for a quarter.
    Spline,
}

impl SlopeWeights {
    fn aside(self) -> f32 {
        match self {
            Self::Horn => 1.0,
            Self::Spline => 0.5,
        }
    }
}

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
        self.weighted_slopes(post, SlopeWeights::Horn)
    }

    /// The slopes at a post by these weights; beside works by Horn's.
    fn weighted_slopes(&self, post: Post, weights: SlopeWeights) -> Vec2 {
        let own = self.height(post);
        if own.is_nan() {
            return Vec2::ZERO;
        }
        let is_land = self.doublings() > 0 && !self.is_beside_works(post);
        let (step, aside) = match self.doublings() {
            0 => (1, weights.aside()),
            doublings if is_land => (1 << doublings, weights.aside()),
            _ => (WORKS_STEP, SlopeWeights::Horn.aside()),
        };
        let beside = AROUND.map(|(east, north)| self.beside(post, east * step, north * step));
        let heights = beside.map(|other| self.height(other));
        let is_other: [bool; 8] = std::array::from_fn(|index| match (is_land, self.doublings()) {
            (true, _) => self.is_pinned(beside[index]),
            (false, 0) => false,
            (false, _) => {
                let (east, north) = AROUND[index];
                let away = DVec2::new((east * step) as f64, (north * step) as f64);
                let run_m = (self.cell() * away).length() as f32;
                (heights[index] - own).abs() > WALL_SLOPE * run_m
            }
        });
        let [ne, e, se, n, sw, w, nw, s] = std::array::from_fn(|index| {
            let opposite = (index + 4) % 8;
            let height = match (is_other[index], is_other[opposite]) {
                (true, false) => 2.0 * own - heights[opposite],
                (true, true) if is_land => own,
                _ => heights[index],
            };
            if height.is_nan() { own } else { height }
        });
        let east = (aside * ne + 2.0 * e + aside * se) - (aside * nw + 2.0 * w + aside * sw);
        let north = (aside * ne + 2.0 * n + aside * nw) - (aside * se + 2.0 * s + aside * sw);
        let (low, high) = (self.beside(post, -step, -step), self.beside(post, step, step));
        let span = |low: u32, high: u32| (2.0 + 2.0 * aside) * (high - low) as f32;
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

    /// [`Lattice::slopes`] of the posts of a row, many times faster where no pinned post is near.
    pub fn slopes_of_row(&self, row: u32) -> Vec<Vec2> {
        self.weighted_slopes_of_row(row, SlopeWeights::Horn)
    }

    /// The slopes by which a post is shaded; see [`Lattice::shaded_slopes_of_row`].
    pub fn shaded_slopes(&self, post: Post) -> Vec2 {
        self.weighted_slopes(post, SlopeWeights::Spline)
    }

    /// The slopes by which the posts of a row are shaded: those of [`Lattice::slopes`], but for weights that are those of the cubic
    /// B-spline over the posts. They keep forms two posts wide that Horn's weights level, and differences of the posts in line
    /// alone would show as dashes along the rows.
    pub fn shaded_slopes_of_row(&self, row: u32) -> Vec<Vec2> {
        self.weighted_slopes_of_row(row, SlopeWeights::Spline)
    }

    fn weighted_slopes_of_row(&self, row: u32, weights: SlopeWeights) -> Vec<Vec2> {
        let aside = weights.aside();
        let posts = (0..self.columns()).map(|column| Post { column, row });
        let (step, columns) = (1usize << self.doublings(), self.columns() as usize);
        if (row as usize) < step || row as usize + step >= self.rows() as usize || columns <= 2 * step {
            return posts.map(|post| self.weighted_slopes(post, weights)).collect();
        }
        let line = |row: usize| &self.heights()[row * columns..][..columns];
        let [south, own, north] = [row as usize - step, row as usize, row as usize + step].map(line);
        let span = (self.cell().as_vec2() * ((4.0 + 4.0 * aside) * step as f32)).to_array();
        let mut slopes = vec![Vec2::NAN; columns];
        let (inner, wide) = (columns - 2 * step, 2 * step);
        let [sw, s, se] = [0, step, wide].map(|from| &south[from..from + inner]);
        let [w, o, e] = [0, step, wide].map(|from| &own[from..from + inner]);
        let [nw, n, ne] = [0, step, wide].map(|from| &north[from..from + inner]);
        for (at, slope) in slopes[step..step + inner].iter_mut().enumerate() {
            let east = (aside * ne[at] + 2.0 * e[at] + aside * se[at])
                - (aside * nw[at] + 2.0 * w[at] + aside * sw[at]);
            let up = (aside * ne[at] + 2.0 * n[at] + aside * nw[at])
                - (aside * se[at] + 2.0 * s[at] + aside * sw[at]);
            // NaN where any of the nine posts has no data.
            *slope = Vec2::new(east / span[0], up / span[1]) + 0.0 * o[at];
        }
        for (column, _) in self.near_pinned(row).iter().enumerate().filter(|(_, is_near)| **is_near) {
            slopes[column] = Vec2::NAN;
        }
        for (slopes, post) in slopes.iter_mut().zip(posts).filter(|(slopes, _)| slopes.is_nan()) {
            *slopes = self.weighted_slopes(post, weights);
        }
        slopes
    }

    /// Which posts of a row of a densified lattice a pinned post may lie so near to that it has an effect on their slopes; empty
    /// where none does.
    fn near_pinned(&self, row: u32) -> Vec<bool> {
        if self.doublings() == 0 || !self.has_pins() {
            return Vec::new();
        }
        let (columns, row) = (self.columns() as usize, row as usize);
        let (reach, step) = (WORKS_STEP as usize, 1usize << self.doublings());
        let beside = (row.saturating_sub(reach)..=row + reach).chain([row.saturating_sub(step), row + step]);
        let mut pinned = vec![false; columns];
        for line in beside.filter(|&beside| beside < self.rows() as usize) {
            let line = &self.pinned()[line * columns..][..columns];
            pinned.iter_mut().zip(line).for_each(|(any, is_pinned)| *any |= is_pinned);
        }
        let reach = reach.max(step);
        let (mut near, mut end) = (Vec::new(), 0);
        for column in (0..columns).filter(|&column| pinned[column]) {
            near.resize(columns, false);
            let last = (column + reach).min(columns - 1);
            near[column.saturating_sub(reach).max(end)..=last].fill(true);
            end = last;
        }
        near
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
    use crate::densify::densify;
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
        for (columns, times) in [(2, 0), (3, 0), (9, 0), (3, 1), (9, 1), (9, 2), (7, 3)] {
            let height =
                |index: u32| if index % 23 == 7 { f32::NAN } else { (index * 7919 % 101) as f32 / 7.0 };
            let heights = (0..columns * 12).map(height).collect();
            let lattice = Lattice::new(DVec2::ZERO, DVec2::new(9.77, 3.1), columns, heights).expect("sound");
            let mut lattice = densify(&lattice, times).expect("few posts");
            for pinned in [0, 1, 5] {
                for number in 0..pinned {
                    let post = Post {
                        column: number * 5 % lattice.columns(),
                        row: (number * 11 + 3) % lattice.rows(),
                    };
                    lattice.pin(post, 4.0 + number as f32);
                }
                for row in 0..lattice.rows() {
                    let posts = || (0..lattice.columns()).map(|column| Post { column, row });
                    let bits = |slopes: Vec<Vec2>| {
                        slopes.iter().map(|at| at.to_array().map(f32::to_bits)).collect::<Vec<_>>()
                    };
                    let slopes = posts().map(|post| lattice.slopes(post)).collect();
                    assert_eq!(bits(lattice.slopes_of_row(row)), bits(slopes), "{columns} {times} {row}");
                    let shaded = posts().map(|post| lattice.shaded_slopes(post)).collect();
                    assert_eq!(
                        bits(lattice.shaded_slopes_of_row(row)),
                        bits(shaded),
                        "{columns} {times} {row}"
                    );
                }
            }
        }
    }

    #[test]
    fn shaded_slopes_keep_narrow_forms_that_horns_weights_level() {
        let height = |index: u32| if (index % 9 + index / 9) % 4 < 2 { 0.0 } else { 10.0 };
        let heights = (0..81).map(height).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(5.0), 9, heights).expect("sound");
        let post = Post { column: 4, row: 4 };
        let (shaded, leveled) = (lattice.shaded_slopes(post), lattice.slopes(post));
        assert!(shaded.length() > 1.3 * leveled.length(), "{shaded} {leveled}");
        let plane = plane();
        for post in plane.posts() {
            assert!((plane.shaded_slopes(post) - Vec2::new(0.2, -0.2)).length() < 1e-6, "{post:?}");
        }
    }

    /// Slopes written as their definition reads, a neighbor after the other.
    fn defined(lattice: &Lattice, post: Post) -> Vec2 {
        let own = lattice.height(post);
        if own.is_nan() {
            return Vec2::ZERO;
        }
        let is_land = lattice.doublings() > 0 && !lattice.is_beside_works(post);
        let step = match lattice.doublings() {
            0 => 1,
            doublings if is_land => 1 << doublings,
            _ => WORKS_STEP,
        };
        let at = |east: i64, north: i64| -> f32 {
            let (east, north) = (east * step, north * step);
            let (there, opposite) = (lattice.beside(post, east, north), lattice.beside(post, -east, -north));
            let is_other = |other: Post| match (is_land, lattice.doublings()) {
                (true, _) => lattice.is_pinned(other),
                (false, 0) => false,
                (false, _) => {
                    let run_m = (lattice.cell() * DVec2::new(east as f64, north as f64)).length() as f32;
                    (lattice.height(other) - own).abs() > WALL_SLOPE * run_m
                }
            };
            let height = match (is_other(there), is_other(opposite)) {
                (true, false) => 2.0 * own - lattice.height(opposite),
                (true, true) if is_land => own,
                _ => lattice.height(there),
            };
            if height.is_nan() { own } else { height }
        };
        let east = (at(1, 1) + 2.0 * at(1, 0) + at(1, -1)) - (at(-1, 1) + 2.0 * at(-1, 0) + at(-1, -1));
        let north = (at(1, 1) + 2.0 * at(0, 1) + at(-1, 1)) - (at(1, -1) + 2.0 * at(0, -1) + at(-1, -1));
        let (low, high) = (lattice.beside(post, -step, -step), lattice.beside(post, step, step));
        let run_m = |low: u32, high: u32, cell: f64| 4.0 * (high - low) as f32 * cell as f32;
        let cell = lattice.cell();
        Vec2::new(east / run_m(low.column, high.column, cell.x), north / run_m(low.row, high.row, cell.y))
    }

    #[test]
    fn slopes_beside_pinned_posts_and_walls_are_those_of_their_definition() {
        for times in 0..3 {
            let height = |index: u32| match index % 31 {
                7 => f32::NAN,
                11 => 90.0,
                _ => (index * 7919 % 101) as f32 / 7.0,
            };
            let lattice =
                Lattice::new(DVec2::ZERO, DVec2::new(9.77, 3.1), 11, (0..121).map(height).collect());
            let mut lattice = densify(&lattice.expect("sound"), times).expect("few posts");
            for number in 0..6 {
                let post =
                    Post { column: number * 7 % lattice.columns(), row: (number * 5 + 2) % lattice.rows() };
                lattice.pin(post, 60.0 * number as f32);
            }
            for post in lattice.posts() {
                let (found, wanted) = (lattice.slopes(post), defined(&lattice, post));
                assert_eq!(
                    found.to_array().map(f32::to_bits),
                    wanted.to_array().map(f32::to_bits),
                    "{times} {post:?}"
                );
            }
        }
    }
}
