//! Textures: filtered reading of a picture and its mip levels.
//!
//! A footprint longer than wide is read by several taps along its length, each at the level of its width (McCormack et
//! al. 1999, "Feline"): roads are seen at grazing angles.

use glam::{Vec2, Vec3};

use crate::cpu::alpha::{AlphaMask, neighbors};
use crate::mip_levels::smaller_levels;
use sandtable_draw::color::{Srgba, linear_from_srgb};
use sandtable_draw::material::TextureWrap;
use sandtable_draw::pixels::Pixels;

#[derive(Debug)]
pub struct Texture<'a> {
    base: &'a Pixels,
    smaller: Vec<Pixels>,
    /// For masks.
    pub alpha: AlphaMask,
    linear: [f32; 256],
}

/// How a texture is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    pub weighting: Weighting,
    /// What it shows beyond its borders, along U and along V.
    pub wrap: [TextureWrap; 2],
}

/// The weight of the colors of transparent texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// The same as of all others, for opaque surfaces.
    Even,
    /// Their alpha, so that the unseen color of holes does not bleed into borders.
    ByAlpha,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// In linear light.
    pub color: Vec3,
    /// In 0..=1.
    pub alpha: f32,
}

impl Texel {
    pub const WHITE: Self = Self { color: Vec3::ONE, alpha: 1.0 };
}

/// The readings that cover a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexelFootprint {
    /// The longer of the pixel's two sides, in the map's unit.
    pub axis: Vec2,
    /// Readings along the axis, at least 1.
    pub taps: u32,
    /// The mip level of each reading, at least 0.
    pub level: f32,
}

impl TexelFootprint {
    /// The footprint of a pixel whose sides span `right` and `down`, measured in cells of `scale` per unit. At most
    /// `most_taps` readings are taken; where that is too few, the level rises instead. Sides that are not finite read
    /// the coarsest level once.
    pub fn new(right: Vec2, down: Vec2, scale: Vec2, most_taps: u32) -> Self {
        let (across, along) = ((right * scale).length_squared(), (down * scale).length_squared());
        if across.max(along) <= 1.0 {
            return Self { axis: Vec2::ZERO, taps: 1, level: 0.0 };
        }
        let axis = if across > along { right } else { down };
        let (longer, shorter) = (across.max(along).sqrt(), across.min(along).sqrt());
        if !longer.is_finite() {
            return Self { axis: Vec2::ZERO, taps: 1, level: f32::MAX };
        }
        let taps = (longer / shorter.max(1.0)).ceil().clamp(1.0, most_taps.max(1) as f32);
        let level = libm::log2f((longer / taps).max(1e-6));
        Self { axis, taps: taps as u32, level: level.max(0.0) }
    }

    pub fn offsets(&self) -> impl Iterator<Item = Vec2> + use<> {
        let (axis, taps) = (self.axis, self.taps);
        (0..taps).map(move |tap| axis * ((tap as f32 + 0.5) / taps as f32 - 0.5))
    }
}

impl<'a> Texture<'a> {
    /// `base` with all smaller levels; an empty picture reads as opaque white.
    pub fn new(base: &'a Pixels) -> Self {
        let smaller = smaller_levels(base);
        let alpha = AlphaMask::new(base, &smaller);
        Self { base, smaller, alpha, linear: std::array::from_fn(|channel| linear_from_srgb(channel as u8)) }
    }

    pub fn size(&self) -> Vec2 {
        Vec2::new(self.base.width() as f32, self.base.height() as f32)
    }

    /// The color over a footprint around `uv`, trilinear. (0, 0) is the upper left corner, (1, 1) the lower right.
    pub fn sample(&self, uv: Vec2, footprint: &TexelFootprint, reading: Reading) -> Texel {
        if self.base.data().is_empty() {
            return Texel::WHITE;
        }
        let level = footprint.level.min(self.smaller.len() as f32);
        let (larger, part) = (level as usize, level - (level as usize) as f32);
        let mut sum = TexelSum { reading, color: Vec3::ZERO, color_weight: 0.0, alpha: 0.0, weight: 0.0 };
        for offset in footprint.offsets() {
            let at = uv + offset;
            self.add_bilinear(&mut sum, at, larger, 1.0 - part);
            if part > 0.0 {
                self.add_bilinear(&mut sum, at, larger + 1, part);
            }
        }
        sum.mean()
    }

    fn add_bilinear(&self, sum: &mut TexelSum, uv: Vec2, level: usize, weight: f32) {
        let pixels = level.checked_sub(1).map_or(self.base, |index| &self.smaller[index]);
        let [across, down] = sum.reading.wrap;
        let (left, right, x) = neighbors(uv.x, pixels.width(), across);
        let (top, bottom, y) = neighbors(uv.y, pixels.height(), down);
        let data = pixels.data();
        let mut add = |row: usize, column: usize, weight: f32| {
            let Srgba([red, green, blue, alpha]) = data[row * pixels.width() as usize + column];
            let linear = |channel: u8| self.linear[usize::from(channel)];
            sum.add(Vec3::new(linear(red), linear(green), linear(blue)), f32::from(alpha) / 255.0, weight);
        };
        add(top, left, weight * (1.0 - x) * (1.0 - y));
        add(top, right, weight * x * (1.0 - y));
        add(bottom, left, weight * (1.0 - x) * y);
        add(bottom, right, weight * x * y);
    }
}

