//! The highest and lowest ground of blocks of cells: a pyramid of maxima and minima.
//!
//! A line that stays above a block's highest post cannot meet the ground in it, and skips the block in one step. Blocks of
//! the lowest level are 4 cells wide, or of another width; those of each level above twice as wide; the last level is a
//! single block. A block's
//! extremes are those of its posts *with its border*, so that all edges that a line crosses in the block lie between them,
//! and neighbors share the posts between them:
//!
//! ```text
//! level 0   o───┬───┬───┬───o       o post that both blocks count
//!           │   ·   ·   ·   │
//!           ├ · · · · · · · ┤       4 × 4 cells, 5 × 5 posts
//!           │   ·   ·   ·   │
//!           o───┴───┴───┴───o
//! ```
//!
//! Posts without data are ignored; a block without any data has a maximum of −∞ and a minimum of +∞, which no line meets.
//! Maxima and minima are stored apart: lines of sight read only the maxima.
//!
//! With blocks of 4 cells, two f32 for every 16 cells and a third as many again above them: a sixth of the lattice's heights.

use rayon::prelude::*;

use crate::lattice::{Lattice, Post};
use crate::post_rect::PostRect;

/// Cells along a side of a block of level 0 for lines of sight, as a power of two. Smaller blocks cost memory (with 1: two thirds of the
/// heights), larger ones more walking where a line passes close over the ground.
pub(crate) const FINEST_BITS: u32 = 2;

/// The highest and lowest posts of blocks of cells, level by level.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    columns: u32,
    rows: u32,
    /// Cells along a side of a block of level 0, as a power of two.
    finest_bits: u32,
    levels: Vec<PyramidLevel>,
}

/// The blocks of one size.
#[derive(Clone, Debug, PartialEq)]
struct PyramidLevel {
    /// Blocks eastward.
    columns: u32,
    /// Blocks northward.
    rows: u32,
    highest: Vec<f32>,
    lowest: Vec<f32>,
}

impl Pyramid {
    /// The pyramid of a lattice for lines of sight; one pass over its heights, on all threads.
    pub fn new(lattice: &Lattice) -> Self {
        Self::with_blocks(lattice, FINEST_BITS)
    }

    /// The pyramid of a lattice whose smallest blocks have sides of 2^`finest_bits` cells.
    pub fn with_blocks(lattice: &Lattice, finest_bits: u32) -> Self {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let mut levels = vec![PyramidLevel::new(columns - 1, rows - 1, finest_bits)];
        while let Some(finer) = levels.last().filter(|level| level.highest.len() > 1) {
            levels.push(PyramidLevel::new(finer.columns, finer.rows, 1));
        }
        let mut pyramid = Self { columns, rows, finest_bits, levels };
        pyramid.update(lattice, PostRect::all(lattice));
        pyramid
    }

    /// Updates the blocks of the posts in `edited`, which alone may have changed since; costs their number, and at least a
    /// block a level.
    ///
    /// # Panics
    /// Where the lattice is not of the pyramid's size, or `edited` leaves it.
    pub fn update(&mut self, lattice: &Lattice, edited: PostRect) {
        assert_eq!((self.columns, self.rows), (lattice.columns(), lattice.rows()), "the pyramid's lattice");
        let PostRect { first, last } = edited;
        assert!(last.column < self.columns && last.row < self.rows, "{last:?} is outside the lattice");
        let bits = self.finest_bits;
        let (finest, coarser) = self.levels.split_first_mut().expect("a pyramid has a level");
        // A post belongs to the cells on both its sides.
        let block = |cell: u32, count: u32| (cell >> bits).min(count - 1);
        let block = |column: u32, row: u32| Post {
            column: block(column, finest.columns),
            row: block(row, finest.rows),
        };
        let first = block(first.column.saturating_sub(1), first.row.saturating_sub(1));
        let mut blocks = PostRect { first, last: block(last.column, last.row) };
        finest.gather(lattice, bits, blocks);
        let mut finer = &*finest;
        for level in coarser {
            blocks = PostRect { first: halved(blocks.first), last: halved(blocks.last) };
            level.reduce(finer, blocks);
            finer = level;
        }
    }

