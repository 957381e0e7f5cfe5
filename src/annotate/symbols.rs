//! Placement of military symbols: on a staff over their place, stacked where several share one place, without overlapping
//! each other or the furniture.
//!
//! ```text
//!    ┌──┐      ┌──┐                  ┌──┐
//!    │ X│      │//│ stack            │ O│ place hidden by the ground:
//!    └┬─┘      ├──┤                  └┬─┘ a dashed staff and a hollow foot
//!     │ staff  │ X│                   ¦
//!     •        └┬─┘                   ○
//! ```
//!
//! Symbols take their turns by importance and take the first free position: a short staff, a longer one, then aside. A
//! symbol without a free position is reported. Labels are placed after symbols and leave them free.

use glam::Vec2;
use tiny_skia::{Stroke, StrokeDash};

use crate::annotation::PictureSymbol;
use crate::composer::Composer;
use crate::drawing::{Drawing, polygon, polyline};
use crate::halo::Halo;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::report::SymbolReport;
use crate::sheet::{HALO, Sheet};
use crate::symbol_drawing::SymbolBlock;
use sandtable_draw::color::Srgba;

/// The staff's length, in heights of a friendly unit's frame, in the order of preference.
const STAFF_LENGTHS: [f32; 7] = [0.45, 1.1, 1.9, 2.8, 3.8, 5.0, 6.5];
/// How far aside of its place a symbol may stand, in widths of its block.
const ASIDE: [f32; 11] = [0.0, 0.55, -0.55, 1.1, -1.1, 1.7, -1.7, 2.4, -2.4, 3.2, -3.2];
/// Symbols whose places are nearer than this share of a frame's height stand at one place.
const STACK_SHARE: f32 = 0.35;
/// Symbols over each other; more would hide too much ground.
const MOST_IN_STACK: usize = 6;
/// Between symbols of a stack, in units of the symbol's box.
const STACK_GAP: f32 = 6.0;
/// The arrow of movement, in heights of a frame.
const ARROW_LENGTH: f32 = 1.1;

const BLACK: Srgba = Srgba::opaque(0, 0, 0);

/// The drawing of all symbols, and the boxes that labels must avoid.
#[derive(Default)]
pub struct DrawnSymbols {
    pub drawing: Drawing,
    /// The boxes of the symbols, then of their staffs and arrows.
    pub boxes: Vec<PixelBox>,
}

/// Draws the symbols so that they do not overlap `furniture`; reports the outcome of each.
pub fn draw_symbols(
    symbols: &[PictureSymbol],
    furniture: &[PixelBox],
    composer: &mut Composer,
    report: &mut SymbolReport,
) -> DrawnSymbols {
    let sheet = composer.sheet;
    let bounds = sheet.bounds().grown(-(sheet.margin() * 0.4).round());
    let mut field = SymbolField { bounds, taken: furniture.to_vec(), lines: Vec::new(), gap: sheet.px(3.0) };
    let mut drawn = DrawnSymbols::default();
    let (mut staffs, mut faces) = (Drawing::default(), Drawing::default());
    for symbols in stacks(symbols, &sheet, report) {
        let mut stack = PreparedStack::new(&symbols, true, composer);
        let mut position = field.position(&stack);
        if position.is_none() {
            // A unit without its name is better than none.
            stack = PreparedStack::new(&symbols, false, composer);
            position = field.position(&stack);
            let texts = symbols.iter().filter(|symbol| position.is_some() && !symbol.texts.is_empty());
            report.without_text.extend(texts.map(|symbol| symbol.name.clone()));
        }
        let Some(position) = position else {
            report.crowded_out.extend(stack.names());
            continue;
        };
        stack.draw_staff(&position, &sheet, &mut staffs);
        stack.draw_faces(&position, &mut faces);
        report.placed.extend(stack.names());
        if !stack.is_visible {
            report.hidden.extend(stack.names());
        }
        field.taken.extend(stack.boxes(&position));
        drawn.boxes.extend(stack.boxes(&position));
        for line in position.staff.into_iter().chain(stack.arrows()) {
            field.lines.push(line);
        }
    }
    drawn.boxes.extend(field.lines.iter().map(|line| box_around(*line, sheet.px(2.0))));
    drawn.drawing.append(staffs);
    drawn.drawing.append(faces);
    drawn
}

