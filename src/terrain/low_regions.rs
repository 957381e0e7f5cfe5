//! Regions of ground below 0 m, found as runs of posts along rows: all threads look for the runs, one joins them.
//!
//! ```text
//! row before   · · 2 2 2 · · 3 3     a run that shares a column with one of the row before belongs to its region
//! row          1 · 2 2 · · 3 3 ·
//! ```

use std::ops::Range;

use rayon::prelude::*;

use sandtable_base::disjoint_sets::root;

/// Which ground is low.
#[derive(Clone, Copy, Debug)]
pub struct LowGround {
    /// Posts at least this many meters below 0 m are low; those less far from 0 m are even.
    pub level_m: f32,
    /// Regions of fewer posts are small: their sides are counted.
    pub least: usize,
}

/// Low posts connected east, north, west and south.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LowRegion {
    /// How many there are.
    pub posts: usize,
    /// Whether one of them lies on the border of the model.
    pub is_at_border: bool,
    /// Even posts beside them, of a small region; one beside several of them counts as often.
    pub even: usize,
    /// Higher posts beside them, likewise.
    pub higher: usize,
}

/// The low regions of a lattice.
pub struct LowRegions {
    runs: Vec<LowRun>,
    /// By the number of the first run of each; without posts at the numbers of the others.
    regions: Vec<LowRegion>,
}

/// Low posts side by side in a row.
#[derive(Clone, Copy)]
struct LowRun {
    first: u32,
    count: u32,
    /// Its region, by the number of the first run of it.
    region: u32,
}

impl LowRun {
    /// The indices of its posts.
    fn posts(self) -> Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

impl LowGround {
    fn is_low(self, height_m: f32) -> bool {
        height_m <= -self.level_m
    }

    /// The regions of `heights`, row by row of `columns`, of which there are fewer than 2³²; the same for any number of threads.
    pub fn regions(self, heights: &[f32], columns: usize) -> LowRegions {
        let rows = heights.par_chunks_exact(columns).enumerate();
        let of_rows: Vec<Vec<LowRun>> =
            rows.map(|(row, heights)| self.runs(heights, row * columns)).collect();
        let (mut runs, mut links) = (Vec::<LowRun>::new(), Vec::<u32>::new());
        let mut before = 0..0;
        for row in of_rows {
            let (first, mut touched) = (runs.len(), before.start);
            for run in row {
                let own = runs.len() as u32;
                links.push(own);
                let Range { start, end } = run.posts();
                while touched < before.end && runs[touched].posts().end + columns <= start {
                    touched += 1;
                }
                let beside =
                    runs[touched..before.end].iter().take_while(|run| run.posts().start + columns < end);
                for other in touched..touched + beside.count() {
                    let [one, other] = [own, other as u32].map(|run| root(&mut links, run));
                    links[one.max(other) as usize] = one.min(other);
                }
                runs.push(run);
            }
            before = first..runs.len();
        }
        let mut regions = vec![LowRegion::default(); runs.len()];
        for (number, run) in (0..).zip(&mut runs) {
            run.region = root(&mut links, number);
            let (posts, region) = (run.posts(), &mut regions[run.region as usize]);
            region.posts += posts.len();
            let is_at_end = posts.start < columns || posts.end + columns > heights.len();
            let is_at_side = posts.start.is_multiple_of(columns) || posts.end.is_multiple_of(columns);
            region.is_at_border |= is_at_end || is_at_side;
        }
        for run in &runs {
            let region = &mut regions[run.region as usize];
            if region.posts < self.least {
                self.count_sides(heights, columns, run.posts(), region);
            }
        }
        LowRegions { runs, regions }
    }

    /// The runs of a row whose first post has index `first`.
    fn runs(self, heights: &[f32], first: usize) -> Vec<LowRun> {
        let (mut runs, mut at) = (Vec::new(), 0);
        while let Some(ahead) = heights[at..].iter().position(|&height_m| self.is_low(height_m)) {
            at += ahead;
            let count = heights[at..].iter().take_while(|&&height_m| self.is_low(height_m)).count();
            runs.push(LowRun { first: (first + at) as u32, count: count as u32, region: 0 });
            at += count;
        }
        runs
    }

