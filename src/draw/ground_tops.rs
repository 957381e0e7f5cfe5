//! The highest land in blocks of a ground map, over which a ray passes in one step.
//!
//! ```text
//! level 0   blocks of 4 × 4 cells
//! level 1   blocks of 8 × 8 cells, each the highest of four
//! …
//! ```
//!
//! A ray that is above the top of a block where it enters and rises cannot meet the ground there (Tevs, Ihrke and Seidel
//! 2008). Water is no land: a ray over a lake finds nothing to meet.

use std::iter::successors;

use glam::UVec2;

use crate::ground::GroundMap;
use crate::ground_levels::PostCount;

/// The cells along a block of the finest level: fewer take memory, more take time where a ray passes close over land.
pub const BLOCK: u32 = 4;

/// The blocks of a map, level by level.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTops {
    /// The levels, the finest first, down to one block.
    pub levels: Vec<TopLevel>,
}

/// The blocks of one level.
#[derive(Clone, Debug, PartialEq)]
pub struct TopLevel {
    /// Columns and rows of blocks.
    pub size: UVec2,
    /// The height of the highest land of each, in meters, row by row from the south-west; minus infinity where all is water.
    pub heights_m: Vec<f32>,
}

impl GroundTops {
    /// The blocks of a checked map.
    pub fn new(map: &GroundMap) -> Self {
        let mut levels: Vec<TopLevel> = Vec::new();
        for size in Self::sizes(PostCount::from_map(map)) {
            let level = levels.last().map_or_else(|| finest(map, size), |finer| finer.halved(size));
            levels.push(level);
        }
        Self { levels }
    }

    /// The columns and rows of blocks of each level of a map with so many posts, the finest first.
    pub fn sizes(posts: PostCount) -> impl Iterator<Item = UVec2> {
        let cells = UVec2::new(posts.columns.max(2), posts.rows.max(2)) - 1;
        let finest = UVec2::new(cells.x.div_ceil(BLOCK), cells.y.div_ceil(BLOCK));
        successors(Some(finest), |size| (*size != UVec2::ONE).then(|| (*size + 1) / 2))
    }

    /// The height of the highest land of all, in meters.
    pub fn highest_m(&self) -> f32 {
        self.levels.last().map_or(f32::NEG_INFINITY, |level| level.top_m(UVec2::ZERO))
    }
}

impl TopLevel {
    /// The top of a block, in meters.
    pub fn top_m(&self, block: UVec2) -> f32 {
        let UVec2 { x, y } = block.min(self.size - 1);
        self.heights_m[y as usize * self.size.x as usize + x as usize]
    }

    /// The next level, of so many blocks.
    fn halved(&self, size: UVec2) -> Self {
        let of_four = |at: UVec2| {
            let corners = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE];
            corners.map(|corner| self.top_m(2 * at + corner)).into_iter().fold(f32::NEG_INFINITY, f32::max)
        };
        let blocks = (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)));
        Self { size, heights_m: blocks.map(of_four).collect() }
    }
}

fn finest(map: &GroundMap, size: UVec2) -> TopLevel {
    let mut heights_m = vec![f32::NEG_INFINITY; size.x as usize * size.y as usize];
    // On one thread: blocks are made at first use, on a thread of a pool that must not take up another use meanwhile.
    for (south, tops) in (0..).step_by(BLOCK as usize).zip(heights_m.chunks_mut(size.x as usize)) {
        for y in south..(south + BLOCK).min(map.rows.max(2) - 1) {
            add_row(map, y, tops);
        }
    }
    TopLevel { size, heights_m }
}

/// Raises `tops` to the cells between row `y` of the posts and the next.
fn add_row(map: &GroundMap, y: u32, tops: &mut [f32]) {
    let columns = map.columns as usize;
    let row = |y: u32| &map.posts[y.min(map.rows - 1) as usize * columns..][..columns];
    let (south, north) = (row(y), row(y + 1));
    let both = |x: usize| [&south[x], &north[x]];
    for x in 0..columns.max(2) - 1 {
        let [west, east] = [both(x), both((x + 1).min(columns - 1))];
        let corners = [west[0], west[1], east[0], east[1]];
        if corners.iter().any(|post| is_land(post.water)) {
            let top = &mut tops[x / BLOCK as usize];
            *top = corners.iter().fold(*top, |top, post| top.max(post.height_m));
        }
    }
}

/// Whether a post with that [`water`](crate::ground::GroundPost::water), or a place between posts, is no water.
pub fn is_land(water: f32) -> bool {
    water < 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ground::GroundPost;

    fn map(columns: u32, rows: u32, post: impl Fn(u32, u32) -> (f32, f32)) -> GroundMap {
        let post = |index: u32| {
            let (height_m, water) = post(index % columns, index / columns);
            GroundPost { height_m, water, ..GroundPost::default() }
        };
        let posts = (0..columns * rows).map(post).collect();
        GroundMap { columns, rows, posts, ..GroundMap::level() }
    }

    #[test]
    fn no_land_of_a_block_is_higher_than_its_top_at_any_level() {
        for (columns, rows) in [(33, 17), (6, 41), (2, 2), (1, 9), (1, 1)] {
            let height = |x: u32, y: u32| ((x * 37 + y * 101) % 53) as f32;
            let map = map(columns, rows, |x, y| (height(x, y), 0.0));
            let tops = GroundTops::new(&map);
            for (level, number) in tops.levels.iter().zip(0..) {
                for y in 0..rows {
                    for x in 0..columns {
                        let block = UVec2::new(x, y) / (BLOCK << number);
                        assert!(level.top_m(block) >= height(x, y), "{x}, {y} at {number}");
                    }
                }
            }
            assert_eq!(tops.levels.last().map(|level| level.size), Some(UVec2::ONE));
            let highest = map.posts.iter().map(|post| post.height_m).fold(0.0, f32::max);
            assert_eq!(tops.highest_m(), highest);
        }
    }

    #[test]
    fn water_has_no_top() {
        let map = map(17, 9, |x, _| if x < 8 { (7.0, 1.0) } else { (3.0, 0.0) });
        let tops = &GroundTops::new(&map).levels[0];
        assert_eq!(tops.top_m(UVec2::ZERO), f32::NEG_INFINITY);
        assert_eq!([tops.top_m(UVec2::X), tops.top_m(UVec2::X * 2)], [7.0, 3.0]);
    }
}
