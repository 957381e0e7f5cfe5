//! Annotating a picture: furniture into the corners, labels between, all painted at once.

use glam::Vec2;

use crate::annotate::annotation::Annotations;
use crate::annotate::canvas::Canvas;
use crate::annotate::drawing::Drawing;
use crate::annotate::labels::draw_labels;
use crate::annotate::pixel_box::PixelBox;
use crate::annotate::report::{Furniture, Report};
use crate::annotate::sheet::Sheet;
use crate::annotate::text::Typesetter;
use crate::annotate::{credit, legend, north, scale_bar, title};
use crate::draw::pixels::Pixels;

/// Furniture larger than this share of the picture, in width or height, would hide what it explains.
const LARGEST_SHARE: Vec2 = Vec2::new(0.63, 0.52);

/// Paints `annotations` on `pixels`; returns what was drawn and what could not be.
///
/// Nothing drawn overlaps anything else drawn, or leaves the picture. The same picture and annotations give
/// the same bytes on every machine. Without annotations the picture is unchanged.
pub fn annotate(pixels: &mut Pixels, annotations: &Annotations) -> Report {
    let sheet = Sheet::new(pixels.width(), pixels.height());
    let mut setter = Typesetter::new();
    let mut report = Report::default();
    let furniture = furnish(annotations, &sheet, &mut setter, &mut report);
    let boxes: Vec<PixelBox> = furniture.iter().map(Drawing::bounds).collect();
    let labels = draw_labels(&annotations.labels, &boxes, &sheet, &mut setter, &mut report);
    let mut canvas = Canvas::over(pixels);
    furniture.iter().chain([&labels]).for_each(|drawing| canvas.draw(drawing));
    canvas.finish();
    report
}

/// The furniture, each piece in its corner; what does not fit is reported as left out.
fn furnish(
    annotations: &Annotations,
    sheet: &Sheet,
    setter: &mut Typesetter,
    report: &mut Report,
) -> Vec<Drawing> {
    let mut corners = Corners { sheet, laid: Vec::new() };
    lay_title(annotations, &mut corners, setter, report);
    if let Some(bar) = &annotations.scale_bar {
        let drawing = scale_bar::compose(bar, sheet, setter);
        corners.lay(Furniture::ScaleBar, drawing, Corner::LowerLeft, report);
    }
    if let Some(arrow) = &annotations.north {
        let drawing = north::compose(arrow, sheet, setter);
        corners.lay(Furniture::NorthArrow, drawing, Corner::UpperRight, report);
    }
    if let Some(legend) = &annotations.legend {
        let mut told = Report::default();
        let drawing = legend::compose(legend, sheet, setter, &mut told);
        if corners.lay(Furniture::Legend, drawing, Corner::LowerRight, report) {
            report.take_texts(told);
        }
    }
    if let Some(text) = &annotations.credit {
        lay_credit(text, &mut corners, setter, report);
    }
    corners.laid
}

fn lay_title(
    annotations: &Annotations,
    corners: &mut Corners<'_>,
    setter: &mut Typesetter,
    report: &mut Report,
) {
    let (title, subtitle) = (annotations.title.as_deref(), annotations.subtitle.as_deref());
    if title.is_none() && subtitle.is_none() {
        return;
    }
    let mut told = Report::default();
    let drawing = title::compose(title, subtitle, corners.sheet, setter, &mut told);
    if corners.lay(Furniture::Title, drawing, Corner::UpperLeft, report) {
        report.take_texts(told);
    }
}

/// The credit stands in the lower margin's line between scale bar and legend, flush right.
fn lay_credit(text: &str, corners: &mut Corners<'_>, setter: &mut Typesetter, report: &mut Report) {
    let sheet = corners.sheet;
    let (inner, room) = (sheet.inner(), corners.free_below());
    let mut told = Report::default();
    let drawing = credit::compose(text, room.size().x, sheet, setter, &mut told).map(|line| {
        let bounds = line.bounds();
        line.moved((Vec2::new(room.max.x, inner.max.y) - bounds.max).round())
    });
    if corners.keep(Furniture::Credit, drawing, report) {
        report.take_texts(told);
    }
}

enum Corner {
    UpperLeft,
    UpperRight,
    LowerLeft,
    LowerRight,
}

/// The furniture laid so far.
struct Corners<'a> {
    sheet: &'a Sheet,
    laid: Vec<Drawing>,
}

impl Corners<'_> {
    /// Moves `drawing` into its corner and keeps it where it fits; returns whether it does.
    fn lay(
        &mut self,
        piece: Furniture,
        drawing: Option<Drawing>,
        corner: Corner,
        report: &mut Report,
    ) -> bool {
        let inner = self.sheet.inner();
        let moved = drawing.map(|drawing| {
            let bounds = match piece {
                // The arrow's middle stays where it is however the needle turns.
                Furniture::NorthArrow => PixelBox::around(Vec2::ZERO, Vec2::splat(north::reach(self.sheet))),
                _ => drawing.bounds(),
            };
            let by = match corner {
                Corner::UpperLeft => inner.min - bounds.min,
                Corner::LowerRight => inner.max - bounds.max,
                Corner::UpperRight => Vec2::new(inner.max.x - bounds.max.x, inner.min.y - bounds.min.y),
                Corner::LowerLeft => Vec2::new(inner.min.x - bounds.min.x, inner.max.y - bounds.max.y),
            };
            drawing.moved(by.round())
        });
        self.keep(piece, moved, report)
    }

    /// Keeps `drawing` where it is, if it fits there; returns whether it does, and reports where it does not.
    fn keep(&mut self, piece: Furniture, drawing: Option<Drawing>, report: &mut Report) -> bool {
        let fits = |drawing: &Drawing| {
            let bounds = drawing.bounds();
            let small =
                piece == Furniture::Credit || bounds.size().cmple(self.sheet.size * LARGEST_SHARE).all();
            let room = bounds.grown(self.sheet.px(6.0));
            small
                && self.sheet.bounds().holds(&bounds)
                && !self.laid.iter().any(|other| other.bounds().overlaps(&room))
        };
        match drawing.filter(fits) {
            Some(drawing) => self.laid.push(drawing),
            None => {
                report.left_out.push(piece);
                return false;
            }
        }
        true
    }

    /// The strip along the lower margin that no panel takes.
    fn free_below(&self) -> PixelBox {
        let inner = self.sheet.inner();
        let air = self.sheet.px(14.0);
        let middle = self.sheet.size.x * 0.5;
        let low = |bounds: &PixelBox| bounds.max.y > inner.max.y - self.sheet.px(30.0);
        let (mut left, mut right) = (inner.min.x, inner.max.x);
        for bounds in self.laid.iter().map(Drawing::bounds).filter(low) {
            if bounds.center().x < middle {
                left = left.max(bounds.max.x + air);
            } else {
                right = right.min(bounds.min.x - air);
            }
        }
        PixelBox { min: Vec2::new(left, inner.min.y), max: Vec2::new(right, inner.max.y) }
    }
}
