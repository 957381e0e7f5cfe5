//! Axes of advance: draw rules AXIS1 and AXIS2.
//!
//! Points 1 to N-1 are the center line from the tip backward; point N is a corner of the arrowhead's base, or the width is
//! stated. Point N on the normal through the first leg gives the base of the head and its half width; the shaft is half as
//! wide as the head.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{direction, offset, turned};
use sandtable_geom::polyline::Polyline;

/// The half width of the shaft, as a share of that of the head.
const SHAFT: f64 = 0.5;

/// The length of a head whose width is stated, in half widths.
const HEAD_LENGTH: f64 = 0.5;

/// The head of an axis: how far behind the tip its base is, and its half width, meters.
pub fn head_m(points: &[DVec2], width_m: Option<f64>) -> [f64; 2] {
    if let Some(width_m) = width_m {
        return [HEAD_LENGTH * width_m / 2.0, width_m / 2.0];
    }
    let corner = points[points.len() - 1] - points[0];
    let toward = direction(points[1], points[0]);
    [-corner.dot(toward), toward.perp_dot(corner).abs()]
}

/// The points of the center line: all but the last, where that gives the width.
pub fn center_line(points: &[DVec2], width_m: Option<f64>) -> &[DVec2] {
    if width_m.is_some() { points } else { &points[..points.len() - 1] }
}

/// An axis of advance.
pub fn axis(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let center = center_line(input.points, input.width_m);
    let [length_m, half_m] = head_m(input.points, input.width_m);
    let (tip, toward) = (center[0], direction(center[1], center[0]));
    let base = tip - toward * length_m;
    // From the base of the head backward, so that its left is on the left of the attack's rear.
    let shaft: Vec<DVec2> = std::iter::once(base).chain(center[1..].iter().copied()).collect();
    let mut sides = [1.0, -1.0].map(|side: f64| offset(&shaft, -side * SHAFT * half_m));
    let wings = [1.0, -1.0].map(|side| base + toward.perp() * (side * half_m));
    let is_crossed = matches!(kind.code, "151401" | "151402");
    if is_crossed {
        let ends = [sides[0][0], sides[1][0]];
        (sides[0][0], sides[1][0]) = (ends[1], ends[0]);
        let [left, right] = ends;
        drawing.line([left, wings[0], tip, wings[1], right]);
    } else if kind.code == "151403" {
        drawing.ring([tip, wings[0], wings[1]]);
    } else {
        drawing.line([sides[0][0], wings[0], tip, wings[1], sides[1][0]]);
    }
    let is_feint = kind.code == "151406";
    sides.iter().for_each(|side| drawing.line(side.clone()));
    if is_feint {
        let ahead = tip + toward * (0.5 * length_m);
        let wing = |side: f64| base + toward.perp() * (side * 1.5 * half_m);
        drawing.dashed([wing(1.0), ahead, wing(-1.0)]);
    }
    if kind.code == "151402" {
        let middle = base.midpoint(center[1]);
        rotor(middle, toward, half_m, drawing);
    }
    // Inside the shaft.
    if let Some(line) = Polyline::new(center.iter().copied(), 0.0) {
        let station = line.length() * if is_crossed { 0.75 } else { 0.55 };
        drawing.text(input.fields.labeled(kind.label), line.at(station));
    }
}

/// The mark of attack helicopters where the sides of the shaft cross: an arrow through a bow tie.
fn rotor(middle: DVec2, toward: DVec2, half_m: f64, drawing: &mut GraphicDrawing) {
    let up = toward.perp();
    drawing.line([middle - up * half_m, middle + up * half_m]);
    let tip = middle + up * half_m;
    let barb = |side: f64| tip - up * (0.5 * half_m) + toward * (side * 0.25 * half_m);
    drawing.line([barb(1.0), tip, barb(-1.0)]);
    let foot = middle - up * half_m;
    drawing.line([foot - toward * (0.25 * half_m), foot + toward * (0.25 * half_m)]);
}

/// The zigzag and the arrow of fix (LINE9, LINE28): tip and rear.
pub fn fix(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, rear] = [input.points[0], input.points[1]];
    let (along, length_m) = (direction(rear, tip), rear.distance(tip));
    let at = |far: f64, aside: f64| rear + (along * far + along.perp() * aside) * length_m;
    /// Lead, half period and amplitude as shares of the length; corners of the zigzag.
    const LEAD: f64 = 1.0 / 15.0;
    const HALF: f64 = 2.0 / 45.0;
    const CORNERS: u32 = 19;
    let corner = |step: u32| {
        let side = if step.is_multiple_of(2) { -LEAD } else { LEAD };
        at(LEAD + HALF * (f64::from(step) + 0.5), side)
    };
    let mut line = vec![rear, at(LEAD, 0.0)];
    line.extend((0..CORNERS).map(corner));
    line.extend([at(LEAD + HALF * f64::from(CORNERS), 0.0), tip]);
    drawing.line(line);
    let barb = 0.063 * length_m;
    let barbs = [1.0, -1.0].map(|side| tip - turned(along, side * std::f64::consts::FRAC_PI_4) * barb);
    if kind.label.is_empty() {
        drawing.filled([barbs[0], tip, barbs[1]]);
    } else {
        drawing.line([barbs[0], tip, barbs[1]]);
        drawing.text(kind.label, at(LEAD / 2.0, 0.0));
    }
}
