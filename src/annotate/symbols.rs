//! Placement of military symbols: on a staff over their place, stacked where several share one place, without overlapping
//! each other or the furniture; no unit is left out.
//!
//! ```text
//!    ┌──┐      ┌──┐                  ┌──┐
//!    │ X│      │//│ stack            │ O│ place hidden by the ground:
//!    └┬─┘      ├──┤                  └┬─┘ a dashed staff and a hollow foot
//!     │ staff  │ X│                   ¦
//!     •        └┬─┘                   ○
//! ```
//!
//! Symbols take their turns by importance and take the first free position: a short staff, a longer one, then aside. Those
//! without a position near their place take turns again: stacks part, leaders become as long as need be, texts go, and symbols
//! become smaller, to half of their size. What still has no room is numbered at its place and listed with its grid reference;
//! what the list has no room for is counted by place. Labels are placed after symbols and leave them free.

use std::collections::HashSet;

use glam::{IVec2, Vec2};

use crate::annotation::PictureSymbol;
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::report::SymbolReport;
use crate::sheet::Sheet;
use crate::symbol_field::{LeaderRule, SymbolField};
use crate::symbol_list::{SymbolBadge, SymbolList, badges};
use crate::symbol_stack::{PreparedStack, StackPosition, has_own_staff};

/// Symbols whose places are nearer than this share of a frame's height stand at one place.
const STACK_SHARE: f32 = 0.35;
/// Symbols over each other; more would hide too much ground.
const MOST_IN_STACK: usize = 6;
/// The forms of a symbol without room near its place: its share of its size, and whether it keeps its texts.
const FORMS: [(f32, bool); 5] = [(1.0, true), (1.0, false), (0.8, false), (0.64, false), (0.5, false)];

/// Symbols that would cover more than this share of a picture at their smallest do not all have room.
const MOST_FILLED: f32 = 0.5;
/// The form of a symbol beside a list.
const LISTED_FORMS: [(f32, bool); 1] = [(0.64, false)];
/// Beside a list symbols cover this share of the picture at most: what is numbered and counted needs room too, and on a small
/// picture most of it.
const MOST_COVERED: [f32; 4] = [0.4, 0.2, 0.1, 0.0];
/// Beside a list the longest leader has this share of the picture's height.
const LONGEST_LEADER: f32 = 0.25;
/// Places in one square of so many design pixels have room, or have none, together.
const HOPELESS_SIDE: f32 = 12.0;

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
    let mut outside = SymbolReport::default();
    let stacks = stacks(symbols, &composer.sheet, &mut outside);
    let mut layout = SymbolLayout::new(furniture, composer);
    let mut list = None;
    let mut left = Vec::new();
    if !layout.place_all(&stacks, composer) {
        // Symbols start anew beside the list.
        let most = stacks.iter().map(Vec::len).sum();
        list = SymbolList::reserve(most, layout.bounds, furniture, composer);
        let reserved: Vec<PixelBox> =
            furniture.iter().copied().chain(list.as_ref().map(|list| list.area)).collect();
        let rows = list.as_ref().map_or(0, |list| list.rows);
        for most_covered in MOST_COVERED {
            layout = SymbolLayout::new(&reserved, composer);
            left = layout.place_some(&stacks, most_covered, composer);
            badges(&left, rows, composer).into_iter().for_each(|badge| layout.place_badge(badge));
            if layout.report.crowded_out.is_empty() {
                break;
            }
        }
    }
    let SymbolLayout { mut staffs, faces, mut boxes, lines, report: placed, .. } = layout;
    report.append(outside);
    report.append(placed);
    boxes.extend(lines.iter().map(|line| box_around(*line, composer.sheet.px(2.0))));
    staffs.append(faces);
    if let Some(list) = list {
        let (drawing, area) = list.draw(&left, composer);
        staffs.append(drawing);
        boxes.push(area);
    }
    DrawnSymbols { drawing: staffs, boxes }
}

/// Symbols as they are placed.
struct SymbolLayout {
    bounds: PixelBox,
    field: SymbolField,
    sheet: Sheet,
    staffs: Drawing,
    faces: Drawing,
    boxes: Vec<PixelBox>,
    lines: Vec<PixelSegment>,
    report: SymbolReport,
}

impl SymbolLayout {
    fn new(furniture: &[PixelBox], composer: &Composer) -> Self {
        let sheet = composer.sheet;
        let bounds = sheet.bounds().grown(-(sheet.margin() * 0.4).round());
        Self {
            bounds,
            field: SymbolField::new(bounds, furniture, sheet.px(3.0)),
            sheet,
            staffs: Drawing::default(),
            faces: Drawing::default(),
            boxes: Vec::new(),
            lines: Vec::new(),
            report: SymbolReport::default(),
        }
    }

