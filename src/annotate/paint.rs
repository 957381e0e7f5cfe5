//! Annotating a picture: furniture into the corners, labels between, all painted at once.

use glam::Vec2;

use crate::annotate::annotation::Annotations;
use crate::annotate::canvas::Canvas;
use crate::annotate::drawing::Drawing;
use crate::annotate::labels::draw_labels;
use crate::annotate::pixel_box::PixelBox;
use crate::annotate::report::{AnnotationReport, FurnitureKind};
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
pub fn annotate(pixels: &mut Pixels, annotations: &Annotations) -> AnnotationReport {
    let sheet = Sheet::new(pixels.width(), pixels.height());
    let mut setter = Typesetter::new();
    let mut report = AnnotationReport::default();
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
    report: &mut AnnotationReport,
) -> Vec<Drawing> {
    let mut corners = CornerStacks { sheet, laid: Vec::new() };
    lay_title(annotations, &mut corners, setter, report);
    if let Some(bar) = &annotations.scale_bar {
        let drawing = scale_bar::compose(bar, sheet, setter);
        corners.lay(FurnitureKind::ScaleBar, drawing, PictureCorner::LowerLeft, report);
    }
    if let Some(arrow) = &annotations.north {
        let drawing = north::compose(arrow, sheet, setter);
        corners.lay(FurnitureKind::NorthArrow, drawing, PictureCorner::UpperRight, report);
    }
    if let Some(legend) = &annotations.legend {
        let mut told = AnnotationReport::default();
        let drawing = legend::compose(legend, sheet, setter, &mut told);
        if corners.lay(FurnitureKind::Legend, drawing, PictureCorner::LowerRight, report) {
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
    corners: &mut CornerStacks<'_>,
    setter: &mut Typesetter,
    report: &mut AnnotationReport,
) {
    let (title, subtitle) = (annotations.title.as_deref(), annotations.subtitle.as_deref());
    if title.is_none() && subtitle.is_none() {
        return;
    }
    let mut told = AnnotationReport::default();
    let drawing = title::compose(title, subtitle, corners.sheet, setter, &mut told);
    if corners.lay(FurnitureKind::Title, drawing, PictureCorner::UpperLeft, report) {
        report.take_texts(told);
    }
}

/// The credit stands in the lower margin's line between scale bar and legend, flush right.
fn lay_credit(
    text: &str,
    corners: &mut CornerStacks<'_>,
    setter: &mut Typesetter,
    report: &mut AnnotationReport,
) {
    let sheet = corners.sheet;
    let (inner, room) = (sheet.inner(), corners.free_below());
    let mut told = AnnotationReport::default();
    let drawing = credit::compose(text, room.size().x, sheet, setter, &mut told).map(|line| {
        let bounds = line.bounds();
        line.moved((Vec2::new(room.max.x, inner.max.y) - bounds.max).round())
    });
    if corners.keep(FurnitureKind::Credit, drawing, report) {
        report.take_texts(told);
    }
}

enum PictureCorner {
    UpperLeft,
    UpperRight,
    LowerLeft,
    LowerRight,
}

/// The furniture laid so far.
struct CornerStacks<'a> {
    sheet: &'a Sheet,
    laid: Vec<Drawing>,
}

impl CornerStacks<'_> {
    /// Moves `drawing` into its corner and keeps it where it fits; returns whether it does.
    fn lay(
        &mut self,
        piece: FurnitureKind,
        drawing: Option<Drawing>,
        corner: PictureCorner,
        report: &mut AnnotationReport,
    ) -> bool {
        let inner = self.sheet.inner();
        let moved = drawing.map(|drawing| {
            let bounds = match piece {
                // The arrow's middle stays where it is however the needle turns.
                FurnitureKind::NorthArrow => {
                    PixelBox::around(Vec2::ZERO, Vec2::splat(north::reach(self.sheet)))
                }
                _ => drawing.bounds(),
            };
            let by = match corner {
                PictureCorner::UpperLeft => inner.min - bounds.min,
                PictureCorner::LowerRight => inner.max - bounds.max,
                PictureCorner::UpperRight => {
                    Vec2::new(inner.max.x - bounds.max.x, inner.min.y - bounds.min.y)
                }
                PictureCorner::LowerLeft => Vec2::new(inner.min.x - bounds.min.x, inner.max.y - bounds.max.y),
            };
            drawing.moved(by.round())
        });
        self.keep(piece, moved, report)
    }

    /// Keeps `drawing` where it is, if it fits there; returns whether it does, and reports where it does not.
    fn keep(
        &mut self,
        piece: FurnitureKind,
        drawing: Option<Drawing>,
        report: &mut AnnotationReport,
    ) -> bool {
        let fits = |drawing: &Drawing| {
            let bounds = drawing.bounds();
            let small =
                piece == FurnitureKind::Credit || bounds.size().cmple(self.sheet.size * LARGEST_SHARE).all();
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
