//! The color of halos: paper, tinted toward the ground that it covers as far as the letters stay legible.

use glam::Vec3;

use crate::pixel_box::PixelBox;
use crate::sheet::{HALO, INK};
use sandtable_draw::color::{Srgba, luminance};
use sandtable_draw::pixels::Pixels;

/// The contrast of letters and halo, as WCAG 2.2, 1.4.3 asks of text.
const LEAST_CONTRAST: f32 = 4.5;
/// The same of a narrow halo: the pixels between it and slanted edges of letters mix both.
const HALO_CONTRAST: f32 = 5.0;
/// The share of the ground in the halo: more, and the halo no longer clears the ground's texture away.
const MOST_TINT: f32 = 0.5;
/// Its share in a patch that breaks a line: enough that the break is not seen, not so much that numbers sink.
const PATCH_TINT: f32 = 0.85;
const TINT_STEPS: usize = 10;
/// Pixels looked at across and down a label.
const SAMPLES: u32 = 12;
/// Letters lighter than this have a dark halo.
const LIGHT_INK: f32 = 0.3;

/// A halo: how far it reaches around letters, and its color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halo {
    pub reach_px: f32,
    pub color: Srgba,
}

impl Halo {
    /// A halo of paper.
    pub fn paper(reach_px: f32) -> Self {
        Self { reach_px, color: HALO }
    }

    /// A patch of the ground's own tone under letters of `ink`, as far as they stay legible: it breaks what is drawn there.
    pub fn patch(pixels: &Pixels, area: &PixelBox, ink: Srgba, reach_px: f32) -> Self {
        let color = mean(pixels, area)
            .map_or_else(|| paper(ink), |ground| tinted(ground, ink, PATCH_TINT, LEAST_CONTRAST));
        let [red, green, blue, _] = color.0;
        Self { reach_px, color: Srgba([red, green, blue, 0xf4]) }
    }

    /// The halo of letters of `ink` over `area` of the picture.
    pub fn over(pixels: &Pixels, area: &PixelBox, ink: Srgba, reach_px: f32) -> Self {
        let tint = |ground| tinted(ground, ink, MOST_TINT, HALO_CONTRAST);
        Self { reach_px, color: mean(pixels, area).map_or_else(|| paper(ink), tint) }
    }
}

/// The halo's color without a ground: light, or dark for light letters.
fn paper(ink: Srgba) -> Srgba {
    if luminance(ink.linear()) < LIGHT_INK {
        return HALO;
    }
    let [red, green, blue, _] = INK.0;
    Srgba([red, green, blue, HALO.0[3]])
}

/// The color with the largest share of the ground, `most` at most, that leaves the contrast `least`, whatever single pixel is
/// below it; the paper's where none does.
fn tinted(ground: Vec3, ink: Srgba, most: f32, least: f32) -> Srgba {
    let paper = paper(ink);
    let mixed = |step: usize| {
        let share = most * step as f32 / TINT_STEPS as f32;
        let [red, green, blue, _] = Srgba::from_linear(paper.linear().lerp(ground, share)).0;
        Srgba([red, green, blue, paper.0[3]])
    };
    let is_legible = |color: &Srgba| worst_contrast(*color, ink) >= least;
    // Letters neither dark nor light need a paper through which no ground shows.
    let [red, green, blue, alpha] = paper.0;
    let denser = (alpha..=255).map(|alpha| Srgba([red, green, blue, alpha]));
    (1..=TINT_STEPS).rev().map(mixed).chain(denser).find(is_legible).unwrap_or(paper)
}

/// The contrast of `ink` and `halo` over black or white, whichever is lower.
pub fn worst_contrast(halo: Srgba, ink: Srgba) -> f32 {
    let ink = luminance(ink.linear());
    let over = |ground: u8| {
        let share = halo.alpha();
        let mix =
            |channel: u8| (f32::from(channel) * share + f32::from(ground) * (1.0 - share)).round() as u8;
        let [red, green, blue, _] = halo.0;
        let ground = luminance(Srgba::opaque(mix(red), mix(green), mix(blue)).linear());
        (ground.max(ink) + 0.05) / (ground.min(ink) + 0.05)
    };
    over(0).min(over(255))
}

/// The mean light of the pixels in `area`; `None` where none of them is on the picture.
fn mean(pixels: &Pixels, area: &PixelBox) -> Option<Vec3> {
    let (min, max) = (area.min.max(glam::Vec2::ZERO), area.max);
    let (left, top) = (min.x as u32, min.y as u32);
    let (right, bottom) =
        ((max.x.max(0.0) as u32).min(pixels.width()), (max.y.max(0.0) as u32).min(pixels.height()));
    if left >= right || top >= bottom {
        return None;
    }
    let step = |length: u32| length.div_ceil(SAMPLES) as usize;
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for y in (top..bottom).step_by(step(bottom - top)) {
        for x in (left..right).step_by(step(right - left)) {
            sum += pixels.at(x, y).linear();
            count += 1.0;
        }
    }
    Some(sum / count)
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::sheet::{SOFT_INK, WATER_INK};

    #[test]
    fn letters_stand_out_of_their_halo_on_every_ground() {
        let friend = Srgba::opaque(0, 107, 140);
        let amber = Srgba::opaque(255, 200, 60);
        for ink in [INK, SOFT_INK, WATER_INK, friend, amber] {
            for red in (0..=255).step_by(51) {
                for green in (0..=255).step_by(51) {
                    for blue in (0..=255).step_by(51) {
                        let ground = Pixels::filled(40, 20, Srgba::opaque(red, green, blue));
                        let area = PixelBox::at(Vec2::ZERO, Vec2::new(40.0, 20.0));
                        let halo = Halo::over(&ground, &area, ink, 2.0).color;
                        let contrast = worst_contrast(halo, ink);
                        assert!(contrast >= LEAST_CONTRAST, "{ink:?} on {red} {green} {blue}: {contrast}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_halo_is_tinted_toward_its_ground() {
        let area = PixelBox::at(Vec2::splat(-5.0), Vec2::splat(30.0));
        let halo = |color: Srgba| Halo::over(&Pixels::filled(40, 40, color), &area, INK, 2.0).color.0;
        let (green, blue) = (halo(Srgba::opaque(120, 180, 100)), halo(Srgba::opaque(90, 140, 200)));
        assert!(green[1] > green[2] + 10 && blue[2] > blue[0] + 10, "{green:?} {blue:?}");
        let off = PixelBox::at(Vec2::splat(900.0), Vec2::splat(30.0));
        assert_eq!(Halo::over(&Pixels::filled(40, 40, INK), &off, INK, 2.0).color, HALO);
    }
}
