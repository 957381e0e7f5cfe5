//! The legend of classes: the kinds of features that the picture shows, each with a swatch of its look there.

use glam::{UVec2, Vec2};

use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{FRAME, INK};
use crate::symbol_drawing::symbol_marks;
use crate::text::TextStyle;
use sandtable_draw::color::Srgba;
use sandtable_draw::print_pattern::PrintPattern;
use sandtable_symbology::symbol::MilitarySymbol;

/// The size of a swatch, the gap to its text, and the distance of baselines, in design pixels.
const SWATCH: Vec2 = Vec2::new(34.0, 16.0);
const GAP: f32 = 11.0;
const LEAD: f32 = 24.0;
/// The widest name, in ems: longer ones are cut.
const WIDEST_EM: f32 = 15.0;
/// The height of a symbol in design pixels: as much as fits between the lines.
const SYMBOL_PX: f32 = 21.0;
const BLACK: Srgba = Srgba::opaque(0, 0, 0);
/// More classes are not listed: a legend that is longer than what it explains is not read.
const MOST: usize = 32;

/// A class of what a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// Its name.
    pub name: String,
    /// Its look.
    pub swatch: LegendSwatch,
}

/// The look of a class.
#[derive(Clone, Debug, PartialEq)]
pub enum LegendSwatch {
    /// A line across the swatch.
    Line {
        /// The color of its fill.
        fill: Srgba,
        /// The color of its edges, where it has any.
        casing: Option<Srgba>,
        /// Its width with its edges, in design pixels.
        width: f32,
    },
    /// A stretch of ground or water.
    Area {
        /// Its mean color.
        fill: Srgba,
        /// The color of the line around it.
        edge: Srgba,
    },
    /// A tint of the ground with a pattern over it.
    Tint {
        /// The mean color of the ground under it.
        fill: Srgba,
        /// The color of the pattern and of the line around it.
        ink: Srgba,
        /// The pattern.
        pattern: Option<PrintPattern>,
    },
    /// A black pattern in a black outline.
    Pattern(PrintPattern),
    /// What stands on the ground, as a block of its mean color.
    Block(Srgba),
    /// A military symbol.
    Symbol(Box<MilitarySymbol>),
}

/// The legend with its upper left corner at the origin; `None` without classes.
pub(crate) fn compose(entries: &[LegendEntry], composer: &mut Composer) -> Option<Drawing> {
    compose_part(entries.get(..MOST).unwrap_or(entries), true, composer)
}

/// The legend in parts that are at most `height` pixels high, the first with its head.
pub(crate) fn compose_parts(entries: &[LegendEntry], height: f32, composer: &mut Composer) -> Vec<Drawing> {
    let entries = entries.get(..MOST).unwrap_or(entries);
    let lead = lead(composer);
    let head = composer.sheet.padding() * 2.0 + composer.style(16.0, TextStyle::MEDIUM).cap_px();
    // A part without a head has a line more.
    let lines = (((height - head) / lead).floor() as usize).max(1);
    let (first, rest) = entries.split_at(lines.min(entries.len()));
    let parts = std::iter::once(first).chain(rest.chunks(lines + 1)).enumerate();
    parts.filter_map(|(number, part)| compose_part(part, number == 0, composer)).collect()
}

/// The distance of baselines.
fn lead(composer: &Composer) -> f32 {
    let style = composer.style(15.0, TextStyle::REGULAR);
    composer.sheet.px(LEAD).max(style.size_px * 1.25)
}

fn compose_part(entries: &[LegendEntry], has_head: bool, composer: &mut Composer) -> Option<Drawing> {
    if entries.is_empty() {
        return None;
    }
    let sheet = composer.sheet;
    let (head_style, style) =
        (composer.style(16.0, TextStyle::MEDIUM), composer.style(15.0, TextStyle::REGULAR));
    let padding = sheet.padding();
    let (mut drawing, mut width, lead) = (Drawing::default(), 0.0_f32, lead(composer));
    // Without a head the first class stands where it would.
    let mut baseline = (padding + head_style.cap_px()).round() - if has_head { 0.0 } else { lead };
    if has_head {
        let head = composer.line("Legend", head_style);
        drawing.write(&head, Vec2::new(padding, baseline), INK);
        width = head.advance;
    }
    let swatch = SWATCH * sheet.scale;
    for entry in entries {
        let Some(line) = composer.fitted(&entry.name, style, style.size_px * WIDEST_EM) else { continue };
        baseline = (baseline + lead).round();
        let middle = baseline - style.cap_px() * 0.5;
        let area = PixelBox::around(Vec2::new(padding + swatch.x * 0.5, middle).round(), swatch * 0.5);
        draw_swatch(&entry.swatch, area, composer, &mut drawing);
        let x = padding + swatch.x + sheet.px(GAP);
        drawing.record_text(&entry.name, line.missing, line.shortened);
        drawing.write(&line, Vec2::new(x.round(), baseline), INK);
        width = width.max(x - padding + line.advance);
    }
    let corner = Vec2::new((width + padding * 2.0).ceil(), (baseline + padding).ceil());
    Some(drawing.on_panel(corner, &sheet))
}

