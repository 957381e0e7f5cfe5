//! Running water.

use crate::draw::color::Srgba;
use crate::ribbon::texture::shade;

pub(super) fn river(u: f32, grain: f32) -> Srgba {
    let depth = 1.0 - (2.0 * u - 1.0).abs();
    let light = (depth * 2.2).min(1.0);
    let mix = |bank: f32, stream: f32| bank + (stream - bank) * light;
    shade([mix(38.0, 92.0) as u8, mix(84.0, 150.0) as u8, mix(118.0, 190.0) as u8], (grain - 0.5) * 8.0)
}
