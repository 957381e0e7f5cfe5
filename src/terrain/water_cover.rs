//! Water that the elevation model itself shows: the sea, and lakes without a vector file.
//!
//! Two rules, both about connected posts (neighbors east, north, west and south):
//!
//! - **Sea**: posts at or below 0 m that are connected to the border of the model, unless most of the land beside them
//!   rises from them like a wall: then they are a margin without data.
//! - **Lakes**: posts of one height, at least [`LEAST_POSTS`] of them, as surveys level standing water, of whose
//!   neighbors nearly all lie higher. The outlet is lower; a terrace of a model with whole meters has about as many lower
//!   neighbors as higher ones. Ground that a feature has shaped is no lake.
//!
//! Both are inferred from heights alone: a polder open to the border is taken for sea.

use glam::DVec2;

use crate::lattice::Lattice;

/// The fewest posts of a lake or a sea: fewer happen to be level.
pub const LEAST_POSTS: usize = 200;

/// The heights of one lake differ by less, meters: what remains of a level survey after warping to another grid.
const LEVEL_M: f32 = 0.01;

/// Land beside the sea that is higher than this many meters and half a cell stands like a wall.
const WALL_M: f32 = 20.0;

/// The greatest share of lower posts among those beside a lake.
const MOST_LOWER: f64 = 0.04;

/// Posts under water.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WaterCover {
    /// Whether each post is under water, row by row from the south-west; empty where none is.
    pub is_water: Vec<bool>,
    /// Posts of the sea.
    pub sea_posts: usize,
    /// Posts of each lake, in the order of their south-western posts.
    pub lakes: Vec<usize>,
}

impl WaterCover {
    /// Whether the point at `world` of `lattice`, whose cover this is, lies under water: the shore runs where half of what
    /// the posts around a point say is water.
    pub fn is_under(&self, lattice: &Lattice, world: DVec2) -> bool {
        let Some((shares, part)) = self.corner_shares(lattice, world) else { return false };
        let [south, north] = shares.map(|[west, east]| west + (east - west) * part.x);
        south + (north - south) * part.y > 0.5
    }

    /// Whether any post around the point at `world` of `lattice`, whose cover this is, lies under water.
    pub fn is_beside(&self, lattice: &Lattice, world: DVec2) -> bool {
        self.corner_shares(lattice, world).is_some_and(|(shares, _)| shares.as_flattened().contains(&1.0))
    }

    /// 1 for each corner of a point's cell that is under water, in rows from the south, and the place in the cell; `None`
    /// outside, and where no post is under water.
    fn corner_shares(&self, lattice: &Lattice, world: DVec2) -> Option<([[f64; 2]; 2], DVec2)> {
        let (cell, part) = lattice.cell_at(world).filter(|_| !self.is_water.is_empty())?;
        let share = |column: u32, row: u32| {
            let post = cell.offset(
                column.min(lattice.columns() - 1 - cell.column),
                row.min(lattice.rows() - 1 - cell.row),
            );
            f64::from(u8::from(self.is_water[lattice.index(post)]))
        };
        Some(([0, 1].map(|row| [0, 1].map(|column| share(column, row))), part))
    }
}

/// The water of a lattice of elevations in meters, by the rules of this module. Time and memory are linear in the number of posts.
pub fn water_cover(lattice: &Lattice) -> WaterCover {
    let heights = lattice.heights();
    let mut search = WaterSearch { lattice, state: vec![PostState::New; heights.len()], posts: Vec::new() };
    let mut cover = WaterCover::default();
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    for row in 0..rows {
        // Of the rows between the first and the last, only the ends lie on the border.
        let step = if row == 0 || row + 1 == rows { 1 } else { columns - 1 };
        for index in (row * columns..(row + 1) * columns).step_by(step) {
            if heights[index] <= 0.0 && search.state[index] == PostState::New {
                cover.sea_posts += search.keep(index, 0.0, |height| height <= 0.0, |region| region.is_sea());
            }
        }
    }
    for (row, line) in heights.chunks_exact(columns).enumerate() {
        for (column, pair) in line.windows(2).enumerate() {
            let (level, index) = (pair[0], row * columns + column);
            if level == pair[1] && search.state[index] == PostState::New {
                let belongs = |height: f32| (height - level).abs() < LEVEL_M;
                let lake = search.keep(index, level, belongs, |region| region.is_lake(lattice));
                cover.lakes.extend((lake > 0).then_some(lake));
            }
        }
    }
    if cover.sea_posts > 0 || !cover.lakes.is_empty() {
        cover.is_water = search.state.iter().map(|&state| state == PostState::Water).collect();
    }
    cover
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PostState {
    New,
    Land,
    Water,
}

struct WaterSearch<'a> {
    lattice: &'a Lattice,
    state: Vec<PostState>,
    /// Of the region that was found last; kept for its memory.
    posts: Vec<usize>,
}

/// Connected posts and how many are beside them.
struct Region<'a> {
    posts: &'a [usize],
    higher: usize,
    lower: usize,
    /// Of those that are higher, those far above.
    walls: usize,
}

impl Region<'_> {
    fn is_sea(&self) -> bool {
        self.posts.len() >= LEAST_POSTS && 2 * self.walls <= self.higher
    }

    fn is_lake(&self, lattice: &Lattice) -> bool {
        self.posts.len() >= LEAST_POSTS
            && self.lower as f64 <= MOST_LOWER * (self.lower + self.higher) as f64
            && !self.posts.iter().any(|&index| lattice.pinned()[index])
    }
}