fn draw_swatch(swatch: &LegendSwatch, area: PixelBox, composer: &mut Composer, drawing: &mut Drawing) {
    let sheet = composer.sheet;
    match swatch {
        LegendSwatch::Line { fill, casing, width } => {
            let (middle, width) = (area.center().y, sheet.px(*width).max(1.0));
            let line = PixelSegment {
                from: Vec2::new(area.min.x + width * 0.5, middle),
                to: Vec2::new(area.max.x - width * 0.5, middle),
            };
            let inner = match casing {
                Some(casing) => {
                    drawing.line(line, width, *casing);
                    (width - sheet.px(1.8).max(1.4)).max(1.0)
                }
                None => width,
            };
            drawing.line(line, inner, *fill);
        }
        LegendSwatch::Area { fill, edge } => {
            drawing.rect(area, *fill);
            drawing.frame(area, sheet.hairline().round(), *edge);
        }
        LegendSwatch::Tint { fill, ink, pattern } => {
            drawing.rect(area, *fill);
            if let Some(pattern) = pattern {
                draw_pattern(*pattern, area, *ink, composer, drawing);
            }
            drawing.frame(area, sheet.hairline().round(), *ink);
        }
        LegendSwatch::Pattern(pattern) => {
            draw_pattern(*pattern, area, BLACK, composer, drawing);
            drawing.frame(area, sheet.hairline().round(), BLACK);
        }
        LegendSwatch::Block(fill) => {
            let block = PixelBox::around(area.center(), Vec2::splat(area.size().y * 0.42)).grown(0.5);
            drawing.rect(block, *fill);
            drawing.frame(block, sheet.hairline().round(), FRAME);
        }
        LegendSwatch::Symbol(symbol) => {
            let (bounds, most) = (symbol.bounds, sheet.px(SYMBOL_PX));
            let size = bounds.max - bounds.min;
            let unit_px = (area.size().x / size.x).min(most / size.y);
            let middle = ((bounds.min + bounds.max) * 0.5 - Vec2::splat(100.0)) * unit_px;
            drawing.append(symbol_marks(symbol, unit_px, None, composer).moved(area.center() - middle));
        }
    }
}

fn draw_pattern(
    pattern: PrintPattern,
    area: PixelBox,
    ink: Srgba,
    composer: &Composer,
    drawing: &mut Drawing,
) {
    let (corner, size) = (area.min.as_uvec2(), area.size().as_uvec2());
    let unit = PrintPattern::unit_px(composer.sheet.size.y as u32);
    for (x, y) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))) {
        if pattern.is_black(x, y, unit) {
            let at = (corner + UVec2::new(x, y)).as_vec2();
            drawing.rect(PixelBox::at(at, Vec2::ONE), ink);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_symbology::code::SymbolCode;

    fn entry(name: &str) -> LegendEntry {
        let fill = Srgba::opaque(200, 120, 40);
        LegendEntry { name: name.into(), swatch: LegendSwatch::Line { fill, casing: Some(INK), width: 6.0 } }
    }

    #[test]
    fn each_class_has_a_line_of_its_own() {
        let mut composer = Composer::new(1920, 1080);
        assert!(compose(&[], &mut composer).is_none());
        let height = |count: usize, composer: &mut Composer| {
            let entries: Vec<LegendEntry> = (0..count).map(|_| entry("Main road")).collect();
            compose(&entries, composer).expect("classes").bounds().size().y
        };
        let step = height(3, &mut composer) - height(2, &mut composer);
        assert!((step - LEAD).abs() < 1.5, "{step}");
        assert_eq!(height(MOST, &mut composer), height(MOST + 50, &mut composer));
    }

    #[test]
    fn a_legend_in_parts_has_every_class_once_and_parts_that_are_low_enough() {
        let mut composer = Composer::new(1920, 1080);
        let entries: Vec<LegendEntry> = (0..20).map(|number| entry(&format!("class {number}"))).collect();
        let parts = compose_parts(&entries, 200.0, &mut composer);
        assert!(parts.len() > 2 && parts.iter().all(|part| part.bounds().size().y <= 200.0));
        let names: Vec<&str> =
            parts.iter().flat_map(|part| &part.texts).map(|text| text.text.as_str()).collect();
        let wanted: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(names, wanted);
    }

    #[test]
    fn the_panel_holds_every_kind_of_swatch_and_cuts_long_names() {
        let fill = Srgba::opaque(90, 140, 90);
        let code = SymbolCode::parse("10031000151211000000").expect("a code");
        let symbol = MilitarySymbol::new(&code).expect("a frame");
        let entries = [
            entry(&"Main road ".repeat(20)),
            LegendEntry { name: "Forest".into(), swatch: LegendSwatch::Area { fill, edge: INK } },
            LegendEntry { name: "Tower".into(), swatch: LegendSwatch::Block(fill) },
            LegendEntry { name: "Symbol".into(), swatch: LegendSwatch::Symbol(Box::new(symbol)) },
        ];
        let drawing = compose(&entries, &mut Composer::new(1920, 1080)).expect("classes");
        let panel = drawing.marks.first().map(|mark| crate::drawing::box_of(&mark.path));
        assert_eq!(panel, Some(drawing.bounds()));
        assert!(drawing.texts[0].shortened);
    }
}