/// The symbols in the picture by importance, those at one place together; the others are reported.
fn stacks<'a>(
    symbols: &'a [PictureSymbol],
    sheet: &Sheet,
    report: &mut SymbolReport,
) -> Vec<Vec<&'a PictureSymbol>> {
    let mut inside: Vec<&PictureSymbol> = Vec::new();
    for symbol in symbols {
        if sheet.bounds().contains(symbol.anchor_px) {
            inside.push(symbol);
        } else {
            report.outside.push(symbol.name.clone());
        }
    }
    inside.sort_by(|a, b| {
        let by_rank = a.rank.total_cmp(&b.rank).then(a.depth_m.total_cmp(&b.depth_m));
        by_rank.then_with(|| a.name.cmp(&b.name))
    });
    let mut stacks: Vec<Vec<&PictureSymbol>> = Vec::new();
    for symbol in inside {
        let near = symbol.height.pixels(sheet) * STACK_SHARE;
        let is_open = |stack: &&mut Vec<&PictureSymbol>| {
            stack.len() < MOST_IN_STACK && stack[0].anchor_px.distance(symbol.anchor_px) <= near
        };
        match stacks.iter_mut().find(is_open) {
            Some(stack) => stack.push(symbol),
            None => stacks.push(vec![symbol]),
        }
    }
    for stack in &mut stacks {
        // A headquarters stands on its own staff, at the bottom.
        stack.sort_by_key(|symbol| !has_own_staff(symbol));
    }
    stacks
}

fn has_own_staff(symbol: &PictureSymbol) -> bool {
    symbol.symbol.anchor != Vec2::splat(100.0)
}

/// Symbols over each other, the first at the bottom.
struct PreparedStack<'a> {
    symbols: Vec<&'a PictureSymbol>,
    /// With the middle of each, from the stack's foot.
    blocks: Vec<(SymbolBlock, Vec2)>,
    /// Of the first symbol.
    anchor: Vec2,
    frame_px: f32,
    is_visible: bool,
}

/// Where a stack stands.
#[derive(Clone, Copy)]
struct StackPosition {
    /// The stack's foot.
    foot: Vec2,
    /// From the place to the foot.
    staff: Option<PixelSegment>,
}