    /// Places all symbols; whether each has room.
    fn place_all(&mut self, stacks: &[Vec<&PictureSymbol>], composer: &mut Composer) -> bool {
        let smallest = FORMS.iter().map(|(scale, _)| *scale).fold(1.0, f32::min);
        let area = |symbol: &&PictureSymbol| least_size(symbol, smallest, &self.sheet).element_product();
        let (all, picture) = (stacks.iter().flatten().map(area).sum::<f32>(), self.bounds.size());
        if all > picture.element_product() * MOST_FILLED {
            return false;
        }
        let far: Vec<&Vec<&PictureSymbol>> = stacks
            .iter()
            .filter(|stack| {
                ![true, false].iter().any(|&has_texts| self.place_near(stack, has_texts, composer))
            })
            .collect();
        far.into_iter().flatten().all(|symbol| {
            let by = [LeaderRule::Free, LeaderRule::Under];
            by.iter().any(|&leader| self.place_anywhere(symbol, &FORMS, (leader, f32::INFINITY), composer))
        })
    }

    /// Places symbols without their texts, as long as there is room; returns the others.
    fn place_some<'a>(
        &mut self,
        stacks: &[Vec<&'a PictureSymbol>],
        most_covered: f32,
        composer: &mut Composer,
    ) -> Vec<&'a PictureSymbol> {
        let side = self.sheet.px(HOPELESS_SIDE).max(1.0);
        let cell = |symbol: &PictureSymbol| (symbol.anchor_px / side).floor().as_ivec2();
        let mut hopeless: HashSet<IVec2> = HashSet::new();
        let mut far = Vec::new();
        for stack in stacks {
            let has_room = self.field.covered_share() < most_covered && !hopeless.contains(&cell(stack[0]));
            if !has_room || !self.place_near(stack, false, composer) {
                hopeless.insert(cell(stack[0]));
                far.extend(stack);
            }
        }
        hopeless.clear();
        let rule = (LeaderRule::Free, self.bounds.size().y * LONGEST_LEADER);
        let mut left = Vec::new();
        for symbol in far {
            let has_room = self.field.covered_share() < most_covered && !hopeless.contains(&cell(symbol));
            if !has_room || !self.place_anywhere(symbol, &LISTED_FORMS, rule, composer) {
                hopeless.insert(cell(symbol));
                left.push(symbol);
            }
        }
        left
    }

    /// Places a stack near its place, with or without its texts: a unit without its name is better than none.
    fn place_near(&mut self, stack: &[&PictureSymbol], has_texts: bool, composer: &mut Composer) -> bool {
        let stack = PreparedStack::new(stack, (1.0, has_texts), composer);
        let found = self.field.near(&stack);
        if let Some(position) = found {
            self.keep(&stack, position, has_texts);
        }
        found.is_some()
    }

    /// Places a symbol anywhere within reach, with a leader, in the first form that has room.
    fn place_anywhere(
        &mut self,
        symbol: &PictureSymbol,
        forms: &[(f32, bool)],
        (leader, reach): (LeaderRule, f32),
        composer: &mut Composer,
    ) -> bool {
        for &(scale, has_texts) in forms {
            let least = least_size(symbol, scale, &self.sheet);
            let is_form = !has_texts || !symbol.texts.is_empty();
            if !is_form || self.field.is_too_large(least, leader) {
                continue;
            }
            let stack = PreparedStack::new(&[symbol], (scale, has_texts), composer);
            if let Some(position) = self.field.anywhere(&stack.standing(), leader, reach) {
                self.keep(&stack, position, has_texts);
                self.report.reduced.extend((scale < 1.0).then(|| symbol.name.clone()));
                return true;
            }
        }
        false
    }

    fn keep(&mut self, stack: &PreparedStack<'_>, position: StackPosition, has_texts: bool) {
        stack.draw_staff(&position, &self.sheet, &mut self.staffs);
        stack.draw_faces(&position, &mut self.faces);
        self.report.placed.extend(stack.names());
        if !stack.is_visible {
            self.report.hidden.extend(stack.names());
        }
        let bare = stack.symbols.iter().filter(|symbol| !has_texts && !symbol.texts.is_empty());
        self.report.without_text.extend(bare.map(|symbol| symbol.name.clone()));
        let boxes: Vec<PixelBox> = stack.boxes(&position).collect();
        let lines: Vec<PixelSegment> = position.staff.into_iter().chain(stack.arrows()).collect();
        self.field.take(&boxes, lines.iter().copied());
        self.boxes.extend(boxes);
        self.lines.extend(lines);
    }

    /// Places the number or the count of symbols that have no room themselves.
    fn place_badge(&mut self, badge: SymbolBadge) {
        let standing = badge.standing();
        let by = [LeaderRule::Free, LeaderRule::Under];
        let found = by.into_iter().find_map(|leader| self.field.anywhere(&standing, leader, f32::INFINITY));
        let Some(position) = found else {
            self.report.crowded_out.extend(badge.names);
            return;
        };
        badge.draw(&position, &self.sheet, (&mut self.staffs, &mut self.faces));
        let area = badge.area.moved(position.foot);
        self.field.take(&[area], position.staff);
        self.boxes.push(area);
        self.lines.extend(position.staff);
        let told = if badge.is_listed { &mut self.report.listed } else { &mut self.report.counted };
        told.extend(badge.names);
    }
}

