//! Transparent surfaces: sorted per pixel and laid over the opaque picture, sample by sample.
//!
//! Fragments are collected after everything opaque of a tile is known, so none is kept that cannot be seen.
//! They are kept in order from the nearest to the farthest while they come in, drapes by the rule of
//! layers; colors are then laid over each other exactly, with no dithering and no limit on overlap but
//! [`MOST_LAYERS`].

use glam::Vec3;

use crate::draw::list::DepthLayer;
use crate::render::cpu::geometry::{FaceId, FacePiece, ScreenFace, ScreenGeometry};
use crate::render::cpu::pattern::{SampleMask, SamplePattern};
use crate::render::cpu::raster::{PixelWindow, cover};
use crate::render::cpu::shade::Shader;
use crate::render::cpu::visibility::{SampleDepths, TILE, Visibility};

/// Transparent fragments a pixel keeps; of more, the farthest is dropped. Bounds memory to 2 MiB a tile.
const MOST_LAYERS: usize = 32;

/// No fragment.
const END: u32 = u32::MAX;

/// From this alpha on a transparent surface counts as what is seen at a pixel, in depths and features.
const SEEN_ALPHA: f32 = 0.5;

/// A transparent face in one pixel.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    face: FaceId,
    next: u32,
    inverse_depth: f32,
    mask: SampleMask,
}

/// The transparent fragments of one tile.
#[derive(Debug)]
pub struct Blend {
    window: PixelWindow,
    heads: Vec<u32>,
    fragments: Vec<Fragment>,
}

impl Blend {
    /// Room for one tile.
    pub fn new() -> Self {
        Self {
            window: PixelWindow { from: [0; 2], to: [0; 2] },
            heads: vec![END; (TILE * TILE) as usize],
            fragments: Vec::new(),
        }
    }

    /// Empties the tile and moves it to `window`.
    pub fn clear(&mut self, window: PixelWindow) {
        self.window = window;
        self.fragments.clear();
        self.heads.fill(END);
    }

    /// Whether nothing transparent was drawn.
    pub fn is_empty(&self) -> bool {
        self.fragments.is_empty()
    }

    fn index(&self, x: u32, y: u32) -> usize {
        ((y - self.window.from[1]) * TILE + x - self.window.from[0]) as usize
    }

    /// Adds what of a transparent piece lies before the opaque surfaces.
    pub fn draw<const N: usize>(
        &mut self,
        piece: &FacePiece,
        (geometry, shader): (&ScreenGeometry, &Shader),
        visibility: &Visibility<N>,
        pattern: &SamplePattern<N>,
    ) {
        let face = geometry.face(piece.face);
        let slope = SampleDepths::of(face, pattern);
        cover(&piece.corners, pattern, piece.window.and(self.window), |x, y, mask| {
            let new = slope.at(face, x, y);
            let (faces, depths) = (visibility.faces(x, y), visibility.depths(x, y));
            let mut seen = 0;
            for sample in (0..N).filter(|sample| mask & (1 << sample) != 0) {
                let id = faces[sample];
                let there = (id != FaceId::NONE).then(|| geometry.face(id));
                seen |= SampleMask::from(shows_before(face, new[sample], there, depths[sample], shader)) << sample;
            }
            if seen != 0 {
                let [right, down] = pattern.centroid(seen);
                let inverse_depth = face.inverse_depth([x as f32 + 0.5 + right, y as f32 + 0.5 + down]);
                let fragment = Fragment { face: piece.face, next: END, inverse_depth, mask: seen };
                self.insert(self.index(x, y), fragment, face);
            }
        });
    }

    /// Puts a fragment before the first of its pixel that does not lie in front of it.
    fn insert(&mut self, pixel: usize, mut fragment: Fragment, face: &ScreenFace) {
        let (mut before, mut here, mut count) = (END, self.heads[pixel], 0);
        while here != END && self.fragments[here as usize].inverse_depth > fragment.inverse_depth * face.reach
        {
            (before, here, count) = (here, self.fragments[here as usize].next, count + 1);
        }
        if count == MOST_LAYERS {
            return;
        }
        fragment.next = here;
        let new = self.fragments.len() as u32;
        self.fragments.push(fragment);
        match before {
            END => self.heads[pixel] = new,
            before => self.fragments[before as usize].next = new,
        }
        self.drop_farthest(new, count);
    }

    /// Ends a pixel's chain after [`MOST_LAYERS`] fragments; `at` is the `count`-th.
    fn drop_farthest(&mut self, mut at: u32, mut count: usize) {
        while at != END {
            count += 1;
            if count == MOST_LAYERS {
                self.fragments[at as usize].next = END;
            }
            at = self.fragments[at as usize].next;
        }
    }

    fn chain(&self, x: u32, y: u32) -> impl Iterator<Item = &Fragment> {
        let at = |index: u32| (index != END).then(|| &self.fragments[index as usize]);
        std::iter::successors(at(self.heads[self.index(x, y)]), move |fragment| at(fragment.next))
    }

    /// Lays a pixel's fragments over the `colors` of its samples, and returns the face that is seen at the
    /// first sample in place of the opaque one, if any.
    pub fn lay_over<const N: usize>(
        &self,
        (x, y): (u32, u32),
        colors: &mut [Vec3; N],
        (geometry, shader): (&ScreenGeometry, &Shader),
        pattern: &SamplePattern<N>,
    ) -> Option<FaceId> {
        let mut chain = [None; MOST_LAYERS];
        let mut count = 0;
        for (place, fragment) in chain.iter_mut().zip(self.chain(x, y)) {
            *place = Some(fragment);
            count += 1;
        }
        let mut seen = None;
        for fragment in chain[..count].iter().rev().flatten() {
            let [right, down] = pattern.centroid(fragment.mask);
            let at = [x as f32 + 0.5 + right, y as f32 + 0.5 + down];
            let shaded = shader.shade(geometry.face(fragment.face), at);
            for (sample, color) in colors.iter_mut().enumerate() {
                if fragment.mask & (1 << sample) != 0 {
                    *color = color.lerp(shaded.color, shaded.alpha);
                }
            }
            if fragment.mask & 1 != 0 && shaded.alpha >= SEEN_ALPHA {
                seen = Some(fragment.face);
            }
        }
        seen
    }
}

/// Whether a transparent face at inverse depth `new` shows before the opaque face that is `there`.
///
/// In the same plane a drape shows over the ground and over drapes that come before it in the list, and is
/// covered by drapes that come after it.
fn shows_before(
    face: &ScreenFace,
    new: f32,
    there: Option<&ScreenFace>,
    depth: f32,
    shader: &Shader,
) -> bool {
    let Some(opaque) = there else { return new > depth };
    match (shader.item(face).layer, shader.item(opaque).layer) {
        (DepthLayer::Draped(_), DepthLayer::Draped(_)) if opaque.item > face.item => new > depth * face.reach,
        (DepthLayer::Draped(_), DepthLayer::Ground | DepthLayer::Draped(_)) => new * face.reach >= depth,
        _ => new > depth,
    }
}
