//! The margin of a sheet: title, legend, norths, scale, facts and sources round the picture, on paper.
//!
//! Columns are filled from the top, the most needed first; what finds no place is left out and reported.

use glam::Vec2;

use crate::annotation::Annotations;
use crate::class_legend;
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::locator::{self, LocatorMap};
use crate::margin_table::{self, MarginTable};
use crate::north::CaptionPlace;
use crate::norths::{self, ThreeNorths};
use crate::paragraph::written_lines;
use crate::pixel_box::PixelBox;
use crate::report::FurnitureKind;
use crate::sheet::{INK, SOFT_INK};
use crate::sheet_frame::SheetFrame;
use crate::text::TextStyle;
use crate::{legend, north, scale_bar};
use sandtable_draw::pixels::Pixels;

/// Lines of facts and of sources at most.
const MOST_LINES: usize = 4;
/// The space between pieces of a column, in design pixels.
const GAP: f32 = 16.0;
/// The least foreshortening of the arrow: in lower views it would be a line.
const LEAST_TILT: f32 = 0.5;

/// The texts of a sheet's margin, besides the furniture of every picture.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginNotes {
    /// The parts of the page.
    pub frame: SheetFrame,
    /// The classification, above and below all else.
    pub classification: Option<String>,
    /// Projection, datum, heights, grid.
    pub facts: Vec<String>,
    /// Sources, date and notes.
    pub sources: Vec<String>,
    /// The three norths.
    pub norths: Option<ThreeNorths>,
    /// Tables, such as the legs of a route.
    pub tables: Vec<MarginTable>,
    /// The whole model in plan.
    pub locator: Option<LocatorMap>,
}

/// The furniture of a margin.
pub(crate) struct SetMargin {
    /// Everything drawn.
    pub drawing: Drawing,
    /// A picture that is part of it, and its upper left corner.
    pub inset: Option<(Pixels, Vec2)>,
    /// What found no place.
    pub left_out: Vec<FurnitureKind>,
}

/// Lays out the margin of a page; coordinates are those of the page.
pub(crate) fn compose(notes: &MarginNotes, annotations: &Annotations, composer: &mut Composer) -> SetMargin {
    composer.sheet.has_panels = false;
    let frame = &notes.frame;
    let mut margin = SetMargin { drawing: Drawing::default(), inset: None, left_out: Vec::new() };
    let line = composer.sheet.whole_px(1.4);
    margin.drawing.frame(frame.picture.grown(line), line, INK);
    draw_head(&mut margin.drawing, annotations, frame.head, composer);
    if let Some(text) = &notes.classification {
        frame.banners.iter().for_each(|area| draw_banner(&mut margin.drawing, text, *area, composer));
    }
    draw_foot(&mut margin, notes, annotations, composer);
    fill_columns(&mut margin, notes, annotations, composer);
    composer.sheet.has_panels = true;
    margin
}

fn draw_head(drawing: &mut Drawing, annotations: &Annotations, area: PixelBox, composer: &mut Composer) {
    let mut baseline = area.min.y;
    let texts =
        [(&annotations.title, 32.0, TextStyle::MEDIUM), (&annotations.subtitle, 18.0, TextStyle::REGULAR)];
    for (number, (text, size, weight)) in texts.into_iter().enumerate() {
        let style = composer.style(size, weight);
        let text = written_lines(text.as_deref().unwrap_or_default(), usize::MAX).0.join(" · ");
        let Some(line) = composer.fitted(&text, style, area.size().x).filter(|_| !text.is_empty()) else {
            continue;
        };
        baseline = (baseline + style.size_px * [0.95, 1.6][number]).round();
        drawing.record_text(&text, line.missing, line.shortened);
        drawing.write(&line, Vec2::new(area.min.x, baseline), if number == 0 { INK } else { SOFT_INK });
    }
}

fn draw_banner(drawing: &mut Drawing, text: &str, area: PixelBox, composer: &mut Composer) {
    let style = TextStyle { tracking: 0.12, ..composer.style(21.0, TextStyle::BOLD) };
    let text = written_lines(text, usize::MAX).0.join(" · ");
    if let Some(line) = composer.fitted(&text, style, area.size().x) {
        let start = area.center() + Vec2::new(-line.advance, style.cap_px()) * 0.5;
        drawing.record_text(&text, line.missing, line.shortened);
        drawing.write(&line, start.round(), INK);
    }
}

/// The scale, then facts, then sources, side by side under the picture.
fn draw_foot(
    margin: &mut SetMargin,
    notes: &MarginNotes,
    annotations: &Annotations,
    composer: &mut Composer,
) {
    let (area, gap) = (notes.frame.foot, composer.sheet.px(34.0));
    let mut left = area.min.x;
    if let Some(bar) = &annotations.scale_bar {
        match scale_bar::compose(bar, None, composer) {
            Some(piece) => {
                let bounds = piece.bounds();
                let at = Vec2::new(left, area.min.y + composer.sheet.px(8.0));
                left += bounds.size().x + gap;
                margin.drawing.append(piece.moved((at - bounds.min).round()));
            }
            None => margin.left_out.push(FurnitureKind::ScaleBar),
        }
    }
    let blocks = [&notes.facts, &notes.sources].into_iter().filter(|lines| !lines.is_empty());
    let count = blocks.clone().count().max(1) as f32;
    let width = ((area.max.x - left - gap * (count - 1.0)) / count).max(0.0);
    for lines in blocks {
        draw_lines(
            &mut margin.drawing,
            lines,
            PixelBox::at(Vec2::new(left, area.min.y), Vec2::new(width, area.size().y)),
            composer,
        );
        left += width + gap;
    }
}

