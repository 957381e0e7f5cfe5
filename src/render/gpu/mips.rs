//! A texture and its ever smaller copies, averaged in linear light.
//!
//! Averaging the sRGB bytes themselves would darken what is fine and bright. Each level halves both sides
//! rounding down, as WebGPU prescribes; where a side is odd a texel of the next level covers a fraction more
//! than two, and the weights below account for it, so that nothing shifts.

use glam::{Vec3, Vec4};

use crate::draw::color::{Srgba, srgb_from_linear};
use crate::draw::pixels::Pixels;

/// `texture` and every smaller level down to a single texel. Levels larger than `limit` a side are left out,
/// so that a texture too large for the adapter is drawn coarser instead of not at all.
///
/// None at all where a side is zero.
pub(in crate::render::gpu) fn levels(texture: &Pixels, limit: u32) -> Vec<Pixels> {
    if texture.width() == 0 || texture.height() == 0 {
        return Vec::new();
    }
    let mut levels = vec![texture.clone()];
    while let Some(smaller) = levels.last().and_then(half) {
        if levels.last().is_some_and(|last| last.width() > limit || last.height() > limit) {
            levels.pop();
        }
        levels.push(smaller);
    }
    levels
}

/// The same picture with colours multiplied by alpha, in linear light.
pub(in crate::render::gpu) fn premultiplied(level: &Pixels) -> Pixels {
    Pixels::from_fn(level.width(), level.height(), |x, y| {
        let texel = level.at(x, y);
        let Srgba([red, green, blue, _]) = Srgba::from_linear(texel.linear() * texel.alpha());
        Srgba([red, green, blue, texel.0[3]])
    })
}

/// The next smaller level; `None` below a single texel.
fn half(level: &Pixels) -> Option<Pixels> {
    let (width, height) = (level.width(), level.height());
    if width == 1 && height == 1 {
        return None;
    }
    let (columns, rows) = (spans(width), spans(height));
    Some(Pixels::from_fn(columns.len() as u32, rows.len() as u32, |x, y| {
        let mut seen = Vec4::ZERO;
        let mut all = Vec3::ZERO;
        for (row, row_weight) in rows[y as usize] {
            for (column, column_weight) in columns[x as usize] {
                let (texel, weight) = (level.at(column, row), row_weight * column_weight);
                let (light, alpha) = (texel.linear(), texel.alpha());
                seen += (light * alpha).extend(alpha) * weight;
                all += light * weight;
            }
        }
        mean(seen, all)
    }))
}

/// The mean colour weighted by alpha, so that the colour of what is invisible does not bleed into what is
/// not; where all is invisible, the plain mean, for surfaces that ignore alpha.
fn mean(seen: Vec4, all: Vec3) -> Srgba {
    let light = if seen.w > 0.0 { seen.truncate() / seen.w } else { all };
    let [red, green, blue] = light.to_array().map(srgb_from_linear);
    Srgba([red, green, blue, (seen.w.clamp(0.0, 1.0) * 255.0 + 0.5) as u8])
}

/// For every texel of a side half as long, the three texels it covers and the share of each.
fn spans(side: u32) -> Vec<[(u32, f32); 3]> {
    let target = (side / 2).max(1);
    let length = side as f32 / target as f32;
    (0..target)
        .map(|index| {
            let (start, end) = (index as f32 * length, (index + 1) as f32 * length);
            std::array::from_fn(|step| {
                let texel = start as u32 + step as u32;
                let overlap = end.min(texel as f32 + 1.0) - start.max(texel as f32);
                (texel.min(side - 1), overlap.max(0.0) / length)
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkerboard_averages_to_half_the_light_not_half_the_bytes() {
        let board = Pixels::from_fn(4, 4, |x, y| match (x + y) % 2 {
            0 => Srgba::WHITE,
            _ => Srgba::opaque(0, 0, 0),
        });
        let levels = levels(&board, 8192);
        assert_eq!(levels.iter().map(Pixels::width).collect::<Vec<_>>(), [4, 2, 1]);
        assert_eq!(levels[2].at(0, 0), Srgba::opaque(188, 188, 188));
    }

    #[test]
    fn odd_sides_keep_a_single_colour_and_every_texel_counts_equally() {
        let color = Srgba([10, 200, 90, 128]);
        for level in levels(&Pixels::filled(7, 3, color), 8192) {
            assert!(level.data().iter().all(|&texel| texel == color), "{level:?}");
        }
        for side in 1..40 {
            let mut share = vec![0.0; side as usize];
            spans(side).iter().flatten().for_each(|&(texel, weight)| share[texel as usize] += weight);
            assert!(share.iter().all(|&sum| (sum - share[0]).abs() < 1e-4), "{side}: {share:?}");
        }
    }

    #[test]
    fn what_is_invisible_does_not_bleed_into_what_is_not() {
        let leaf = Srgba([20, 120, 30, 255]);
        let edge = Pixels::from_fn(2, 1, |x, _| if x == 0 { leaf } else { Srgba([255, 0, 255, 0]) });
        assert_eq!(levels(&edge, 64)[1].at(0, 0), Srgba([20, 120, 30, 128]));
        assert_eq!(premultiplied(&edge).data(), [leaf, Srgba([0, 0, 0, 0])]);
    }

    #[test]
    fn a_texture_too_large_for_the_adapter_starts_at_a_smaller_level() {
        let sides: Vec<u32> =
            levels(&Pixels::filled(64, 8, Srgba::WHITE), 16).iter().map(Pixels::width).collect();
        assert_eq!(sides, [16, 8, 4, 2, 1]);
        assert!(levels(&Pixels::filled(0, 8, Srgba::WHITE), 16).is_empty());
    }
}
