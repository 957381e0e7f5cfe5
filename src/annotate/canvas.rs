//! Painting drawings on a picture: `tiny_skia` over [`Pixels`], in place.
//!
//! `tiny_skia` wants colors multiplied by alpha, pictures hold them straight. For opaque pixels the two
//! are the same bytes, so a rendered picture is painted on without a copy. The few translucent pixels are
//! multiplied first and remembered; when painting ends, those still untouched get their old bytes back and
//! only the painted ones are divided again, so that annotating never changes a pixel it does not paint.

use tiny_skia::{ColorU8, FillRule, Paint, PixmapMut, PremultipliedColorU8, Transform};

use crate::annotate::drawing::{Drawing, PaintedPath};
use crate::draw::color::Srgba;
use crate::draw::pixels::Pixels;

/// A picture being painted on; [`Canvas::finish`] makes it a picture of straight colors again.
pub struct Canvas<'a> {
    pixels: &'a mut Pixels,
    translucent: Vec<Translucent>,
}

/// A pixel that is not opaque: where, as it was, and as it was multiplied.
struct Translucent {
    index: usize,
    straight: Srgba,
    multiplied: Srgba,
}

impl<'a> Canvas<'a> {
    /// Starts painting on `pixels`.
    pub fn over(pixels: &'a mut Pixels) -> Self {
        let translucent: Vec<_> = pixels
            .data()
            .iter()
            .enumerate()
            .filter(|(_, color)| color.0[3] < 255)
            .map(|(index, &straight)| Translucent { index, straight, multiplied: multiply(straight) })
            .collect();
        for pixel in &translucent {
            pixels.data_mut()[pixel.index] = pixel.multiplied;
        }
        Self { pixels, translucent }
    }

    /// Paints the marks of `drawing`; what lies outside the picture is cut off.
    pub fn draw(&mut self, drawing: &Drawing) {
        let (width, height) = (self.pixels.width(), self.pixels.height());
        let bytes = bytemuck::cast_slice_mut(self.pixels.data_mut());
        let Some(mut map) = PixmapMut::from_bytes(bytes, width, height) else { return };
        drawing.marks().iter().for_each(|mark| fill(&mut map, mark));
    }

    /// Ends painting: colors are straight again.
    pub fn finish(self) {
        let data = self.pixels.data_mut();
        for pixel in self.translucent {
            let painted = data[pixel.index];
            data[pixel.index] = if painted == pixel.multiplied { pixel.straight } else { divide(painted) };
        }
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
    use crate::annotate::pixel_box::PixelBox;

    fn square(color: Srgba) -> Drawing {
        let mut drawing = Drawing::default();
        drawing.rect(PixelBox::at(Vec2::splat(2.0), Vec2::splat(4.0)), color);
        drawing
    }

    #[test]
    fn pixels_that_are_not_painted_keep_every_byte_whatever_their_alpha() {
        let before = Pixels::from_fn(16, 16, |x, y| Srgba([x as u8 * 16, 7, y as u8, (x * y) as u8]));
        let mut after = before.clone();
        let mut canvas = Canvas::over(&mut after);
        canvas.draw(&square(Srgba::opaque(1, 2, 3)));
        canvas.finish();
        for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
            let inside = (2..6).contains(&x) && (2..6).contains(&y);
            let expected = if inside { Srgba::opaque(1, 2, 3) } else { before.at(x, y) };
            assert_eq!(after.at(x, y), expected, "at {x}, {y}");
        }
    }

    #[test]
    fn paint_on_a_transparent_picture_keeps_its_own_straight_color() {
        let mut pixels = Pixels::filled(8, 8, Srgba([200, 200, 200, 0]));
        let mut canvas = Canvas::over(&mut pixels);
        canvas.draw(&square(Srgba([250, 120, 60, 128])));
        canvas.finish();
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
        let mut canvas = Canvas::over(&mut pixels);
        canvas.draw(&square(Srgba([255, 255, 255, 128])));
        canvas.finish();
        assert!(pixels.at(3, 3).0[0].abs_diff(128) <= 1);
        assert_eq!(pixels.at(3, 3).0[3], 255);
    }

    #[test]
    fn an_empty_picture_is_no_error() {
        let mut pixels = Pixels::filled(0, 9, Srgba::WHITE);
        let mut canvas = Canvas::over(&mut pixels);
        canvas.draw(&square(Srgba::WHITE));
        canvas.finish();
    }
}
