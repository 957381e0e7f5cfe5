//! A whole symbol: frame, icon, modifiers and amplifiers, from its code.
//!
//! ```text
//!         ┌──┐            task force, echelon, feint or dummy
//!       ┌─┴──┴─┐
//!       │ icon │          frame, sector 1 modifier over the icon, sector 2 below it
//!       ├──────┘
//!       │  o──o           mobility, condition
//!       └ staff           of a headquarters; its foot is where it is
//! ```

use glam::Vec2;

use crate::amplifiers::{Amplification, staff_foot};
use crate::code::SymbolCode;
use crate::control_point::control_point;
use crate::drawing::{BLACK, PALE, SymbolMark, SymbolPen, parse};
use crate::entities;
use crate::fields::{SymbolContext, SymbolIdentity, SymbolSet, SymbolStatus};
use crate::frame::{FRAME_LINE, FrameInk, FrameShape, SymbolBox, fill};
use crate::frame_marks::{FrameAddition, frame_marks};
use crate::modifiers;

/// The light dashes over the frame of what is only assumed, and of what is planned: lengths of dash and gap.
const ASSUMED_DASH: [f32; 2] = [4.0, 4.0];
const PLANNED_DASH: [f32; 2] = [8.0, 12.0];
/// Between the marks of mobility and the condition bar, besides its own gap.
const MOBILITY_GAP: f32 = 2.0;
const WHITE: [u8; 3] = [255, 255, 255];
/// Subtypes of any type: headquarters element; support of a division and below, of a corps, of a theater.
const SPECIAL_ELEMENTS: [(u32, &str); 4] = [
    (95, "@staff-line"),
    (96, "@division-and-below-support"),
    (97, "@corps-support"),
    (98, "@theater-support"),
];
/// How much higher echelons are over the bar of an installation.
const INSTALLATION_BAR: f32 = 15.0;
/// The box of an icon without a frame.
const BARE_ICON: SymbolBox = SymbolBox::new(50.0, 50.0, 150.0, 150.0);
/// In the frame of a thing of an unknown set.
const UNKNOWN_SET: &str = "text 80 ?";

/// A symbol in its box of 200 × 200 units, Y down; amplifiers may leave the box.
#[derive(Clone, Debug, PartialEq)]
pub struct MilitarySymbol {
    /// In drawing order.
    pub marks: Vec<SymbolMark>,
    /// Around all marks but for half the width of their lines.
    pub bounds: SymbolBox,
    /// Around the frame.
    pub frame: SymbolBox,
    /// The point of the symbol that is at the place: its middle, or the foot of a headquarters staff.
    pub anchor: Vec2,
    /// Parts of the code that the drawing lacks.
    pub notes: Vec<String>,
}

impl MilitarySymbol {
    /// The symbol of a code; `None` for lines and areas, and for sets whose symbols have no frames, such as weather.
    pub fn new(code: &SymbolCode) -> Option<Self> {
        let Some(shape) = FrameShape::of(code) else { return control_point(code) };
        let (frame, mut notes) = (shape.bounds(), Vec::new());
        let outline = shape.outline();
        let drawn = icon(code, shape, &mut notes);
        let mut marks = match FrameInk::of(code) {
            FrameInk::None => in_color(drawn, fill(code)),
            FrameInk::Line(color) => {
                let pen = SymbolPen { color, dash: frame_dash(code), ..SymbolPen::black(FRAME_LINE) };
                [vec![SymbolMark::stroke(outline, pen)], drawn].concat()
            }
            FrameInk::Filled(color) => {
                let mut marks = vec![SymbolMark::filled(outline.clone(), color)];
                marks.extend(drawn);
                marks.push(SymbolMark::stroke(outline.clone(), SymbolPen::black(FRAME_LINE)));
                marks.extend(frame_dash(code).map(|dash| {
                    let pen = SymbolPen { width: FRAME_LINE + 1.0, color: WHITE, dash: Some(dash) };
                    SymbolMark::stroke(outline, pen)
                }));
                marks
            }
        };
        let mut bounds = if FrameInk::of(code) == FrameInk::None { BARE_ICON } else { frame };
        if let Some((inside, around)) = frame_marks(code, shape) {
            marks.extend(inside);
            bounds = bounds.union(around);
        }
        let mut amplified = Amplification::new(bounds);
        amplified.mobility(code.amplifier, shape);
        let bottom = match amplified.bounds.max.y {
            below if below > frame.max.y => below + MOBILITY_GAP,
            _ => frame.max.y,
        };
        amplified.role(code.role, code.amplifier, shape);
        let over = if FrameAddition::of(code) == Some(FrameAddition::InstallationBar) {
            SymbolBox { min: frame.min - Vec2::new(0.0, INSTALLATION_BAR), ..frame }
        } else {
            frame
        };
        amplified.echelon(code.amplifier, over);
        amplified.leader(code.amplifier, shape);
        amplified.condition(code.status, frame, bottom);
        marks.extend(amplified.marks);
        if let Some(letter) = exercise_letter(code, frame) {
            // The letter's field, as wide and high as a field of text beside the frame.
            let (at, size) = (frame.min, Vec2::new(frame.max.x + 32.0, frame.min.y + 10.0));
            amplified.bounds =
                amplified.bounds.union(SymbolBox { min: Vec2::new(at.x, at.y - 35.0), max: size });
            marks.push(letter);
        }
        let anchor = if code.role.is_headquarters() { staff_foot(shape) } else { Vec2::splat(100.0) };
        Some(Self { marks, bounds: amplified.bounds, frame, anchor, notes })
    }
}