impl<'a> PreparedStack<'a> {
    fn new(symbols: &[&'a PictureSymbol], has_texts: bool, composer: &mut Composer) -> Self {
        let mut blocks: Vec<(SymbolBlock, Vec2)> = Vec::new();
        for symbol in symbols {
            let texts = if has_texts { symbol.texts.as_slice() } else { &[] };
            let block = SymbolBlock::new(symbol, texts, composer);
            let at = match blocks.last() {
                Some((below, at)) => {
                    let top = at.y + below.bounds.min.y - STACK_GAP * block.unit_px;
                    Vec2::new(at.x, top - block.bounds.max.y)
                }
                None if has_own_staff(symbol) => -block.anchor,
                None => Vec2::new(0.0, -block.symbol.max.y),
            };
            blocks.push((block, at));
        }
        Self {
            symbols: symbols.to_vec(),
            anchor: symbols[0].anchor_px,
            frame_px: symbols[0].height.pixels(&composer.sheet),
            is_visible: symbols.iter().all(|symbol| symbol.visible),
            blocks,
        }
    }

    fn names(&self) -> impl Iterator<Item = String> {
        self.symbols.iter().map(|symbol| symbol.name.clone())
    }

    /// The positions, the best first.
    fn positions(&self) -> impl Iterator<Item = StackPosition> {
        let (anchor, frame) = (self.anchor, self.frame_px);
        let own_staff = has_own_staff(self.symbols[0]);
        let center = self.blocks[0].1;
        let moves = self.symbols.iter().any(|symbol| symbol.direction_px.is_some());
        let first = if own_staff {
            Some(StackPosition { foot: anchor, staff: None })
        } else {
            // On a map a symbol's middle is at its place.
            let on_place = self.symbols[0].is_on_map && self.symbols.len() == 1 && !moves;
            on_place.then(|| StackPosition { foot: anchor - center, staff: None })
        };
        let width = self.blocks.iter().map(|(block, _)| block.symbol.size().x).fold(0.0, f32::max);
        let aside = STAFF_LENGTHS.into_iter().flat_map(move |length| {
            ASIDE.into_iter().map(move |aside| {
                let foot = (anchor + Vec2::new(aside * width, -length * frame)).round();
                StackPosition { foot, staff: Some(PixelSegment { from: anchor, to: foot }) }
            })
        });
        first.into_iter().chain(aside)
    }

    /// From the place to where the symbols move.
    fn arrows(&self) -> impl Iterator<Item = PixelSegment> {
        let reach = self.frame_px * ARROW_LENGTH;
        let directions = self.symbols.iter().filter_map(|symbol| symbol.direction_px);
        directions
            .map(move |direction| PixelSegment { from: self.anchor, to: self.anchor + direction * reach })
    }

    fn boxes(&self, position: &StackPosition) -> impl Iterator<Item = PixelBox> {
        let foot = position.foot;
        self.blocks.iter().map(move |(block, at)| block.bounds.moved(foot + *at))
    }

    fn draw_faces(&self, position: &StackPosition, drawing: &mut Drawing) {
        for (block, at) in &self.blocks {
            drawing.append(block.drawing.clone().moved(position.foot + *at));
        }
    }

    /// The staff with its foot, and arrows of movement.
    fn draw_staff(&self, position: &StackPosition, sheet: &Sheet, drawing: &mut Drawing) {
        let width = sheet.px(1.6).max(1.1);
        let halo = width + sheet.px(2.4).max(1.6);
        self.arrows().for_each(|arrow| draw_arrow(arrow, sheet, drawing));
        if let Some(staff) = position.staff {
            drawing.line(staff, halo, HALO);
            if self.is_visible {
                drawing.line(staff, width, BLACK);
            } else {
                draw_dashes(staff, width, sheet, drawing);
            }
        }
        let (anchor, radius) = (self.anchor, sheet.px(3.0).max(2.0));
        if !self.is_visible {
            drawing.disc(anchor, radius + width + sheet.px(1.2), HALO);
            drawing.disc(anchor, radius + width * 0.5, BLACK);
            drawing.disc(anchor, radius - width * 0.5, Srgba::opaque(255, 255, 255));
        } else if position.staff.is_some() {
            drawing.disc(anchor, radius + sheet.px(1.2), HALO);
            drawing.disc(anchor, radius, BLACK);
        }
    }
}

/// An arrow along a line, with its head at the line's end.
fn draw_arrow(arrow: PixelSegment, sheet: &Sheet, drawing: &mut Drawing) {
    let PixelSegment { from, to } = arrow;
    let reach = to - from;
    let along = reach.normalize_or_zero();
    let (head, width) = (reach.length() * 0.32, sheet.px(2.2).max(1.4));
    let line = PixelSegment { from, to: to - along * head };
    let corners =
        [to, to - along * head + along.perp() * head * 0.42, to - along * head - along.perp() * head * 0.42];
    let halo = sheet.px(1.6).max(1.0);
    drawing.line(line, width + 2.0 * halo, HALO);
    if let Some(triangle) = polygon(&corners) {
        drawing.line(line, width, BLACK);
        drawing.fill_haloed(triangle, BLACK, Halo::paper(halo));
        drawing.line(line, width, BLACK);
    }
}

fn draw_dashes(line: PixelSegment, width: f32, sheet: &Sheet, drawing: &mut Drawing) {
    let lengths = vec![sheet.px(5.0).max(3.0), sheet.px(3.5).max(2.0)];
    let dashed = StrokeDash::new(lengths, 0.0).zip(polyline(&[line.from, line.to]));
    let dashes = dashed.and_then(|(dash, path)| path.dash(&dash, 1.0));
    let outline = dashes.and_then(|path| path.stroke(&Stroke { width, ..Stroke::default() }, 1.0));
    if let Some(outline) = outline {
        drawing.fill(outline, BLACK);
    }
}

fn box_around(line: PixelSegment, reach: f32) -> PixelBox {
    PixelBox { min: line.from.min(line.to), max: line.from.max(line.to) }.grown(reach)
}

/// What is taken on the picture.
struct SymbolField {
    bounds: PixelBox,
    taken: Vec<PixelBox>,
    /// Staffs and arrows.
    lines: Vec<PixelSegment>,
    gap: f32,
}

impl SymbolField {
    /// The first free position of a stack, if there is one off its own arrows.
    fn position(&self, stack: &PreparedStack<'_>) -> Option<StackPosition> {
        let free = || stack.positions().filter(|position| self.is_free(stack, position));
        let is_clear = |position: &StackPosition| {
            stack.boxes(position).all(|area| !stack.arrows().any(|arrow| area.meets(&arrow)))
        };
        free().find(is_clear).or_else(|| free().next())
    }