struct TexelSum {
    reading: Reading,
    color: Vec3,
    color_weight: f32,
    alpha: f32,
    weight: f32,
}

impl TexelSum {
    fn add(&mut self, color: Vec3, alpha: f32, weight: f32) {
        let color_weight = match self.reading.weighting {
            Weighting::Even => weight,
            Weighting::ByAlpha => weight * alpha,
        };
        self.color += color * color_weight;
        self.color_weight += color_weight;
        self.alpha += alpha * weight;
        self.weight += weight;
    }

    fn mean(&self) -> Texel {
        let color = if self.color_weight > 0.0 { self.color / self.color_weight } else { Vec3::ZERO };
        Texel { color, alpha: self.alpha / self.weight }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVEN: Reading = Reading { weighting: Weighting::Even, wrap: [TextureWrap::Repeat; 2] };

    fn sharp() -> TexelFootprint {
        TexelFootprint { axis: Vec2::ZERO, taps: 1, level: 0.0 }
    }

    fn checker(side: u32) -> Pixels {
        let [black, white] = [Srgba::opaque(0, 0, 0), Srgba::WHITE];
        Pixels::from_fn(side, side, |x, y| if (x + y) % 2 == 0 { black } else { white })
    }

    #[test]
    fn the_middle_of_a_texel_reads_that_texel_and_repeats() {
        let pixels = Pixels::from_fn(4, 2, |x, y| Srgba::opaque(10 * x as u8, 100 * y as u8, 7));
        let texture = Texture::new(&pixels);
        for (u, v) in [(0.625, 0.75), (-0.375, 1.75), (5.625, -7.25)] {
            let texel = texture.sample(Vec2::new(u, v), &sharp(), EVEN);
            assert!((texel.color - Srgba::opaque(20, 100, 7).linear()).length() < 1e-6, "{u}, {v}");
        }
    }

    #[test]
    fn each_axis_goes_on_beyond_the_border_in_its_own_way() {
        let pixels = Pixels::from_fn(4, 2, |x, y| Srgba::opaque(10 * x as u8, 100 * y as u8, 7));
        let texture = Texture::new(&pixels);
        let wrap = [TextureWrap::Mirror, TextureWrap::Clamp];
        for (u, v, [x, y]) in [(1.125, 0.25, [3, 0]), (1.625, 7.0, [1, 1]), (-0.375, -3.0, [1, 0])] {
            let texel = texture.sample(Vec2::new(u, v), &sharp(), Reading { wrap, ..EVEN });
            assert!((texel.color - pixels.at(x, y).linear()).length() < 1e-6, "{u}, {v}");
        }
    }

    #[test]
    fn every_level_of_a_checker_keeps_its_mean_light() {
        for side in [8, 12, 16] {
            let pixels = checker(side);
            let texture = Texture::new(&pixels);
            let blurred = TexelFootprint { level: 99.0, ..sharp() };
            let texel = texture.sample(Vec2::new(0.3, 0.1), &blurred, EVEN);
            assert!((texel.color.x - 0.5).abs() < 0.02, "{side}: {}", texel.color.x);
        }
    }

    #[test]
    fn odd_sides_keep_their_mean_light_too() {
        let pixels = Pixels::from_fn(7, 5, |x, _| Srgba::opaque(if x < 2 { 255 } else { 0 }, 0, 0));
        let texture = Texture::new(&pixels);
        let texel = texture.sample(Vec2::ZERO, &TexelFootprint { level: 99.0, ..sharp() }, EVEN);
        assert!((texel.color.x - 2.0 / 7.0).abs() < 0.01, "{}", texel.color.x);
    }

    #[test]
    fn a_hole_s_color_does_not_bleed_when_weighted_by_alpha() {
        let pixels = Pixels::from_fn(2, 1, |x, _| if x == 0 { Srgba::WHITE } else { Srgba([0, 0, 0, 0]) });
        let texture = Texture::new(&pixels);
        let texel =
            texture.sample(Vec2::new(0.5, 0.5), &sharp(), Reading { weighting: Weighting::ByAlpha, ..EVEN });
        assert!((texel.color - Vec3::ONE).length() < 1e-6 && (texel.alpha - 0.5).abs() < 1e-6);
    }

    #[test]
    fn grazing_footprints_take_several_sharp_readings() {
        let long = TexelFootprint::new(Vec2::new(8.0, 0.0), Vec2::new(0.0, 1.0), Vec2::ONE, 8);
        assert_eq!((long.taps, long.level), (8, 0.0));
        let round = TexelFootprint::new(Vec2::new(8.0, 0.0), Vec2::new(0.0, 8.0), Vec2::ONE, 8);
        assert_eq!((round.taps, round.level), (1, 3.0));
    }

    #[test]
    fn hostile_coordinates_and_empty_textures_still_read_something() {
        let (pixels, empty) = (checker(4), Pixels::filled(0, 3, Srgba::WHITE));
        let texture = Texture::new(&pixels);
        for coordinate in [f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX] {
            let footprint = TexelFootprint::new(Vec2::splat(coordinate), Vec2::ONE, texture.size(), 8);
            texture.sample(Vec2::splat(coordinate), &footprint, EVEN);
        }
        let white = Texture::new(&empty).sample(Vec2::ZERO, &sharp(), EVEN);
        assert_eq!(white, Texel { color: Vec3::ONE, alpha: 1.0 });
    }
}
