//! Forms of maneuver of MIL-STD-2525E: arrows that turn, split and go on.

use std::f64::consts::{FRAC_PI_4, FRAC_PI_8, PI};

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{arc, arrowhead, direction, turned};
use crate::graphic::task::lettered;

/// An arrowhead whose barbs are `barb` long, at 45° to its shaft.
fn square_head(tip: DVec2, toward: DVec2, barb: f64, drawing: &mut GraphicDrawing) {
    let leg = barb * std::f64::consts::FRAC_1_SQRT_2;
    drawing.line(arrowhead(tip, toward, leg, leg));
}

/// The part of `point - from` across the line from `from` to `to`.
fn offset_of(point: DVec2, from: DVec2, to: DVec2) -> DVec2 {
    let across = direction(from, to).perp();
    across * across.dot(point - from)
}

/// Exploit (LINE30): an arrow from point 2 to its tip at point 1; point 3 says how far the barbs reach. The rear barbs are
/// dashed.
pub fn exploit(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, rear, side] = [input.points[0], input.points[1], input.points[2]];
    let toward = direction(rear, tip);
    let reach_m = offset_of(side, tip, rear).length();
    drawing.line([tip, rear]);
    drawing.line(arrowhead(tip, toward, reach_m, reach_m));
    drawing.dashed(arrowhead(rear, toward, reach_m, reach_m));
}

/// Mobile defense (AREA27): a bow behind point 2, as wide as point 3 is off, an arrow from it to point 1 and back, with teeth.
pub fn mobile_defense(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, turn, side] = [input.points[0], input.points[1], input.points[2]];
    let (along, length_m) = (direction(tip, turn), tip.distance(turn));
    let across = offset_of(side, tip, turn);
    let (center, radius_m) = (turn + across / 2.0, across.length() / 2.0);
    let out = -across.normalize_or_zero();
    drawing.line([turn + across, tip + across]);
    drawing.line([tip, turn]);
    square_head(tip, -along, length_m / 8.0, drawing);
    let place = |angle: f64, share: f64| {
        center + (out * libm::cos(angle) + along * libm::sin(angle)) * (radius_m * share)
    };
    let bow: Vec<DVec2> = (0..=32).map(|step| place(PI * f64::from(step) / 32.0, 1.0)).collect();
    /// The height of a tooth in radii.
    const TOOTH: f64 = 0.364;
    for angle in [1.5 * FRAC_PI_8, PI - 1.5 * FRAC_PI_8] {
        let [from, to] = [angle - FRAC_PI_8 / 2.0, angle + FRAC_PI_8 / 2.0];
        drawing.filled([place(from, 1.0), place(angle, 1.0 + TOOTH), place(to, 1.0)]);
    }
    let base_m = 2.0 * radius_m * libm::sin(FRAC_PI_8 / 2.0);
    for (foot, out) in [(tip, out), (tip + across, -out)] {
        let from = foot + along * (length_m / 8.0);
        let apex = from + along * (base_m / 2.0) + out * (TOOTH * radius_m);
        drawing.filled([from, apex, from + along * base_m]);
    }
    lettered(&bow, 0.5, kind, input, drawing);
}

/// Relief in place and demonstrate (AREA18): an arrow from point 2 to point 1, a half circle from it to point 3, and a line - of
/// a relief an arrow - from point 4.
pub fn relief(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, turn, back, end] = [input.points[0], input.points[1], input.points[2], input.points[3]];
    let is_relief = kind.code == "341900";
    let barb_m = tip.distance(turn) / 8.0;
    square_head(tip, direction(turn, tip), barb_m, drawing);
    drawing.line([end, back]);
    if is_relief {
        square_head(back, direction(end, back), barb_m, drawing);
    }
    // The half circle lies ahead of points 2 and 3, away from point 1.
    let (center, radius) = (turn.midpoint(back), back - turn.midpoint(back));
    let way = if radius.perp().dot(turn - tip) > 0.0 { 1.0 } else { -1.0 };
    drawing.line(arc(center, radius, way * PI));
    if is_relief {
        drawing.line([tip, turn]);
        drawing.text(kind.label, (tip + turn + back + end) / 4.0);
    } else {
        lettered(&[tip, turn], 0.5, kind, input, drawing);
    }
}