    fn is_free(&self, stack: &PreparedStack<'_>, position: &StackPosition) -> bool {
        let free = |area: PixelBox| {
            let spaced = area.grown(self.gap);
            self.bounds.holds(&area)
                && !self.taken.iter().any(|taken| taken.overlaps(&spaced))
                && !self.lines.iter().any(|line| area.meets(line))
        };
        let passes = |staff: PixelSegment| !self.taken.iter().any(|taken| taken.meets(&staff));
        stack.boxes(position).all(free) && position.staff.is_none_or(passes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::annotation::SymbolHeight;
    use sandtable_symbology::code::SymbolCode;
    use sandtable_symbology::symbol::MilitarySymbol;
    use sandtable_symbology::texts::{SymbolNote, TextPlace};

    fn symbol(name: &str, code: &str, x: f32, y: f32) -> PictureSymbol {
        let code = SymbolCode::parse(code).expect(code);
        PictureSymbol {
            symbol: MilitarySymbol::new(&code).expect("a frame"),
            texts: vec![SymbolNote { text: name.to_owned(), place: TextPlace::Left(3) }],
            name: name.to_owned(),
            anchor_px: Vec2::new(x, y),
            direction_px: None,
            depth_m: 1000.0,
            visible: true,
            is_on_map: false,
            rank: 0.0,
            height: SymbolHeight::Design(38.0),
        }
    }

    const BATTALION: &str = "10031000161211000000";
    const HEADQUARTERS: &str = "10031002181211000000";

    fn draw(symbols: &[PictureSymbol]) -> (DrawnSymbols, SymbolReport) {
        let mut report = SymbolReport::default();
        let drawn = draw_symbols(symbols, &[], &mut Composer::new(1920, 1080), &mut report);
        (drawn, report)
    }

    #[test]
    fn every_symbol_ends_in_one_list_and_hidden_ones_are_drawn() {
        let symbols = [
            symbol("seen", BATTALION, 400.0, 500.0),
            PictureSymbol { visible: false, ..symbol("behind the ridge", BATTALION, 800.0, 500.0) },
            symbol("off the sheet", BATTALION, -10.0, 500.0),
            symbol("nowhere", BATTALION, f32::NAN, 500.0),
        ];
        let (_, report) = draw(&symbols);
        assert_eq!(report.placed, ["behind the ridge", "seen"]);
        assert_eq!(report.hidden, ["behind the ridge"]);
        assert_eq!(report.outside, ["off the sheet", "nowhere"]);
        assert!(report.crowded_out.is_empty());
    }

    /// Forty symbols in rows of nine, with their places `pitch` apart.
    fn forty(pitch: Vec2) -> (DrawnSymbols, SymbolReport) {
        let one = |n: usize| {
            let at = Vec2::new(250.0, 300.0) + pitch * Vec2::new((n % 9) as f32, (n / 9) as f32);
            symbol(&format!("{n}-77"), if n.is_multiple_of(7) { HEADQUARTERS } else { BATTALION }, at.x, at.y)
        };
        draw(&(0..40).map(one).collect::<Vec<_>>())
    }

    #[test]
    fn forty_symbols_overlap_nowhere_and_stay_inside_however_close() {
        for pitch in [Vec2::new(150.0, 120.0), Vec2::new(90.0, 70.0), Vec2::new(47.0, 31.0)] {
            let (drawn, report) = forty(pitch);
            assert_eq!(report.placed.len() + report.crowded_out.len(), 40);
            let sheet = Composer::new(1920, 1080).sheet;
            let faces = &drawn.boxes[..report.placed.len()];
            for (number, area) in faces.iter().enumerate() {
                assert!(!faces[..number].iter().any(|other| other.overlaps(area)), "{pitch}: {area:?}");
            }
            assert!(faces.iter().all(|area| sheet.bounds().holds(area)), "{pitch}");
        }
    }

    #[test]
    fn forty_symbols_with_room_are_all_drawn_with_their_text() {
        let (_, report) = forty(Vec2::new(150.0, 120.0));
        assert!(report.crowded_out.is_empty() && report.without_text.is_empty(), "{report:?}");
    }

    #[test]
    fn symbols_at_one_place_are_stacked_over_a_headquarters() {
        let symbols = [
            symbol("a", BATTALION, 900.0, 600.0),
            symbol("b", BATTALION, 901.0, 600.0),
            symbol("hq", HEADQUARTERS, 900.0, 601.0),
        ];
        let (drawn, report) = draw(&symbols);
        assert_eq!(report.placed, ["hq", "a", "b"]);
        let [hq, a, b] = [0, 1, 2].map(|index: usize| drawn.boxes[index]);
        assert!(b.max.y <= a.min.y && a.max.y <= hq.min.y, "{hq:?} {a:?} {b:?}");
        let foot = Vec2::new(900.0, 601.0);
        assert!((hq.max.y - foot.y).abs() < 6.0, "its staff ends at its place");
    }

    #[test]
    fn the_order_of_the_input_does_not_matter() {
        let mut symbols: Vec<PictureSymbol> =
            (0..12).map(|n| symbol(&format!("{n}"), BATTALION, 300.0 + 19.0 * n as f32, 500.0)).collect();
        let forth = draw(&symbols).0.drawing.marks;
        symbols.reverse();
        assert_eq!(draw(&symbols).0.drawing.marks, forth);
    }
}
