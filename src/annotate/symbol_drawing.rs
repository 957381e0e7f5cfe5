//! Military symbols as drawings: marks of the symbol's box in pixels, with the lines of text round the frame.

use glam::Vec2;
use tiny_skia::{LineCap, LineJoin, Path, PathBuilder, Stroke, StrokeDash};

use crate::annotation::PictureSymbol;
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::halo::Halo;
use crate::pixel_box::PixelBox;
use crate::sheet::{HALO, INK};
use crate::text::{TextStyle, TypesetLine};
use sandtable_draw::color::Srgba;
use sandtable_symbology::drawing::{PathStep, SymbolMark, SymbolPen};
use sandtable_symbology::symbol::MilitarySymbol;
use sandtable_symbology::texts::{ROW_PITCH, SymbolNote, TEXT_GAP, TEXT_SIZE, TextPlace};

/// Outlines of strokes are approximated to this fraction of a pixel.
const STROKE_PRECISION: f32 = 4.0;
/// Thinner lines are drawn this wide, in pixels: below a pixel black turns gray.
const THINNEST: f32 = 1.1;
/// How far the halo reaches around a symbol, in design pixels: it parts a frame from the ground.
const HALO_REACH: f32 = 1.6;
/// The greatest width of a line of text, in units: longer ones end with an ellipsis.
const WIDEST_TEXT: f32 = 420.0;

/// A symbol drawn round the middle of its box, (100, 100), as the origin.
pub struct SymbolBlock {
    pub drawing: Drawing,
    /// Around all of it, with its halo.
    pub bounds: PixelBox,
    /// Around the symbol without its text.
    pub symbol: PixelBox,
    /// The point at its place.
    pub anchor: Vec2,
    /// Pixels per unit of the box.
    pub unit_px: f32,
}

impl SymbolBlock {
    /// `texts` are the lines of text that are drawn, `scale` is the share of its size that it has.
    pub fn new(symbol: &PictureSymbol, texts: &[SymbolNote], scale: f32, composer: &mut Composer) -> Self {
        let unit_px = symbol.height.pixels(&composer.sheet) * scale / 100.0;
        let pixels = |at: Vec2| (at - Vec2::splat(100.0)) * unit_px;
        let halo = composer.sheet.px(HALO_REACH).max(1.0);
        let mut drawing = symbol_marks(&symbol.symbol, unit_px, Some(halo), composer);
        let area = PixelBox { min: pixels(symbol.symbol.bounds.min), max: pixels(symbol.symbol.bounds.max) };
        let around = area.grown(halo + 2.0 * unit_px);
        let texts = draw_texts(&symbol.symbol, texts, unit_px, composer);
        let bounds = around.union(texts.bounds());
        drawing.append(texts);
        Self { drawing, bounds, symbol: around, anchor: pixels(symbol.symbol.anchor), unit_px }
    }
}

/// A symbol without the text round it, its middle at the origin, `unit_px` pixels a unit of its box; on a halo that reaches so
/// many pixels, if any.
pub(crate) fn symbol_marks(
    symbol: &MilitarySymbol,
    unit_px: f32,
    halo: Option<f32>,
    composer: &mut Composer,
) -> Drawing {
    let mut drawing = Drawing::default();
    let shapes: Vec<DrawnShape> =
        symbol.marks.iter().filter_map(|mark| DrawnShape::new(mark, unit_px)).collect();
    for (shape, reach) in shapes.iter().zip(halo.into_iter().cycle()) {
        shape.draw_halo(reach, &mut drawing);
    }
    let mut shapes = shapes.into_iter();
    for mark in &symbol.marks {
        match mark {
            SymbolMark::Shape { .. } => {
                if let Some(shape) = shapes.next() {
                    shape.draw(&mut drawing);
                }
            }
            SymbolMark::Text { text, center, size, color: [red, green, blue] } => {
                let style = TextStyle::new(size * unit_px, TextStyle::BOLD);
                let line = composer.line(text, style);
                let at = (*center - Vec2::splat(100.0)) * unit_px;
                let at = at + Vec2::new(-line.advance * 0.5, style.cap_px() * 0.5);
                drawing.write(&line, at, Srgba::opaque(*red, *green, *blue));
            }
        }
    }
    drawing
}

