//! Summits and saddles of a lattice, by prominence: how far one must go down from a summit to reach higher ground.
//!
//! Posts are flooded from the highest down. A post with no flooded neighbor is a summit; one where two floods meet is the
//! saddle of the lower summit, whose prominence is its height above it (the merge tree of Carr, Snoeyink and Axen 2003).

use glam::Vec2;
use rayon::prelude::*;

use crate::lattice::Lattice;
use crate::neighbors::neighbors;
use sandtable_base::disjoint_sets::root;

/// Lattices with more posts on a side are read as blocks, each by its highest post: prominence of hills is that of the
/// blocks, and hills inside of one block are one.
const MOST_BLOCKS: u32 = 512;

/// A summit with the saddle that parts it from higher ground; world X and Y, heights in meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProminentSummit {
    /// Its post.
    pub at: Vec2,
    /// Its height.
    pub height_m: f32,
    /// Above its saddle; above the lowest ground for the highest summit.
    pub prominence_m: f32,
    /// `None` for the highest summit of connected ground.
    pub saddle: Option<SaddlePoint>,
}

/// The highest way between two summits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaddlePoint {
    /// Its post; of a lattice read in blocks, the highest post of its block.
    pub at: Vec2,
    /// Its height.
    pub height_m: f32,
}

/// All summits of `lattice` that are not on its border, the most prominent first.
pub fn summits(lattice: &Lattice) -> Vec<ProminentSummit> {
    let blocks = PostBlocks::new(lattice);
    let mut order: Vec<u32> = (0..blocks.heights.len() as u32)
        .filter(|&block| blocks.heights[block as usize].is_finite())
        .collect();
    order.par_sort_unstable_by(|&a, &b| {
        blocks.heights[b as usize].total_cmp(&blocks.heights[a as usize]).then(a.cmp(&b))
    });
    let Some(lowest) = order.last().map(|&block| blocks.heights[block as usize]) else { return Vec::new() };
    // The root of a flood is its summit; `u32::MAX` before a block is flooded.
    let mut floods = vec![u32::MAX; blocks.heights.len()];
    let mut summits = Vec::new();
    for &block in &order {
        floods[block as usize] = block;
        for neighbor in blocks.neighbors(block) {
            if floods[neighbor as usize] == u32::MAX {
                continue;
            }
            // The root of a flood is its summit, its first and highest block.
            let (one, other) = (root(&mut floods, block), root(&mut floods, neighbor));
            if one == other {
                continue;
            }
            let order = |root: u32| (blocks.heights[root as usize], std::cmp::Reverse(root));
            let (higher, lower) = if order(one) > order(other) { (one, other) } else { (other, one) };
            floods[lower as usize] = higher;
            if lower != block {
                let saddle =
                    SaddlePoint { at: blocks.position(block), height_m: blocks.heights[block as usize] };
                summits.push(blocks.summit(lower, saddle.height_m, Some(saddle)));
            }
        }
    }
    let highest = order.iter().filter(|&&block| floods[block as usize] == block);
    summits.extend(highest.map(|&block| blocks.summit(block, lowest, None)));
    summits.retain(|summit| summit.prominence_m > 0.0 && blocks.is_inside(summit.at));
    summits.sort_by(|a, b| b.prominence_m.total_cmp(&a.prominence_m).then(a.at.x.total_cmp(&b.at.x)));
    summits
}

/// The highest posts of square blocks.
struct PostBlocks<'a> {
    lattice: &'a Lattice,
    columns: u32,
    rows: u32,
    heights: Vec<f32>,
    /// Indices into the lattice.
    posts: Vec<u32>,
}

impl<'a> PostBlocks<'a> {
    fn new(lattice: &'a Lattice) -> Self {
        let side = lattice.columns().max(lattice.rows()).div_ceil(MOST_BLOCKS);
        let (columns, rows) = (lattice.columns().div_ceil(side), lattice.rows().div_ceil(side));
        let count = columns as usize * rows as usize;
        let (mut heights, mut posts) = (vec![f32::NAN; count], vec![0; count]);
        let width = lattice.columns() as usize;
        for (row, line) in lattice.heights().chunks_exact(width).enumerate() {
            let first = (row as u32 / side) as usize * columns as usize;
            for (column, &height) in line.iter().enumerate() {
                let block = first + column / side as usize;
                if height.is_finite() && (heights[block].is_nan() || height > heights[block]) {
                    heights[block] = height;
                    posts[block] = (row * width + column) as u32;
                }
            }
        }
        Self { lattice, columns, rows, heights, posts }
    }

    fn neighbors(&self, block: u32) -> impl Iterator<Item = u32> + use<> {
        let around = neighbors(block as usize, self.columns as usize, self.rows as usize);
        around.map(|(_, other)| other as u32)
    }

    fn position(&self, block: u32) -> Vec2 {
        self.lattice.position(self.lattice.post_at(self.posts[block as usize] as usize))
    }

    fn summit(&self, block: u32, below_m: f32, saddle: Option<SaddlePoint>) -> ProminentSummit {
        let height_m = self.heights[block as usize];
        ProminentSummit { at: self.position(block), height_m, prominence_m: height_m - below_m, saddle }
    }

    /// Whether a place is off the border, where a slope that goes on looks like a summit.
    fn is_inside(&self, at: Vec2) -> bool {
        let extent = self.lattice.extent();
        let margin = self.lattice.cell() * 1.5;
        let at = at.as_dvec2();
        (at - extent.min).cmpgt(margin).all() && (extent.max - at).cmpgt(margin).all()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// Hills as cones: place, height, slope 1.
    fn cones(columns: u32, hills: &[(f32, f32, f32)]) -> Lattice {
        let height = |n: u32| {
            let at = Vec2::new((n % columns) as f32, (n / columns) as f32);
            hills.iter().map(|&(x, y, top)| top - at.distance(Vec2::new(x, y))).fold(0.0, f32::max)
        };
        let heights = (0..columns * columns).map(height).collect();
        Lattice::new(DVec2::ZERO, DVec2::ONE, columns, heights).expect("a lattice")
    }

    #[test]
    fn two_hills_have_their_prominence_and_the_saddle_between_them() {
        let summits = summits(&cones(65, &[(20.0, 32.0, 30.0), (44.0, 32.0, 22.0)]));
        assert_eq!(summits.len(), 2);
        assert_eq!(
            (summits[0].at, summits[0].prominence_m, summits[0].saddle),
            (Vec2::new(20.0, 32.0), 30.0, None)
        );
        assert_eq!(summits[1].at, Vec2::new(44.0, 32.0));
        let saddle = summits[1].saddle.expect("between the two");
        assert_eq!((saddle.at, saddle.height_m), (Vec2::new(36.0, 32.0), 14.0));
        assert_eq!(summits[1].prominence_m, 8.0);
    }

    #[test]
    fn a_slope_that_goes_on_beyond_the_border_is_no_summit_and_level_ground_has_none() {
        assert!(summits(&cones(33, &[(0.0, 10.0, 20.0)])).is_empty());
        assert!(summits(&cones(33, &[])).is_empty());
    }

    #[test]
    fn a_large_lattice_is_read_in_blocks_and_keeps_its_summits_to_the_post() {
        let summits = summits(&cones(1100, &[(301.0, 303.0, 200.0), (707.0, 801.0, 150.0)]));
        let places: Vec<Vec2> = summits.iter().map(|summit| summit.at).collect();
        assert_eq!(places, [Vec2::new(301.0, 303.0), Vec2::new(707.0, 801.0)]);
    }
}
