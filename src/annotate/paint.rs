//! Annotating a picture: furniture in the corners, labels between, all painted at once.

use glam::Vec2;

use crate::annotate::annotation::Annotations;
use crate::annotate::canvas::paint;
use crate::annotate::composer::Composer;
use crate::annotate::cover::SceneCover;
use crate::annotate::drawing::Drawing;
use crate::annotate::fixed_text::draw_fixed;
use crate::annotate::labels::draw_labels;
use crate::annotate::pixel_box::PixelBox;
use crate::annotate::report::{AnnotationReport, FurnitureKind};
use crate::annotate::sheet::Sheet;
use crate::annotate::{credit, legend, north, rim, scale_bar, title};
use crate::draw::pixels::Pixels;

/// Furniture larger than this share of the picture, in width or height, would hide what it explains.
const LARGEST_SHARE: Vec2 = Vec2::new(0.63, 0.52);

/// Paints `annotations` on `pixels`; returns a report.
///
/// Nothing drawn overlaps anything else drawn, or leaves the picture. The same picture and annotations give the same
/// bytes on every machine. Without annotations the picture is unchanged.
pub fn annotate(pixels: &mut Pixels, annotations: &Annotations) -> AnnotationReport {
    let mut composer = Composer::with_font(pixels.width(), pixels.height(), annotations.font.as_ref());
    let furniture = Furniture::lay_out(annotations, &mut composer);
    let mut boxes: Vec<PixelBox> = furniture.pieces().map(Drawing::bounds).collect();
    let marks = rim::draw_marks(&annotations.rim, &boxes, &mut composer);
    boxes.extend(marks.iter().map(Drawing::bounds));
    let mut report = AnnotationReport::default();
    furniture.pieces().for_each(|drawing| report.add_texts(&drawing.texts));
    let fixed = draw_fixed(&annotations.fixed_texts, &mut boxes, &mut composer, &mut report);
    let labels =
        draw_labels(&annotations.labels, &annotations.line_labels, &boxes, &mut composer, &mut report);
    paint(pixels, furniture.pieces().chain(&marks).chain([&fixed, &labels]));
    report.left_out = furniture.left_out;
    report
}

/// The space between pieces of furniture that stand under each other, design pixels.
const GAP: f32 = 14.0;

/// A corner is free where a panel covers no more than this share of its own area of the scene.
const FREE: f32 = 0.05;

struct Furniture {
    sheet: Sheet,
    drawings: Vec<(FurnitureKind, Drawing)>,
    left_out: Vec<FurnitureKind>,
}

impl Furniture {
    /// Each piece in its corner; pieces that do not fit are left out.
    fn lay_out(annotations: &Annotations, composer: &mut Composer) -> Self {
        let mut furniture = Self { sheet: composer.sheet, drawings: Vec::new(), left_out: Vec::new() };
        let (title, subtitle) = (annotations.title.as_deref(), annotations.subtitle.as_deref());
        let has_title = title.is_some() || subtitle.is_some();
        let (bar, arrow, legend) = (&annotations.scale_bar, &annotations.north, &annotations.legend);
        for (kind, piece) in [
            (FurnitureKind::Title, has_title.then(|| title::compose(title, subtitle, composer))),
            (FurnitureKind::ScaleBar, bar.as_ref().map(|bar| scale_bar::compose(bar, composer))),
            (FurnitureKind::NorthArrow, arrow.as_ref().map(|arrow| north::compose(arrow, composer))),
            (FurnitureKind::Legend, legend.as_ref().map(|legend| legend::compose(legend, composer))),
        ] {
            piece.into_iter().for_each(|drawing| furniture.place(kind, drawing, annotations.cover.as_ref()));
        }
        if let Some(text) = &annotations.credit {
            // Flush right in the lower margin, between scale bar and legend.
            let strip = furniture.free_below();
            let credit = credit::compose(text, strip.size().x, composer);
            let moved = credit.map(|line| {
                let by = strip.max - line.bounds().max;
                line.moved(by.round())
            });
            furniture.keep(FurnitureKind::Credit, moved);
        }
        furniture
    }

