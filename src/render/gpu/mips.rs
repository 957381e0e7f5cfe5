//! A texture's levels in the forms a device takes.

use crate::draw::color::Srgba;
use crate::draw::pixels::Pixels;
use crate::render::mip_levels::smaller_levels;

/// `texture` and every smaller level down to a single texel; none where a side is zero. Levels larger than `limit` a
/// side are left out, so that a texture too large for the adapter is drawn coarser.
pub fn levels(texture: &Pixels, limit: u32) -> Vec<Pixels> {
    let fits = |level: &Pixels| (1..=limit).contains(&level.width()) && (1..=limit).contains(&level.height());
    let largest = fits(texture).then(|| texture.clone());
    largest.into_iter().chain(smaller_levels(texture).into_iter().filter(fits)).collect()
}

/// `level` with colors multiplied by alpha, in linear light.
pub fn premultiplied(level: &Pixels) -> Pixels {
    Pixels::from_fn(level.width(), level.height(), |x, y| {
        let texel = level.at(x, y);
        let Srgba([red, green, blue, _]) = Srgba::from_linear(texel.linear() * texel.alpha());
        Srgba([red, green, blue, texel.0[3]])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transparent_texels_are_black_when_multiplied() {
        let leaf = Srgba([20, 120, 30, 255]);
        let edge = Pixels::from_fn(2, 1, |x, _| if x == 0 { leaf } else { Srgba([255, 0, 255, 0]) });
        assert_eq!(premultiplied(&edge).data(), [leaf, Srgba([0, 0, 0, 0])]);
    }

    #[test]
    fn a_texture_too_large_for_the_adapter_starts_at_a_smaller_level() {
        let widths = |width, height, limit| -> Vec<u32> {
            levels(&Pixels::filled(width, height, Srgba::WHITE), limit).iter().map(Pixels::width).collect()
        };
        assert_eq!(widths(64, 8, 16), [16, 8, 4, 2, 1]);
        assert_eq!(widths(4, 4, 8192), [4, 2, 1]);
        assert!(widths(0, 8, 16).is_empty());
    }
}