impl MilitarySymbol {
    /// The symbol in black on white: frames tell friend from foe without their colors.
    pub fn in_black_and_white(mut self) -> Self {
        for mark in &mut self.marks {
            match mark {
                SymbolMark::Shape { fill, stroke, .. } => {
                    if let Some(fill) = fill.as_mut().filter(|fill| **fill != BLACK) {
                        *fill = WHITE;
                    }
                    if let Some(pen) = stroke.as_mut().filter(|pen| ![WHITE, PALE].contains(&pen.color)) {
                        pen.color = BLACK;
                    }
                }
                SymbolMark::Text { color, .. } => *color = BLACK,
            }
        }
        self
    }
}

/// The icon and its modifiers; what is missing is noted.
fn icon(code: &SymbolCode, shape: FrameShape, notes: &mut Vec<String>) -> Vec<SymbolMark> {
    let drawn = |drawing: &str| parse(drawing, shape).unwrap_or_default();
    let mut above: Vec<SymbolMark> = Vec::new();
    for (sector, number) in [(1, code.modifiers[0]), (2, code.modifiers[1])] {
        match modifiers::find(code, sector) {
            Some(modifier) => above.extend(drawn(modifier.drawing)),
            None if number == 0 => {}
            None => notes.push(format!(
                "the sector {sector} modifier {number:02} of the set {:02} ({}) is not drawn",
                code.set.number(),
                code.set.name()
            )),
        }
    }
    let mut marks = Vec::new();
    if code.set == SymbolSet::Unknown {
        marks.extend(drawn(UNKNOWN_SET));
    }
    if let Some(function) = code.unknown_function {
        let function = String::from_utf8_lossy(&function).into_owned();
        notes.push(format!("the function {function} of 2525C is not drawn: the frame stands alone"));
    } else if code.entity != 0 {
        match drawing_of(code) {
            Some((icon, line)) => {
                let icon = drawn(icon).into_iter();
                match modifiers::place_of_icon(code) {
                    Some((offset, factor)) => marks.extend(icon.map(|mark| mark.placed(offset, factor))),
                    None => marks.extend(icon),
                }
                marks.extend(line.map(drawn).unwrap_or_default());
            }
            None => notes.push(format!(
                "the entity {:06} of the set {:02} ({}) is not drawn: the frame stands alone",
                code.entity,
                code.set.number(),
                code.set.name()
            )),
        }
    }
    marks.extend(above);
    marks
}

/// The drawing of the entity, and the line of a special element of it: a headquarters, or support of a level of command.
fn drawing_of(code: &SymbolCode) -> Option<(&'static str, Option<&'static str>)> {
    if let Some(entity) = entities::of(code) {
        return Some((entity.drawing, None));
    }
    let line = SPECIAL_ELEMENTS.iter().find(|row| row.0 == code.entity % 100)?.1;
    Some((entities::find(code.set, code.entity / 100 * 100)?.drawing, Some(line)))
}

/// The icon of a symbol without a frame: its lines tell friend from foe.
fn in_color(mut marks: Vec<SymbolMark>, color: [u8; 3]) -> Vec<SymbolMark> {
    for mark in &mut marks {
        if let SymbolMark::Shape { stroke: Some(pen), .. } = mark {
            pen.color = color;
        }
    }
    marks
}

fn frame_dash(code: &SymbolCode) -> Option<[f32; 2]> {
    if is_pending_track(code) {
        Some(ASSUMED_DASH)
    } else if code.status == SymbolStatus::Planned {
        Some(PLANNED_DASH)
    } else {
        code.identity.is_assumed().then_some(ASSUMED_DASH)
    }
}

/// Fused tracks and tracks of electronic means alone are pending whatever their identity.
fn is_pending_track(code: &SymbolCode) -> bool {
    matches!(
        (code.set, code.entity),
        (SymbolSet::SeaSurface, 160_000) | (SymbolSet::Subsurface, 140_000 | 150_000)
    )
}

