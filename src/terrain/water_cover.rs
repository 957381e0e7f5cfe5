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

use crate::terrain::lattice::{Lattice, Post};

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

/// The water of a lattice of elevations in meters, by the rules of this module. Time and memory are linear in the number of posts.
pub fn water_cover(lattice: &Lattice) -> WaterCover {
    let mut search =
        WaterSearch { lattice, state: vec![PostState::New; lattice.heights().len()], stack: Vec::new() };
    let mut cover = WaterCover::default();
    let (columns, rows) = (lattice.columns(), lattice.rows());
    for post in lattice.posts() {
        let on_border =
            post.column == 0 || post.row == 0 || post.column + 1 == columns || post.row + 1 == rows;
        if on_border && search.is_new(post) && lattice.height(post) <= 0.0 {
            cover.sea_posts += search.keep(post, 0.0, |height| height <= 0.0, Region::is_sea);
        }
    }
    for post in lattice.posts().filter(|&post| post.column + 1 < columns) {
        let level = lattice.height(post);
        if search.is_new(post) && level == lattice.height(post.offset(1, 0)) {
            let lake = search.keep(
                post,
                level,
                |height| (height - level).abs() < LEVEL_M,
                |region| region.is_lake(lattice),
            );
            cover.lakes.extend((lake > 0).then_some(lake));
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
    stack: Vec<Post>,
}

/// Connected posts and how many are beside them.
struct Region {
    posts: Vec<usize>,
    higher: usize,
    lower: usize,
    /// Of those that are higher, those far above.
    walls: usize,
}

impl Region {
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
    fn is_new(&self, post: Post) -> bool {
        self.state[self.lattice.index(post)] == PostState::New
    }

    /// Marks the region of `first` whose heights `belong` as water where `is_water` holds, and as land otherwise; the
    /// number of posts of water. Heights beside the region are compared with `level`.
    fn keep(
        &mut self,
        first: Post,
        level: f32,
        belongs: impl Fn(f32) -> bool,
        is_water: impl Fn(&Region) -> bool,
    ) -> usize {
        let region = self.region(first, level, belongs);
        if !is_water(&region) {
            return 0;
        }
        region.posts.iter().for_each(|&index| self.state[index] = PostState::Water);
        region.posts.len()
    }

    /// The posts connected to `first` whose heights `belong`, all marked as land.
    fn region(&mut self, first: Post, level: f32, belongs: impl Fn(f32) -> bool) -> Region {
        let lattice = self.lattice;
        let mut region = Region { posts: Vec::new(), higher: 0, lower: 0, walls: 0 };
        let wall = level + WALL_M + lattice.cell().max_element() as f32 / 2.0;
        self.state[lattice.index(first)] = PostState::Land;
        self.stack.push(first);
        while let Some(post) = self.stack.pop() {
            region.posts.push(lattice.index(post));
            for next in neighbors(lattice, post) {
                let (index, height) = (lattice.index(next), lattice.height(next));
                if belongs(height) {
                    if self.state[index] == PostState::New {
                        self.state[index] = PostState::Land;
                        self.stack.push(next);
                    }
                } else if height > level {
                    region.higher += 1;
                    region.walls += usize::from(height > wall);
                } else if height < level {
                    region.lower += 1;
                }
            }
        }
        region
    }
}

fn neighbors(lattice: &Lattice, Post { column, row }: Post) -> impl Iterator<Item = Post> {
    let east = (column + 1 < lattice.columns()).then_some(Post { column: column + 1, row });
    let north = (row + 1 < lattice.rows()).then_some(Post { column, row: row + 1 });
    let west = column.checked_sub(1).map(|column| Post { column, row });
    let south = row.checked_sub(1).map(|row| Post { column, row });
    [east, north, west, south].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

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
