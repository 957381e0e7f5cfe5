//! Which face each sample of a tile sees: the outcome of the opaque and masked surfaces.
//!
//! A depth is kept as its inverse, which is linear over the picture; larger is nearer. Ground and drapes
//! must come in the list's order, layers rising, which makes the rules of [`crate::draw::list::DepthLayer`] local: whatever
//! a draped face meets is ground or a drape that it lies over. Solids come last, in any order: the nearest wins, and of
//! two at the same depth the first of the list.

use crate::render::cpu::geometry::{FaceId, FacePiece, ScreenFace};
use crate::render::cpu::occlusion::Occlusion;
use crate::render::cpu::pattern::{SampleMask, SamplePattern};
use crate::render::cpu::raster::{PixelWindow, cover};

/// Pixels along the side of a tile: 8 bytes a sample keep a tile of 8 samples within 256 KiB, the second
/// level cache of common processors.
pub const TILE: u32 = 64;

/// The faces seen in one tile and their inverse depths.
#[derive(Debug)]
pub struct Visibility<const N: usize> {
    window: PixelWindow,
    faces: Vec<[FaceId; N]>,
    depths: Vec<[f32; N]>,
    occlusion: Occlusion,
}

impl<const N: usize> Visibility<N> {
    /// Room for one tile.
    pub fn new() -> Self {
        let pixels = (TILE * TILE) as usize;
        Self {
            window: PixelWindow { from: [0; 2], to: [0; 2] },
            faces: vec![[FaceId::NONE; N]; pixels],
            depths: vec![[0.0; N]; pixels],
            occlusion: Occlusion::new(),
        }
    }

    /// Empties the tile and moves it to `window`, of at most [`TILE`] pixels a side; what lies beyond
    /// `farthest_m` will not be seen.
    pub fn clear(&mut self, window: PixelWindow, farthest_m: f64) {
        self.window = window;
        self.occlusion.clear();
        self.faces.fill([FaceId::NONE; N]);
        self.depths.fill([(1.0 / farthest_m) as f32; N]);
    }

    /// The faces the samples of a pixel see.
    pub fn faces(&self, x: u32, y: u32) -> &[FaceId; N] {
        &self.faces[self.index(x, y)]
    }

    /// The inverse depths at the samples of a pixel.
    pub fn depths(&self, x: u32, y: u32) -> &[f32; N] {
        &self.depths[self.index(x, y)]
    }

    fn index(&self, x: u32, y: u32) -> usize {
        ((y - self.window.from[1]) * TILE + x - self.window.from[0]) as usize
    }

    /// Whether a solid's piece may be seen in front of what is there; if so, takes note that it is drawn.
    ///
    /// To be asked of solids only, after everything else is drawn: it notes nothing else.
    pub fn may_show(&mut self, piece: &FacePiece, face: &ScreenFace) -> bool {
        let here = piece.window.and(self.window);
        let [left, top] = self.window.from;
        let within = |[x, y]: [u32; 2]| [x - left, y - top];
        let window = PixelWindow { from: within(here.from), to: within(here.to) };
        if self.occlusion.hides(window, face.range[1], &self.depths) {
            return false;
        }
        self.occlusion.note(window);
        true
    }

    /// Draws a piece of a solid or of the ground where it is nearer than what is there. Solids may come in any order:
    /// of two at the same depth the first of the list is kept.
    pub fn draw_nearer(&mut self, piece: &FacePiece, face: &ScreenFace, pattern: &SamplePattern<N>) {
        let id = piece.face;
        self.draw(piece, face, pattern, |new, there, other| new > there || (new == there && id.0 < other.0));
    }

    /// Draws a piece of a draped face where it is behind what is there by no more than the face's reach.
    pub fn draw_draped(&mut self, piece: &FacePiece, face: &ScreenFace, pattern: &SamplePattern<N>) {
        self.draw(piece, face, pattern, |new, there, _| new * face.reach >= there);
    }

