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
use crate::drawing::{BLACK, PathStep, SymbolMark, SymbolPen, parse, path};
use crate::entities;
use crate::fields::{SymbolContext, SymbolIdentity, SymbolSet, SymbolStatus};
use crate::frame::{FRAME_LINE, FrameOpening, FrameShape, SymbolBox, fill};
use crate::modifiers::modifiers;

/// The light dashes over the frame of what is only assumed, and of what is planned: lengths of dash and gap.
const ASSUMED_DASH: [f32; 2] = [4.0, 4.0];
const PLANNED_DASH: [f32; 2] = [8.0, 12.0];
/// Between the marks of mobility and the condition bar, besides its own gap.
const MOBILITY_GAP: f32 = 2.0;
const WHITE: [u8; 3] = [255, 255, 255];
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
        let mut marks = vec![SymbolMark::filled(outline.clone(), fill(code))];
        marks.extend(icon(code, shape, &mut notes));
        marks.push(SymbolMark::stroke(outline.clone(), SymbolPen::black(FRAME_LINE)));
        if let Some(dash) = frame_dash(code) {
            let pen = SymbolPen { width: FRAME_LINE + 1.0, color: WHITE, dash: Some(dash) };
            marks.push(SymbolMark::stroke(outline, pen));
        }
        let mut bounds = frame;
        if let Some((inside, around)) = set_marks(code.set, shape) {
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
        amplified.echelon(code.amplifier, frame);
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
            if let SymbolMark::Shape { fill: Some(fill), .. } = mark
                && *fill != BLACK
            {
                *fill = WHITE;
            }
        }
        self
    }
}

/// The icon and its modifiers; what is missing is noted.
fn icon(code: &SymbolCode, shape: FrameShape, notes: &mut Vec<String>) -> Vec<SymbolMark> {
    let mut drawings = Vec::new();
    if code.set == SymbolSet::Unknown {
        drawings.push(UNKNOWN_SET);
    }
    if let Some(function) = code.unknown_function {
        let function = String::from_utf8_lossy(&function).into_owned();
        notes.push(format!("the function {function} of 2525C is not drawn: the frame stands alone"));
    } else if code.entity != 0 {
        match entities::find(code.set, code.entity) {
            Some(entity) => drawings.push(entity.drawing),
            None => notes.push(format!(
                "the entity {:06} of the set {:02} ({}) is not drawn: the frame stands alone",
                code.entity,
                code.set.number(),
                code.set.name()
            )),
        }
    }
    for (sector, number) in [(1, code.modifiers[0]), (2, code.modifiers[1])] {
        let found = modifiers(code.set, sector).iter().find(|row| row.code == u32::from(number));
        match found {
            Some(modifier) => drawings.push(modifier.drawing),
            None if number == 0 => {}
            None => notes.push(format!(
                "the sector {sector} modifier {number:02} of the set {:02} ({}) is not drawn",
                code.set.number(),
                code.set.name()
            )),
        }
    }
    drawings.iter().filter_map(|drawing| parse(drawing, shape)).flatten().collect()
}

fn frame_dash(code: &SymbolCode) -> Option<[f32; 2]> {
    if code.status == SymbolStatus::Planned {
        Some(PLANNED_DASH)
    } else {
        code.identity.is_assumed().then_some(ASSUMED_DASH)
    }
}

