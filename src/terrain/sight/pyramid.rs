//! How high and how low the ground goes, block by block: a pyramid of maxima and minima over the lattice's cells.
//!
//! A line that stays above a block's highest post cannot meet the ground in it, and the block is passed in one step.
//! Blocks of the lowest level are [`FINEST`] cells wide, those of each level above twice as wide; the last
//! level is a single block. A block's extremes are those of its posts *with its border*, so that all edges that a line
//! crosses within the block lie between them, and neighbors share the posts between them:
//!
//! ```text
//! level 0   o───┬───┬───┬───o       o post that both blocks count
//!           │   ·   ·   ·   │
//!           ├ · · · · · · · ┤       4 × 4 cells, 5 × 5 posts
//!           │   ·   ·   ·   │
//!           o───┴───┴───┴───o
//! ```
//!
//! Posts without data count for nothing; a block without any has a maximum of −∞ and a minimum of +∞, which no line
//! meets. The maxima stand apart from the minima: what looks from above the ground asks for the maxima alone.
//!
//! Two f32 for every 16 cells and a third as many again above them: a sixth of the lattice's heights.

use rayon::prelude::*;

use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::post_rect::PostRect;

/// Cells along a side of a block of level 0, as a power of two.
pub(in crate::terrain) const FINEST_BITS: u32 = 2;
/// Blocks along a side that make one of the level above, as a power of two.
pub(in crate::terrain) const FACTOR_BITS: u32 = 1;
/// Cells along a side of a block of level 0. Smaller ones cost memory (2: two thirds of the heights), larger ones more
/// walking where a line passes close over the ground.
pub const FINEST: u32 = 1 << FINEST_BITS;

/// The highest and lowest posts of blocks of cells, level by level.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    columns: u32,
    rows: u32,
    levels: Vec<PyramidLevel>,
}

/// The blocks of one size.
#[derive(Clone, Debug, PartialEq)]
struct PyramidLevel {
    /// Blocks eastward; there are as many rows as `highest` has room for.
    columns: u32,
    highest: Vec<f32>,
    lowest: Vec<f32>,
}

/// What is wrong with a pyramid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PyramidFault {
    /// It is that of a lattice of another size.
    #[error("the pyramid is that of {0}×{1} posts, the lattice has {2}×{3}")]
    Size(u32, u32, u32, u32),
    /// A block's extremes are not those of its posts.
    #[error("level {level}, block ({column}, {row}): {found:?}, its posts reach {expected:?}")]
    Block {
        /// The level.
        level: usize,
        /// The block's column.
        column: u32,
        /// The block's row.
        row: u32,
        /// The lowest and highest it says.
        found: (f32, f32),
        /// The lowest and highest there are.
        expected: (f32, f32),
    },
}

impl Pyramid {
    /// The pyramid of a lattice; one pass over its heights, on all threads.
    pub fn new(lattice: &Lattice) -> Self {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let mut levels = vec![PyramidLevel::sized(columns - 1, rows - 1, FINEST_BITS)];
        while let Some(finer) = levels.last().filter(|level| level.highest.len() > 1) {
            levels.push(PyramidLevel::sized(finer.columns, finer.rows(), FACTOR_BITS));
        }
        let mut pyramid = Self { columns, rows, levels };
        let last = Post { column: columns - 1, row: rows - 1 };
        pyramid.mend(lattice, PostRect { first: Post { column: 0, row: 0 }, last });
        pyramid
    }

    /// Takes up the heights of the posts in `edited`, which alone may have changed since; costs their number, and at
    /// least a block a level.
    ///
    /// # Panics
    /// Where the lattice is not of the size that the pyramid was made for, or `edited` leaves it.
    pub fn mend(&mut self, lattice: &Lattice, edited: PostRect) {
        assert_eq!((self.columns, self.rows), (lattice.columns(), lattice.rows()), "one pyramid a lattice");
        let PostRect { first, last } = edited;
        assert!(last.column < self.columns && last.row < self.rows, "{last:?} is outside the lattice");
        // A post counts for the cells on both its sides.
        let cell = |post: Post, back: u32| {
            [post.column.saturating_sub(back), post.row.saturating_sub(back)].map(|cell| cell >> FINEST_BITS)
        };
        let finest = &mut self.levels[0];
        let most = [finest.columns - 1, finest.rows() - 1];
        let mut low = cell(first, 1);
        let mut high = cell(last, 0);
        high = [high[0].min(most[0]), high[1].min(most[1])];
        finest.gather(lattice, low, high);
        for level in 1..self.levels.len() {
            low = low.map(|block| block >> FACTOR_BITS);
            high = high.map(|block| block >> FACTOR_BITS);
            let (below, above) = self.levels.split_at_mut(level);
            above[0].reduce(&below[level - 1], low, high);
        }
    }

