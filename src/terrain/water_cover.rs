//! Water that the elevation model itself shows: the sea, and lakes without a vector file.
//!
//! The rules are about connected posts (neighbors east, north, west and south):
//!
//! - **Sea**, where no level is stated: level ground at 0 m that is connected to the border of the model, at least
//!   [`LEAST_POSTS`] of it, as surveys leave the sea. Most of the ground beside it is higher; a band of zeros on a plain that
//!   falls through 0 m has as much lower ground as higher. Where most of the land rises from it like a wall, it is a margin
//!   without data. Pits in it, which are noise, belong to it.
//! - **Sea**, at a stated level: posts at or below it that are connected to the border.
//! - **Lakes**: posts of one height, at least [`LEAST_POSTS`] of them, as surveys level standing water, of whose
//!   neighbors nearly all lie higher. The outlet is lower; a terrace of a model with whole meters has about as many lower
//!   neighbors as higher ones. Ground that a feature has shaped is no lake.
//!
//! Ground below 0 m alone is no sea: polders, the Jordan valley and the plains of Mars are dry.

use std::ops::Range;

use bytemuck::Zeroable;
use glam::DVec2;
use rayon::prelude::*;

use crate::lattice::Lattice;
use crate::level_regions::large_region_posts;
use crate::low_regions::{LowGround, LowRegion};
use crate::returned_memory::returned_zeros;
use crate::terraces::are_whole;

/// The fewest posts of a lake or a sea without a stated level: fewer happen to be level.
pub const LEAST_POSTS: usize = 200;

/// The heights of one lake differ by less, meters: what remains of a level survey after warping to another grid.
const LEVEL_M: f32 = 0.01;

/// Land beside the sea that is higher than this many meters and half a cell stands like a wall.
const WALL_M: f32 = 20.0;

/// The greatest share of lower posts among those beside a lake.
const MOST_LOWER: f64 = 0.04;

/// The same beside the sea: land behind dikes that the model does not show lies lower.
const MOST_LOWER_AT_SEA: f64 = 0.25;

/// With more posts than this for each lower one beside it, level ground at 0 m is the sea whatever the share of these: no
/// plain is so level, and beside a sea with that many posts there may be nothing but polders.
const WIDE_POSTS: usize = 250;

/// What is taken for water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterRules {
    /// Whether level ground is: the sea at 0 m, unless its level is stated, and lakes. Default: it is.
    pub infers_level: bool,
    /// The stated level of the sea in meters. Default: none.
    pub sea_level_m: Option<f32>,
}

/// Posts under water.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WaterCover {
    /// Whether each post is under water, row by row from the south-west; empty where none is.
    pub is_water: Vec<bool>,
    /// Posts of the sea.
    pub sea_posts: usize,
    /// Posts of each lake, in the order of their south-western posts.
    pub lakes: Vec<usize>,
    /// Posts below 0 m that are no sea, without a stated level, in regions of at least [`LEAST_POSTS`]; some may be lakes.
    pub low_posts: usize,
    /// Those of them that are connected to the border.
    pub open_low_posts: usize,
}

impl Default for WaterRules {
    fn default() -> Self {
        Self { infers_level: true, sea_level_m: None }
    }
}

impl WaterRules {
    /// The greatest elevation of a post of the sea, in meters.
    pub fn highest_sea_m(&self) -> f32 {
        self.sea_level_m.unwrap_or(LEVEL_M)
    }
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
pub fn water_cover(lattice: &Lattice, rules: &WaterRules) -> WaterCover {
    let heights = lattice.heights();
    let state = returned_zeros(heights.len());
    let mut search = WaterSearch { lattice, state, posts: Vec::new() };
    let mut cover = WaterCover::default();
    match rules.sea_level_m {
        Some(level_m) => cover.sea_posts = search.sea_at(level_m),
        None if rules.infers_level => {
            search.sort_low_ground(&mut cover);
            cover.sea_posts = search.level_sea();
        }
        None => {}
    }
    if rules.infers_level {
        cover.lakes = search.lakes();
    }
    if cover.sea_posts > 0 || !cover.lakes.is_empty() {
        cover.is_water = search.state.iter().map(|&state| state == PostState::Water).collect();
    }
    cover
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Zeroable)]
#[repr(u8)]
enum PostState {
    #[default]
    New,
    /// Of a few posts below 0 m among zeros.
    Pit,
    /// A pit in a region of zeros that was found.
    FoundPit,
    Land,
    Water,
}

