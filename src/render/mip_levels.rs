//! The smaller levels of a texture, averaged in linear light.
//!
//! Averaging sRGB bytes would darken fine bright detail. Each level halves both sides rounding down, as WebGPU
//! prescribes, and is kept as 8-bit sRGB: all levels together add a third to the texture's size. Where a side is odd, a
//! texel of the next level covers a fraction more than two texels. Weighting texels by the part covered keeps the
//! picture in place (NVIDIA 2005, "Non-Power-of-Two Mipmapping").

use std::iter::successors;

use glam::{Vec3, Vec4};

use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// Every smaller level of `texture`, the largest first, down to a single texel; none where a side is zero.
pub fn smaller_levels(texture: &Pixels) -> Vec<Pixels> {
    successors(next_level(texture), next_level).collect()
}

/// The next smaller level; `None` below a single texel.
fn next_level(level: &Pixels) -> Option<Pixels> {
    let (width, height) = (level.width(), level.height());
    if width.min(height) == 0 || width.max(height) == 1 {
        return None;
    }
    Some(Pixels::par_from_fn((width / 2).max(1), (height / 2).max(1), |x, y| {
        let mut by_alpha = Vec4::ZERO;
        let mut even = Vec3::ZERO;
        for (row, down) in covered(y, height) {
            for (column, across) in covered(x, width) {
                let (texel, weight) = (level.at(column, row), across * down);
                let (light, alpha) = (texel.linear(), texel.alpha());
                by_alpha += (light * alpha).extend(alpha) * weight;
                even += light * weight;
            }
        }
        mean(by_alpha, even)
    }))
}

/// The mean weighted by alpha, so that the color of transparent texels does not bleed into opaque ones. Where all are
/// transparent, the even mean, for surfaces that ignore alpha.
fn mean(by_alpha: Vec4, even: Vec3) -> Srgba {
    let light = if by_alpha.w > 0.0 { by_alpha.truncate() / by_alpha.w } else { even };
    let Srgba([red, green, blue, _]) = Srgba::from_linear(light);
    Srgba([red, green, blue, (by_alpha.w.clamp(0.0, 1.0) * 255.0 + 0.5) as u8])
}

/// The texels of a row of `side` that texel `index` of the next level covers, with their weights. Of `2 m + 1` texels,
/// texel `i` of the `m` below covers texel `2 i` to a part of `m - i`, the next one in full and the one after to a part
/// of `i + 1`, in `m`-ths: integers, so that no rounding adds up along the row.
fn covered(index: u32, side: u32) -> impl Iterator<Item = (u32, f32)> {
    let half = side / 2;
    let parts = match (side, side % 2) {
        (1, _) => [1, 0, 0],
        (_, 0) => [half, half, 0],
        _ => [half - index, half, index + 1],
    };
    (2 * index..)
        .zip(parts)
        .filter(|&(_, part)| part > 0)
        .map(move |(texel, part)| (texel, part as f32 / side as f32))
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
        let levels = smaller_levels(&board);
        assert_eq!(levels.iter().map(Pixels::width).collect::<Vec<_>>(), [2, 1]);
        assert_eq!(levels[1].at(0, 0), Srgba::opaque(188, 188, 188));
    }

    #[test]
    fn both_sides_shrink_to_one_and_an_empty_texture_has_no_levels() {
        let sizes: Vec<_> = smaller_levels(&Pixels::filled(13, 3, Srgba::WHITE))
            .iter()
            .map(|level| (level.width(), level.height()))
            .collect();
        assert_eq!(sizes, [(6, 1), (3, 1), (1, 1)]);
        for (width, height) in [(1, 1), (0, 8), (8, 0), (0, 0)] {
            assert!(smaller_levels(&Pixels::filled(width, height, Srgba::WHITE)).is_empty());
        }
    }

    #[test]
    fn odd_sides_keep_a_single_color_and_every_texel_counts_equally() {
        let color = Srgba([10, 200, 90, 128]);
        for level in smaller_levels(&Pixels::filled(7, 3, color)) {
            assert!(level.data().iter().all(|&texel| texel == color), "{level:?}");
        }
        for side in 1..40_u32 {
            let mut share = vec![0.0; side as usize];
            let all = (0..(side / 2).max(1)).flat_map(|index| covered(index, side));
            all.for_each(|(texel, weight)| share[texel as usize] += weight);
            assert!(share.iter().all(|&sum| (sum - share[0]).abs() < 1e-6), "{side}: {share:?}");
        }
    }

    #[test]
    fn odd_sides_shift_nothing() {
        for side in 1..40_u32 {
            let below = (side / 2).max(1);
            for index in 0..below {
                let middle: f32 = covered(index, side).map(|(texel, part)| (texel as f32 + 0.5) * part).sum();
                let expected = (index as f32 + 0.5) * side as f32 / below as f32;
                assert!((middle - expected).abs() < 0.1, "{side}, {index}: {middle} for {expected}");
                let whole: f32 = covered(index, side).map(|(_, part)| part).sum();
                assert!((whole - 1.0).abs() < 1e-6, "{side}, {index}: {whole}");
            }
        }
    }

    #[test]
    fn transparent_colors_do_not_bleed_into_opaque_ones() {
        let leaf = Srgba([20, 120, 30, 255]);
        let edge = Pixels::from_fn(2, 1, |x, _| if x == 0 { leaf } else { Srgba([255, 0, 255, 0]) });
        assert_eq!(smaller_levels(&edge)[0].at(0, 0), Srgba([20, 120, 30, 128]));
        let holes = Pixels::from_fn(2, 2, |x, _| Srgba([if x == 0 { 255 } else { 0 }, 7, 7, 0]));
        assert_eq!(smaller_levels(&holes)[0].at(0, 0), Srgba([188, 7, 7, 0]));
    }
}