/// The lines of text round the frame.
pub(crate) fn draw_texts(
    symbol: &MilitarySymbol,
    texts: &[SymbolNote],
    unit_px: f32,
    composer: &mut Composer,
) -> Drawing {
    let frame = symbol.frame;
    let style = TextStyle::new((TEXT_SIZE * unit_px).max(composer.sheet.type_px(10.0)), TextStyle::BOLD);
    let (gap, halo) = (TEXT_GAP * unit_px, composer.sheet.px(2.0).max(1.4));
    let pitch = style.size_px * ROW_PITCH;
    let (left, right) = ((frame.min.x - 100.0) * unit_px - gap, (frame.max.x - 100.0) * unit_px + gap);
    let middle = ((frame.min.y + frame.max.y) * 0.5 - 100.0) * unit_px;
    let row_y = |row: u8| middle + (f32::from(row) - 2.0) * pitch + style.cap_px() * 0.5;
    let mut lines: Vec<(TypesetLine, Vec2)> = Vec::new();
    let mut drawing = Drawing::default();
    for SymbolNote { text, place } in texts {
        let Some(line) = composer.fitted(text, style, WIDEST_TEXT * unit_px) else { continue };
        let at = match place {
            TextPlace::Left(row) => Vec2::new(left - line.advance, row_y(*row)),
            TextPlace::Right(row) => Vec2::new(right, row_y(*row)),
            TextPlace::Above => {
                let top = (symbol.bounds.min.y - 100.0) * unit_px;
                Vec2::new(-line.advance * 0.5, top - gap)
            }
            // The bar is a mark of the symbol.
            TextPlace::Bar => continue,
            TextPlace::Below => {
                let bottom = (symbol.bounds.max.y - 100.0) * unit_px;
                Vec2::new(-line.advance * 0.5, bottom + gap + style.cap_px())
            }
            TextPlace::Inside => Vec2::new(-line.advance * 0.5, middle + style.cap_px() * 0.5),
        };
        drawing.record_text(text, line.missing, line.shortened);
        lines.push((line, at));
    }
    let outside: Vec<(&TypesetLine, Vec2)> = lines.iter().map(|(line, at)| (line, *at)).collect();
    drawing.draw_halo(&outside, Halo::paper(halo));
    lines.iter().for_each(|(line, at)| drawing.write(line, *at, INK));
    drawing
}

/// A shape of a symbol in pixels.
struct DrawnShape {
    path: Path,
    fill: Option<[u8; 3]>,
    stroke: Option<SymbolPen>,
    unit_px: f32,
}

impl DrawnShape {
    fn new(mark: &SymbolMark, unit_px: f32) -> Option<Self> {
        let SymbolMark::Shape { steps, fill, stroke } = mark else { return None };
        Some(Self { path: path(steps, unit_px)?, fill: *fill, stroke: *stroke, unit_px })
    }

    fn width(&self, pen: &SymbolPen) -> f32 {
        (pen.width * self.unit_px).max(THINNEST)
    }

    fn draw_halo(&self, reach: f32, drawing: &mut Drawing) {
        let width = self.stroke.as_ref().map_or(0.0, |pen| self.width(pen));
        let style = Stroke {
            width: width + 2.0 * reach,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        if let Some(outline) = self.path.stroke(&style, STROKE_PRECISION) {
            drawing.fill(outline, Srgba([HALO.0[0], HALO.0[1], HALO.0[2], 255]));
        }
    }

    fn draw(self, drawing: &mut Drawing) {
        let opaque = |[red, green, blue]: [u8; 3]| Srgba::opaque(red, green, blue);
        if let Some(pen) = self.stroke {
            let dash = pen
                .dash
                .and_then(|dash| StrokeDash::new(dash.map(|length| length * self.unit_px).to_vec(), 0.0));
            let style = Stroke { width: self.width(&pen), miter_limit: 10.0, dash, ..Stroke::default() };
            let dashed = style.dash.as_ref().and_then(|dash| self.path.dash(dash, STROKE_PRECISION));
            let outline = dashed.as_ref().unwrap_or(&self.path).stroke(&style, STROKE_PRECISION);
            if let Some(fill) = self.fill {
                drawing.fill(self.path, opaque(fill));
            }
            if let Some(outline) = outline {
                drawing.fill(outline, opaque(pen.color));
            }
        } else if let Some(fill) = self.fill {
            drawing.fill(self.path, opaque(fill));
        }
    }
}

/// Steps as a path in pixels round the middle of the box.
fn path(steps: &[PathStep], unit_px: f32) -> Option<Path> {
    let pixels = |at: Vec2| (at - Vec2::splat(100.0)) * unit_px;
    let mut builder = PathBuilder::new();
    for step in steps {
        match *step {
            PathStep::Move(at) => {
                let at = pixels(at);
                builder.move_to(at.x, at.y);
            }
            PathStep::Line(at) => {
                let at = pixels(at);
                builder.line_to(at.x, at.y);
            }
            PathStep::Quad(control, end) => {
                let (control, end) = (pixels(control), pixels(end));
                builder.quad_to(control.x, control.y, end.x, end.y);
            }
            PathStep::Cubic(one, two, end) => {
                let (one, two, end) = (pixels(one), pixels(two), pixels(end));
                builder.cubic_to(one.x, one.y, two.x, two.y, end.x, end.y);
            }
            PathStep::Close => builder.close(),
        }
    }
    builder.finish()
}