    /// How many levels there are, at least one.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// How many bytes it takes up.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| 8 * level.highest.len()).sum()
    }

    /// The lowest and the highest post of all, as [`Lattice::height_range`].
    pub fn height_range(&self) -> (f32, f32) {
        let top = &self.levels[self.levels.len() - 1];
        (top.lowest[0], top.highest[0])
    }

    /// Cells along a side of a level's blocks, as a power of two.
    fn side_bits(level: usize) -> u32 {
        FINEST_BITS + FACTOR_BITS * level as u32
    }

    /// Cells along the side of the one block of the last level, as a power of two.
    pub(in crate::terrain) fn top_bits(&self) -> u32 {
        Self::side_bits(self.levels.len() - 1)
    }

    fn level(&self, bits: u32) -> &PyramidLevel {
        &self.levels[((bits - FINEST_BITS) / FACTOR_BITS) as usize]
    }

    /// The highest post of a block with sides of 2^`bits` cells, −∞ where it has no data.
    #[inline]
    pub(in crate::terrain) fn highest(&self, bits: u32, [column, row]: [u32; 2]) -> f32 {
        let level = self.level(bits);
        level.highest[level.index(column, row)]
    }

    /// The lowest post of a block with sides of 2^`bits` cells, +∞ where it has no data.
    #[inline]
    pub(in crate::terrain) fn lowest(&self, bits: u32, [column, row]: [u32; 2]) -> f32 {
        let level = self.level(bits);
        level.lowest[level.index(column, row)]
    }

    /// Looks at every block's every post.
    ///
    /// # Errors
    /// The first block that is not as its posts are.
    pub fn check(&self, lattice: &Lattice) -> Result<(), PyramidFault> {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        if (self.columns, self.rows) != (columns, rows) {
            return Err(PyramidFault::Size(self.columns, self.rows, columns, rows));
        }
        for (number, level) in self.levels.iter().enumerate() {
            for index in 0..level.highest.len() as u32 {
                let (column, row) = (index % level.columns, index / level.columns);
                let found = (level.lowest[index as usize], level.highest[index as usize]);
                let expected = extremes(lattice, Self::side_bits(number), column, row);
                if found != expected {
                    return Err(PyramidFault::Block { level: number, column, row, found, expected });
                }
            }
        }
        Ok(())
    }
}

/// The lowest and highest post of a block with sides of 2^`bits` cells, one by one.
fn extremes(lattice: &Lattice, bits: u32, column: u32, row: u32) -> (f32, f32) {
    let range = |block: u32, count: u32| (block << bits)..=((block + 1) << bits).min(count - 1);
    let mut found = (f32::INFINITY, f32::NEG_INFINITY);
    for row in range(row, lattice.rows()) {
        for column in range(column, lattice.columns()) {
            let height = lattice.height(Post { column, row });
            found = (found.0.min(height), found.1.max(height));
        }
    }
    found
}

impl PyramidLevel {
    /// A level of blocks with sides of 2^`bits` of what lies below it, `columns` × `rows` of these.
    fn sized(columns: u32, rows: u32, bits: u32) -> Self {
        let [columns, rows] = [columns, rows].map(|count| count.div_ceil(1 << bits));
        let count = columns as usize * rows as usize;
        Self { columns, highest: vec![f32::NEG_INFINITY; count], lowest: vec![f32::INFINITY; count] }
    }

    fn rows(&self) -> u32 {
        (self.highest.len() / self.columns as usize) as u32
    }

