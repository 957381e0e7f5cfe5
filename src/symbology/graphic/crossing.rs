//! Crossing sites: draw rules LINE11, LINE12, LINE16, LINE17 and LINE18; fighting positions, abatis.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{direction, text_m, turned};
use sandtable_geom::polyline::Polyline;

/// Flanges at the ends of a bridge, in text heights.
const FLANGE_EM: f64 = 1.25;

/// The arrowheads of a ferry: length and half width in text heights.
const FERRY_EM: [f64; 2] = [2.0, 1.0];

/// The side ends of a fighting position, as a share of its length.
const FIGHTING: f64 = 0.05;

/// A bridge or an assault crossing: two sides with flanges outward.
pub fn bridge(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [a, b, c, d] = [input.points[0], input.points[1], input.points[2], input.points[3]];
    for ([from, to], [near, far]) in [([a, b], [c, d]), ([c, d], [a, b])] {
        drawing.line([from, to]);
        let along = direction(from, to);
        let away = along.perp() * along.perp_dot(near.midpoint(far) - from).signum() * -1.0;
        for (end, outward) in [(from, -along), (to, along)] {
            let flange = (outward + away) * (FRAC_1_SQRT_2 * FLANGE_EM * input.em_m);
            drawing.line([end, end + flange]);
        }
    }
    let [middle, outward] = [a.midpoint(c), direction(b.midpoint(d), a.midpoint(c))];
    drawing.text_beside(input.fields.labeled("{}"), middle + outward * (0.5 * input.em_m), outward);
}

/// A ford: two sides, the second through point 3, dashed; of a difficult one a zigzag between.
pub fn ford(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [from, to, side] = [input.points[0], input.points[1], input.points[2]];
    let along = direction(from, to);
    let aside = along.perp() * along.perp_dot(side - from);
    drawing.dashed([from, to]);
    drawing.dashed([from + aside, to + aside]);
    if kind.code == "271600" {
        let middle = from.midpoint(to);
        let count = (aside.length() / (0.53 * input.em_m)).floor().clamp(2.0, 200.0);
        let corner = |step: u32| {
            let half = if step.is_multiple_of(2) { 0.83 } else { -0.83 };
            middle + aside * (f64::from(step) / count) + along * (half * input.em_m)
        };
        drawing.line((0..=count as u32).map(corner).collect::<Vec<_>>());
    }
}

/// A ferry: a line with filled arrowheads at both ends.
pub fn ferry(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [from, to] = [input.points[0], input.points[1]];
    drawing.line([from, to]);
    for (tip, toward) in [(to, direction(from, to)), (from, direction(to, from))] {
        let base = tip - toward * (FERRY_EM[0] * input.em_m);
        let half = toward.perp() * (FERRY_EM[1] * input.em_m);
        drawing.filled([base + half, tip, base - half]);
    }
}

/// A fighting position (LINE19): a line with ends turned to its right, toward the rear.
pub fn fighting_position(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [from, to] = [input.points[0], input.points[1]];
    let back = -(to - from).perp() * FIGHTING;
    drawing.line([from + back, from, to, to + back]);
}

/// An abatis (LINE13): one notch at the start of a line.
pub fn abatis(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// The base and the height of the notch in text heights.
    const NOTCH_EM: [f64; 2] = [2.5, 1.77];
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let base_m = (NOTCH_EM[0] * input.em_m).min(line.length() / 2.0);
    let [from, to] = [line.at(0.0), line.at(base_m)];
    // The notch is on the upper side on the picture.
    let aside = direction(from, to).perp();
    let over = if aside.dot(input.up) < 0.0 { -aside } else { aside };
    let apex = from.midpoint(to) + over * (NOTCH_EM[1] * input.em_m);
    let mut points = vec![from, apex];
    points.extend(line.between(base_m, line.length()));
    drawing.line(points);
}

/// A roadblock (LINE12): lines as far off the one between points 1 and 2 as point 3 is, on both sides. Those of a planned one are
/// dashed; that of one that is safe on the side away from point 3. One that is complete is crossed by two lines.
pub fn roadblock(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [from, to, side] = [input.points[0], input.points[1], input.points[2]];
    let along = direction(from, to);
    let aside = along.perp() * along.perp().dot(side - from);
    let [near, far] = [[from + aside, to + aside], [from - aside, to - aside]];
    match kind.code {
        "271201" => [near, far].into_iter().for_each(|line| drawing.dashed(line)),
        "271202" => {
            drawing.line(near);
            drawing.dashed(far);
        }
        _ => [near, far].into_iter().for_each(|line| drawing.line(line)),
    }
    if kind.code == "271204" {
        /// The angle of the crossing lines to those of the block.
        const CROSSING_RAD: f64 = 75.0 * std::f64::consts::PI / 180.0;
        let half = turned(along, CROSSING_RAD) * (from.distance(to) / 2.0);
        for way in [1.0, -1.0] {
            let middle = from.midpoint(to) + along * (aside.length() * way);
            drawing.line([middle - half, middle + half]);
        }
    }
}

/// A convoy (LINE9, LINE20): a box that points the way it moves; of a halted one the point is turned inward.
pub fn convoy(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [rear, front] = [input.points[1], input.points[0]];
    let (along, length_m) = (direction(rear, front), rear.distance(front));
    /// The head's length and half width, and the box's half width, in lengths.
    const MOVING: [f64; 3] = [0.12, 0.06, 0.04];
    const HALTED: [f64; 3] = [0.08, 0.04, 0.04];
    let sizes = if kind.code == "330100" { MOVING } else { HALTED };
    let [head_m, wide_m, half_m] = sizes.map(|share| share * length_m);
    let at = |far: f64, aside: f64| rear + along * far + along.perp() * aside;
    let neck = length_m - head_m;
    if kind.code == "330100" {
        drawing.line([
            at(neck, half_m),
            at(0.0, half_m),
            at(0.0, -half_m),
            at(neck, -half_m),
            at(neck, -wide_m),
            front,
            at(neck, wide_m),
            at(neck, half_m),
        ]);
    } else {
        drawing.ring([at(0.0, half_m), at(0.0, -half_m), at(neck, -half_m), at(neck, half_m)]);
        drawing.line([at(length_m, wide_m), at(neck, 0.0), at(length_m, -wide_m)]);
    }
    let middle: DVec2 = at(neck / 2.0, 0.0);
    let text = input.fields.further.clone();
    if text_m(&text, input.em_m) < neck {
        drawing.text(text, middle);
    }
    // The vehicles over the rear, the times under the middle.
    let up = if along.perp().dot(input.up) < 0.0 { -1.0 } else { 1.0 };
    let beside = half_m + 0.3 * input.em_m;
    let [over, under] = [along.perp() * up, -along.perp() * up];
    drawing.text_beside(input.fields.equipment.clone(), at(0.15 * neck, up * beside), over);
    drawing.text_beside(input.fields.times(), at(neck / 2.0, -up * beside), under);
}