    /// Draws a piece where `is_seen` says so of its inverse depth, the one there and the face there.
    ///
    /// The nearer of both depths is kept, so that drapes laid over each other do not sink step by step.
    fn draw(
        &mut self,
        piece: &FacePiece,
        face: &ScreenFace,
        pattern: &SamplePattern<N>,
        is_seen: impl Fn(f32, f32, FaceId) -> bool,
    ) {
        let slope = SampleDepths::of(face, pattern);
        cover(&piece.corners, pattern, piece.window.and(self.window), |x, y, mask| {
            let index = self.index(x, y);
            let new = slope.at(face, x, y);
            let (faces, depths) = (&mut self.faces[index], &mut self.depths[index]);
            for sample in 0..N {
                let seen = mask & (1 << sample) != 0 && is_seen(new[sample], depths[sample], faces[sample]);
                faces[sample] = if seen { piece.face } else { faces[sample] };
                depths[sample] = if seen { new[sample].max(depths[sample]) } else { depths[sample] };
            }
        });
    }

    /// Draws a piece with holes. Of the samples of a pixel, at `(x, y)`, that it would be seen at, `solid` tells those
    /// at which it has none; nothing changes at the others.
    ///
    /// Solids may come in any order: of two at the same depth the first of the list is kept.
    pub fn draw_masked(
        &mut self,
        piece: &FacePiece,
        face: &ScreenFace,
        pattern: &SamplePattern<N>,
        solid: impl Fn((u32, u32), SampleMask) -> SampleMask,
    ) {
        let slope = SampleDepths::of(face, pattern);
        cover(&piece.corners, pattern, piece.window.and(self.window), |x, y, mask| {
            let index = self.index(x, y);
            let new = slope.at(face, x, y);
            let (faces, depths) = (&mut self.faces[index], &mut self.depths[index]);
            let mut in_front = 0;
            for sample in 0..N {
                let there = depths[sample];
                let seen = if face.is_draped() {
                    new[sample] * face.reach >= there
                } else {
                    new[sample] > there || (new[sample] == there && piece.face.0 < faces[sample].0)
                };
                in_front |= SampleMask::from(seen) << sample;
            }
            let seen = mask & in_front;
            if seen == 0 {
                return;
            }
            let seen = solid((x, y), seen);
            for sample in (0..N).filter(|sample| seen & (1 << sample) != 0) {
                faces[sample] = piece.face;
                depths[sample] = new[sample].max(depths[sample]);
            }
        });
    }
}

/// How a face's inverse depth differs between a pixel's center and its samples.
#[derive(Clone, Copy, Debug)]
pub struct SampleDepths<const N: usize> {
    offsets: [f32; N],
}

impl<const N: usize> SampleDepths<N> {
    /// The differences for one face.
    pub fn of(face: &ScreenFace, pattern: &SamplePattern<N>) -> Self {
        let plane = &face.planes.inverse_depth;
        let change = |[x, y]: [i32; 2]| (plane.right * f64::from(x) + plane.down * f64::from(y)) / 16.0;
        Self { offsets: pattern.sixteenths.map(|offset| change(offset) as f32) }
    }

    /// The inverse depths at the samples of a pixel, kept to what the face's corners span.
    pub fn at(&self, face: &ScreenFace, x: u32, y: u32) -> [f32; N] {
        let center = face.planes.inverse_depth.at([x as f32 + 0.5, y as f32 + 0.5]) as f32;
        let [least, most] = face.range;
        self.offsets.map(|offset| (center + offset).max(least).min(most))
    }
}

/// The samples of `faces` that see `face`.
pub fn samples_of<const N: usize>(faces: &[FaceId; N], face: FaceId) -> SampleMask {
    let bits = faces.iter().enumerate().map(|(sample, &seen)| SampleMask::from(seen == face) << sample);
    bits.fold(0, |mask, bit| mask | bit)
}
