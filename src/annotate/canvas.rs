//! Painting drawings on a picture: `tiny_skia` over [`Pixels`], in place.
//!
//! `tiny_skia` needs colors multiplied by alpha; pictures hold straight colors. For opaque pixels the two are the same
//! bytes, so that a rendered picture needs no copy. The few translucent pixels are multiplied first and recorded.
//! Afterward the untouched ones get their old bytes back, and only painted ones are divided: annotating never changes a
//! pixel that it does not paint.

use glam::Vec2;
use rayon::prelude::*;
use tiny_skia::{ColorU8, FillRule, Paint, PixmapMut, PremultipliedColorU8, Transform};

use crate::drawing::{Drawing, PaintedPath};
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// A pixel that is not opaque: its index, its color, and its color multiplied by alpha.
struct Translucent {
    index: usize,
    straight: Srgba,
    multiplied: Srgba,
}

/// Paints `drawings` on `pixels`, in order, clipped to the picture.
pub fn paint<'a>(pixels: &mut Pixels, drawings: impl IntoIterator<Item = &'a Drawing>) {
    let translucent: Vec<_> = (pixels.data().par_iter().enumerate())
        .filter(|(_, color)| color.0[3] < 255)
        .map(|(index, &straight)| Translucent { index, straight, multiplied: multiply(straight) })
        .collect();
    let data = pixels.data_mut();
    translucent.iter().for_each(|pixel| data[pixel.index] = pixel.multiplied);
    let (width, height) = (pixels.width(), pixels.height());
    if let Some(mut map) = PixmapMut::from_bytes(bytemuck::cast_slice_mut(pixels.data_mut()), width, height) {
        drawings.into_iter().flat_map(|drawing| &drawing.marks).for_each(|mark| fill(&mut map, mark));
    }
    let data = pixels.data_mut();
    for pixel in translucent {
        let painted = &mut data[pixel.index];
        *painted = if *painted == pixel.multiplied { pixel.straight } else { divide(*painted) };
    }
}

/// Copies a picture onto a page, as far as it lies on it.
pub fn paste(page: &mut Pixels, picture: &Pixels, corner: Vec2) {
    let (corner, stride) = (corner.as_uvec2(), page.width() as usize);
    let width = picture.width().min(page.width().saturating_sub(corner.x)) as usize;
    let rows = picture.height().min(page.height().saturating_sub(corner.y)) as usize;
    for (row, from) in picture.data().chunks_exact(picture.width().max(1) as usize).take(rows).enumerate() {
        let start = (corner.y as usize + row) * stride + corner.x as usize;
        page.data_mut()[start..start + width].copy_from_slice(&from[..width]);
    }
}

fn fill(map: &mut PixmapMut<'_>, mark: &PaintedPath) {
    let [red, green, blue, alpha] = mark.color.0;
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, alpha);
    map.fill_path(&mark.path, &paint, FillRule::Winding, Transform::identity(), None);
}

fn multiply(straight: Srgba) -> Srgba {
    let [red, green, blue, alpha] = straight.0;
    let color = ColorU8::from_rgba(red, green, blue, alpha).premultiply();
    Srgba([color.red(), color.green(), color.blue(), color.alpha()])
}

fn divide(multiplied: Srgba) -> Srgba {
    let [red, green, blue, alpha] = multiplied.0;
    let cut = |channel: u8| channel.min(alpha);
    let color = PremultipliedColorU8::from_rgba(cut(red), cut(green), cut(blue), alpha)
        .map_or(ColorU8::from_rgba(0, 0, 0, 0), |color| color.demultiply());
    Srgba([color.red(), color.green(), color.blue(), color.alpha()])
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::pixel_box::PixelBox;

    fn square(color: Srgba) -> Drawing {
        let mut drawing = Drawing::default();
        drawing.rect(PixelBox::at(Vec2::splat(2.0), Vec2::splat(4.0)), color);
        drawing
    }

    #[test]
    fn pixels_that_are_not_painted_keep_every_byte_whatever_their_alpha() {
        let before = Pixels::from_fn(16, 16, |x, y| Srgba([x as u8 * 16, 7, y as u8, (x * y) as u8]));
        let mut after = before.clone();
        paint(&mut after, [&square(Srgba::opaque(1, 2, 3))]);
        for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
            let inside = (2..6).contains(&x) && (2..6).contains(&y);
            let expected = if inside { Srgba::opaque(1, 2, 3) } else { before.at(x, y) };
            assert_eq!(after.at(x, y), expected, "at {x}, {y}");
        }
    }

    #[test]
    fn paint_on_a_transparent_picture_keeps_its_own_straight_color() {
        let mut pixels = Pixels::filled(8, 8, Srgba([200, 200, 200, 0]));
        paint(&mut pixels, [&square(Srgba([250, 120, 60, 128]))]);
        let painted = pixels.at(3, 3).0;
        assert_eq!(painted[3], 128);
        for (is, was) in painted.iter().zip([250, 120, 60]) {
            assert!(is.abs_diff(was) <= 1, "{painted:?}");
        }
        assert_eq!(pixels.at(0, 0), Srgba([200, 200, 200, 0]));
    }

    #[test]
    fn half_of_white_over_black_is_gray() {
        let mut pixels = Pixels::filled(8, 8, Srgba::opaque(0, 0, 0));
        paint(&mut pixels, [&square(Srgba([255, 255, 255, 128]))]);
        assert!(pixels.at(3, 3).0[0].abs_diff(128) <= 1);
        assert_eq!(pixels.at(3, 3).0[3], 255);
    }

    #[test]
    fn an_empty_picture_is_no_error() {
        let mut pixels = Pixels::filled(0, 9, Srgba::WHITE);
        paint(&mut pixels, [&square(Srgba::WHITE)]);
    }
}
