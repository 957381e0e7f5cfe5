//! A contact sheet: several pictures of a scene on one, each with its caption.

use glam::Vec2;

use crate::canvas::{paint, paste};
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::pixel_box::PixelBox;
use crate::sheet::{FRAME, INK, PAPER, SOFT_INK};
use crate::text::TextStyle;
use sandtable_draw::font::FontFile;
use sandtable_draw::pixels::Pixels;

/// Heights of the title's and of the captions' lines, and the gap between pictures, in design pixels.
const TITLE: f32 = 58.0;
const CAPTION: f32 = 34.0;
const GAP: f32 = 18.0;

/// Pictures smaller than this show nothing, in pixels.
const SMALLEST_PX: u32 = 16;

/// A picture and its caption.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPicture<'a> {
    /// The line below it.
    pub caption: String,
    /// The picture, of the size that [`ContactSheet::picture_size`] says.
    pub pixels: &'a Pixels,
}

/// The layout of pictures on a sheet: in rows, as large as there is room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactSheet {
    width: u32,
    height: u32,
    columns: u32,
    picture: [u32; 2],
}

impl ContactSheet {
    /// A sheet of `width` by `height` pixels for `count` pictures of its own shape; `None` where they would be smaller than
    /// 16 pixels.
    pub fn new(width: u32, height: u32, count: u32) -> Option<Self> {
        let composer = Composer::new(width, height);
        let [title, caption, gap] = [TITLE, CAPTION, GAP].map(|length| composer.sheet.px(length));
        let shape = height as f32 / width as f32;
        let wide = |columns: u32| {
            let rows = count.div_ceil(columns) as f32;
            let across = (width as f32 - gap) / columns as f32 - gap;
            let down = (height as f32 - title - gap) / rows - gap - caption;
            across.min(down / shape)
        };
        let columns = (1..=count.max(1)).max_by(|a, b| wide(*a).total_cmp(&wide(*b)).then(b.cmp(a)))?;
        let picture = [wide(columns), wide(columns) * shape].map(|side| side.max(0.0) as u32);
        let is_legible = picture.iter().all(|&side| side >= SMALLEST_PX);
        is_legible.then_some(Self { width, height, columns, picture })
    }

    /// Width and height of each picture in pixels.
    pub fn picture_size(&self) -> [u32; 2] {
        self.picture
    }

    /// The sheet with `title` and `pictures`.
    pub fn compose(
        &self,
        title: Option<&str>,
        pictures: &[ContactPicture<'_>],
        font: Option<&FontFile>,
    ) -> Pixels {
        let mut composer = Composer::with_font(self.width, self.height, font);
        let sheet = composer.sheet;
        let mut pixels = Pixels::filled(self.width, self.height, PAPER);
        let mut drawing = Drawing::default();
        let [top, below, gap] = [TITLE, CAPTION, GAP].map(|length| sheet.px(length).round());
        let style = composer.style(28.0, TextStyle::MEDIUM);
        let size = Vec2::from(self.picture.map(|side| side as f32));
        let used = self.columns as f32 * (size.x + gap) + gap;
        let left = ((sheet.size.x - used) * 0.5).round() + gap;
        if let Some(line) = title.and_then(|title| composer.fitted(title, style, sheet.size.x - 2.0 * left)) {
            drawing.write(&line, Vec2::new(left, (top + line.style.cap_px()) * 0.5).round(), INK);
        }
        for (number, picture) in (0..).zip(pictures) {
            let cell = Vec2::new((number % self.columns) as f32, (number / self.columns) as f32);
            let at = Vec2::new(left, top) + cell * Vec2::new(size.x + gap, size.y + below + gap);
            paste(&mut pixels, picture.pixels, at);
            drawing.frame(PixelBox { min: at, max: at + size }, sheet.px(1.0).max(1.0), FRAME);
            let style = composer.style(17.0, TextStyle::REGULAR);
            if let Some(line) = composer.fitted(&picture.caption, style, size.x) {
                let baseline = at.y + size.y + (below + line.style.cap_px()) * 0.5;
                drawing.write(&line, Vec2::new(at.x, baseline).round(), SOFT_INK);
            }
        }
        paint(&mut pixels, [&drawing]);
        pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;

    #[test]
    fn pictures_have_the_sheet_s_shape_and_fill_it() {
        for (count, columns) in [(1, 1), (2, 2), (3, 2), (4, 2), (5, 3), (9, 3), (12, 4)] {
            let sheet = ContactSheet::new(1920, 1080, count).expect("room");
            assert_eq!(sheet.columns, columns, "{count}");
            let [width, height] = sheet.picture_size();
            assert!(
                (width as f32 / height as f32 / (16.0 / 9.0) - 1.0).abs() < 0.02,
                "{count}: {width}x{height}"
            );
            let rows = count.div_ceil(columns);
            assert!(width * columns <= 1920 && height * rows <= 1080);
            assert!(width * columns * 10 > 1920 * 7, "{count}: {width}");
        }
        assert_eq!(ContactSheet::new(64, 64, 100), None);
    }

    #[test]
    fn every_picture_is_whole_and_none_covers_another() {
        let sheet = ContactSheet::new(640, 360, 5).expect("room");
        let [width, height] = sheet.picture_size();
        let color = |number: u8| Srgba::opaque(10 * number, 200, 0);
        let drawn: Vec<(String, Pixels)> = (1..=5)
            .map(|number| (format!("No {number}"), Pixels::filled(width, height, color(number))))
            .collect();
        let pictures: Vec<ContactPicture> = drawn
            .iter()
            .map(|(caption, pixels)| ContactPicture { caption: caption.clone(), pixels })
            .collect();
        let composed = sheet.compose(Some("Five"), &pictures, None);
        for number in 1..=5 {
            let shown = composed.data().iter().filter(|&&pixel| pixel == color(number)).count();
            // The frame covers a pixel along the border.
            let inner = (width as usize - 4) * (height as usize - 4);
            assert!(shown >= inner && shown <= (width * height) as usize, "{number}: {shown} of {inner}");
        }
    }
}