    /// Widens the range of a block of level 0 to hold that of new posts, where none of its extremes was removed.
    pub fn widen(&mut self, mut block: Post, (low, high): (f32, f32)) {
        for level in &mut self.levels {
            let index = level.index(block.column, block.row);
            level.lowest[index] = level.lowest[index].min(low);
            level.highest[index] = level.highest[index].max(high);
            block = halved(block);
        }
    }

    /// The number of its bytes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| 8 * level.highest.len()).sum()
    }

    /// The lowest and the highest post of all, as [`Lattice::height_range`].
    pub fn height_range(&self) -> (f32, f32) {
        let top = &self.levels[self.levels.len() - 1];
        (top.lowest[0], top.highest[0])
    }

    /// Cells along the side of the one block of the last level, as a power of two.
    pub fn top_bits(&self) -> u32 {
        self.finest_bits + self.levels.len() as u32 - 1
    }

    fn level(&self, bits: u32) -> &PyramidLevel {
        &self.levels[(bits - self.finest_bits) as usize]
    }

    /// The highest post of a block with sides of 2^`bits` cells, −∞ where it has no data.
    #[inline]
    pub(crate) fn highest(&self, bits: u32, block: Post) -> f32 {
        let level = self.level(bits);
        level.highest[level.index(block.column, block.row)]
    }

    /// The lowest post of a block with sides of 2^`bits` cells, +∞ where it has no data.
    #[inline]
    pub(crate) fn lowest(&self, bits: u32, block: Post) -> f32 {
        let level = self.level(bits);
        level.lowest[level.index(block.column, block.row)]
    }

    /// The lowest and the highest post of a block with sides of 2^`bits` cells, low above high where it has no data; `None`
    /// beyond the lattice.
    pub fn range(&self, bits: u32, block: Post) -> Option<(f32, f32)> {
        let level = self.level(bits);
        let is_inside = block.column < level.columns && block.row < level.rows;
        is_inside.then(|| (self.lowest(bits, block), self.highest(bits, block)))
    }

    /// Checks every block against all its posts.
    ///
    /// # Panics
    /// Where a block has other extremes, or the lattice is smaller than the pyramid's.
    pub fn check(&self, lattice: &Lattice) {
        for (number, level) in self.levels.iter().enumerate() {
            for (index, extremes) in
                level.lowest.iter().copied().zip(level.highest.iter().copied()).enumerate()
            {
                let block = Post { column: index as u32 % level.columns, row: index as u32 / level.columns };
                let expected = self::extremes(lattice, self.finest_bits + number as u32, block);
                assert_eq!(extremes, expected, "level {number}, {block:?}, and its posts");
            }
        }
    }
}

/// The block of twice the size that holds a block.
fn halved(block: Post) -> Post {
    Post { column: block.column >> 1, row: block.row >> 1 }
}

/// The lowest and highest post of a block with sides of 2^`bits` cells, one by one.
fn extremes(lattice: &Lattice, bits: u32, block: Post) -> (f32, f32) {
    let first = Post { column: block.column << bits, row: block.row << bits };
    let posts = PostRect { first, last: first.offset(1 << bits, 1 << bits) }.clipped(lattice);
    posts
        .into_iter()
        .flat_map(PostRect::posts)
        .map(|post| lattice.height(post))
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)))
}

impl PyramidLevel {
    /// A level of blocks with sides of 2^`bits` of the `columns` × `rows` units below it.
    fn new(columns: u32, rows: u32, bits: u32) -> Self {
        let [columns, rows] = [columns, rows].map(|count| count.div_ceil(1 << bits));
        let count = columns as usize * rows as usize;
        Self { columns, rows, highest: vec![f32::NEG_INFINITY; count], lowest: vec![f32::INFINITY; count] }
    }

