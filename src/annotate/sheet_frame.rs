//! The frame of a sheet with a margin: where the picture lies on the page, and where the furniture beside it.
//!
//! ```text
//! ┌─────────────────────────────────┐     ┌───────────────────┐
//! │ banner                          │     │ head              │
//! │ head: title, subtitle           │     │ ┌───────────────┐ │
//! │ ┌─────────────────────┐ column  │     │ │    picture    │ │
//! │ │       picture       │  legend │     │ └───────────────┘ │
//! │ │                     │  norths │     │  foot             │
//! │ └─────────────────────┘         │     │ column   column   │
//! │ foot: scale, facts, sources     │     │  legend   norths  │
//! └─────────────────────────────────┘     └───────────────────┘
//!             landscape                          portrait
//! ```
//!
//! The picture is drawn at the size of the frame's inside: nothing is computed to be covered.

use glam::{UVec2, Vec2};

use crate::pixel_box::PixelBox;
use crate::sheet::Sheet;
use sandtable_description::words::SheetLayout;

/// Sizes in design pixels: from the page's edge; of a banner; of title and subtitle; of the numbers round the picture; of
/// the line of facts; the width of a column; the height of columns under the picture.
const EDGE: f32 = 20.0;
const BANNER: f32 = 34.0;
const HEAD: f32 = 66.0;
const NUMBERS: f32 = 30.0;
const FOOT: f32 = 92.0;
const COLUMN: f32 = 286.0;
const BELOW: f32 = 360.0;
/// Pages wider than this share of their height have their column beside the picture.
const LANDSCAPE: f32 = 1.15;
/// A picture smaller than this, in pixels, is not worth a margin.
const LEAST: f32 = 48.0;

/// The parts of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetFrame {
    pub(crate) page: UVec2,
    /// The picture, in whole pixels.
    pub(crate) picture: PixelBox,
    pub(crate) head: PixelBox,
    pub(crate) foot: PixelBox,
    pub(crate) columns: Vec<PixelBox>,
    /// The bands above and below all else; empty without a classification.
    pub(crate) banners: Vec<PixelBox>,
}

impl SheetFrame {
    /// The frame of a page of `size` pixels; `None` for layouts without a margin, and for pages too small for one.
    pub fn new(layout: SheetLayout, size: (u32, u32), has_title: bool, has_banner: bool) -> Option<Self> {
        if !matches!(layout, SheetLayout::Margin | SheetLayout::Military) {
            return None;
        }
        let sheet = Sheet::new(size.0, size.1);
        let [edge, banner, head, numbers, foot, column, below] =
            [EDGE, BANNER, HEAD, NUMBERS, FOOT, COLUMN, BELOW].map(|design| sheet.whole_px(design));
        let inner = sheet.bounds().grown(-edge);
        let banner = if has_banner { banner } else { 0.0 };
        let head = if has_title { head } else { 0.0 };
        let is_landscape = sheet.size.x > sheet.size.y * LANDSCAPE;
        let beside = if is_landscape { column + edge } else { 0.0 };
        let under = if is_landscape { 0.0 } else { below };
        let picture = PixelBox {
            min: inner.min + Vec2::new(numbers, banner + head + numbers),
            max: inner.max - Vec2::new(numbers + beside, banner + foot + under + numbers),
        };
        if picture.size().cmplt(Vec2::splat(LEAST)).any() {
            return None;
        }
        let (left, right) = (picture.min.x, picture.max.x);
        let foot_top = picture.max.y + numbers;
        let columns = if is_landscape {
            let min = Vec2::new(inner.max.x - column, picture.min.y);
            vec![PixelBox { min, max: Vec2::new(inner.max.x, inner.max.y - banner) }]
        } else {
            let count = ((right - left) / column).floor().clamp(1.0, 4.0);
            let width = (right - left) / count;
            let top = foot_top + foot;
            let column = |index: f32| {
                PixelBox::at(Vec2::new(left + width * index, top), Vec2::new(width - edge, under))
            };
            (0..count as u16).map(|index| column(f32::from(index))).collect()
        };
        let banners = [inner.min.y, inner.max.y - banner]
            .map(|top| PixelBox::at(Vec2::new(inner.min.x, top), Vec2::new(inner.size().x, banner)));
        Some(Self {
            page: UVec2::new(size.0, size.1),
            picture,
            head: PixelBox {
                min: Vec2::new(left, inner.min.y + banner),
                max: Vec2::new(inner.max.x, inner.min.y + banner + head),
            },
            foot: PixelBox { min: Vec2::new(left, foot_top), max: Vec2::new(right, foot_top + foot) },
            columns,
            banners: if has_banner { banners.into() } else { Vec::new() },
        })
    }

    /// Width and height of the page in pixels.
    pub fn page_size(&self) -> (u32, u32) {
        (self.page.x, self.page.y)
    }

    /// The column and row of the picture's upper left pixel.
    pub fn picture_corner(&self) -> (u32, u32) {
        let corner = self.picture.min.as_uvec2();
        (corner.x, corner.y)
    }

    /// Width and height of the picture in pixels.
    pub fn picture_size(&self) -> (u32, u32) {
        let size = self.picture.size().round().as_uvec2();
        (size.x, size.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_a_page_lie_side_by_side_on_it() {
        for size in [(1920, 1080), (480, 270), (1240, 1754), (3508, 2480)] {
            let frame = SheetFrame::new(SheetLayout::Military, size, true, true).expect("large enough");
            let page = Sheet::new(size.0, size.1).bounds();
            let mut parts = vec![frame.picture, frame.head, frame.foot];
            parts.extend(frame.columns.iter().chain(&frame.banners));
            for (index, part) in parts.iter().enumerate() {
                assert!(page.holds(part), "{size:?}: {part:?}");
                assert!(!parts[..index].iter().any(|other| other.overlaps(part)), "{size:?}: {part:?}");
            }
            assert_eq!(frame.picture.min, frame.picture.min.round());
        }
    }

    #[test]
    fn other_layouts_and_stamps_have_no_margin() {
        assert_eq!(SheetFrame::new(SheetLayout::Compact, (1920, 1080), true, false), None);
        assert_eq!(SheetFrame::new(SheetLayout::Margin, (120, 90), true, false), None);
    }
}
