//! Boundaries and the floors of trenches.

use crate::texture::shade::shade;
use sandtable_draw::color::Srgba;

/// A dash of a boundary: the violet that maps keep for what cannot be seen on the ground.
pub(super) fn boundary(u: f32, grain: f32) -> Srgba {
    let from_edge = u.min(1.0 - u);
    let ink = if from_edge < 0.12 { [92, 38, 72] } else { [122, 52, 94] };
    shade(ink, (grain - 0.5) * 8.0)
}

/// Half a trench as a share of the bare earth across it, parapets included.
const TRENCH_HALF: f32 = 0.192;

/// A trench seen from above: its sides catch some light, its floor lies in their shade.
pub(super) fn trench(u: f32, grain: f32) -> Srgba {
    let inside = 1.0 - (u - 0.5).abs() / TRENCH_HALF;
    if inside < 0.0 {
        return shade([150, 122, 88], (grain - 0.5) * 16.0);
    }
    let depth = (inside * 1.9).min(1.0);
    let color = [132.0 - 74.0 * depth, 104.0 - 62.0 * depth, 74.0 - 46.0 * depth];
    shade(color.map(|channel: f32| channel as u8), (grain - 0.5) * 16.0)
}
