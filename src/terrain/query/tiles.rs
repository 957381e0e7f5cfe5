//! A copy of the heights in tiles of one cache line, for scattered queries on large grounds.
//!
//! ```text
//!  12 13 14 15 │ 12            a line of 64 bytes holds 4 × 4 posts, 3 × 3 cells; the last
//!   8  9 10 11 │  8            column and row are the next tile's first, so that the four
//!   4  5  6  7 │  4  …         corners of a cell never lie in two lines
//!   0  1  2  3 │  0
//! ```
//!
//! The overlap costs memory: 16 posts for every 9, 78 % more than the lattice, beside the lattice. It saves the second
//! cache line, and the second page, of every query. Making the tiles reads and writes every post once, so they are made
//! when as many scattered positions were queried as there are posts: fewer queries have then paid at most twice what the
//! better choice would have cost, and many more queries hardly more than it.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::lattice::{Lattice, Post};
use crate::query::batch::{index_of, rounded};

/// Cells along a tile's side.
const CELLS: u32 = 3;

/// Grounds with fewer posts than this (4 MiB) are mostly in the second cache, where rows are as fast as tiles.
const LEAST_POSTS: usize = 1 << 20;

/// The heights of a lattice in tiles.
pub struct HeightTiles {
    /// Tiles per row of tiles.
    across: u32,
    lines: Vec<CacheLine>,
}

/// A tile, in one cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct CacheLine([f32; 16]);

/// The place of a cell's corners: the tile's number times 16, plus the index of the south-west corner in it.
#[derive(Clone, Copy, Default)]
pub struct TileSlot(usize);

impl HeightTiles {
    /// The tiles of a lattice.
    pub fn new(lattice: &Lattice) -> Self {
        let across = (lattice.columns() - 1).div_ceil(CELLS);
        let down = (lattice.rows() - 1).div_ceil(CELLS);
        let mut lines = vec![CacheLine([f32::NAN; 16]); across as usize * down as usize];
        lines.par_chunks_mut(across as usize).enumerate().for_each(|(row, lines)| {
            for (line, column) in lines.iter_mut().zip(0u32..) {
                *line = line_at(lattice, Post { column: column * CELLS, row: row as u32 * CELLS });
            }
        });
        Self { across, lines }
    }

    /// The place of the corners of the cell at `column` and `row`, whole numbers.
    #[inline(always)]
    pub fn slot(&self, column: f64, row: f64) -> TileSlot {
        const THIRD: f64 = 1.0 / 3.0;
        // (n − 1)/3 rounded to the nearest is n/3 rounded down: it never lies midway between two whole numbers.
        let tile = |at: f64| rounded((at - 1.0) * THIRD);
        let (x, y) = (tile(column), tile(row));
        let (east, north) = (column - 3.0 * x, row - 3.0 * y);
        TileSlot(index_of((y * f64::from(self.across) + x) * 16.0 + north * 4.0 + east))
    }

    /// The corners of a cell: south-west and south-east, north-west and north-east.
    #[inline(always)]
    pub fn corners(&self, slot: TileSlot) -> [[f32; 2]; 2] {
        let line = &self.lines[slot.0 >> 4].0;
        // A cell's south-west corner is at most in the third column and row; the clamp proves it to the compiler.
        let cell = &line[(slot.0 & 15).min(10)..][..6];
        [[cell[0], cell[1]], [cell[4], cell[5]]]
    }

    /// Checks that every cell's corners are the lattice's, bit for bit.
    ///
    /// # Panics
    /// Where a cell's are not.
    pub fn check(&self, lattice: &Lattice) {
        let is_cell = |post: &Post| post.column + 1 < lattice.columns() && post.row + 1 < lattice.rows();
        for cell in lattice.posts().filter(is_cell) {
            let [[sw, se], [nw, ne]] = self.corners(self.slot(f64::from(cell.column), f64::from(cell.row)));
            let (tiled, expected) = ([sw, se, nw, ne], lattice.corner_heights(cell));
            assert_eq!(tiled.map(f32::to_bits), expected.map(f32::to_bits), "the corners of {cell:?}");
        }
    }
}

/// The tile whose south-west post is `first`; posts beyond the lattice are no data.
fn line_at(lattice: &Lattice, first: Post) -> CacheLine {
    let mut line = CacheLine([f32::NAN; 16]);
    let width = (lattice.columns() - first.column).min(4) as usize;
    for row in 0..(lattice.rows() - first.row).min(4) {
        let from = lattice.index(first.offset(0, row));
        let slot = 4 * row as usize;
        line.0[slot..slot + width].copy_from_slice(&lattice.heights()[from..from + width]);
    }
    line
}

/// Tiles that are made when they pay; see the module.
#[derive(Default)]
pub struct LazyTiles {
    tiles: OnceLock<HeightTiles>,
    scattered: AtomicUsize,
    is_making: AtomicBool,
}

impl LazyTiles {
    /// The tiles, if they are made.
    pub fn get(&self) -> Option<&HeightTiles> {
        self.tiles.get()
    }

    /// Counts scattered positions that were queried.
    pub fn count(&self, scattered: usize) {
        self.scattered.fetch_add(scattered, Ordering::Relaxed);
    }

    /// Makes the tiles of `lattice`, always the same one, where they pay and no other thread is making them. It does not
    /// wait for another thread: in a thread pool that could deadlock.
    pub fn make_if_worthwhile(&self, lattice: &Lattice) {
        let posts = lattice.heights().len();
        let pays = posts >= LEAST_POSTS && self.scattered.load(Ordering::Relaxed) >= posts;
        if pays && self.tiles.get().is_none() && !self.is_making.swap(true, Ordering::Relaxed) {
            // It is unset: `is_making` never becomes false again.
            let _ = self.tiles.set(HeightTiles::new(lattice));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn tiles_hold_every_cell_of_a_lattice_of_any_size() {
        for columns in 2..12u32 {
            for rows in 2..12u32 {
                let heights = (0..columns * rows).map(|index| index as f32).collect();
                let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, columns, heights).expect("sound");
                HeightTiles::new(&lattice).check(&lattice);
            }
        }
    }

    #[test]
    fn tiles_are_made_after_as_many_queries_as_they_cost() {
        let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 1024, vec![1.0; 1 << 20]).expect("sound");
        let lazy = LazyTiles::default();
        lazy.make_if_worthwhile(&lattice);
        lazy.count((1 << 20) - 1);
        lazy.make_if_worthwhile(&lattice);
        assert!(lazy.get().is_none());
        lazy.count(1);
        lazy.make_if_worthwhile(&lattice);
        assert!(lazy.get().is_some());
    }
}