/// The letter at the upper right of an exercise: J joker, K faker, X exercise; S in a simulation.
fn exercise_letter(code: &SymbolCode, frame: SymbolBox) -> Option<SymbolMark> {
    let letter = match (code.context, code.identity) {
        (SymbolContext::Exercise, SymbolIdentity::Suspect) => "J",
        (SymbolContext::Exercise, SymbolIdentity::Hostile) => "K",
        (SymbolContext::Exercise, _) => "X",
        (SymbolContext::Simulation, _) => "S",
        _ => return None,
    };
    let center = Vec2::new(frame.max.x + 19.0, frame.min.y - 9.0);
    Some(SymbolMark::Text { text: letter.to_owned(), center, size: 30.0, color: BLACK })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fields::CodedField;

    fn symbol(code: &str) -> MilitarySymbol {
        MilitarySymbol::new(&SymbolCode::parse(code).expect(code)).expect(code)
    }

    #[test]
    fn every_drawing_is_one_in_every_frame() {
        let shapes = [FrameShape::Rectangle, FrameShape::Diamond, FrameShape::Square, FrameShape::Quatrefoil];
        for set in entities::SETS {
            let rows = entities::entities(set)
                .iter()
                .chain(modifiers::modifiers(set, 1))
                .chain(modifiers::modifiers(set, 2));
            let rows = rows.chain(modifiers::changed(set, 1)).chain(modifiers::changed(set, 2));
            for (row, shape) in rows.flat_map(|row| shapes.map(|shape| (row, shape))) {
                let marks = parse(row.drawing, shape).map(|marks| marks.len());
                // An entity whose symbol is the frame alone has no drawing.
                assert_eq!(marks.is_some_and(|count| count > 0), !row.drawing.is_empty(), "{}", row.name);
            }
        }
    }

    #[test]
    fn an_entity_that_is_not_drawn_leaves_its_frame_and_a_note_that_names_it() {
        let unknown = symbol("10031500001299000000");
        assert!(unknown.notes[0].contains("129900 of the set 15 (land equipment)"), "{:?}", unknown.notes);
        assert_eq!(unknown.bounds, symbol("10031500000000000000").bounds);
        assert_eq!(symbol("10031000001211000099").notes.len(), 1);
        assert!(symbol("10031000001211000319").notes.is_empty());
        assert!(symbol("SFGPEZZZ--MO---").notes[0].contains("EZZZ--"));
    }

    #[test]
    fn a_headquarters_element_is_drawn_over_the_icon_of_its_type() {
        let (infantry, line) = (symbol("10031000001211000000"), parse("@staff-line", FrameShape::Rectangle));
        let element = symbol("10031000001211950000");
        assert!(element.notes.is_empty() && element.marks.len() == infantry.marks.len() + 1);
        assert!(line.is_some_and(|line| element.marks.contains(&line[0])));
        for (_, drawing) in SPECIAL_ELEMENTS {
            assert!(parse(drawing, FrameShape::Diamond).is_some(), "{drawing}");
        }
    }

    #[test]
    fn equipment_makes_way_for_modifiers_and_its_lines_stay_as_wide() {
        let (tank, modified) = (symbol("10031500001202000000"), symbol("10031500001202000100"));
        let (SymbolMark::Shape { stroke: whole, .. }, SymbolMark::Shape { stroke: small, .. }) =
            (&tank.marks[1], &modified.marks[1])
        else {
            panic!("a tank is lines")
        };
        assert_eq!(whole, small);
        assert_eq!(modified.marks[1], tank.marks[1].clone().placed(Vec2::new(0.0, 10.0), 0.7));
    }

    #[test]
    fn a_number_means_by_edition_what_it_means_there() {
        assert_eq!(symbol("10031000000000008100").notes, symbol("13031000000000008100").notes);
        assert_ne!(symbol("10031000000000008100").marks, symbol("13031000000000008100").marks);
        assert_eq!(symbol("10031000000000008000").marks, symbol("13031000000000008000").marks);
    }

    #[test]
    fn control_measures_have_no_frame() {
        let code = SymbolCode::parse("10032500001403000000").expect("a phase line");
        assert_eq!(MilitarySymbol::new(&code), None);
    }

    #[test]
    fn every_set_status_role_and_amplifier_is_drawn_without_a_number_that_is_none() {
        let base = SymbolCode::parse("10031000000000000000").expect("a frame");
        for set in SymbolSet::VALUES {
            for identity in SymbolIdentity::VALUES {
                for amplifier in crate::fields::SymbolAmplifier::VALUES {
                    let code = SymbolCode {
                        set: set.value,
                        identity: identity.value,
                        amplifier: amplifier.value,
                        ..base
                    };
                    let Some(symbol) = MilitarySymbol::new(&code) else { continue };
                    assert!(symbol.bounds.min.is_finite() && symbol.bounds.max.is_finite());
                    assert!(!symbol.marks.is_empty());
                }
            }
        }
    }
}
