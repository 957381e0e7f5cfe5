//! Tiles gathered in bands: a picture's rows, 64 at a time.
//!
//! A band first picks its pieces out of all, and each of its tiles then picks from those. Nothing is
//! counted or sorted beforehand, pieces keep the list's order by themselves, and only the bands at work
//! take memory, however many tiles a hostile list's triangles cover.

use rayon::prelude::*;

use crate::draw::color::Srgba;
use crate::draw::list::FeatureId;
use crate::render::cpu::geometry::FacePiece;
use crate::render::cpu::pattern::SamplePattern;
use crate::render::cpu::raster::PixelWindow;
use crate::render::cpu::tile::{TileContext, TileScratch, draw_tile};
use crate::render::cpu::visibility::TILE;

/// The rows of a picture that a band writes.
#[derive(Debug)]
pub struct BandRows<'a> {
    /// Colors.
    pub colors: &'a mut [Srgba],
    /// Depths.
    pub depths_m: &'a mut [f32],
    /// Features.
    pub features: &'a mut [FeatureId],
}

/// Draws band `number`, counted from the top, into its rows.
pub fn draw_band<const N: usize>(
    frame: &TileContext,
    pattern: &SamplePattern<N>,
    number: u32,
    out: BandRows,
) {
    let [width, height] = frame.screen.size;
    let (top, bottom) = (number * TILE, (number * TILE + TILE).min(height));
    let band = PixelWindow { from: [0, top], to: [width, bottom] };
    let reaches = |piece: &&FacePiece| !piece.window.and(band).is_empty();
    let pieces: Vec<FacePiece> = frame.geometry.pieces().filter(reaches).copied().collect();
    let window =
        |tile: u32| PixelWindow { from: [tile * TILE, top], to: [(tile * TILE + TILE).min(width), bottom] };
    let tiles: Vec<_> = (0..width.div_ceil(TILE))
        .into_par_iter()
        .map_init(TileScratch::new, |scratch, tile| {
            (window(tile), draw_tile(frame, pattern, &pieces, window(tile), scratch))
        })
        .collect();
    for (window, pixels) in tiles {
        let columns = (window.to[0] - window.from[0]) as usize;
        for (row, line) in pixels.chunks_exact(columns).enumerate() {
            let start = row * width as usize + window.from[0] as usize;
            for (place, pixel) in (start..).zip(line) {
                out.colors[place] = pixel.color;
                out.depths_m[place] = pixel.depth_m;
                out.features[place] = pixel.feature;
            }
        }
    }
}
