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

/// The length of the streaks of white water in texels.
pub(super) const STREAK: u32 = 16;

/// Rapids: streaks of foam on running water, `streak` being the number of each, 0..1.
pub(super) fn rapids(u: f32, streak: f32) -> Srgba {
    white(u, 0.75 * (2.0 * streak - 0.9).clamp(0.0, 1.0), streak)
}

/// Falls: foam with streaks of water.
pub(super) fn falls(u: f32, streak: f32) -> Srgba {
    white(u, 0.45 + 0.55 * (1.6 * streak).min(1.0), streak)
}

/// Running water under this share of foam; less of it along the banks.
fn white(u: f32, foam: f32, grain: f32) -> Srgba {
    /// How far from the banks foam is at its most, as a part of the water's width.
    const CALM: f32 = 0.12;
    let foam = foam * (u.min(1.0 - u) / CALM).min(1.0);
    let Srgba([red, green, blue, _]) = river(u, grain);
    let mix = |water: u8, white: f32| (f32::from(water) * (1.0 - foam) + white * foam) as u8;
    Srgba::opaque(mix(red, 236.0), mix(green, 242.0), mix(blue, 244.0))
}

/// A bar: dry sand and gravel in its middle, wet along its sides.
pub(super) fn bar(u: f32, grain: f32) -> Srgba {
    let dry = (u.min(1.0 - u) * 3.0).min(1.0);
    let mix = |wet: f32, sand: f32| (wet + (sand - wet) * dry) as u8;
    shade([mix(140.0, 206.0), mix(136.0, 194.0), mix(116.0, 162.0)], (grain - 0.5) * 26.0)
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
