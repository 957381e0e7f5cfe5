//! The farthest depth in each block of a tile: pieces that lie behind it need not be drawn.
//!
//! The farthest depth of any sample is kept for each block of 8×8 pixels (the hierarchical depth buffer of Greene et
//! al. 1993, at a single level). Depths only ever come nearer, so that an old value stays true, if not tight. It is
//! computed again once [`STALE`] more pieces have been drawn into the block, which costs less than a fifth of drawing
//! them.

use std::ops::Range;

use crate::cpu::raster::PixelWindow;
use crate::cpu::visibility::TILE;

const BLOCK: u32 = 8;

const BLOCKS: usize = (TILE / BLOCK) as usize;

/// Pieces drawn into a block after which its farthest depth is computed again.
const STALE: u8 = 16;

/// Pieces over more blocks than these are not tested: hardly any of them is hidden entirely.
const MOST_BLOCKS: usize = 4;

#[derive(Debug)]
pub struct Occlusion {
    farthest: [[f32; BLOCKS]; BLOCKS],
    /// Pieces drawn since, [`STALE`] at most.
    drawn: [[u8; BLOCKS]; BLOCKS],
}

impl Occlusion {
    pub fn new() -> Self {
        Self { farthest: [[0.0; BLOCKS]; BLOCKS], drawn: [[STALE; BLOCKS]; BLOCKS] }
    }

    /// Whether all of `window`, in pixels of the tile, is nearer than the nearness `nearest`. `depths` are those
    /// of the tile's samples, row by row, [`TILE`] pixels per row.
    pub fn hides<const N: usize>(&mut self, window: PixelWindow, nearest: f32, depths: &[[f32; N]]) -> bool {
        let [columns, rows] = blocks(window);
        if columns.len() * rows.len() > MOST_BLOCKS {
            return false;
        }
        rows.into_iter().all(|row| {
            columns.clone().all(|column| {
                if self.drawn[row][column] >= STALE {
                    self.farthest[row][column] = farthest(depths, column, row);
                    self.drawn[row][column] = 0;
                }
                nearest < self.farthest[row][column]
            })
        })
    }

    pub fn count_piece(&mut self, window: PixelWindow) {
        let [columns, rows] = blocks(window);
        for row in rows {
            for drawn in &mut self.drawn[row][columns.clone()] {
                *drawn = (*drawn + 1).min(STALE);
            }
        }
    }
}

fn blocks(window: PixelWindow) -> [Range<usize>; 2] {
    [0, 1].map(|axis| (window.from[axis] / BLOCK) as usize..window.to[axis].div_ceil(BLOCK) as usize)
}

fn farthest<const N: usize>(depths: &[[f32; N]], column: usize, row: usize) -> f32 {
    let (side, block) = (TILE as usize, BLOCK as usize);
    let lines = depths[row * block * side..][..block * side].chunks_exact(side);
    let mut least = [f32::MAX; N];
    for pixel in lines.flat_map(|line| &line[column * block..][..block]) {
        for (least, &depth) in least.iter_mut().zip(pixel) {
            *least = if depth < *least { depth } else { *least };
        }
    }
    least.into_iter().fold(f32::MAX, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: PixelWindow = PixelWindow { from: [0; 2], to: [TILE; 2] };

    fn depths(depth: f32) -> Vec<[f32; 1]> {
        vec![[depth]; (TILE * TILE) as usize]
    }

    #[test]
    fn only_pieces_behind_every_sample_of_their_blocks_are_hidden() {
        let mut depths = depths(0.5);
        depths[(TILE * 3 + 20) as usize] = [0.1];
        let window = |left: u32, right: u32| PixelWindow { from: [left, 2], to: [right, 5] };
        let mut occlusion = Occlusion::new();
        assert!(occlusion.hides(window(3, 12), 0.4, &depths));
        assert!(!occlusion.hides(window(3, 12), 0.5, &depths));
        assert!(!occlusion.hides(window(3, 20), 0.4, &depths));
        assert!(occlusion.hides(window(3, 20), 0.05, &depths));
    }

    #[test]
    fn nearer_depths_are_found_once_enough_pieces_were_drawn() {
        let mut occlusion = Occlusion::new();
        let window = PixelWindow { from: [0; 2], to: [8; 2] };
        assert!(!occlusion.hides(window, 0.4, &depths(0.1)));
        (1..STALE).for_each(|_| occlusion.count_piece(ALL));
        assert!(!occlusion.hides(window, 0.4, &depths(0.5)));
        occlusion.count_piece(ALL);
        assert!(occlusion.hides(window, 0.4, &depths(0.5)));
    }

    #[test]
    fn pieces_over_many_blocks_are_taken_to_be_visible() {
        assert!(!Occlusion::new().hides(ALL, 0.1, &depths(0.5)));
    }
}
