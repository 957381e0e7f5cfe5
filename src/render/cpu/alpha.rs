//! The alpha of a texture, stored apart and read for masks.
//!
//! Alpha is read far more often than color: at every sample, and at every leaf behind another. It is therefore stored
//! as bytes of its own, a quarter of the texture's size. A reading is one bilinear tap of the level whose texels are
//! nearest in size to a sample's share of the pixel. More taps are taken only where that share is at least 1.5 times
//! as long as wide. Blending two levels, as colors need, would not show: a reading ends as yes or no, and the samples
//! of a pixel are averaged after it.

use glam::{UVec2, Vec2};

use sandtable_draw::material::TextureWrap;
use sandtable_draw::pixels::Pixels;

#[derive(Debug)]
pub struct AlphaMask {
    /// The largest first; none where the texture is opaque or empty.
    levels: Vec<AlphaLevel>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskFootprint {
    level: usize,
    taps: u32,
    axis: Vec2,
}

#[derive(Debug)]
struct AlphaLevel {
    size: [u32; 2],
    alphas: Vec<u8>,
    /// The least and the greatest alpha of the square of [`AROUND`] texels a side that begins at each texel, as far as there
    /// are any: where all are far from the cutoff, no sample of a pixel need be read.
    extremes: Vec<[u8; 2]>,
}

/// The side of the squares of which extremes are known. Two of them reach across the texels of most pixels.
const AROUND: u32 = 4;

impl AlphaMask {
    pub fn new(base: &Pixels, smaller: &[Pixels]) -> Self {
        let is_opaque = base.data().iter().all(|color| color.0[3] == u8::MAX);
        let levels = std::iter::once(base).chain(smaller).map(AlphaLevel::new);
        Self { levels: if is_opaque { Vec::new() } else { levels.collect() } }
    }

    /// The footprint of a sample whose share of the pixel is the parallelogram of the sides `right` and `down`, with
    /// at most `most_taps` taps. Sides that are not finite read the coarsest level once.
    pub fn footprint(&self, right: Vec2, down: Vec2, most_taps: u32) -> MaskFootprint {
        let scale =
            self.levels.first().map_or(Vec2::ONE, |level| Vec2::from(level.size.map(|side| side as f32)));
        let (across, along) = ((right * scale).length_squared(), (down * scale).length_squared());
        let (longer, shorter) = (across.max(along), across.min(along).max(1.0));
        let last = self.levels.len().saturating_sub(1);
        if !(across + along).is_finite() {
            return MaskFootprint { level: last, taps: 1, axis: Vec2::ZERO };
        }
        // 1.5 squared: below it the ratio of the sides rounds to one tap.
        let taps = if longer < 2.25 * shorter { 1.0 } else { (longer / shorter).sqrt().round() };
        let taps = taps.clamp(1.0, most_taps.max(1) as f32);
        let axis = if across > along { right } else { down };
        MaskFootprint { level: nearest_level(longer / (taps * taps)).min(last), taps: taps as u32, axis }
    }

    /// Bounds of [`AlphaMask::sample`] at all places up to `reach` around `uv`, each way; `None` where these are many, or the
    /// texture ends between them.
    pub fn bounds(&self, uv: Vec2, reach: Vec2, footprint: &MaskFootprint) -> Option<[f32; 2]> {
        let level = self.levels.get(footprint.level)?;
        let reach = if footprint.taps == 1 { reach } else { reach + footprint.axis.abs() * 0.5 };
        let [least, greatest] = level.extremes_within(uv - reach, uv + reach)?;
        // Half a step of alpha is more than any rounding.
        Some([(f32::from(least) - 0.5) / 255.0, (f32::from(greatest) + 0.5) / 255.0])
    }

