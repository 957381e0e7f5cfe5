//! The shades of a color and the grain that textures have.

use sandtable_draw::color::Srgba;

/// A color, lighter by a number of steps of 255.
pub(super) fn shade(color: [u8; 3], by: f32) -> Srgba {
    let [red, green, blue] = color.map(|channel| (f32::from(channel) + by).clamp(0.0, 255.0) as u8);
    Srgba::opaque(red, green, blue)
}

/// A fixed number in 0..1 for each pixel, without pattern (a 32-bit integer hash, Wellons 2018).
pub(super) fn grain(x: u32, y: u32) -> f32 {
    let mut hash = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 16).wrapping_mul(0x7feb_352d);
    hash = (hash ^ hash >> 15).wrapping_mul(0x846c_a68b);
    (hash >> 16 & 0xffff) as f32 / 65536.0
}
