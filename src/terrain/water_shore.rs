//! The shore of inferred water as pictures draw it, and how far off it open water lies.
//!
//! Whether a post is under water is all that is known; a line between such posts is a staircase. So the shore is drawn
//! where a smoothed cover passes one half: the binomial mean of the posts around, which rounds the steps, held on its own
//! side of one half at every post, so that the line stays between the posts that it parts. One number says both:
//!
//! ```text
//!   0.25 ──── land ──── 0.5 ─ shore ─ 0.75 ─ near the shore ─────────── open water ─ 1
//!   └────── 0.25 + smoothed cover / 2 ──────┘ + a quarter of the way to open water
//! ```
//!
//! The way to open water is the distance from the shore as a share of the greatest in its body of water, found on a grid of
//! bounded size.

use glam::DVec2;

use crate::lattice::Lattice;
use crate::neighbors::sides;
use crate::water_cover::WaterCover;
use sandtable_geom::distance_field::{RegionGrid, distances_m};

/// The weights of posts to either side in the smoothed cover, of 64: a standard deviation of 1.2 posts, which is what a
/// step of one post needs. Wider ones would move headlands.
const WEIGHTS: [u32; 7] = [1, 6, 15, 20, 15, 6, 1];

/// How far from one half the smoothed cover of a post is at least: nearer, the shore would touch posts.
const LEAST_SIDE: f32 = 0.06;

/// The most cells of the grid of distances to a side: colors that change over a fiftieth of the picture need no more.
const MOST_CELLS: u32 = 512;

/// The share of the greatest distance from the shore at which water is open. Farther than that there is little of it.
pub const OPEN_SHARE: f64 = 0.6;

/// The shore of a lattice's water.
pub struct WaterShore<'a> {
    cover: &'a WaterCover,
    posts: [usize; 2],
    /// How many posts lie between neighbors of the grid of distances.
    step: usize,
    columns: usize,
    /// The way to open water in 0..=1.
    open: Vec<f32>,
}

impl<'a> WaterShore<'a> {
    /// The shore of the water that `cover` finds on `lattice`; `None` where there is none.
    pub fn new(lattice: &Lattice, cover: &'a WaterCover) -> Option<Self> {
        if cover.is_water.is_empty() {
            return None;
        }
        let posts = [lattice.columns() as usize, lattice.rows() as usize];
        let step = lattice.columns().max(lattice.rows()).div_ceil(MOST_CELLS) as usize;
        let [columns, rows] = posts.map(|posts| posts.div_ceil(step));
        let is_water: Vec<bool> = (0..columns * rows)
            .map(|cell| cover.is_water[cell / columns * step * posts[0] + cell % columns * step])
            .collect();
        let cell = lattice.cell() * step as f64;
        Some(Self { cover, posts, step, columns, open: open(&is_water, columns, cell) })
    }

    /// The number of the module's scale at every post of a row.
    pub fn row(&self, row: usize) -> Vec<f32> {
        let [columns, rows] = self.posts;
        let mut sums = vec![0u32; columns];
        for (offset, weight) in WEIGHTS.into_iter().enumerate() {
            let beside = (row + offset).saturating_sub(3).min(rows - 1);
            let covered = &self.cover.is_water[beside * columns..][..columns];
            sums.iter_mut().zip(covered).for_each(|(sum, &is_water)| *sum += weight * u32::from(is_water));
        }
        if sums.iter().all(|&sum| sum == 0) {
            return vec![0.25; columns];
        }
        let own = &self.cover.is_water[row * columns..][..columns];
        // The ends are repeated past the border.
        let ends = [sums[0], sums[columns - 1]].map(|end| [end; 3]);
        let sums = [ends[0].as_slice(), &sums, &ends[1]].concat();
        let value = |(column, near): (usize, &[u32])| {
            let weighted = WEIGHTS.iter().zip(near).map(|(weight, sum)| weight * sum);
            let smoothed = weighted.sum::<u32>() as f32 / 4096.0;
            if own[column] {
                0.25 + 0.5 * smoothed.max(0.5 + LEAST_SIDE) + 0.25 * self.open_at(column, row)
            } else {
                0.25 + 0.5 * smoothed.min(0.5 - LEAST_SIDE)
            }
        };
        sums.windows(WEIGHTS.len()).enumerate().map(value).collect()
    }

