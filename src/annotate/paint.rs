//! Annotating a picture: furniture in the corners, labels between, all painted at once.

use glam::Vec2;

use crate::annotation::Annotations;
use crate::canvas::{paint, paste};
use crate::composer::Composer;
use crate::cover::SceneCover;
use crate::drawing::Drawing;
use crate::fixed_text::draw_fixed;
use crate::grid::FigurePlace;
use crate::labels::draw_labels;
use crate::north::CaptionPlace;
use crate::pixel_box::PixelBox;
use crate::report::{AnnotationReport, FurnitureKind};
use crate::sheet::{PAPER, Sheet};
use crate::symbols::draw_symbols;
use crate::tapered::draw_rock;
use crate::{
    azimuth_scale, class_legend, credit, grid, legend, margin, north, rim, scale_bar, skyline_names, title,
};
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// Furniture larger than this share of the picture, in width or height, would hide what it explains.
const LARGEST_SHARE: Vec2 = Vec2::new(0.63, 0.52);

/// A sheet laid out, before anything is painted.
pub struct ComposedSheet {
    /// The picture, on paper where the sheet has a margin.
    pub pixels: Pixels,
    /// What is painted on it, in order.
    pub(crate) drawings: Vec<Drawing>,
}

impl ComposedSheet {
    /// Changes the colors of the furniture and of the paper around the picture; the picture itself keeps its own.
    pub fn recolor(&mut self, color: &dyn Fn(Srgba) -> Srgba) {
        for mark in self.drawings.iter_mut().flat_map(|drawing| &mut drawing.marks) {
            mark.color = color(mark.color);
        }
        for pixel in self.pixels.data_mut().iter_mut().filter(|pixel| **pixel == WHITE) {
            *pixel = color(WHITE);
        }
    }

    /// The sheet with everything painted.
    pub fn painted(self) -> Pixels {
        let Self { mut pixels, drawings } = self;
        paint(&mut pixels, &drawings);
        pixels
    }
}

/// Paints `annotations` on `pixels`; returns a report. With a margin the picture becomes the page.
///
/// Nothing drawn overlaps anything else drawn, or leaves the picture; only the grid lies under all. The same picture and
/// annotations give the same bytes on every machine. Without annotations the picture is unchanged.
pub fn annotate(pixels: &mut Pixels, annotations: &Annotations) -> AnnotationReport {
    let picture = std::mem::replace(pixels, Pixels::filled(0, 0, PAPER));
    let (sheet, report) = compose_sheet(picture, annotations);
    *pixels = sheet.painted();
    report
}

/// Lays out `annotations` on and around a picture.
pub fn compose_sheet(picture: Pixels, annotations: &Annotations) -> (ComposedSheet, AnnotationReport) {
    let font = annotations.font.as_ref();
    let mut composer = Composer::with_font(picture.width(), picture.height(), font);
    let mut report = AnnotationReport::default();
    let Some(margin) = &annotations.margin else {
        let furniture = Furniture::lay_out(annotations, &mut composer);
        furniture.pieces().for_each(|drawing| report.add_texts(&drawing.texts));
        let Furniture { drawings, left_out, .. } = furniture;
        let drawings = drawings.into_iter().map(|(_, drawing)| drawing).collect();
        let place = FigurePlace::Inside;
        let drawings = on_picture(annotations, (&picture, drawings), place, &mut composer, &mut report);
        report.left_out = left_out;
        return (ComposedSheet { pixels: picture, drawings }, report);
    };
    let page = margin.frame.page;
    let mut page_composer = Composer::with_font(page.x, page.y, font);
    // Type on the picture is as large as beside it.
    composer.sheet.scale = page_composer.sheet.scale;
    let place = FigurePlace::Outside;
    let drawings = on_picture(annotations, (&picture, Vec::new()), place, &mut composer, &mut report);
    let corner = margin.frame.picture.min;
    let mut drawings: Vec<Drawing> = drawings.into_iter().map(|drawing| drawing.moved(corner)).collect();
    let set = margin::compose(margin, annotations, &mut page_composer);
    report.add_texts(&set.drawing.texts);
    report.left_out = set.left_out;
    drawings.push(set.drawing);
    let mut pixels = Pixels::filled(page.x, page.y, WHITE);
    paste(&mut pixels, &picture, corner);
    set.inset.iter().for_each(|(inset, corner)| paste(&mut pixels, inset, *corner));
    (ComposedSheet { pixels, drawings }, report)
}

/// The paper of a page.
const WHITE: Srgba = Srgba::opaque(255, 255, 255);