impl WaterSearch<'_> {
    /// Marks the posts connected to the one at index `first` whose heights `belong` as water where `is_water` holds of
    /// them, and as land otherwise; the number of posts of water. Heights beside them are compared with `level`.
    fn keep(
        &mut self,
        first: usize,
        level: f32,
        belongs: impl Fn(f32) -> bool,
        is_water: impl Fn(&Region) -> bool,
    ) -> usize {
        let Self { lattice, state, posts } = self;
        let (heights, columns) = (lattice.heights(), lattice.columns() as usize);
        let wall = level + WALL_M + lattice.cell().max_element() as f32 / 2.0;
        let (mut higher, mut lower, mut walls) = (0, 0, 0);
        state[first] = PostState::Land;
        posts.clear();
        posts.push(first);
        let mut visited = 0;
        while let Some(&post) = posts.get(visited) {
            visited += 1;
            let column = post % columns;
            let mut visit = |next: usize| {
                let height = heights[next];
                if belongs(height) {
                    if state[next] == PostState::New {
                        state[next] = PostState::Land;
                        posts.push(next);
                    }
                } else if height > level {
                    higher += 1;
                    walls += usize::from(height > wall);
                } else if height < level {
                    lower += 1;
                }
            };
            if column + 1 < columns {
                visit(post + 1);
            }
            if post + columns < heights.len() {
                visit(post + columns);
            }
            if column > 0 {
                visit(post - 1);
            }
            if post >= columns {
                visit(post - columns);
            }
        }
        if !is_water(&Region { posts, higher, lower, walls }) {
            return 0;
        }
        posts.iter().for_each(|&index| state[index] = PostState::Water);
        posts.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Post;

    fn lattice(height: impl Fn(f32, f32) -> f32) -> Lattice {
        let heights = (0..60 * 50).map(|index| height((index % 60) as f32, (index / 60) as f32)).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 60, heights).expect("sound")
    }

    fn bowl(x: f32, y: f32) -> f32 {
        (f32::hypot(x - 30.0, y - 25.0) - 10.0).max(0.0) + 300.0
    }

    #[test]
    fn a_level_basin_is_a_lake() {
        let cover = water_cover(&lattice(bowl));
        assert_eq!(cover.lakes.len(), 1);
        assert!((290..330).contains(&cover.lakes[0]), "a disk of radius 10: {:?}", cover.lakes);
        assert_eq!(cover.is_water.iter().filter(|&&is_water| is_water).count(), cover.lakes[0]);
        assert!(cover.is_water[25 * 60 + 30] && !cover.is_water[25 * 60 + 45]);
        let ground = lattice(bowl);
        let shore = (0..600).find(|&x| !cover.is_under(&ground, DVec2::new(300.0 + f64::from(x), 250.0)));
        assert_eq!(shore, Some(105), "between the tenth post, which is water, and the next");
        let beside = [106.0, 112.0].map(|x| cover.is_beside(&ground, DVec2::new(300.0 + x, 250.0)));
        assert_eq!(beside, [true, false], "in the cell of the shore, and in the next");
        assert!(!cover.is_under(&ground, DVec2::new(-9.0, 250.0)));
        assert!(!WaterCover::default().is_under(&ground, DVec2::new(300.0, 250.0)));
    }

    #[test]
    fn an_outlet_leaves_a_lake_a_lake_and_a_terrace_is_none() {
        let outlet = |x: f32, y: f32| if x > 40.0 && y == 25.0 { 299.0 } else { bowl(x, y) };
        assert_eq!(water_cover(&lattice(outlet)).lakes.len(), 1);
        let terraces = lattice(|x, y| ((x + y) / 15.0).floor() + 100.0);
        assert_eq!(water_cover(&terraces), WaterCover::default());
    }

    #[test]
    fn the_sea_is_what_lies_at_or_below_0_up_to_the_border() {
        let coast =
            lattice(
                |x, y| if y < 20.0 { -x } else { y - 19.0 - if x > 40.0 && y == 30.0 { 40.0 } else { 0.0 } },
            );
        let cover = water_cover(&coast);
        assert_eq!(cover.sea_posts, 20 * 60, "20 rows; the channel is too small");
        assert!(cover.lakes.is_empty());
        let enclosed = lattice(|x, y| f32::hypot(x - 30.0, y - 25.0) - 12.0);
        assert_eq!(water_cover(&enclosed), WaterCover::default(), "a hollow below 0 far from the border");
    }

    #[test]
    fn a_sea_with_its_depths_is_a_sea() {
        let shelf = lattice(|_, y| if y < 20.0 { -500.0 } else { y - 19.0 });
        assert_eq!(water_cover(&shelf).sea_posts, 20 * 60);
    }

    #[test]
    fn a_margin_of_zeros_around_high_ground_is_no_sea() {
        let margin = lattice(|x, y| if x < 10.0 || y < 8.0 { 0.0 } else { 400.0 + x * y });
        assert_eq!(water_cover(&margin).sea_posts, 0);
    }

    #[test]
    fn ground_that_a_feature_has_shaped_is_no_lake() {
        let mut pad = lattice(bowl);
        pad.pin(Post { column: 30, row: 25 }, 300.0);
        assert_eq!(water_cover(&pad), WaterCover::default());
    }

    #[test]
    fn posts_without_data_are_neither_water_nor_beside_it() {
        let holed = lattice(|x, y| if bowl(x, y) > 300.0 { f32::NAN } else { 300.0 });
        assert_eq!(water_cover(&holed).lakes, [317], "all that is known around it is nothing");
    }
}
