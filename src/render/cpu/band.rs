//! Tiles gathered in bands of 64 rows.
//!
//! A band first selects its pieces from all, and each of its tiles selects from those. Nothing is counted or sorted
//! beforehand, and pieces keep the list's order. Only the bands in work take memory, however many tiles the triangles
//! of a hostile list cover.
//!
//! Tiles differ in cost, the most by six times from the mean. The last that are begun are drawn in quarters, so that the
//! threads end together.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::cpu::geometry::FacePiece;
use crate::cpu::raster::PixelWindow;
use crate::cpu::tile::{TileContext, TileScratch, draw_tile};
use crate::cpu::visibility::TILE;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;

#[derive(Debug)]
pub struct BandRows<'a> {
    pub colors: &'a mut [Srgba],
    pub depths_m: &'a mut [f32],
    pub features: &'a mut [FeatureId],
}

/// The tiles of some bands that nobody has begun.
#[derive(Debug)]
pub struct TilesLeft(AtomicU32);

impl TilesLeft {
    /// Those of all `rows` of a picture.
    pub fn new(width: u32, rows: u32) -> Self {
        Self(AtomicU32::new(width.div_ceil(TILE) * rows.div_ceil(TILE)))
    }

    /// Begins a tile: its parts, which a pixel does not depend on.
    fn begin(&self, window: PixelWindow) -> Vec<PixelWindow> {
        let threads = rayon::current_num_threads();
        let left = self.0.fetch_sub(1, Ordering::Relaxed) as usize;
        if threads == 1 || left > threads { vec![window] } else { quarters(window).to_vec() }
    }
}

/// The quarters of a window, some of them empty where a side has one pixel.
fn quarters(PixelWindow { from: [left, top], to: [right, bottom] }: PixelWindow) -> [PixelWindow; 4] {
    let (x, y) = (left + (right - left).div_ceil(2), top + (bottom - top).div_ceil(2));
    [
        PixelWindow { from: [left, top], to: [x, y] },
        PixelWindow { from: [x, top], to: [right, y] },
        PixelWindow { from: [left, y], to: [x, bottom] },
        PixelWindow { from: [x, y], to: [right, bottom] },
    ]
}

/// Draws band `number`, counted from the top, into its rows.
pub fn draw_band<const N: usize>(frame: &TileContext<N>, number: u32, rows: BandRows, left: &TilesLeft) {
    let [width, height] = frame.screen.size;
    let (top, bottom) = (number * TILE, (number * TILE + TILE).min(height));
    let band = PixelWindow { from: [0, top], to: [width, bottom] };
    let pieces: Vec<FacePiece> = frame.geometry.pieces_in(band).copied().collect();
    let window =
        |tile: u32| PixelWindow { from: [tile * TILE, top], to: [(tile * TILE + TILE).min(width), bottom] };
    let draw =
        |scratch: &mut TileScratch<N>, part: PixelWindow| (part, draw_tile(frame, &pieces, part, scratch));
    let tiles: Vec<Vec<_>> = (0..width.div_ceil(TILE))
        .into_par_iter()
        // A thread that is done takes any tile that is left, one at a time.
        .with_max_len(1)
        .map_init(TileScratch::new, |scratch, tile| match &left.begin(window(tile))[..] {
            [whole] => vec![draw(scratch, *whole)],
            parts => parts
                .par_iter()
                .filter(|part| !part.is_empty())
                .map_init(TileScratch::new, |scratch, part| draw(scratch, *part))
                .collect(),
        })
        .collect();
    for (part, pixels) in tiles.into_iter().flatten() {
        let columns = (part.to[0] - part.from[0]) as usize;
        for (row, line) in (part.from[1] - top..).zip(pixels.chunks_exact(columns)) {
            let start = (row * width + part.from[0]) as usize;
            for (index, pixel) in (start..).zip(line) {
                rows.colors[index] = pixel.color;
                rows.depths_m[index] = pixel.depth_m;
                rows.features[index] = pixel.feature;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_tiles_are_drawn_in_quarters_that_hold_each_pixel_once() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        let window = PixelWindow { from: [64, 128], to: [101, 129] };
        let left = TilesLeft::new(65, 129);
        let parts: Vec<_> = pool.install(|| (0..6).map(|_| left.begin(window)).collect());
        assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), [1, 1, 1, 4, 4, 4]);
        let holds = |part: &PixelWindow, [x, y]: [u32; 2]| {
            let PixelWindow { from, to } = part;
            (from[0]..to[0]).contains(&x) && (from[1]..to[1]).contains(&y)
        };
        for at in (60..110).flat_map(|x| (126..132).map(move |y| [x, y])) {
            let count = parts[5].iter().filter(|part| holds(part, at)).count();
            assert_eq!(count, usize::from(holds(&window, at)), "{at:?}");
        }
    }

    #[test]
    fn one_thread_draws_whole_tiles() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        let window = PixelWindow { from: [0, 0], to: [64, 64] };
        assert_eq!(pool.install(|| TilesLeft::new(64, 64).begin(window)), [window]);
    }
}