/// Grid, marks and labels on `picture`, round the pieces of `furniture` on it.
fn on_picture(
    annotations: &Annotations,
    (picture, furniture): (&Pixels, Vec<Drawing>),
    place: FigurePlace,
    composer: &mut Composer,
    report: &mut AnnotationReport,
) -> Vec<Drawing> {
    let mut boxes: Vec<PixelBox> = furniture.iter().map(Drawing::bounds).collect();
    let placed = &mut report.figures;
    let marks = rim::draw_marks(&annotations.rim, &boxes, composer, placed);
    boxes.extend(marks.iter().map(Drawing::bounds));
    let grid = annotations.grid.as_ref();
    let lines = grid.map(|grid| grid::draw_lines(grid, composer));
    let figures = grid.map(|grid| grid::draw_figures(grid, &boxes, place, composer, placed));
    let figures = figures.unwrap_or_default();
    boxes.extend(figures.iter().map(Drawing::bounds));
    let fixed = draw_fixed(&annotations.fixed_texts, &mut boxes, composer, report);
    let mut panorama = Drawing::default();
    if let Some(marks) = &annotations.panorama {
        panorama = azimuth_scale::compose(marks, composer);
        boxes.push(panorama.bounds());
        let sky = (picture, annotations.cover.as_ref());
        panorama.append(skyline_names::draw(&marks.peaks, sky, &mut boxes, composer, report));
    }
    // The names over a skyline are known by their texts already.
    let known: Vec<PixelBox> =
        report.boxes.iter().map(|area| PixelBox { min: area.min, max: area.max }).collect();
    let symbols = draw_symbols(&annotations.symbols, &boxes, composer, &mut report.symbols);
    report.add_texts(&symbols.drawing.texts);
    boxes.extend(&symbols.boxes);
    let labels = draw_labels(annotations, picture, &boxes, composer, report);
    report
        .boxes
        .retain(|area| area.text.is_some() || !known.contains(&PixelBox { min: area.min, max: area.max }));
    std::iter::once(draw_rock(&annotations.rock))
        .chain(lines)
        .chain(furniture)
        .chain(marks)
        .chain(figures)
        .chain([panorama, fixed, symbols.drawing, labels])
        .collect()
}

/// The space between pieces of furniture that stand under each other, design pixels.
const GAP: f32 = 14.0;

/// A corner is free where a panel covers no more than this share of its own area of the scene: a corner of the scene under a
/// panel is seen, however small.
const FREE: f32 = 0.01;