    fn open_at(&self, column: usize, row: usize) -> f32 {
        let last = [self.columns - 1, self.open.len() / self.columns - 1];
        let [(x, right), (y, up)] = [(column, last[0]), (row, last[1])].map(|(post, last)| {
            let cell = (post / self.step).min(last.saturating_sub(1));
            (cell, ((post as f32 / self.step as f32) - cell as f32).min(1.0))
        });
        let at = |x: usize, y: usize| self.open[y.min(last[1]) * self.columns + x.min(last[0])];
        let mix = |a: f32, b: f32, part: f32| a + (b - a) * part;
        mix(mix(at(x, y), at(x + 1, y), right), mix(at(x, y + 1), at(x + 1, y + 1), right), up)
    }
}

/// The way to open water at every cell of a grid, each body of water for itself.
fn open(is_water: &[bool], columns: usize, cell: DVec2) -> Vec<f32> {
    let grid = RegionGrid { columns, step_m: cell.to_array() };
    let distances_m = distances_m(is_water, grid);
    let mut open = vec![0.0; is_water.len()];
    let mut is_found = vec![false; is_water.len()];
    let mut body = Vec::new();
    for first in 0..is_water.len() {
        if !is_water[first] || is_found[first] {
            continue;
        }
        body.clear();
        body.push(first);
        is_found[first] = true;
        let mut next = 0;
        while let Some(&at) = body.get(next) {
            next += 1;
            let beside = sides(at, columns, is_water.len());
            for beside in beside.into_iter().flatten().filter(|&beside| is_water[beside]) {
                if !std::mem::replace(&mut is_found[beside], true) {
                    body.push(beside);
                }
            }
        }
        let farthest_m = body.iter().map(|&at| distances_m[at]).fold(0.0, f64::max);
        for &at in &body {
            let share = distances_m[at] / (OPEN_SHARE * farthest_m);
            open[at] = if share.is_nan() { 1.0 } else { share.min(1.0) as f32 };
        }
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::water_cover::{WaterRules, water_cover};

    /// A coast that runs from the south-west to the north-east in steps of a post.
    fn coast() -> Lattice {
        let height = |index: usize| if index / 80 < index % 80 / 2 + 10 { 0.0 } else { 5.0 };
        Lattice::new(DVec2::ZERO, DVec2::splat(30.0), 80, (0..80 * 80).map(height).collect()).expect("sound")
    }

    #[test]
    fn every_post_stays_on_its_side_of_the_shore() {
        let lattice = coast();
        let cover = water_cover(&lattice, &WaterRules::default());
        let shore = WaterShore::new(&lattice, &cover).expect("a sea");
        for row in 0..80 {
            for (value, &is_water) in shore.row(row).into_iter().zip(&cover.is_water[row * 80..]) {
                assert!(value.is_finite() && (0.25..=1.0).contains(&value) && (value > 0.5) == is_water);
            }
        }
    }

    #[test]
    fn the_shore_of_a_staircase_is_nearly_straight() {
        let lattice = coast();
        let cover = water_cover(&lattice, &WaterRules::default());
        let shore = WaterShore::new(&lattice, &cover).expect("a sea");
        let columns: Vec<Vec<f32>> = (0..80).map(|row| shore.row(row)).collect();
        // Where the shore crosses each column of posts, against the line that the stairs follow.
        let off = |column: usize| {
            let row = (0..79).find(|&row| columns[row + 1][column] < 0.5).expect("a shore");
            let (south, north) = (columns[row][column], columns[row + 1][column]);
            let at = row as f32 + (south - 0.5) / (south - north);
            at - (column as f32 / 2.0 + 9.25)
        };
        let worst = (8..70).map(|column| off(column).abs()).fold(0.0, f32::max);
        assert!(worst < 0.3, "{worst} posts; the stairs themselves are off by half a post");
    }

    #[test]
    fn water_is_open_far_from_its_shore_and_a_pond_has_its_own_middle() {
        let height = |index: usize| {
            let (x, y) = ((index % 80) as f32, (index / 80) as f32);
            if y < 30.0 { 0.0 } else { (f32::hypot(x - 40.0, y - 60.0) - 10.0).max(0.0) + 7.0 }
        };
        let heights = (0..80 * 80).map(height).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(30.0), 80, heights).expect("sound");
        let cover = water_cover(&lattice, &WaterRules::default());
        assert!(cover.sea_posts > 0 && cover.lakes.len() == 1);
        let shore = WaterShore::new(&lattice, &cover).expect("water");
        let at = |column: usize, row: usize| shore.row(row)[column];
        assert_eq!((at(40, 60), at(40, 0)), (1.0, 1.0));
        assert!(at(40, 28) < 0.8 && at(40, 20) < at(40, 10));
        assert_eq!(at(40, 40), 0.25);
        assert!(WaterShore::new(&lattice, &WaterCover::default()).is_none());
    }
}