    #[inline]
    fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.columns as usize + column as usize
    }

    /// Sets the blocks from `low` to `high` from the posts under them.
    fn gather(&mut self, lattice: &Lattice, low: [u32; 2], high: [u32; 2]) {
        let stride = lattice.columns() as usize;
        let (heights, rows) = (lattice.heights(), lattice.rows());
        let from = (low[0] << FINEST_BITS) as usize;
        let through = (((high[0] + 1) << FINEST_BITS) as usize).min(stride - 1);
        self.each_row(low, high, |row, highest, lowest| {
            // Down the columns first: rows side by side are what a processor compares many of at once.
            let (first, last) = (row << FINEST_BITS, ((row + 1) << FINEST_BITS).min(rows - 1));
            let of_row = |row: u32| &heights[row as usize * stride + from..=row as usize * stride + through];
            let mut high = of_row(first).to_vec();
            let mut low = high.clone();
            for row in first + 1..=last {
                for ((high, low), &height) in high.iter_mut().zip(&mut low).zip(of_row(row)) {
                    *high = high.max(height);
                    *low = low.min(height);
                }
            }
            for (block, (highest, lowest)) in highest.iter_mut().zip(lowest).enumerate() {
                let first = block << FINEST_BITS;
                let last = (first + FINEST as usize).min(high.len() - 1);
                *highest = high[first..=last].iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b));
                *lowest = low[first..=last].iter().fold(f32::INFINITY, |a, &b| a.min(b));
            }
        });
    }

    /// Sets the blocks from `low` to `high` from those of the level below.
    fn reduce(&mut self, finer: &Self, low: [u32; 2], high: [u32; 2]) {
        let below = |block: u32, count: u32| (block << FACTOR_BITS)..((block + 1) << FACTOR_BITS).min(count);
        self.each_row(low, high, |row, highest, lowest| {
            for (column, (highest, lowest)) in (low[0]..).zip(highest.iter_mut().zip(lowest)) {
                (*highest, *lowest) = (f32::NEG_INFINITY, f32::INFINITY);
                for row in below(row, finer.rows()) {
                    for index in below(column, finer.columns).map(|column| finer.index(column, row)) {
                        *highest = highest.max(finer.highest[index]);
                        *lowest = lowest.min(finer.lowest[index]);
                    }
                }
            }
        });
    }

    /// Calls `set` with every row from `low` to `high` and its blocks' extremes there, on all threads.
    fn each_row(
        &mut self,
        low: [u32; 2],
        high: [u32; 2],
        set: impl Fn(u32, &mut [f32], &mut [f32]) + Sync + Send,
    ) {
        let columns = self.columns as usize;
        let rows = low[1] as usize * columns..(high[1] as usize + 1) * columns;
        let part = low[0] as usize..=high[0] as usize;
        let highest = self.highest[rows.clone()].par_chunks_exact_mut(columns);
        let lowest = self.lowest[rows].par_chunks_exact_mut(columns);
        highest.zip(lowest).enumerate().for_each(|(row, (highest, lowest))| {
            set(low[1] + row as u32, &mut highest[part.clone()], &mut lowest[part.clone()]);
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn rough(columns: u32, rows: u32) -> Lattice {
        let height = |index: u32| if index % 11 == 3 { f32::NAN } else { ((index * 7919) % 101) as f32 };
        let heights = (0..columns * rows).map(height).collect();
        Lattice::new(DVec2::ZERO, DVec2::new(10.0, 20.0), columns, heights).expect("sound")
    }

    #[test]
    fn every_block_is_as_high_and_as_low_as_its_posts_whatever_the_lattices_size() {
        for (columns, rows) in [(2, 2), (5, 5), (6, 9), (33, 17), (2, 70), (100, 41)] {
            let lattice = rough(columns, rows);
            let pyramid = Pyramid::new(&lattice);
            assert_eq!(pyramid.check(&lattice), Ok(()), "{columns} × {rows}");
            assert_eq!(pyramid.height_range(), lattice.height_range());
        }
    }

    #[test]
    fn a_mended_pyramid_is_the_one_that_would_be_made_anew() {
        let mut lattice = rough(70, 50);
        let mut pyramid = Pyramid::new(&lattice);
        for (first, last) in [((3, 4), (3, 4)), ((0, 0), (9, 2)), ((64, 31), (69, 49)), ((8, 8), (8, 33))] {
            let post = |(column, row)| Post { column, row };
            for row in first.1..=last.1 {
                for column in first.0..=last.0 {
                    lattice.pin(post((column, row)), -500.0 + (column * 31 + row) as f32 * 10.0);
                }
            }
            pyramid.mend(&lattice, PostRect { first: post(first), last: post(last) });
            assert_eq!(pyramid.check(&lattice), Ok(()), "after {first:?} to {last:?}");
        }
    }

    #[test]
    fn a_pyramid_takes_up_less_than_half_of_what_the_heights_do() {
        let lattice = rough(513, 513);
        assert!(2 * Pyramid::new(&lattice).bytes() < 4 * lattice.heights().len());
    }
}
