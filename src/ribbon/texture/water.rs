//! Running water.

use crate::texture::shade::shade;
use sandtable_draw::color::Srgba;

pub(super) fn river(u: f32, grain: f32) -> Srgba {
    let depth = 1.0 - (2.0 * u - 1.0).abs();
    let light = (depth * 2.2).min(1.0);
    let mix = |bank: f32, stream: f32| bank + (stream - bank) * light;
    shade([mix(38.0, 92.0) as u8, mix(84.0, 150.0) as u8, mix(118.0, 190.0) as u8], (grain - 0.5) * 8.0)
}

/// The middle of running water.
pub(super) fn stream(grain: f32) -> Srgba {
    shade([92, 150, 190], (grain - 0.5) * 8.0)
}

/// Still water.
pub(super) fn lake(grain: f32) -> Srgba {
    shade([92, 150, 190], (grain - 0.5) * 5.0)
}

/// A bank, from its outer edge on either side: damp green that fades into the ground.
pub(super) fn bank(u: f32, grain: f32) -> Srgba {
    /// How far from the edge, as a part of banks and water together, the bank is opaque.
    const FADE: f32 = 0.06;
    let alpha = (u.min(1.0 - u) / FADE).min(1.0) * 0.75;
    let Srgba([red, green, blue, _]) = shade([116, 138, 92], (grain - 0.5) * 24.0);
    Srgba([red, green, blue, (alpha * 255.0 + 0.5) as u8])
}
