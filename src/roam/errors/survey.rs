//! The tiles of plain ground, where every post has data and none is pinned.
//!
//! Plain ground is scanned without a test at every post. The survey answers for tiles, so its answer costs little beside the
//! scan; it errs one way only: a region that it calls plain is plain.

use rayon::prelude::*;

use crate::errors::scan::PostTriangle;
use sandtable_terrain::lattice::Lattice;

/// Posts along a tile's side: a smaller one scans less ground around a hole the slow way; a larger one makes fewer tiles.
const TILE: usize = 32;

/// The plain tiles of the posts that a lattice holds.
#[derive(Clone, Debug)]
pub struct TileSurvey {
    /// Column and row of the south-westernmost held post.
    first: (i32, i32),
    tiles_east: usize,
    blemished: Vec<bool>,
}

impl TileSurvey {
    /// Reads every held post once.
    pub fn new(lattice: &Lattice) -> Self {
        let (held, heights) = (lattice.held(), lattice.held_heights());
        let columns = held.width();
        let tiles_east = columns.div_ceil(TILE);
        let has_pins = lattice.has_pins();
        let mut blemished = vec![false; tiles_east * held.height().div_ceil(TILE)];
        blemished.par_chunks_mut(tiles_east).enumerate().for_each(|(north, tiles)| {
            let posts = north * TILE * columns..((north + 1) * TILE * columns).min(heights.len());
            for heights in heights[posts.clone()].chunks_exact(columns) {
                for (tile, heights) in tiles.iter_mut().zip(heights.chunks(TILE)) {
                    *tile |= !is_plain(heights, &[]);
                }
            }
            // Of ground without a pin they are not looked at.
            for pinned in lattice.pinned()[posts].chunks_exact(columns).filter(|_| has_pins) {
                for (tile, pinned) in tiles.iter_mut().zip(pinned.chunks(TILE)) {
                    *tile |= !is_plain(&[], pinned);
                }
            }
        });
        Self { first: (held.first.column as i32, held.first.row as i32), tiles_east, blemished }
    }

    /// Whether all posts from column and row `first` to `last`, ends included and held, are known to be plain.
    #[inline]
    pub fn is_plain(&self, first: (i32, i32), last: (i32, i32)) -> bool {
        let tile = |at: i32, first: i32| (at - first) as usize / TILE;
        let (column, row) = (|at| tile(at, self.first.0), |at| tile(at, self.first.1));
        (row(first.1)..=row(last.1)).all(|north| {
            let west = north * self.tiles_east;
            !self.blemished[west + column(first.0)..=west + column(last.0)].contains(&true)
        })
    }

    /// Whether all posts under a triangle are known to be plain.
    #[inline]
    pub fn covers(&self, triangle: &PostTriangle<'_>) -> bool {
        let (first, last) = triangle.bounds();
        self.is_plain(first, last)
    }
}

/// Whether all these posts have data and none is pinned. It does not stop early: that would cost more than it saves on the
/// few posts of a row.
#[inline]
pub fn is_plain(heights: &[f32], pinned: &[bool]) -> bool {
    !(heights.iter().fold(false, |hole, height| hole | height.is_nan())
        | pinned.iter().fold(false, |any, &pin| any | pin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use sandtable_terrain::lattice::Post;

    #[test]
    fn holes_and_pins_spoil_their_own_tiles_only() {
        let mut heights = vec![1.0; 100 * 70];
        heights[40 * 100 + 70] = f32::NAN;
        let mut lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 100, heights).expect("sound");
        lattice.pin(Post { column: 99, row: 69 }, 2.0);
        let survey = TileSurvey::new(&lattice);
        assert!(survey.is_plain((0, 0), (99, 31)) && survey.is_plain((0, 0), (63, 69)));
        assert!(!survey.is_plain((60, 30), (64, 32)) && !survey.is_plain((96, 64), (96, 64)));
        assert!(survey.is_plain((96, 32), (99, 63)));
    }
}
