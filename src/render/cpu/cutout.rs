//! Which samples of a pixel see a masked face and not through it.
//!
//! Foliage is the dearest thing there is to draw: leaf lies behind leaf, and every sample reads the mask anew. So what
//! is the same all over a face is looked up once a face, and what hardly changes across a pixel (how large a part of
//! the mask a pixel spans, and which way it runs) is worked out once a pixel, as graphics hardware does; a sample only
//! reads the mask's alpha at its own place.

use glam::Vec2;

use crate::render::cpu::geometry::ScreenFace;
use crate::render::cpu::hit::Barycentric;
use crate::render::cpu::pattern::{SampleMask, SamplePattern};
use crate::render::cpu::texture::Texture;

/// The part of a pixel's side that a sample reads the mask over: the square root of an eighth, as there are eight
/// samples in most pictures.
const SAMPLE_SIDE: f32 = 0.354;

/// A face with its mask.
#[derive(Clone, Copy, Debug)]
pub struct Cutout<'a> {
    /// The face.
    pub face: &'a ScreenFace,
    /// Below this alpha there is a hole.
    pub cutoff: f32,
    /// The alpha at the face's corners, apart from the texture's.
    pub alphas: [f32; 3],
    /// The texture, and where in it the corners lie.
    pub texture: Option<(&'a Texture<'a>, [[f32; 2]; 3])>,
    /// The most readings of the texture along a pixel.
    pub most_taps: u32,
}

impl Cutout<'_> {
    /// Those of `samples`, all on the face, of pixel `(x, y)` at which there is no hole.
    pub fn solid<const N: usize>(
        &self,
        (x, y): (u32, u32),
        samples: SampleMask,
        pattern: &SamplePattern<N>,
    ) -> SampleMask {
        let [right, down] = pattern.centroid(samples);
        let shares = Barycentric::of(self.face, [x as f32 + 0.5 + right, y as f32 + 0.5 + down]);
        let [a, b, c] = self.alphas;
        let alpha = shares.blend_number([a, b, c]);
        let Some((texture, corners)) = self.texture else {
            return if alpha < self.cutoff { 0 } else { samples };
        };
        let [uv, across, along] = shares.blend_uv(corners);
        let mask = texture.alpha();
        let reading = mask.reading(across * SAMPLE_SIDE, along * SAMPLE_SIDE, self.most_taps);
        let mut solid = 0;
        for sample in (0..N).filter(|sample| samples & (1 << sample) != 0) {
            let offset = Vec2::from(pattern.offset(sample)) - Vec2::new(right, down);
            let at = uv + across * offset.x + along * offset.y;
            let hole = alpha * mask.at(at, &reading) < self.cutoff;
            solid |= SampleMask::from(!hole) << sample;
        }
        solid
    }
}