impl PostState {
    /// Whether a post is a pit among zeros.
    fn is_pit(self) -> bool {
        matches!(self, Self::Pit | Self::FoundPit)
    }

    /// Whether a search for water has not found the post yet.
    fn is_open(self) -> bool {
        matches!(self, Self::New | Self::Pit)
    }

    /// The state of an open post that a search for water has found.
    fn found(self) -> Self {
        if self.is_pit() { Self::FoundPit } else { Self::Land }
    }
}

struct WaterSearch<'a> {
    lattice: &'a Lattice,
    state: Vec<PostState>,
    /// Of the region that was found last, by index; kept for its memory. A lattice has fewer than 2³² posts.
    posts: Vec<u32>,
}

/// How many posts beside a region lie higher and lower.
#[derive(Clone, Copy, Debug, Default)]
struct RegionSides {
    higher: usize,
    lower: usize,
    /// Of those that are higher, those far above.
    walls: usize,
}

impl RegionSides {
    /// Whether `posts` level posts at 0 m with these sides are the sea.
    fn is_sea(&self, posts: usize) -> bool {
        let beside = (self.lower + self.higher) as f64;
        let is_low = self.lower as f64 <= MOST_LOWER_AT_SEA * beside || self.lower * WIDE_POSTS <= posts;
        posts >= LEAST_POSTS && 2 * self.walls <= self.higher && is_low
    }

    /// Whether `posts` level posts with these sides are a lake.
    fn is_lake(&self, posts: usize) -> bool {
        posts >= LEAST_POSTS && self.lower as f64 <= MOST_LOWER * (self.lower + self.higher) as f64
    }
}