    #[inline]
    fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.columns as usize + column as usize
    }

    /// Sets blocks of the finest level, with sides of 2^`bits` cells, from the posts under them.
    fn gather(&mut self, lattice: &Lattice, bits: u32, blocks: PostRect) {
        let stride = lattice.columns() as usize;
        let (heights, rows) = (lattice.heights(), lattice.rows());
        let from = (blocks.first.column << bits) as usize;
        let through = (((blocks.last.column + 1) << bits) as usize).min(stride - 1);
        self.set_rows(blocks, |row, highest, lowest| {
            // Down the columns first, since the compiler vectorizes comparisons of whole rows.
            let (first, last) = (row << bits, ((row + 1) << bits).min(rows - 1));
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
                let first = block << bits;
                let last = (first + (1 << bits)).min(high.len() - 1);
                *highest = high[first..=last].iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b));
                *lowest = low[first..=last].iter().fold(f32::INFINITY, |a, &b| a.min(b));
            }
        });
    }

    /// Sets blocks from those of the level below.
    fn reduce(&mut self, finer: &Self, blocks: PostRect) {
        let below = |block: u32, count: u32| block << 1..((block + 1) << 1).min(count);
        self.set_rows(blocks, |row, highest, lowest| {
            for (column, (highest, lowest)) in (blocks.first.column..).zip(highest.iter_mut().zip(lowest)) {
                (*highest, *lowest) = (f32::NEG_INFINITY, f32::INFINITY);
                for row in below(row, finer.rows) {
                    for index in below(column, finer.columns).map(|column| finer.index(column, row)) {
                        *highest = highest.max(finer.highest[index]);
                        *lowest = lowest.min(finer.lowest[index]);
                    }
                }
            }
        });
    }

    /// Calls `set` with each row of blocks and the extremes of its blocks, on all threads.
    fn set_rows(&mut self, blocks: PostRect, set: impl Fn(u32, &mut [f32], &mut [f32]) + Sync + Send) {
        let PostRect { first, last } = blocks;
        let columns = self.columns as usize;
        let rows = first.row as usize * columns..(last.row as usize + 1) * columns;
        let part = first.column as usize..=last.column as usize;
        let highest = self.highest[rows.clone()].par_chunks_exact_mut(columns);
        let lowest = self.lowest[rows].par_chunks_exact_mut(columns);
        highest.zip(lowest).enumerate().for_each(|(row, (highest, lowest))| {
            set(first.row + row as u32, &mut highest[part.clone()], &mut lowest[part.clone()]);
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
    fn every_block_has_the_extremes_of_its_posts_on_any_lattice() {
        for (columns, rows) in [(2, 2), (5, 5), (6, 9), (33, 17), (2, 70), (100, 41)] {
            let lattice = rough(columns, rows);
            let pyramid = Pyramid::new(&lattice);
            pyramid.check(&lattice);
            assert_eq!(pyramid.height_range(), lattice.height_range());
        }
    }

    #[test]
    fn an_updated_pyramid_has_the_extremes_of_the_edited_posts() {
        let mut lattice = rough(70, 50);
        let mut pyramid = Pyramid::new(&lattice);
        for (first, last) in [((3, 4), (3, 4)), ((0, 0), (9, 2)), ((64, 31), (69, 49)), ((8, 8), (8, 33))] {
            let post = |(column, row)| Post { column, row };
            for row in first.1..=last.1 {
                for column in first.0..=last.0 {
                    lattice.pin(post((column, row)), -500.0 + (column * 31 + row) as f32 * 10.0);
                }
            }
            pyramid.update(&lattice, PostRect { first: post(first), last: post(last) });
            pyramid.check(&lattice);
        }
    }

    #[test]
    fn a_pyramid_takes_less_than_half_the_memory_of_the_heights() {
        let lattice = rough(513, 513);
        assert!(2 * Pyramid::new(&lattice).bytes() < 4 * lattice.heights().len());
    }
}
