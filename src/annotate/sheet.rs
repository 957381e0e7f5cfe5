//! The sheet: sizes and colors shared by everything painted, designed for a picture 1080 pixels high.
//!
//! Sizes grow in proportion above 1080 pixels. Below, they shrink more slowly than the picture: type becomes illegible
//! long before a picture becomes useless.

use glam::Vec2;

use crate::pixel_box::PixelBox;
use sandtable_draw::color::Srgba;

/// Letters and lines.
pub const INK: Srgba = Srgba::opaque(0x1e, 0x23, 0x27);
/// Second lines and notes.
pub const SOFT_INK: Srgba = Srgba::opaque(0x3c, 0x42, 0x47);
/// Names of waters.
pub const WATER_INK: Srgba = Srgba::opaque(0x14, 0x4f, 0x7e);
/// White of bars and needles.
pub const PAPER: Srgba = Srgba::opaque(0xfd, 0xfc, 0xf9);
/// The halo around letters and lines on the picture itself.
pub const HALO: Srgba = Srgba([0xfd, 0xfc, 0xf9, 0xd8]);
/// The ground of panels: light enough for text, transparent enough to show the terrain behind.
pub const PANEL: Srgba = Srgba([0xfa, 0xf9, 0xf5, 0xd6]);
/// Hairlines around panels.
pub const FRAME: Srgba = Srgba([0x1e, 0x23, 0x27, 0x60]);

/// Height of the picture for which the sizes are designed.
const DESIGN_HEIGHT: f32 = 1080.0;
/// Pictures narrower than 3:4 are scaled by their width, so that furniture fits.
const DESIGN_ASPECT: f32 = 0.75;
/// Share of the sizes that does not shrink with the picture below the design height.
const STEADY_SHARE: f32 = 0.32;
/// The smallest type: below this the embedded light font turns gray.
const SMALLEST_TYPE_PX: f32 = 9.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Width and height in pixels.
    pub size: Vec2,
    /// Pixels per design pixel.
    pub scale: f32,
    /// Whether pieces of furniture stand on panels; on paper they need none.
    pub has_panels: bool,
}

impl Sheet {
    pub fn new(width: u32, height: u32) -> Self {
        let size = Vec2::new(width as f32, height as f32);
        let share = size.y.min(size.x * DESIGN_ASPECT) / DESIGN_HEIGHT;
        let scale = if share < 1.0 { STEADY_SHARE + (1.0 - STEADY_SHARE) * share } else { share };
        Self { size, scale, has_panels: true }
    }

    /// A design length in pixels.
    pub fn px(&self, design: f32) -> f32 {
        design * self.scale
    }

    /// A design length in whole pixels, at least one: makes edges crisp.
    pub fn whole_px(&self, design: f32) -> f32 {
        self.px(design).round().max(1.0)
    }

    /// A size of type in pixels.
    pub fn type_px(&self, design: f32) -> f32 {
        self.px(design).max(SMALLEST_TYPE_PX)
    }

    pub fn margin(&self) -> f32 {
        self.whole_px(26.0).min((self.size.y * 0.03).round().max(2.0))
    }

    pub fn padding(&self) -> f32 {
        self.whole_px(15.0)
    }

    pub fn hairline(&self) -> f32 {
        self.px(1.0).max(1.0)
    }

    pub fn bounds(&self) -> PixelBox {
        PixelBox { min: Vec2::ZERO, max: self.size }
    }

    pub fn inner(&self) -> PixelBox {
        self.bounds().grown(-self.margin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::luminance;

    #[test]
    fn sizes_are_as_designed_at_1080_double_at_4k_and_legible_at_270() {
        assert_eq!(Sheet::new(1920, 1080).scale, 1.0);
        assert_eq!(Sheet::new(3840, 2160).scale, 2.0);
        let small = Sheet::new(480, 270);
        assert!(small.scale > 0.45 && small.type_px(12.0) >= SMALLEST_TYPE_PX);
    }

    #[test]
    fn inks_stand_out_of_their_halo_on_any_ground() {
        let luminance = |color: Srgba| luminance(color.linear());
        let over = |ground: u8| {
            let share = HALO.alpha();
            let [red, green, blue, _] = HALO
                .0
                .map(|halo| (f32::from(halo) * share + f32::from(ground) * (1.0 - share)).round() as u8);
            Srgba::opaque(red, green, blue)
        };
        for ink in [INK, SOFT_INK, WATER_INK] {
            for ground in 0..=255 {
                // WCAG 2.2, 1.4.3
                let contrast = (luminance(over(ground)) + 0.05) / (luminance(ink) + 0.05);
                assert!(contrast >= 4.5, "{ink:?} over {ground}: {contrast}");
            }
        }
    }

    #[test]
    fn a_tall_narrow_picture_is_scaled_by_its_width() {
        assert!(Sheet::new(1080, 1920).scale < 1.0);
    }
}
