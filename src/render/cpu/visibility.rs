//! The face that each sample of a tile sees, among opaque and masked surfaces.
//!
//! A depth is kept as its nearness, which is linear over the picture; larger is nearer. Ground and drapes must come in
//! the list's order, layers rising, which makes the rules of [`sandtable_draw::list::DepthLayer`] local: what a draped
//! face meets is ground or a drape that it lies over. Solids come last, in any order: the nearest wins, and of two at
//! the same depth the first of the list.

use crate::cpu::geometry::{FaceId, FacePiece, ScreenFace};
use crate::cpu::occlusion::Occlusion;
use crate::cpu::pattern::{SampleMask, SamplePattern};
use crate::cpu::raster::{PixelWindow, cover};

/// Pixels along the side of a tile: at 8 bytes per sample a tile of 8 samples takes 256 KiB, the second level cache of
/// common processors.
pub const TILE: u32 = 64;

#[derive(Debug)]
pub struct Visibility<const N: usize> {
    window: PixelWindow,
    faces: Vec<[FaceId; N]>,
    depths: Vec<[f32; N]>,
    occlusion: Occlusion,
}

impl<const N: usize> Visibility<N> {
    pub fn new() -> Self {
        let pixels = (TILE * TILE) as usize;
        Self {
            window: PixelWindow::EMPTY,
            faces: vec![[FaceId::NONE; N]; pixels],
            depths: vec![[0.0; N]; pixels],
            occlusion: Occlusion::new(),
        }
    }

    /// Empties the tile and moves it to `window`, of at most [`TILE`] pixels a side. Surfaces no nearer than
    /// `farthest` will not be seen.
    pub fn clear(&mut self, window: PixelWindow, farthest: f32) {
        self.window = window;
        self.occlusion = Occlusion::new();
        self.faces.fill([FaceId::NONE; N]);
        self.depths.fill([farthest; N]);
    }

    pub fn faces(&self, x: u32, y: u32) -> &[FaceId; N] {
        &self.faces[self.index(x, y)]
    }

    pub fn depths(&self, x: u32, y: u32) -> &[f32; N] {
        &self.depths[self.index(x, y)]
    }

    fn index(&self, x: u32, y: u32) -> usize {
        ((y - self.window.from[1]) * TILE + x - self.window.from[0]) as usize
    }

    /// Whether a solid's piece may be seen in front of the faces drawn before; if so, counts it as drawn. Must be
    /// called for solids only, after everything else is drawn.
    pub fn may_show(&mut self, piece: &FacePiece, face: &ScreenFace) -> bool {
        let visible = piece.window.intersection(self.window);
        let [left, top] = self.window.from;
        let in_tile = |[x, y]: [u32; 2]| [x - left, y - top];
        let window = PixelWindow { from: in_tile(visible.from), to: in_tile(visible.to) };
        if self.occlusion.hides(window, face.range[1], &self.depths) {
            return false;
        }
        self.occlusion.count_piece(window);
        true
    }

    /// Draws a piece where it is visible: a draped face where it is behind the surface there by no more than its reach,
    /// any other face where it is nearer. `solid` returns those of a pixel's seen samples that are not in a hole of the
    /// face. The nearer of both depths is kept, so that drapes laid over each other do not sink step by step.
    pub fn draw(
        &mut self,
        piece: &FacePiece,
        face: &ScreenFace,
        pattern: &SamplePattern<N>,
        solid: impl Fn((u32, u32), SampleMask) -> SampleMask,
    ) {
        let offsets = SampleDepths::new(face, pattern);
        cover(&piece.corners, pattern, piece.window.intersection(self.window), |x, y, mask| {
            let index = self.index(x, y);
            let new = offsets.at(face, x, y);
            let (faces, depths) = (&mut self.faces[index], &mut self.depths[index]);
            let mut in_front = 0;
            for sample in 0..N {
                let there = depths[sample];
                let is_seen = if face.reach > 1.0 {
                    new[sample] * face.reach >= there
                } else {
                    new[sample] > there || (new[sample] == there && piece.face.0 < faces[sample].0)
                };
                in_front |= SampleMask::from(is_seen) << sample;
            }
            let mut seen = mask & in_front;
            if seen != 0 {
                seen = solid((x, y), seen);
            }
            for sample in 0..N {
                let is_seen = seen & (1 << sample) != 0;
                faces[sample] = if is_seen { piece.face } else { faces[sample] };
                depths[sample] = if is_seen { new[sample].max(depths[sample]) } else { depths[sample] };
            }
        });
    }
}

/// The differences of a face's nearness between a pixel's center and its samples.
#[derive(Clone, Copy, Debug)]
pub struct SampleDepths<const N: usize> {
    offsets: [f32; N],
}

impl<const N: usize> SampleDepths<N> {
    pub fn new(face: &ScreenFace, pattern: &SamplePattern<N>) -> Self {
        let plane = &face.planes.nearness;
        let change = |[x, y]: [i32; 2]| (plane.right * f64::from(x) + plane.down * f64::from(y)) / 16.0;
        Self { offsets: pattern.sixteenths.map(|offset| change(offset) as f32) }
    }

    /// The nearnesses at the samples of a pixel, clamped to the range of the face's corners.
    pub fn at(&self, face: &ScreenFace, x: u32, y: u32) -> [f32; N] {
        let center = face.planes.nearness.at([x as f32 + 0.5, y as f32 + 0.5]) as f32;
        let [least, most] = face.range;
        self.offsets.map(|offset| (center + offset).max(least).min(most))
    }
}

pub fn samples_of<const N: usize>(faces: &[FaceId; N], face: FaceId) -> SampleMask {
    let bits = faces.iter().enumerate().map(|(sample, &seen)| SampleMask::from(seen == face) << sample);
    bits.fold(0, |mask, bit| mask | bit)
}