    fn pieces(&self) -> impl Iterator<Item = &Drawing> {
        self.drawings.iter().map(|(_, drawing)| drawing)
    }

    /// Moves a piece into its corner, or into the upper one on its side where that is free and its own is not, and keeps it
    /// where it fits.
    fn place(&mut self, kind: FurnitureKind, drawing: Option<Drawing>, cover: Option<&SceneCover>) {
        let is_free = |drawing: &Drawing| cover.is_none_or(|cover| cover.share(&drawing.bounds()) <= FREE);
        let moved = drawing.map(|drawing| {
            let own = self.in_corner(kind, drawing);
            let upper = if is_free(&own) { None } else { self.below_upper(kind, &own) };
            upper.filter(is_free).unwrap_or(own)
        });
        self.keep(kind, moved);
    }

    /// A piece of a lower corner moved up, below what stands in the upper corner on its side; `None` for other pieces.
    fn below_upper(&self, kind: FurnitureKind, own: &Drawing) -> Option<Drawing> {
        let above = match kind {
            FurnitureKind::ScaleBar => FurnitureKind::Title,
            FurnitureKind::Legend => FurnitureKind::NorthArrow,
            _ => return None,
        };
        let above = self.drawings.iter().find(|(other, _)| *other == above);
        let top = match above {
            Some((_, above)) => above.bounds().max.y + self.sheet.px(GAP),
            None => self.sheet.inner().min.y,
        };
        Some(own.clone().moved(Vec2::new(0.0, top - own.bounds().min.y).round()))
    }

    /// A piece moved into its corner.
    fn in_corner(&self, kind: FurnitureKind, drawing: Drawing) -> Drawing {
        let inner = self.sheet.inner();
        let PixelBox { min, max } = match kind {
            // The arrow's center stays in place however the needle turns.
            FurnitureKind::NorthArrow => PixelBox::around(Vec2::ZERO, Vec2::splat(north::reach(&self.sheet))),
            _ => drawing.bounds(),
        };
        let (to_min, to_max) = (inner.min - min, inner.max - max);
        let by = match kind {
            FurnitureKind::Title => to_min,
            FurnitureKind::NorthArrow => Vec2::new(to_max.x, to_min.y),
            FurnitureKind::ScaleBar => Vec2::new(to_min.x, to_max.y),
            FurnitureKind::Legend | FurnitureKind::Credit => to_max,
        };
        drawing.moved(by.round())
    }

    /// Keeps a piece where it is, if it fits there.
    fn keep(&mut self, kind: FurnitureKind, drawing: Option<Drawing>) {
        let fits = |drawing: &Drawing| {
            let bounds = drawing.bounds();
            let is_small =
                kind == FurnitureKind::Credit || bounds.size().cmple(self.sheet.size * LARGEST_SHARE).all();
            let spaced = bounds.grown(self.sheet.px(6.0));
            is_small
                && self.sheet.bounds().holds(&bounds)
                && !self.pieces().any(|other| other.bounds().overlaps(&spaced))
        };
        match drawing.filter(fits) {
            Some(drawing) => self.drawings.push((kind, drawing)),
            None => self.left_out.push(kind),
        }
    }

    /// The part inside the margins that no panel at the lower border takes.
    fn free_below(&self) -> PixelBox {
        let mut free = self.sheet.inner();
        let gap = self.sheet.px(14.0);
        let low = free.max.y - self.sheet.px(30.0);
        for bounds in self.pieces().map(Drawing::bounds).filter(|bounds| bounds.max.y > low) {
            if bounds.center().x < self.sheet.size.x * 0.5 {
                free.min.x = free.min.x.max(bounds.max.x + gap);
            } else {
                free.max.x = free.max.x.min(bounds.min.x - gap);
            }
        }
        free
    }
}