impl WaterSearch<'_> {
    /// The posts at the border.
    fn border(&self) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.lattice.columns() as usize, self.lattice.rows() as usize);
        (0..rows).flat_map(move |row| {
            // Of the rows between the first and the last, only the ends lie on the border.
            let step = if row == 0 || row + 1 == rows { 1 } else { (columns - 1).max(1) };
            (row * columns..(row + 1) * columns).step_by(step)
        })
    }

    /// Marks what lies at or below a stated level and is connected to the border as water; the number of its posts.
    fn sea_at(&mut self, level_m: f32) -> usize {
        let mut count = 0;
        for index in self.border() {
            if self.lattice.heights()[index] <= level_m && self.state[index].is_open() {
                self.find(index, level_m, |height, _| height <= level_m);
                count += self.flood();
            }
        }
        count
    }

    /// Parts the ground below 0 m into pits and low ground, which is counted.
    fn sort_low_ground(&mut self, cover: &mut WaterCover) {
        let low = LowGround { level_m: LEVEL_M, least: LEAST_POSTS };
        let regions = low.regions(self.lattice.heights(), self.lattice.columns() as usize);
        for LowRegion { posts, is_at_border, .. } in
            regions.iter().filter(|region| region.posts >= LEAST_POSTS)
        {
            cover.low_posts += posts;
            cover.open_low_posts += if *is_at_border { *posts } else { 0 };
        }
        // A few posts that lie beside zeros at least as often as beside land are noise among these.
        let is_pit = |region: &LowRegion| region.posts < LEAST_POSTS && region.even >= region.higher;
        regions.posts_of(is_pit).for_each(|posts| self.state[posts].fill(PostState::Pit));
    }

    /// Marks the sea without a stated level as water; the number of its posts.
    fn level_sea(&mut self) -> usize {
        let is_zero = |height: f32, state: PostState| height.abs() < LEVEL_M || state.is_pit();
        let mut count = 0;
        for index in self.border() {
            if is_zero(self.lattice.heights()[index], self.state[index]) && self.state[index].is_open() {
                let sides = self.find(index, 0.0, is_zero);
                count += if sides.is_sea(self.posts.len()) { self.flood() } else { 0 };
            }
        }
        count
    }

    /// Marks lakes as water; the posts of each.
    fn lakes(&mut self) -> Vec<usize> {
        let heights = self.lattice.heights();
        let mut lakes = Vec::new();
        for index in level_posts(self.lattice) {
            let level = heights[index];
            if !self.state[index].is_open() {
                continue;
            }
            let belongs = |height: f32, _| (height - level).abs() < LEVEL_M;
            let sides = self.find(index, level, belongs);
            let is_shaped = || self.posts.iter().any(|&index| self.lattice.pinned()[index as usize]);
            if sides.is_lake(self.posts.len()) && !is_shaped() {
                lakes.push(self.flood());
            }
        }
        lakes
    }

    /// Marks the region that was found last as water; the number of its posts.
    fn flood(&mut self) -> usize {
        self.posts.iter().for_each(|&index| self.state[index as usize] = PostState::Water);
        self.posts.len()
    }

    /// Finds the posts connected to the one at index `first`, which `belongs`, that belong, too, by their height and state.
    /// Heights beside them are compared with `level`.
    fn find(&mut self, first: usize, level: f32, belongs: impl Fn(f32, PostState) -> bool) -> RegionSides {
        let Self { lattice, state, posts } = self;
        let (heights, columns) = (lattice.heights(), lattice.columns() as usize);
        let wall = level + WALL_M + lattice.cell().max_element() as f32 / 2.0;
        let mut sides = RegionSides::default();
        state[first] = state[first].found();
        posts.clear();
        posts.push(first as u32);
        let mut visited = 0;
        while let Some(&post) = posts.get(visited) {
            visited += 1;
            let post = post as usize;
            let column = post % columns;
            let mut visit = |next: usize| {
                let (height, before) = (heights[next], state[next]);
                if belongs(height, before) {
                    if before.is_open() {
                        state[next] = before.found();
                        posts.push(next as u32);
                    }
                } else if (height - level).abs() >= LEVEL_M {
                    sides.higher += usize::from(height > level);
                    sides.walls += usize::from(height > wall);
                    sides.lower += usize::from(height < level);
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
        sides
    }
}

/// Posts of a stretch of a row: few of rough ground hold two equal heights.
const STRETCH: usize = 256;

/// The stretches of rows, and the post east of each, of which something holds: all threads look, so that a search on one
/// passes most posts over.
fn stretches_where(lattice: &Lattice, holds: impl Fn(&[f32]) -> bool + Sync) -> Vec<Range<usize>> {
    let (heights, columns) = (lattice.heights(), lattice.columns() as usize);
    let of_row = |row: usize| {
        let (start, end) = (row * columns, (row + 1) * columns);
        let stretch = move |from: usize| from..(from + STRETCH + 1).min(end);
        (start..end).step_by(STRETCH).map(stretch).filter(|posts| holds(&heights[posts.clone()]))
    };
    (0..lattice.rows() as usize).into_par_iter().flat_map_iter(of_row).collect()
}

/// Posts, rising, among which is the first of every lake that is as high as the one east of it.
///
/// Where heights are whole numbers, those of one lake are equal, and no region of equal heights shares posts with another: small
/// ones need not be looked at.
fn level_posts(lattice: &Lattice) -> Box<dyn Iterator<Item = usize> + '_> {
    let (heights, columns) = (lattice.heights(), lattice.columns() as usize);
    if are_whole(heights) {
        let posts = large_region_posts(heights, columns, LEAST_POSTS);
        return Box::new(posts.into_iter().map(|index| index as usize));
    }
    let has_level = |posts: &[f32]| posts.windows(2).fold(false, |any, pair| any | (pair[0] == pair[1]));
    let stretches = stretches_where(lattice, has_level).into_iter();
    let level = move |&index: &usize| heights[index] == heights[index + 1];
    Box::new(stretches.flat_map(move |posts| (posts.start..posts.end - 1).filter(level)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Post;

    fn lattice(height: impl Fn(f32, f32) -> f32) -> Lattice {
        let heights = (0..60 * 50).map(|index| height((index % 60) as f32, (index / 60) as f32)).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 60, heights).expect("sound")
    }

    fn water_cover(lattice: &Lattice) -> WaterCover {
        super::water_cover(lattice, &WaterRules::default())
    }

    fn at_level(lattice: &Lattice, level_m: f32) -> WaterCover {
        super::water_cover(lattice, &WaterRules { sea_level_m: Some(level_m), ..WaterRules::default() })
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
    fn the_sea_is_level_ground_at_0_up_to_the_border() {
        let coast = |x: f32, y: f32| match (x, y) {
            (_, ..20.0) => 0.0,
            (40.0.., 30.0) => 0.0,
            _ => y - 19.0,
        };
        let cover = water_cover(&lattice(coast));
        assert_eq!(cover.sea_posts, 20 * 60, "20 rows; the channel is too small");
        assert!(cover.lakes.is_empty() && cover.low_posts == 0);
        let pits =
            |x: f32, y: f32| if y < 18.0 && x % 7.0 < 2.0 && y % 5.0 < 2.0 { -3.0 } else { coast(x, y) };
        assert_eq!(water_cover(&lattice(pits)).sea_posts, 20 * 60, "pits are noise");
        let enclosed = lattice(|x, y| f32::hypot(x - 30.0, y - 25.0) - 12.0);
        let cover = water_cover(&enclosed);
        assert!(cover.sea_posts == 0 && cover.lakes.is_empty() && cover.open_low_posts == 0, "{cover:?}");
    }

    type Height = fn(f32, f32) -> f32;

    /// At four rotations: a valley that falls to −70 m, a plain of whole meters that falls through 0, a level polder.
    #[test]
    fn dry_ground_below_0_that_meets_the_border_is_land() {
        let valley = |x: f32, y: f32| -20.0 - (30.0 - (x - 30.0).abs()) - y / 8.0;
        let plain = |x: f32, _: f32| (6.0 - x / 5.0).round();
        let polder = |x: f32, y: f32| if y > 45.0 { 4.0 } else { -3.5 - 0.02 * ((x * 3.0 + y * 7.0) % 11.0) };
        let grounds: [(&str, Height); 3] = [("valley", valley), ("plain", plain), ("polder", polder)];
        for (name, height) in grounds {
            for turn in 0..4 {
                let turned = |x: f32, y: f32| match turn {
                    0 => (x, y),
                    1 => (y * 1.2, x / 1.2),
                    2 => (59.0 - x, 49.0 - y),
                    _ => (59.0 - y * 1.2, 49.0 - x / 1.2),
                };
                let cover = water_cover(&lattice(|x, y| {
                    let (x, y) = turned(x, y);
                    height(x, y)
                }));
                assert_eq!(cover.sea_posts, 0, "{name} turned {turn} times");
                assert!(cover.is_water.is_empty(), "{name} turned {turn} times");
                assert!(cover.open_low_posts > 1000, "{name} turned {turn} times");
            }
        }
    }

    /// Whole meters from −2 to 3 without order, as radar measures a polder.
    #[test]
    fn noise_around_0_is_no_sea() {
        let noise = |x: f32, y: f32| {
            let mut bits = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B);
            bits ^= bits >> 15;
            bits = bits.wrapping_mul(0x2C1B_3C6D);
            ((bits >> 12) % 6) as f32 - 2.0
        };
        let cover = water_cover(&lattice(noise));
        assert_eq!((cover.sea_posts, cover.lakes.len()), (0, 0));
    }

    #[test]
    fn a_polder_beside_the_sea_stays_dry_and_a_lake_below_0_is_a_lake() {
        let coast = |x: f32, y: f32| match (x, y) {
            (_, ..20.0) => 0.0,
            (..12.0, ..21.0) => -4.0,
            (_, ..21.0) => 5.0,
            (_, ..48.0) => -4.0 - (x + y) * 0.02,
            _ => 9.0,
        };
        let cover = water_cover(&lattice(coast));
        assert_eq!(cover.sea_posts, 20 * 60);
        assert_eq!(cover.open_low_posts, 27 * 60 + 12, "behind a dike with a gap");
        assert!(!cover.is_water[30 * 60 + 30]);
        let dead_sea = lattice(|x, y| if y < 20.0 { -430.0 } else { -430.0 + (y - 19.0) + x * 0.01 });
        let cover = water_cover(&dead_sea);
        assert_eq!((cover.sea_posts, cover.lakes), (0, vec![20 * 60]));
    }

    #[test]
    fn a_sea_with_its_depths_has_a_stated_level() {
        let shelf = lattice(|x, y| if y < 20.0 { -500.0 - x } else { y - 19.0 });
        assert_eq!(water_cover(&shelf).sea_posts, 0);
        let cover = at_level(&shelf, 0.0);
        assert_eq!((cover.sea_posts, cover.low_posts), (20 * 60, 0));
        assert_eq!(at_level(&shelf, 2.5).sea_posts, 22 * 60);
        assert_eq!(at_level(&shelf, -1000.0), WaterCover::default());
        let enclosed = lattice(|x, y| f32::hypot(x - 30.0, y - 25.0) - 12.0);
        assert_eq!(at_level(&enclosed, 0.0), WaterCover::default(), "a hollow far from the border");
        let rules = WaterRules { infers_level: false, sea_level_m: Some(0.0) };
        assert_eq!(super::water_cover(&shelf, &rules).sea_posts, 20 * 60);
        let rules = WaterRules { infers_level: false, sea_level_m: None };
        assert_eq!(super::water_cover(&lattice(bowl), &rules), WaterCover::default());
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
