//! Drawings: filled paths with colors, laid out before a pixel is painted.
//!
//! Strokes and letters become filled outlines at once. With a single primitive the canvas stays small, and the bounds of
//! a drawing are the bounds of what it paints, halos included.

use glam::Vec2;
use tiny_skia::{LineCap, LineJoin, Path, PathBuilder, Rect, Stroke, Transform};

use crate::halo::Halo;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{FRAME, PANEL, Sheet};
use sandtable_draw::color::Srgba;

/// Outlines of strokes are approximated to this fraction of a pixel: at 1 the round joins of small type are visible
/// polygons.
const STROKE_PRECISION: f32 = 4.0;

#[derive(Clone, Debug, PartialEq)]
pub struct PaintedPath {
    /// The outline in pixels, filled by the non-zero rule.
    pub path: Path,
    /// The color, with straight alpha.
    pub color: Srgba,
}

#[derive(Clone, Debug, PartialEq)]
pub struct DrawnText {
    pub text: String,
    /// Characters that the fonts lack.
    pub missing: usize,
    pub shortened: bool,
}

/// Marks in the order in which they are painted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    pub marks: Vec<PaintedPath>,
    /// For the report.
    pub texts: Vec<DrawnText>,
}

impl Drawing {
    pub fn record_text(&mut self, text: &str, missing: usize, shortened: bool) {
        self.texts.push(DrawnText { text: text.to_owned(), missing, shortened });
    }

    /// The smallest box around all marks; [`PixelBox::EMPTY`] where there are none.
    pub fn bounds(&self) -> PixelBox {
        self.marks.iter().map(|mark| box_of(&mark.path)).fold(PixelBox::EMPTY, PixelBox::union)
    }

    pub fn fill(&mut self, path: Path, color: Srgba) {
        self.marks.push(PaintedPath { path, color });
    }

    /// Draws along `path`, `width` pixels wide, with round joins and ends.
    pub fn stroke(&mut self, path: &Path, width: f32, color: Srgba) {
        let style =
            Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        if let Some(outline) = path.stroke(&style, STROKE_PRECISION) {
            self.fill(outline, color);
        }
    }

    pub fn line(&mut self, line: PixelSegment, width: f32, color: Srgba) {
        if let Some(path) = polyline(&[line.from, line.to]) {
            self.stroke(&path, width, color);
        }
    }

    pub fn rect(&mut self, area: PixelBox, color: Srgba) {
        if let Some(rect) = rect_of(area) {
            self.fill(PathBuilder::from_rect(rect), color);
        }
    }

    /// Draws a frame of `width` pixels along the inside of `area`'s edge.
    pub fn frame(&mut self, area: PixelBox, width: f32, color: Srgba) {
        let (min, max) = (area.min, area.max);
        let inner = area.grown(-width);
        let sides = [
            PixelBox { min, max: Vec2::new(max.x, inner.min.y) },
            PixelBox { min: Vec2::new(min.x, inner.max.y), max },
            PixelBox { min: Vec2::new(min.x, inner.min.y), max: Vec2::new(inner.min.x, inner.max.y) },
            PixelBox { min: Vec2::new(inner.max.x, inner.min.y), max: Vec2::new(max.x, inner.max.y) },
        ];
        let mut path = PathBuilder::new();
        sides.iter().filter_map(|side| rect_of(*side)).for_each(|side| path.push_rect(side));
        self.marks.extend(path.finish().map(|path| PaintedPath { path, color }));
    }

    /// This drawing on a panel from the origin to `corner`: a light ground with a hairline around it. On a sheet without
    /// panels, this drawing.
    pub fn on_panel(self, corner: Vec2, sheet: &Sheet) -> Self {
        if !sheet.has_panels {
            return self;
        }
        let area = PixelBox { min: Vec2::ZERO, max: corner };
        let mut panel = Self::default();
        panel.rect(area, PANEL);
        panel.frame(area, sheet.hairline().round(), FRAME);
        panel.marks.extend(self.marks);
        Self { marks: panel.marks, texts: self.texts }
    }

    pub fn disc(&mut self, center: Vec2, radius: f32, color: Srgba) {
        let path = PathBuilder::from_circle(center.x, center.y, radius).filter(|_| radius > 0.0);
        self.marks.extend(path.map(|path| PaintedPath { path, color }));
    }

    /// Fills `path` on a halo.
    pub fn fill_haloed(&mut self, path: Path, color: Srgba, halo: Halo) {
        self.stroke(&path, halo.reach_px * 2.0, halo.color);
        self.fill(path, color);
    }

    pub fn append(&mut self, other: Self) {
        self.marks.extend(other.marks);
        self.texts.extend(other.texts);
    }

    pub fn moved(self, by: Vec2) -> Self {
        let shift = Transform::from_translate(by.x, by.y);
        let moved = |mark: PaintedPath| Some(PaintedPath { path: mark.path.transform(shift)?, ..mark });
        Self { marks: self.marks.into_iter().filter_map(moved).collect(), texts: self.texts }
    }
}

pub fn box_of(path: &Path) -> PixelBox {
    let bounds = path.bounds();
    PixelBox { min: Vec2::new(bounds.left(), bounds.top()), max: Vec2::new(bounds.right(), bounds.bottom()) }
}

/// An open path through `points`; `None` for fewer than two different ones or where one is not finite.
pub fn polyline(points: &[Vec2]) -> Option<Path> {
    path_through(points)?.finish()
}

/// The closed path through `points`; `None` for fewer than two different ones or where one is not finite.
pub fn polygon(points: &[Vec2]) -> Option<Path> {
    let mut path = path_through(points)?;
    path.close();
    path.finish()
}

fn path_through(points: &[Vec2]) -> Option<PathBuilder> {
    let (first, rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(first.x, first.y);
    rest.iter().for_each(|point| path.line_to(point.x, point.y));
    Some(path)
}

fn rect_of(area: PixelBox) -> Option<Rect> {
    let has_extent = area.min.cmplt(area.max).all();
    Rect::from_ltrb(area.min.x, area.min.y, area.max.x, area.max.y).filter(|_| has_extent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_strokes_with_their_width() {
        let mut drawing = Drawing::default();
        drawing.line(PixelSegment { from: Vec2::new(10.0, 10.0), to: Vec2::new(10.0, 20.0) }, 4.0, FRAME);
        let bounds = drawing.bounds();
        assert!((bounds.min - Vec2::splat(8.0)).length() < 0.1, "{bounds:?}");
        assert!((bounds.max - Vec2::new(12.0, 22.0)).length() < 0.1, "{bounds:?}");
    }

    #[test]
    fn moving_moves_the_bounds() {
        let mut drawing = Drawing::default();
        drawing.rect(PixelBox::at(Vec2::ZERO, Vec2::new(30.0, 20.0)), PANEL);
        let moved = drawing.moved(Vec2::new(5.0, 7.0)).bounds();
        assert_eq!(moved, PixelBox::at(Vec2::new(5.0, 7.0), Vec2::new(30.0, 20.0)));
    }

    #[test]
    fn what_is_not_finite_or_has_no_extent_draws_nothing() {
        let mut drawing = Drawing::default();
        drawing.rect(PixelBox::EMPTY, FRAME);
        drawing.line(PixelSegment { from: Vec2::splat(f32::NAN), to: Vec2::ONE }, 1.0, FRAME);
        drawing.disc(Vec2::ZERO, 0.0, FRAME);
        assert!(drawing.marks.is_empty());
    }
}