    /// The alpha around `uv`, 0..=1, of a texture that goes on beyond its borders as `wrap` says.
    pub fn sample(&self, uv: Vec2, footprint: &MaskFootprint, wrap: [TextureWrap; 2]) -> f32 {
        let Some(level) = self.levels.get(footprint.level) else { return 1.0 };
        if footprint.taps == 1 {
            return level.bilinear(uv, wrap);
        }
        let taps = footprint.taps as f32;
        let offset = |tap: u32| footprint.axis * ((tap as f32 + 0.5) / taps - 0.5);
        (0..footprint.taps).map(|tap| level.bilinear(uv + offset(tap), wrap)).sum::<f32>() / taps
    }
}

/// The mip level whose texels are nearest in size to a square of area `area`, in texels of the largest level: half the
/// base-2 logarithm, rounded, taken from the float's exponent.
fn nearest_level(area: f32) -> usize {
    let exponent = (area.max(1.0) * 2.0).to_bits() >> (f32::MANTISSA_DIGITS - 1);
    (exponent as usize).saturating_sub(f32::MAX_EXP as usize - 1) / 2
}

impl AlphaLevel {
    fn new(pixels: &Pixels) -> Self {
        let size = [pixels.width(), pixels.height()];
        let alphas: Vec<u8> = pixels.data().iter().map(|color| color.0[3]).collect();
        let width = size[0].max(1) as usize;
        let wider =
            |[least, greatest]: [u8; 2], other: [u8; 2]| [least.min(other[0]), greatest.max(other[1])];
        // Along the rows, then along the columns.
        let mut extremes: Vec<[u8; 2]> = alphas.iter().map(|&alpha| [alpha; 2]).collect();
        for row in extremes.chunks_exact_mut(width) {
            for at in 0..width {
                let next = &row[at..width.min(at + AROUND as usize)];
                row[at] = next.iter().copied().fold(row[at], wider);
            }
        }
        for at in 0..extremes.len() {
            let below = extremes[at..].iter().step_by(width).take(AROUND as usize);
            extremes[at] = below.copied().fold(extremes[at], wider);
        }
        Self { size, alphas, extremes }
    }

    /// The extremes of the texels that bilinear readings between two places take in.
    fn extremes_within(&self, from: Vec2, to: Vec2) -> Option<[u8; 2]> {
        let size = Vec2::from(self.size.map(|side| side as f32));
        let (low, high) = (from * size - 0.5, to * size - 0.5);
        if !(low.cmpge(Vec2::ZERO).all() && high.cmplt(size - 1.0).all()) {
            return None;
        }
        // The second texel of the last reading.
        let (first, last) = (low.as_uvec2(), high.as_uvec2() + 1);
        if (last - first).max_element() >= 2 * AROUND {
            return None;
        }
        let second = (last + 1).saturating_sub(UVec2::splat(AROUND)).max(first);
        let at = |x: u32, y: u32| self.extremes[(y * self.size[0] + x) as usize];
        let corners =
            [at(first.x, first.y), at(second.x, first.y), at(first.x, second.y), at(second.x, second.y)];
        let [least, greatest] = [0, 1].map(|bound| corners.map(|corner| corner[bound]));
        Some([least.into_iter().min()?, greatest.into_iter().max()?])
    }

    fn bilinear(&self, uv: Vec2, wrap: [TextureWrap; 2]) -> f32 {
        let [width, height] = self.size;
        let [x, y] = (Vec2::new(uv.x * width as f32, uv.y * height as f32) - 0.5).to_array();
        // Most readings are away from the border, where all textures are alike.
        if x >= 0.0 && y >= 0.0 && x < (width - 1) as f32 && y < (height - 1) as f32 {
            let (left, top) = (x as u32, y as u32);
            let columns = (left as usize, left as usize + 1, x - left as f32);
            return self.blend(columns, (top as usize, top as usize + 1, y - top as f32));
        }
        self.blend(neighbors(uv.x, width, wrap[0]), neighbors(uv.y, height, wrap[1]))
    }

