//! The tiles of the globe: two at level 0, each four at the next, counted from the south-west (TMS, global geodetic).

use std::ops::RangeInclusive;

use glam::DVec2;

/// Posts along a side of a tile.
pub const POSTS: usize = CELLS as usize + 1;
/// Cells along a side of a tile.
const CELLS: u64 = 64;
/// The finest level: posts a meter apart.
pub const MOST_LEVEL: u32 = 22;

/// A tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TileAddress {
    pub level: u32,
    /// From the west.
    pub x: u64,
    /// From the south.
    pub y: u64,
}

/// The tiles of a level that meet a rectangle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TileRange {
    pub level: u32,
    pub x: RangeInclusive<u64>,
    pub y: RangeInclusive<u64>,
}

impl TileAddress {
    /// The longitude and latitude of a post, degrees, by its column from the west and its row from the south.
    ///
    /// The share of the way round the globe is exact, so that a post has the same bits in all tiles that it is a post of.
    pub fn post(self, column: usize, row: usize) -> DVec2 {
        let posts = (CELLS << self.level) as f64;
        let share = |tile: u64, post: usize| (tile * CELLS + post as u64) as f64 / posts;
        DVec2::new(180.0 * share(self.x, column) - 180.0, 180.0 * share(self.y, row) - 90.0)
    }

    /// Its south-west and its north-east corner, degrees.
    pub fn corners(self) -> (DVec2, DVec2) {
        (self.post(0, 0), self.post(POSTS - 1, POSTS - 1))
    }

    /// All posts, row by row from the south-west.
    pub fn posts(self) -> Vec<DVec2> {
        (0..POSTS).flat_map(|row| (0..POSTS).map(move |column| self.post(column, row))).collect()
    }

    /// The tiles of a finer level that lie in it.
    fn below(self, level: u32) -> TileRange {
        let shift = level - self.level;
        let range = |first: u64| (first << shift)..=((first + 1) << shift) - 1;
        TileRange { level, x: range(self.x), y: range(self.y) }
    }

    /// Its path in a folder of tiles.
    pub fn path(self) -> String {
        format!("{}/{}/{}.terrain", self.level, self.x, self.y)
    }
}

impl TileRange {
    /// The tiles of a level that meet `[west, south, east, north]` in degrees. Level 0 has both tiles: a globe is made of
    /// them.
    pub fn meeting(level: u32, [west, south, east, north]: [f64; 4]) -> Self {
        if level == 0 {
            return Self { level, x: 0..=1, y: 0..=0 };
        }
        let size = 180.0 / (1u64 << level) as f64;
        let range = |low: f64, high: f64, count: u64| {
            let first = ((low / size) as u64).min(count - 1);
            let last = (libm::ceil(high / size) as u64).saturating_sub(1).clamp(first, count - 1);
            first..=last
        };
        let count = 1u64 << level;
        Self {
            level,
            x: range(west + 180.0, east + 180.0, 2 * count),
            y: range(south + 90.0, north + 90.0, count),
        }
    }

    /// Whether it has a tile.
    pub fn contains(&self, x: u64, y: u64) -> bool {
        self.x.contains(&x) && self.y.contains(&y)
    }

    /// The number of its tiles.
    pub fn count(&self) -> u64 {
        (self.x.end() - self.x.start() + 1).saturating_mul(self.y.end() - self.y.start() + 1)
    }

    /// Its tiles, from the south-west.
    pub fn tiles(&self) -> impl Iterator<Item = TileAddress> + use<> {
        let (level, x) = (self.level, self.x.clone());
        self.y.clone().flat_map(move |y| x.clone().map(move |x| TileAddress { level, x, y }))
    }

    fn intersection(&self, other: &Self) -> Self {
        let both = |a: &RangeInclusive<u64>, b: &RangeInclusive<u64>| {
            *a.start().max(b.start())..=*a.end().min(b.end())
        };
        Self { level: self.level, x: both(&self.x, &other.x), y: both(&self.y, &other.y) }
    }
}

/// Levels of a shard: 341 tiles and 1.4 million posts, some seconds' work.
pub const SHARD_LEVELS: u32 = 5;

/// The levels of the roots of shards, from the finest: each has as many levels as a shard below it. Those above the last, fewer
/// than of a shard, are the top.
pub fn group_starts(max_level: u32) -> Vec<u32> {
    let finest = max_level.saturating_sub(SHARD_LEVELS - 1);
    (0..=finest).rev().step_by(SHARD_LEVELS as usize).collect()
}

/// A tile and all below it down to a level that meet `bounds`.
pub fn pyramid(root: TileAddress, max_level: u32, bounds: [f64; 4]) -> Vec<TileAddress> {
    let within = |level: u32| TileRange::meeting(level, bounds).intersection(&root.below(level));
    (root.level..=max_level).flat_map(|level| within(level).tiles()).collect()
}

/// All tiles above a level that meet `bounds`.
pub fn top(level: u32, bounds: [f64; 4]) -> Vec<TileAddress> {
    (0..level).flat_map(|level| TileRange::meeting(level, bounds).tiles()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn posts_that_tiles_share_have_the_same_bits_on_every_level() {
        let tile = TileAddress { level: 11, x: 1073, y: 1437 };
        let (east, north) = (TileAddress { x: 1074, ..tile }, TileAddress { y: 1438, ..tile });
        for post in 0..POSTS {
            assert_eq!(tile.post(POSTS - 1, post), east.post(0, post));
            assert_eq!(tile.post(post, POSTS - 1), north.post(post, 0));
        }
        let parent = TileAddress { level: 10, x: 536, y: 718 };
        assert_eq!(parent.post(32 + 7, 32 + 9), tile.post(14, 18));
        assert_eq!(TileAddress { level: 0, x: 1, y: 0 }.post(64, 64), DVec2::new(180.0, 90.0));
    }

    #[test]
    fn every_tile_that_meets_the_bounds_is_in_one_shard() {
        let bounds = [7.1, 46.2, 9.9, 47.7];
        let max_level = 12;
        assert_eq!(group_starts(max_level), [8, 3]);
        let mut tiles = top(3, bounds);
        for start in [3, 8] {
            for root in TileRange::meeting(start, bounds).tiles() {
                let shard = pyramid(root, start + SHARD_LEVELS - 1, bounds);
                assert!((1..=341).contains(&shard.len()));
                tiles.extend(shard);
            }
        }
        let count: u64 = (0..=max_level).map(|level| TileRange::meeting(level, bounds).count()).sum();
        assert_eq!(tiles.len() as u64, count);
        tiles.sort();
        tiles.dedup();
        assert_eq!(tiles.len() as u64, count);
        let ranges = TileRange::meeting(2, [-180.0, -90.0, 180.0, 90.0]);
        assert_eq!((ranges.x, ranges.y), (0..=7, 0..=3));
        let edge = TileRange::meeting(1, [0.0, 0.0, 90.0, 90.0]);
        assert_eq!((edge.x, edge.y), (2..=2, 1..=1));
    }
}
