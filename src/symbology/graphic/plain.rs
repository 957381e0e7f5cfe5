//! Lines, areas and points that are no control measures: what an overlay draws by itself, with a text.

use glam::DVec2;

use crate::graphic::area::label_area;
use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::{DrawRule, GraphicKind, GraphicShape, GraphicTint, MOST_POINTS};
use crate::graphic::plane::circle;

/// The radius of a point, in heights of a text.
const POINT_RADIUS: f64 = 0.36;

const fn plain(
    word: &'static str,
    shape: GraphicShape,
    points: [usize; 2],
    rule_fn: DrawRule,
) -> GraphicKind {
    GraphicKind {
        word,
        set: 0,
        code: "",
        name: word,
        rule: "",
        shape,
        points,
        fields: "T",
        label: "{}",
        tint: GraphicTint::Own,
        icon: "",
        rule_fn,
    }
}

/// A line with its text in the middle.
pub static PLAIN_LINE: GraphicKind = plain("line", GraphicShape::Line, [2, MOST_POINTS], line);
/// An area with its text inside.
pub static PLAIN_AREA: GraphicKind = plain("area", GraphicShape::Area, [3, MOST_POINTS], area);
/// A point with its text beside it.
pub static PLAIN_POINT: GraphicKind = plain("point", GraphicShape::Point, [1, 1], point);

fn line(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(input.points);
    let middle = input.points[input.points.len() / 2];
    drawing.text_beside(input.fields.designation.clone(), middle, DVec2::Y);
}

fn area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    label_area(kind, input, drawing);
}

fn point(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let at = input.points[0];
    drawing.filled(circle(at, input.em_m * POINT_RADIUS));
    drawing.text_beside(input.fields.designation.clone(), at, DVec2::X);
}