/// The share that a scale bar beside the title may cover: more would hide the skyline, which tells more than the foreground.
const NEARLY_FREE: f32 = 0.1;

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
        let highest_px = composer.sheet.size.y * LARGEST_SHARE.y;
        let note = annotations.grid.as_ref().and_then(|grid| grid.note.as_deref());
        for (kind, piece) in [
            (FurnitureKind::Title, has_title.then(|| title::compose(title, subtitle, composer))),
            (FurnitureKind::ScaleBar, bar.as_ref().map(|bar| scale_bar::compose(bar, note, composer))),
            (
                FurnitureKind::NorthArrow,
                arrow.as_ref().map(|arrow| north::compose(arrow, CaptionPlace::Below, composer)),
            ),
            (
                FurnitureKind::Legend,
                legend.as_ref().map(|legend| legend::compose(legend, highest_px, composer)),
            ),
        ] {
            piece.into_iter().for_each(|drawing| furniture.place(kind, drawing, annotations.cover.as_ref()));
        }
        if !annotations.classes.is_empty() {
            let legend = class_legend::compose(&annotations.classes, composer);
            furniture.place_emptiest(FurnitureKind::Classes, legend, annotations.cover.as_ref());
        }
        if let Some(text) = &annotations.credit {
            let credit =
                furniture.credit(text, composer).or_else(|| furniture.credit_for_legend(text, composer));
            furniture.keep(FurnitureKind::Credit, credit);
        }
        furniture
    }

    /// The credit flush right in the lower margin, between scale bar and legend; `None` where it does not fit.
    fn credit(&self, text: &str, composer: &mut Composer) -> Option<Drawing> {
        let strip = self.free_below();
        let line = credit::compose(text, strip.size().x, composer)?;
        let by = strip.max - line.bounds().max;
        Some(line.moved(by.round())).filter(|credit| self.fits(FurnitureKind::Credit, credit))
    }

    /// The credit in place of the legend, which is left out for it: who made the data is owed a credit, and nobody a legend.
    fn credit_for_legend(&mut self, text: &str, composer: &mut Composer) -> Option<Drawing> {
        let index = self.drawings.iter().position(|(kind, _)| *kind == FurnitureKind::Legend)?;
        let legend = self.drawings.remove(index);
        let credit = self.credit(text, composer);
        match credit {
            Some(_) => self.left_out.push(FurnitureKind::Legend),
            None => self.drawings.insert(index, legend),
        }
        credit
    }

    fn pieces(&self) -> impl Iterator<Item = &Drawing> {
        self.drawings.iter().map(|(_, drawing)| drawing)
    }

    /// Moves a piece into its corner or, where that is not free, to the first place of [`Self::elsewhere`] that fits and covers
    /// less of the scene than it may, and keeps it where it fits.
    fn place(&mut self, kind: FurnitureKind, drawing: Option<Drawing>, cover: Option<&SceneCover>) {
        let covered = |drawing: &Drawing| cover.map_or(0.0, |cover| cover.share(&drawing.bounds()));
        let moved = drawing.map(|drawing| {
            let own = self.in_corner(kind, drawing);
            let share = covered(&own);
            let other = if share <= FREE { Vec::new() } else { self.elsewhere(kind, &own, share) };
            let better =
                other.into_iter().find(|(most, other)| covered(other) <= *most && self.fits(kind, other));
            better.map_or(own, |(_, other)| other)
        });
        self.keep(kind, moved);
    }

    /// Keeps a piece where it covers least of the scene, of the places at the left and the right border that are free.
    fn place_emptiest(&mut self, kind: FurnitureKind, drawing: Option<Drawing>, cover: Option<&SceneCover>) {
        /// Places that are tried along each border.
        const TRIED: u16 = 24;
        let inner = self.sheet.inner();
        let gap = self.sheet.px(GAP);
        let best = drawing.and_then(|drawing| {
            let bounds = drawing.bounds();
            let slack = inner.size() - bounds.size();
            let places = (0..=TRIED).flat_map(|step| {
                let y = slack.y * f32::from(step) / f32::from(TRIED);
                [slack.x, 0.0].map(|x| Vec2::new(x, y))
            });
            let free = places.filter(|at| {
                let area = PixelBox::at(inner.min + *at, bounds.size()).grown(gap * 0.5);
                !self.pieces().any(|other| other.bounds().overlaps(&area))
            });
            let share = |at: &Vec2| {
                let area = PixelBox::at(inner.min + *at, bounds.size());
                cover.map_or(0.0, |cover| cover.share(&area))
            };
            let at = free.min_by(|a, b| share(a).total_cmp(&share(b)))?;
            Some(drawing.moved((inner.min + at - bounds.min).round()))
        });
        self.keep(kind, best);
    }

    /// Other places for a piece of a lower corner that covers `share` of its area of the scene there, each with the share that
    /// it covers at most. Below what is in the upper corner on its side it covers nothing; else a scale bar is beside that, where
    /// it may cover [`NEARLY_FREE`]; else the piece is in the first of these and covers half as much as in its own.
    fn elsewhere(&self, kind: FurnitureKind, own: &Drawing, share: f32) -> Vec<(f32, Drawing)> {
        let above = match kind {
            FurnitureKind::ScaleBar => FurnitureKind::Title,
            FurnitureKind::Legend => FurnitureKind::NorthArrow,
            _ => return Vec::new(),
        };
        let above = self.drawings.iter().find(|(other, _)| *other == above).map(|(_, above)| above.bounds());
        let (gap, inner, from) = (self.sheet.px(GAP), self.sheet.inner(), own.bounds().min);
        let top = above.map_or(inner.min.y, |above| above.max.y + gap);
        let below = own.clone().moved(Vec2::new(0.0, top - from.y).round());
        let beside = above.filter(|_| kind == FurnitureKind::ScaleBar).map(|above| {
            let corner = Vec2::new(above.max.x + gap, inner.min.y);
            (NEARLY_FREE.min(share / 2.0), own.clone().moved((corner - from).round()))
        });
        let free = (FREE, below.clone());
        std::iter::once(free).chain(beside).chain([(FREE.max(share / 2.0), below)]).collect()
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
            FurnitureKind::Legend | FurnitureKind::Credit | FurnitureKind::Classes => to_max,
            // They stand in the margins of a sheet only.
            FurnitureKind::Norths | FurnitureKind::Table | FurnitureKind::Locator => to_max,
        };
        drawing.moved(by.round())
    }

    /// Keeps a piece where it is, if it fits there.
    fn keep(&mut self, kind: FurnitureKind, drawing: Option<Drawing>) {
        match drawing.filter(|drawing| self.fits(kind, drawing)) {
            Some(drawing) => self.drawings.push((kind, drawing)),
            None => self.left_out.push(kind),
        }
    }

    /// Whether a piece is small enough for the picture, and where it is lies within it and clear of all others.
    fn fits(&self, kind: FurnitureKind, drawing: &Drawing) -> bool {
        let bounds = drawing.bounds();
        let is_small =
            kind == FurnitureKind::Credit || bounds.size().cmple(self.sheet.size * LARGEST_SHARE).all();
        let spaced = bounds.grown(self.sheet.px(6.0));
        is_small
            && self.sheet.bounds().holds(&bounds)
            && !self.pieces().any(|other| other.bounds().overlaps(&spaced))
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