/// Envelopment (LINE31): a line from point 1 to point 2, and from there a half circle to the foot of point 3 on that line, on the
/// side away from point 3; point 4 is what is enveloped.
pub fn envelopment(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [rear, turn, side] = [input.points[0], input.points[1], input.points[2]];
    let along = direction(rear, turn);
    let foot = turn + along * along.dot(side - turn);
    let (center, radius) = (turn.midpoint(foot), turn - turn.midpoint(foot));
    let away = if along.perp().dot(side - turn) > 0.0 { -along.perp() } else { along.perp() };
    let way = if radius.perp().dot(away) > 0.0 { 1.0 } else { -1.0 };
    lettered(&[rear, turn], 0.5, kind, input, drawing);
    let barb_m = (1.25 * input.em_m).min(turn.distance(foot) / 4.0);
    if barb_m > 0.0 {
        drawing.line(arc(center, radius, way * PI));
        square_head(foot, -away, barb_m, drawing);
    }
}

/// Infiltration (LINE32): a line from point 1, an S at point 2, and an arrow to point 3.
pub fn infiltration(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [rear, turn, tip] = [input.points[0], input.points[1], input.points[2]];
    /// The radius of the bends, and the arrowhead's length and half width, in text heights.
    const BEND_EM: f64 = 2.0;
    const HEAD_EM: [f64; 2] = [1.5, 0.75];
    let radius_m = BEND_EM * input.em_m;
    // The bends go right or left, and up or down on the picture, as point 3 does.
    let up = input.up.normalize_or(DVec2::Y);
    let signed = |axis: DVec2| if axis.dot(tip - turn) < 0.0 { -axis } else { axis };
    let [aside, on] = [signed(-up.perp()), signed(up)];
    let way = if aside.perp_dot(on) > 0.0 { 1.0 } else { -1.0 };
    let (before, after) = (turn - aside * radius_m, turn + aside * radius_m);
    let mut path = arc(before, -on * radius_m, way * PI / 2.0);
    path.extend(arc(after, -aside * radius_m, -way * PI / 2.0).into_iter().skip(1));
    lettered(&[rear, path[0]], 0.5, kind, input, drawing);
    let from = path[path.len() - 1];
    path.push(tip);
    drawing.line(path);
    let [length, half] = HEAD_EM.map(|size| size * input.em_m);
    drawing.line(arrowhead(tip, direction(from, tip), length, half));
}

/// Pursuit (LINE33): a line from point 1 to point 2, and a half circle from there to as far as point 3 is off, with a barred
/// arrowhead that points back.
pub fn pursuit(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [rear, turn, side] = [input.points[0], input.points[1], input.points[2]];
    let along = direction(rear, turn);
    let across = offset_of(side, turn, turn + along);
    let tip = turn + across;
    lettered(&[rear, turn], 0.5, kind, input, drawing);
    let center = turn + across / 2.0;
    let way = if across.perp_dot(along) > 0.0 { -1.0 } else { 1.0 };
    drawing.line(arc(center, -across / 2.0, way * PI));
    let barb_m = (2.083 * input.em_m).min(0.2 * across.length());
    if barb_m > 0.0 {
        square_head(tip, -along, barb_m, drawing);
        let bar = along.perp() * barb_m;
        drawing.line([tip - bar, tip + bar]);
    }
}

/// Search area, reconnaissance area (AREA21): two lightning arrows from point 1 to points 2 and 3.
pub fn search_area(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let center = input.points[0];
    let tips = [input.points[1], input.points[2]];
    /// Half of the jag, and a leg of the arrowhead, as shares of the first arrow's length.
    const JAG: f64 = 0.036;
    const LEG: f64 = 0.0405;
    let [jag_m, leg_m] = [JAG, LEG].map(|share| share * center.distance(tips[0]));
    let inward = tips[0].midpoint(tips[1]) - center;
    for tip in tips {
        let along = direction(center, tip);
        let side = if along.perp().dot(inward) < 0.0 { -along.perp() } else { along.perp() };
        let middle = center.midpoint(tip);
        let jag = |way: f64| middle + (along + side) * (way * jag_m);
        drawing.line([center, jag(1.0), jag(-1.0), tip]);
        let barbs =
            [1.0, -1.0].map(|way| tip - turned(along, way * FRAC_PI_4) * (leg_m * std::f64::consts::SQRT_2));
        drawing.filled([barbs[0], tip, barbs[1]]);
    }
}
