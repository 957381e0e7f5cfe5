//! The samples of a pixel that lie on a masked face and not in one of its holes.
//!
//! Foliage is the most expensive thing to draw: leaf lies behind leaf, and every sample reads the mask. Constants of a
//! face are therefore computed once per face, and the mask's footprint, which hardly changes across a pixel, once per
//! pixel, as graphics hardware does. A sample only reads the mask's alpha at its own position, and not even that where the
//! mask has no hole, or is nothing but one, all around the pixel.

use glam::Vec2;

use crate::cpu::geometry::ScreenFace;
use crate::cpu::hit::Barycentric;
use crate::cpu::pattern::{SampleMask, SamplePattern};
use crate::cpu::texture::Texture;
use sandtable_draw::material::TextureWrap;

/// The part of a pixel's side that a sample reads the mask over: the square root of an eighth, as most pictures have
/// eight samples per pixel.
const SAMPLE_SIDE: f32 = 0.354;

/// How far samples lie from the middle of their pixel each way, in pixels, and a rounding more.
const FARTHEST_SAMPLE: f32 = 7.01 / 16.0;

#[derive(Clone, Copy, Debug)]
pub struct Cutout<'a> {
    pub face: &'a ScreenFace,
    /// Alpha below this is a hole.
    pub cutoff: f32,
    /// The alpha at the face's corners, without the texture's.
    pub alphas: [f32; 3],
    pub texture: Option<(&'a Texture<'a>, [[f32; 2]; 3])>,
    /// What the texture shows beyond its borders.
    pub wrap: [TextureWrap; 2],
    /// The most readings of the texture along a pixel.
    pub most_taps: u32,
}

impl Cutout<'_> {
    /// Those of `samples` of pixel `(x, y)`, all on the face, that do not lie in a hole.
    pub fn solid<const N: usize>(
        &self,
        (x, y): (u32, u32),
        samples: SampleMask,
        pattern: &SamplePattern<N>,
    ) -> SampleMask {
        let weights = Barycentric::new(self.face, pattern.centroid_in(x, y, samples));
        let alpha = weights.blend_number(self.alphas);
        let Some((texture, corners)) = self.texture else {
            return if alpha < self.cutoff { 0 } else { samples };
        };
        let [uv, across, along] = weights.blend_uv(corners);
        let mask = &texture.alpha;
        let footprint = mask.footprint(across * SAMPLE_SIDE, along * SAMPLE_SIDE, self.most_taps);
        let center = Vec2::from(pattern.centroid(samples));
        let middle = uv - across * center.x - along * center.y;
        match mask.bounds(middle, (across.abs() + along.abs()) * FARTHEST_SAMPLE, &footprint) {
            // A product of numbers that are not negative is the lesser, the lesser they are.
            Some([least, _]) if alpha >= 0.0 && alpha * least >= self.cutoff => return samples,
            Some([_, greatest]) if alpha >= 0.0 && alpha * greatest < self.cutoff => return 0,
            _ => {}
        }
        let mut solid = 0;
        for sample in (0..N).filter(|sample| samples & (1 << sample) != 0) {
            let offset = Vec2::from(pattern.offset(sample)) - center;
            let at = uv + across * offset.x + along * offset.y;
            let is_hole = alpha * mask.sample(at, &footprint, self.wrap) < self.cutoff;
            solid |= SampleMask::from(!is_hole) << sample;
        }
        solid
    }
}
