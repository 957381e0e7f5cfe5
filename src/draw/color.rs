//! Colors: 8-bit sRGB as authored, linear light for arithmetic.
//!
//! Both conversions use tables or `libm`, so that a color is the same number on every platform.

use std::sync::LazyLock;

use glam::Vec3;

/// An sRGB color with straight alpha, as written in files and scene descriptions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Srgba(pub [u8; 4]);

impl Srgba {
    /// Opaque white: the color that changes nothing when multiplied.
    pub const WHITE: Self = Self([255; 4]);

    /// An opaque color.
    pub const fn opaque(red: u8, green: u8, blue: u8) -> Self {
        Self([red, green, blue, 255])
    }

    /// Red, green and blue in linear light, each in 0..=1.
    #[inline]
    pub fn linear(self) -> Vec3 {
        let [red, green, blue, _] = self.0;
        Vec3::new(linear_from_srgb(red), linear_from_srgb(green), linear_from_srgb(blue))
    }

    /// Alpha in 0..=1.
    pub fn alpha(self) -> f32 {
        f32::from(self.0[3]) / 255.0
    }

    /// The opaque color nearest to `linear` light; values outside 0..=1 are clamped.
    #[inline]
    pub fn from_linear(linear: Vec3) -> Self {
        let [red, green, blue] = linear.to_array().map(srgb_from_linear);
        Self::opaque(red, green, blue)
    }
}

/// The shares of red, green and blue in luminance (IEC 61966-2-1).
pub(crate) const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// The luminance of a color in linear light, 0..=1 (IEC 61966-2-1).
#[inline]
pub fn luminance(linear: Vec3) -> f32 {
    linear.dot(Vec3::from(LUMINANCE))
}

/// The lightness L* of a color in linear light, 0..=100 (CIE 1976, for a white of luminance 1).
pub fn lightness(linear: Vec3) -> f32 {
    let luminance = luminance(linear);
    if luminance > 216.0 / 24_389.0 {
        116.0 * libm::cbrtf(luminance) - 16.0
    } else {
        luminance * 24_389.0 / 27.0
    }
}

/// One sRGB channel in linear light, 0..=1 (IEC 61966-2-1).
pub fn linear_from_srgb(channel: u8) -> f32 {
    static TABLE: LazyLock<[f32; 256]> = LazyLock::new(|| {
        std::array::from_fn(|channel| {
            let value = channel as f32 / 255.0;
            if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
        })
    });
    TABLE[usize::from(channel)]
}

/// The sRGB channel value nearest to linear `light` (IEC 61966-2-1); clamps to 0..=1, NaN gives 0.
///
/// Looks up a table of 4096 steps on the square root of the light. Its rounding stays within one step of the exact
/// conversion.
pub fn srgb_from_linear(light: f32) -> u8 {
    const STEPS: f32 = 4095.0;
    static TABLE: LazyLock<[u8; STEPS as usize + 1]> = LazyLock::new(|| {
        std::array::from_fn(|step| {
            let root = step as f32 / STEPS;
            let light = root * root;
            let value = if light <= 0.003_130_8 {
                light * 12.92
            } else {
                1.055 * libm::powf(light, 1.0 / 2.4) - 0.055
            };
            (value * 255.0 + 0.5) as u8
        })
    });
    let root = light.clamp(0.0, 1.0).sqrt();
    // At most the last step, which the mask leaves as it is.
    TABLE[(root * STEPS + 0.5) as i32 as usize & STEPS as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_value_survives_the_round_trip() {
        for channel in 0..=255 {
            assert_eq!(srgb_from_linear(linear_from_srgb(channel)), channel);
        }
    }

    #[test]
    fn lightness_is_that_of_the_standard() {
        for (gray, wanted) in [(0, 0.0), (8, 2.19), (10, 2.74), (119, 50.03), (255, 100.0)] {
            let found = lightness(Srgba::opaque(gray, gray, gray).linear());
            assert!((found - wanted).abs() < 0.02, "{gray}: {found}");
        }
    }

    #[test]
    fn light_out_of_range_is_clamped() {
        assert_eq!(srgb_from_linear(-1.0), 0);
        assert_eq!(srgb_from_linear(7.0), 255);
        assert_eq!(srgb_from_linear(f32::NAN), 0);
    }
}
