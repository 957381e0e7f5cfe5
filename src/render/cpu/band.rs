//! Tiles gathered in bands of 64 rows.
//!
//! A band first selects its pieces from all, and each of its tiles selects from those. Nothing is counted or sorted
//! beforehand, and pieces keep the list's order. Only the bands in work take memory, however many tiles the triangles
//! of a hostile list cover.

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

/// Draws band `number`, counted from the top, into its rows.
pub fn draw_band<const N: usize>(frame: &TileContext<N>, number: u32, rows: BandRows) {
    let [width, height] = frame.screen.size;
    let (top, bottom) = (number * TILE, (number * TILE + TILE).min(height));
    let band = PixelWindow { from: [0, top], to: [width, bottom] };
    let pieces: Vec<FacePiece> = frame.geometry.pieces_in(band).copied().collect();
    let window =
        |tile: u32| PixelWindow { from: [tile * TILE, top], to: [(tile * TILE + TILE).min(width), bottom] };
    let tiles: Vec<_> = (0..width.div_ceil(TILE))
        .into_par_iter()
        // Tiles differ in cost: a thread that is done takes any that is left, one at a time.
        .with_max_len(1)
        .map_init(TileScratch::new, |scratch, tile| {
            (window(tile), draw_tile(frame, &pieces, window(tile), scratch))
        })
        .collect();
    for (window, pixels) in tiles {
        let columns = (window.to[0] - window.from[0]) as usize;
        for (row, line) in pixels.chunks_exact(columns).enumerate() {
            let start = row * width as usize + window.from[0] as usize;
            for (index, pixel) in (start..).zip(line) {
                rows.colors[index] = pixel.color;
                rows.depths_m[index] = pixel.depth_m;
                rows.features[index] = pixel.feature;
            }
        }
    }
}