    fn blend(&self, (left, right, x): (usize, usize, f32), (top, bottom, y): (usize, usize, f32)) -> f32 {
        let at = |row: usize, column: usize| f32::from(self.alphas[row * self.size[0] as usize + column]);
        let above = at(top, left) + (at(top, right) - at(top, left)) * x;
        let below = at(bottom, left) + (at(bottom, right) - at(bottom, left)) * x;
        (above + (below - above) * y) / 255.0
    }
}

/// The two texels around a coordinate and its distance from the first toward the second, in texels. `size` must not be 0.
pub fn neighbors(coordinate: f32, size: u32, wrap: TextureWrap) -> (usize, usize, f32) {
    match wrap {
        TextureWrap::Repeat => neighbors_around(coordinate, size),
        TextureWrap::Mirror | TextureWrap::Clamp => neighbors_within(wrap.fold(coordinate), size),
    }
}

/// Those of a coordinate in 0..=1 in a row that ends at its borders.
fn neighbors_within(coordinate: f32, size: u32) -> (usize, usize, f32) {
    let last = (size - 1) as f32;
    let position = (coordinate * size as f32 - 0.5).clamp(0.0, last);
    let first = position as u32;
    (first as usize, (first + 1).min(size - 1) as usize, position - first as f32)
}

/// Those of a coordinate in a row that repeats. Rounds by casting, which is much cheaper than `floor` and `rem_euclid`.
/// Casts saturate and turn NaN to 0: coordinates that are not finite give some texel too.
fn neighbors_around(coordinate: f32, size: u32) -> (usize, usize, f32) {
    let part = coordinate - coordinate as i64 as f32;
    let repeated = if part < 0.0 { part + 1.0 } else { part }.clamp(0.0, 1.0);
    let position = repeated * size as f32 - 0.5;
    // It may be half a texel below 0: 1 is added before rounding, since casts round toward 0.
    let above = (position + 1.0) as u32;
    let last = size - 1;
    let (first, second) =
        if above == 0 { (last, 0) } else { ((above - 1).min(last), if above > last { 0 } else { above }) };
    (first as usize, second as usize, position - (above as f32 - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mip_levels::smaller_levels;
    use sandtable_draw::color::Srgba;

    const REPEAT: [TextureWrap; 2] = [TextureWrap::Repeat; 2];

    /// A square whose left half is a hole.
    fn half(side: u32) -> AlphaMask {
        let alpha = |x: u32| if x < side / 2 { 0 } else { 255 };
        let pixels = Pixels::from_fn(side, side, |x, _| Srgba([0, 0, 0, alpha(x)]));
        AlphaMask::new(&pixels, &smaller_levels(&pixels))
    }

    #[test]
    fn the_level_is_the_one_whose_texels_are_nearest_in_size() {
        for (side, level) in [(0.0, 0), (1.0, 0), (1.4, 0), (1.5, 1), (2.8, 1), (2.9, 2), (64.0, 6)] {
            assert_eq!(nearest_level(side * side), level, "{side} texels");
        }
    }

    #[test]
    fn only_footprints_half_as_long_again_as_wide_take_more_taps() {
        let alpha = half(16);
        let footprint = |across: f32| alpha.footprint(Vec2::X * across / 16.0, Vec2::Y * 2.0 / 16.0, 8);
        assert_eq!([1.5, 2.9, 3.1, 8.0, 99.0].map(|across| footprint(across).taps), [1, 1, 2, 4, 8]);
        assert_eq!(footprint(2.0).level, 1);
        assert_eq!(footprint(f32::INFINITY).level, 4);
    }

    #[test]
    fn alpha_blends_the_texels_around_a_place_and_repeats() {
        let alpha = half(8);
        let sharp = alpha.footprint(Vec2::ZERO, Vec2::ZERO, 8);
        for (u, there) in [(0.25, 0.0), (0.75, 1.0), (0.5, 0.5), (1.0, 0.5), (-0.25, 1.0), (7.25, 0.0)] {
            assert_eq!(alpha.sample(Vec2::new(u, 0.3), &sharp, REPEAT), there, "at {u}");
        }
        let long = alpha.footprint(Vec2::X, Vec2::ZERO, 8);
        assert_eq!(alpha.sample(Vec2::new(0.1, 0.3), &long, REPEAT), 0.5);
    }

    #[test]
    fn a_mirrored_texture_meets_itself_and_a_clamped_one_keeps_its_border() {
        use TextureWrap::{Clamp, Mirror, Repeat};
        let alpha = half(8);
        let sharp = alpha.footprint(Vec2::ZERO, Vec2::ZERO, 8);
        for (u, wrap, there) in [
            (1.25, Repeat, 0.0),
            (1.25, Mirror, 1.0),
            (1.75, Mirror, 0.0),
            (-0.25, Mirror, 0.0),
            (1.75, Clamp, 1.0),
            (-0.25, Clamp, 0.0),
            // At the border nothing of the other side is mixed in.
            (1.0, Mirror, 1.0),
            (0.0, Mirror, 0.0),
            (1.0, Clamp, 1.0),
        ] {
            let read = alpha.sample(Vec2::new(u, 0.3), &sharp, [wrap, Repeat]);
            assert_eq!(read, there, "{wrap:?} at {u}");
        }
    }

    #[test]
    fn no_reading_is_beyond_the_bounds_of_its_place() {
        // Leaves: islands of either with ragged borders, and a wide hole.
        let hash = |x: u32, y: u32| (x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b)) >> 13;
        let alpha = |x: u32, y: u32| match hash(x / 5, y / 7) % 3 {
            0 => 0,
            1 => 255,
            _ => hash(x, y) as u8,
        };
        let pixels = Pixels::from_fn(61, 47, |x, y| Srgba([0, 0, 0, if x > 44 { 0 } else { alpha(x, y) }]));
        let mask = AlphaMask::new(&pixels, &smaller_levels(&pixels));
        let (mut bounded, mut decided) = (0, 0);
        for step in 0..4000_u32 {
            let part = |salt: u32| (hash(step, salt) % 10_007) as f32 / 10_007.0;
            let uv = Vec2::new(part(1), part(2));
            let (right, down) = (Vec2::new(part(3), part(4)) * 0.05, Vec2::new(-part(5), part(6)) * 0.05);
            let footprint = mask.footprint(right * 0.35, down * 0.35, 8);
            let Some([least, greatest]) = mask.bounds(uv, (right.abs() + down.abs()) * 0.44, &footprint)
            else {
                continue;
            };
            bounded += 1;
            decided += u32::from(least > 0.5 || greatest < 0.5);
            let wrap = [REPEAT, [TextureWrap::Mirror, TextureWrap::Clamp]][step as usize % 2];
            for sample in 0..9_u32 {
                let [x, y] = [(sample % 3) as f32 - 1.0, (sample / 3) as f32 - 1.0].map(|way| way * 0.44);
                let read = mask.sample(uv + right * x + down * y, &footprint, wrap);
                assert!(least <= read && read <= greatest, "{read} is not in {least}..={greatest}");
            }
        }
        assert!(bounded > 2000 && decided > 400, "{bounded} {decided}");
    }

    #[test]
    fn opaque_textures_and_hostile_coordinates_give_an_answer() {
        let opaque = AlphaMask::new(&Pixels::filled(4, 4, Srgba::WHITE), &[]);
        assert_eq!(opaque.sample(Vec2::ZERO, &opaque.footprint(Vec2::X, Vec2::Y, 8), REPEAT), 1.0);
        let alpha = half(4);
        for coordinate in [f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX] {
            let footprint = alpha.footprint(Vec2::splat(coordinate), Vec2::ONE, 8);
            for wrap in [TextureWrap::Repeat, TextureWrap::Mirror, TextureWrap::Clamp] {
                alpha.sample(Vec2::splat(coordinate), &footprint, [wrap; 2]);
            }
            alpha.bounds(Vec2::splat(coordinate), Vec2::splat(coordinate.abs()), &footprint);
        }
    }
}
