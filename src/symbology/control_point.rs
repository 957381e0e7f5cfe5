//! Points of control measures as symbols: an icon without a frame, in the color of its side.

use glam::Vec2;

use crate::code::SymbolCode;
use crate::drawing::{BLACK, PathStep, SymbolMark, SymbolPen, parse};
use crate::fields::{SymbolIdentity, SymbolSet, SymbolStatus};
use crate::frame::{FrameShape, SymbolBox};
use crate::graphic::icon::statements;
use crate::graphic::kind::{GraphicKind, GraphicShape};
use crate::symbol::MilitarySymbol;

/// Lengths of dash and gap of what is planned, and of what an icon dashes itself.
const DASH: [f32; 2] = [8.0, 8.0];

/// The red of what is hostile.
const HOSTILE: [u8; 3] = [190, 10, 20];

/// The symbol of a point of symbol set 25; `None` for its lines and areas, which are graphics.
pub(super) fn control_point(code: &SymbolCode) -> Option<MilitarySymbol> {
    if code.set != SymbolSet::ControlMeasure {
        return None;
    }
    let kind = GraphicKind::of_code(25, &format!("{:06}", code.entity))?;
    if kind.shape != GraphicShape::Point {
        return None;
    }
    let is_hostile = matches!(code.identity, SymbolIdentity::Hostile | SymbolIdentity::Suspect);
    let ink = if is_hostile { HOSTILE } else { BLACK };
    let is_planned = code.status == SymbolStatus::Planned;
    let mut marks = Vec::new();
    for (statement, is_dashed) in statements(kind.icon) {
        let dash = (is_dashed || is_planned).then_some(DASH);
        let drawn = parse(statement, FrameShape::Rectangle).unwrap_or_default();
        marks.extend(drawn.into_iter().map(|mark| inked(mark, ink, dash)));
    }
    let bounds =
        marks.iter().flat_map(places).map(|at| SymbolBox { min: at, max: at }).reduce(SymbolBox::union)?;
    Some(MilitarySymbol { marks, bounds, frame: bounds, anchor: Vec2::splat(100.0), notes: Vec::new() })
}

/// A mark in a color.
fn inked(mark: SymbolMark, ink: [u8; 3], dash: Option<[f32; 2]>) -> SymbolMark {
    match mark {
        SymbolMark::Shape { steps, fill, stroke } => SymbolMark::Shape {
            steps,
            fill: fill.map(|_| ink),
            stroke: stroke.map(|pen| SymbolPen { color: ink, dash, ..pen }),
        },
        text => text,
    }
}

/// The ends of a mark's steps, or the corners of the space of its text.
fn places(mark: &SymbolMark) -> Vec<Vec2> {
    match mark {
        SymbolMark::Shape { steps, .. } => steps
            .iter()
            .filter_map(|step| match *step {
                PathStep::Move(to) | PathStep::Line(to) => Some(to),
                PathStep::Quad(_, to) | PathStep::Cubic(_, _, to) => Some(to),
                PathStep::Close => None,
            })
            .collect(),
        SymbolMark::Text { text, center, size, .. } => {
            // Capitals are about as wide as they are high.
            let half = Vec2::new(0.33 * text.chars().count() as f32, 0.36) * *size;
            vec![*center - half, *center + half]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_of_control_measures_is_a_symbol_and_a_line_is_not() {
        let symbol = |code: &str| MilitarySymbol::new(&SymbolCode::parse(code).expect("a code"));
        let checkpoint = symbol("10032500001303000000").expect("a checkpoint");
        assert_eq!(
            (checkpoint.bounds.min, checkpoint.bounds.max),
            (Vec2::new(60.0, -60.0), Vec2::new(140.0, 100.0))
        );
        assert_eq!(checkpoint.anchor, Vec2::splat(100.0));
        assert!(checkpoint.notes.is_empty() && checkpoint.marks.len() >= 2);
        let hostile = symbol("10062500002803000000").expect("a mine");
        let colors = hostile.marks.iter().filter_map(|mark| match mark {
            SymbolMark::Shape { fill, .. } => *fill,
            SymbolMark::Text { .. } => None,
        });
        assert_eq!(colors.collect::<Vec<_>>(), [HOSTILE]);
        assert_eq!(symbol("10032500001403000000"), None, "a phase line is a graphic");
    }
}