/// What a set adds to its frame, and the box around it.
fn set_marks(set: SymbolSet, shape: FrameShape) -> Option<(Vec<SymbolMark>, SymbolBox)> {
    let frame = shape.bounds();
    let black = |text: &str| SymbolMark::filled(path(text), BLACK);
    match set {
        SymbolSet::LandInstallation => {
            // The bar sits on the frame, and sinks to it on a diamond's tip and a quatrefoil's lobe.
            let (top, bottom) = match shape {
                FrameShape::Diamond => (frame.min.y - 10.0, frame.min.y + 14.0),
                FrameShape::Quatrefoil => (frame.min.y - 10.0, frame.min.y + 2.0),
                _ => (frame.min.y - 10.0, frame.min.y),
            };
            let bar = SymbolBox::new(83.0, top, 117.0, bottom);
            let mut steps = match shape {
                FrameShape::Diamond => path("M85,43 L85,18 L115,18 L115,43 L100,28"),
                _ => path_of(&bar),
            };
            steps.push(PathStep::Close);
            Some((vec![SymbolMark::filled(steps, BLACK)], bar))
        }
        SymbolSet::Activity => {
            let corners = match shape {
                FrameShape::Diamond => [
                    "M100,28 L111,39 L100,50 L89,39 Z",
                    "M172,100 L161,111 L150,100 L161,89 Z",
                    "M100,172 L89,161 L100,150 L111,161 Z",
                    "M28,100 L39,89 L50,100 L39,111 Z",
                ],
                FrameShape::Square => [
                    "M45,45 L61,45 L61,61 L45,61 Z",
                    "M155,45 L155,61 L139,61 L139,45 Z",
                    "M155,155 L139,155 L139,139 L155,139 Z",
                    "M45,155 L45,139 L61,139 L61,155 Z",
                ],
                FrameShape::Quatrefoil => [
                    "M92,31 L108,31 L108,47 L92,47 Z",
                    "M169,92 L169,108 L153,108 L153,92 Z",
                    "M108,169 L92,169 L92,153 L108,153 Z",
                    "M31,108 L31,92 L47,92 L47,108 Z",
                ],
                _ => [
                    "M25,50 L41,50 L41,65 L25,65 Z",
                    "M175,50 L175,65 L159,65 L159,50 Z",
                    "M175,150 L159,150 L159,135 L175,135 Z",
                    "M25,150 L25,135 L41,135 L41,150 Z",
                ],
            };
            Some((corners.map(black).to_vec(), frame))
        }
        SymbolSet::Space | SymbolSet::SpaceMissile | SymbolSet::SignalsSpace => {
            let top = match shape {
                FrameShape::Arch(FrameOpening::Below) => {
                    "M68.5,50 C75,38.5 87,30 100,30 C113,30 125,38.5 131.5,50 Z"
                }
                FrameShape::Tent(FrameOpening::Below) => "M67,50 L100,20 L133,50 Z",
                FrameShape::OpenBox(FrameOpening::Below) => "M45,30 L155,30 L155,50 L45,50 Z",
                FrameShape::Trefoil(FrameOpening::Below) => "M63.3,50 A100,57.4 37.4,37.4 -168.6 -11.4 Z",
                _ => return None,
            };
            Some((vec![black(top)], frame))
        }
        SymbolSet::Cyberspace => {
            let corner = match shape {
                FrameShape::Diamond => "M150,78 L172,100 L150,122 Z",
                FrameShape::Square => "M117,155 L155,117 L155,155 Z",
                FrameShape::Quatrefoil => {
                    "M150,66 C162,72 169.25,84 169.25,100 C169.25,116 162,128 150,134 Z"
                }
                _ => "M135,150 L175,110 L175,150 Z",
            };
            Some((vec![black(corner)], frame))
        }
        _ => None,
    }
}

fn path_of(area: &SymbolBox) -> Vec<PathStep> {
    let (min, max) = (area.min, area.max);
    let corners = [Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)];
    [PathStep::Move(min)].into_iter().chain(corners.map(PathStep::Line)).collect()
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
    Some(SymbolMark::Text { text: letter.to_owned(), center, size: 30.0 })
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
            let rows = entities::entities(set).iter().chain(modifiers(set, 1)).chain(modifiers(set, 2));
            for (row, shape) in rows.flat_map(|row| shapes.map(|shape| (row, shape))) {
                assert!(parse(row.drawing, shape).is_some_and(|marks| !marks.is_empty()), "{}", row.name);
            }
        }
    }

    #[test]
    fn an_entity_that_is_not_drawn_leaves_its_frame_and_a_note_that_names_it() {
        let unknown = symbol("10031500001205000000");
        assert!(unknown.notes[0].contains("120500 of the set 15 (land equipment)"), "{:?}", unknown.notes);
        assert_eq!(unknown.bounds, symbol("10031500000000000000").bounds);
        assert_eq!(symbol("10031000001211009900").notes.len(), 1);
        assert!(symbol("10031000001211000319").notes.is_empty());
        assert!(symbol("SFGPEZZZ--MO---").notes[0].contains("EZZZ--"));
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
                    assert!(symbol.marks.len() >= 2);
                }
            }
        }
    }
}