fn draw_lines(drawing: &mut Drawing, lines: &[String], area: PixelBox, composer: &mut Composer) {
    let style = composer.style(13.5, TextStyle::REGULAR);
    let mut baseline = area.min.y + style.size_px * 1.35;
    for text in lines.iter().take(MOST_LINES) {
        if let Some(line) = composer.fitted(text, style, area.size().x) {
            drawing.record_text(text, line.missing, line.shortened);
            drawing.write(&line, Vec2::new(area.min.x, baseline).round(), SOFT_INK);
            baseline += style.size_px * 1.38;
        }
    }
}

/// Fills the columns from the top: each piece stands in the first column that has room for it.
fn fill_columns(
    margin: &mut SetMargin,
    notes: &MarginNotes,
    annotations: &Annotations,
    composer: &mut Composer,
) {
    let gap = composer.sheet.px(GAP);
    let mut columns = notes.frame.columns.clone();
    let Some(first) = columns.first().copied() else { return };
    let (width, height) = (first.size().x, first.size().y);
    let arrow = annotations.north.as_ref().map(|arrow| {
        let arrow = north::NorthArrow { foreshortening: arrow.foreshortening.max(LEAST_TILT), ..*arrow };
        north::compose(&arrow, CaptionPlace::Beside, composer)
    });
    let norths = notes.norths.as_ref().map(|norths| Some(norths::compose(norths, composer)));
    let ramp = annotations.legend.as_ref().map(|legend| legend::compose(legend, height, composer));
    let of_one = [(FurnitureKind::NorthArrow, arrow), (FurnitureKind::Legend, ramp)];
    let mut pieces: Vec<(FurnitureKind, Option<Drawing>)> =
        of_one.into_iter().filter_map(|(kind, piece)| Some((kind, piece?))).collect();
    // A legend that is longer than what is left goes on in the next column.
    let taken: f32 =
        pieces.iter().flat_map(|(_, piece)| piece).map(|piece| piece.bounds().size().y + gap).sum();
    let left = if columns.len() > 1 && height - taken < height / 3.0 { height } else { height - taken };
    let classes = class_legend::compose_parts(&annotations.classes, left, composer);
    match have_room(&classes, &pieces, &columns, gap) {
        true => pieces.extend(classes.into_iter().map(|part| (FurnitureKind::Classes, Some(part)))),
        // Part of a legend would explain part of the picture.
        false => margin.left_out.push(FurnitureKind::Classes),
    }
    pieces.extend(norths.map(|norths| (FurnitureKind::Norths, norths)));
    for table in &notes.tables {
        pieces.push((FurnitureKind::Table, margin_table::compose(table, width, composer)));
    }
    pieces.extend(
        notes.locator.as_ref().map(|of| (FurnitureKind::Locator, Some(locator::compose(of, composer)))),
    );
    for (kind, piece) in pieces {
        let Some(piece) = piece else {
            margin.left_out.push(kind);
            continue;
        };
        let bounds = piece.bounds();
        let size = bounds.size();
        let Some(free) = columns.iter_mut().find(|column| has_room(size, column)) else {
            margin.left_out.push(kind);
            continue;
        };
        // What is drawn on the locator's relief may reach a little beyond it.
        let origin = if kind == FurnitureKind::Locator { Vec2::ONE } else { -bounds.min };
        let by = (free.min + origin).round();
        if let Some(locator) = notes.locator.as_ref().filter(|_| kind == FurnitureKind::Locator) {
            margin.inset = Some((locator.relief.clone(), by));
        }
        margin.drawing.append(piece.moved(by));
        free.min.y += size.y + gap;
    }
}

fn has_room(size: Vec2, column: &PixelBox) -> bool {
    !size.cmpgt(column.size() + 1.0).any()
}

/// Whether all `parts` have room in the columns after the pieces before them.
fn have_room(
    parts: &[Drawing],
    before: &[(FurnitureKind, Option<Drawing>)],
    columns: &[PixelBox],
    gap: f32,
) -> bool {
    let mut columns = columns.to_vec();
    let mut place = |piece: &Drawing| {
        let size = piece.bounds().size();
        let free = columns.iter_mut().find(|column| has_room(size, column));
        free.map(|free| free.min.y += size.y + gap).is_some()
    };
    // A piece before that has no room is left out.
    before.iter().filter_map(|(_, piece)| piece.as_ref()).for_each(|piece| {
        place(piece);
    });
    parts.iter().all(place)
}