    /// Counts what lies beside the posts of a run.
    fn count_sides(self, heights: &[f32], columns: usize, posts: Range<usize>, region: &mut LowRegion) {
        let west = (!posts.start.is_multiple_of(columns)).then(|| posts.start - 1);
        let east = Some(posts.end).filter(|end| !end.is_multiple_of(columns));
        let south = posts.clone().filter_map(|post| post.checked_sub(columns));
        let north = posts.map(|post| post + columns).filter(|&post| post < heights.len());
        for beside in west.into_iter().chain(east).chain(south).chain(north) {
            let height_m = heights[beside];
            if height_m.abs() < self.level_m {
                region.even += 1;
            } else if height_m > 0.0 {
                region.higher += 1;
            }
        }
    }
}

impl LowRegions {
    /// All of them, in the order of their first posts.
    pub fn iter(&self) -> impl Iterator<Item = &LowRegion> {
        self.regions.iter().filter(|region| region.posts > 0)
    }

    /// The indices of the posts of the regions that are wanted, in runs, rising.
    pub fn posts_of(&self, is_wanted: impl Fn(&LowRegion) -> bool) -> impl Iterator<Item = Range<usize>> {
        let wanted = self.runs.iter().filter(move |run| is_wanted(&self.regions[run.region as usize]));
        wanted.map(|run| run.posts())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbors::sides;

    /// The regions by visiting each post by post.
    fn plain(ground: LowGround, heights: &[f32], columns: usize) -> Vec<LowRegion> {
        let mut is_found = vec![false; heights.len()];
        let mut regions = Vec::new();
        for start in 0..heights.len() {
            let (mut open, mut region) = (vec![start], LowRegion::default());
            while let Some(at) = open.pop() {
                if !ground.is_low(heights[at]) || std::mem::replace(&mut is_found[at], true) {
                    continue;
                }
                region.posts += 1;
                let around = sides(at, columns, heights.len());
                region.is_at_border |= around.contains(&None);
                for beside in around.into_iter().flatten() {
                    open.push(beside);
                    region.even += usize::from(heights[beside].abs() < ground.level_m);
                    region.higher += usize::from(heights[beside] >= ground.level_m);
                }
            }
            regions.extend((region.posts > 0).then_some(region));
        }
        for region in regions.iter_mut().filter(|region| region.posts >= ground.least) {
            (region.even, region.higher) = (0, 0);
        }
        regions
    }

    #[test]
    fn regions_are_those_found_post_by_post() {
        let ground = LowGround { level_m: 0.5, least: 9 };
        for (columns, rows, seed) in [(31, 23, 1u32), (1, 40, 2), (40, 1, 3), (64, 50, 4), (7, 90, 5)] {
            for low_share in [2, 5, 8] {
                let height = |at: u32| {
                    let mixed = (at ^ seed.wrapping_mul(0x9E37_79B9)).wrapping_mul(0x85EB_CA6B);
                    match (mixed >> 13) % 10 {
                        part if part < low_share => -1.0,
                        8 => 0.2,
                        9 => f32::NAN,
                        _ => 3.0,
                    }
                };
                let heights: Vec<f32> = (0..columns * rows).map(height).collect();
                let found = ground.regions(&heights, columns as usize);
                let all: Vec<LowRegion> = found.iter().copied().collect();
                assert_eq!(all, plain(ground, &heights, columns as usize), "{columns} × {rows}, {low_share}");
                let posts: Vec<usize> = found.posts_of(|_| true).flatten().collect();
                let low = (0..heights.len()).filter(|&at| ground.is_low(heights[at]));
                assert!(posts.into_iter().eq(low));
            }
        }
    }
}