/// The least size of a symbol at a share of its size, without texts.
fn least_size(symbol: &PictureSymbol, scale: f32, sheet: &Sheet) -> Vec2 {
    let bounds = symbol.symbol.bounds;
    (bounds.max - bounds.min) * (symbol.height.pixels(sheet) * scale / 100.0)
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

fn box_around(line: PixelSegment, reach: f32) -> PixelBox {
    PixelBox { min: line.from.min(line.to), max: line.from.max(line.to) }.grown(reach)
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
            reference: Some("16S GF 55447 24162".to_owned()),
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

    /// Panics where symbols, numbers, counts and the list overlap, leave the sheet, or leave a symbol out.
    fn check_all_are_shown(drawn: &DrawnSymbols, report: &SymbolReport, symbols: usize, what: &str) {
        let SymbolReport { placed, outside, listed, counted, crowded_out, .. } = report;
        assert!(crowded_out.is_empty(), "{what}: {}", crowded_out.len());
        assert_eq!(placed.len() + outside.len() + listed.len() + counted.len(), symbols, "{what}");
        let sheet = Composer::new(1920, 1080).sheet;
        let faces = &drawn.boxes[..placed.len() + listed.len()];
        for (number, area) in faces.iter().enumerate() {
            assert!(!faces[..number].iter().any(|other| other.overlaps(area)), "{what}: {area:?}");
        }
        assert!(faces.iter().all(|area| sheet.bounds().holds(area)), "{what}");
    }

    #[test]
    fn forty_symbols_are_all_drawn_overlap_nowhere_and_stay_inside_however_close() {
        for pitch in [Vec2::new(150.0, 120.0), Vec2::new(90.0, 70.0), Vec2::new(47.0, 31.0), Vec2::ONE] {
            let (drawn, report) = forty(pitch);
            check_all_are_shown(&drawn, &report, 40, &pitch.to_string());
            assert_eq!(report.placed.len(), 40, "{pitch}");
        }
    }

    /// `count` symbols of the numbers of a seed, about so many places that units gather at, within `spread` pixels.
    fn scattered(seed: u64, count: usize, places: usize, spread: f32) -> Vec<PictureSymbol> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut next = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        let middles: Vec<Vec2> = (0..places).map(|_| Vec2::new(next() * 1920.0, next() * 1080.0)).collect();
        let one = |n: usize| {
            let at = middles[n % places] + (Vec2::new(next(), next()) - 0.5) * spread;
            let is_on_map = seed.is_multiple_of(2);
            let code = if n.is_multiple_of(9) { HEADQUARTERS } else { BATTALION };
            PictureSymbol {
                is_on_map,
                visible: !n.is_multiple_of(5),
                ..symbol(&format!("{n}-77"), code, at.x, at.y)
            }
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn two_hundred_symbols_are_all_on_the_sheet_and_none_over_another() {
        for seed in 1..=12 {
            let places = [3, 17, 200][seed as usize % 3];
            let symbols = scattered(seed, 200, places, 400.0);
            let (drawn, report) = draw(&symbols);
            check_all_are_shown(&drawn, &report, 200, &format!("seed {seed}"));
            assert_eq!(report.placed.len() + report.outside.len(), 200, "seed {seed}: drawn as symbols");
        }
    }

    #[test]
    fn symbols_beyond_what_a_sheet_holds_are_listed_by_number_or_counted() {
        let symbols = scattered(5, 4000, 4000, 1.0);
        let (drawn, report) = draw(&symbols);
        check_all_are_shown(&drawn, &report, 4000, "4000");
        let counts = [report.placed.len(), report.listed.len(), report.counted.len()];
        assert!(counts[0] > 200 && counts[1] > 30 && counts[2] > 30, "{counts:?}");
    }

    #[test]
    fn a_small_picture_counts_what_it_cannot_show() {
        let symbols: Vec<PictureSymbol> = scattered(7, 300, 10, 100.0)
            .into_iter()
            .map(|symbol| PictureSymbol { anchor_px: symbol.anchor_px * 0.1, ..symbol })
            .collect();
        let mut report = SymbolReport::default();
        draw_symbols(&symbols, &[], &mut Composer::new(192, 108), &mut report);
        let SymbolReport { placed, outside, listed, counted, crowded_out, .. } = report;
        let counts = [placed, outside, listed, counted, crowded_out].map(|names| names.len());
        assert_eq!(counts.iter().sum::<usize>(), 300);
        assert!(counts[3] > 100 && counts[4] == 0, "{counts:?}");
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
