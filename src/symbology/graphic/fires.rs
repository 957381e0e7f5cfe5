//! Fires: targets, range fans, fire areas by a radius.

use glam::DVec2;

use crate::graphic::area::{hatch, inner_text, is_hatched};
use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{arc, arrowhead, circle, direction};
use sandtable_geom::azimuth::heading;

/// Half of the bar at the end of a linear target, in text heights.
const BAR_EM: f64 = 1.04;

/// How much longer than the greatest range the arrow of a sector is.
const ARROW: f64 = 1.2;

/// A linear target (LINE5): a line with bars at its ends, its number over it.
pub fn linear_target(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let points = input.points;
    drawing.line(points);
    let last = points.len() - 1;
    for leg in [[0, 1], [last, last - 1]] {
        let bar = direction(points[leg[0]], points[leg[1]]).perp() * (BAR_EM * input.em_m);
        drawing.line([points[leg[0]] - bar, points[leg[0]] + bar]);
    }
    // The texts stand in the middle of its middle leg.
    let middle_leg = last.div_ceil(2);
    let [from, to] = [points[middle_leg - 1], points[middle_leg]];
    let aside = direction(from, to).perp();
    let above = if aside.dot(input.up) < 0.0 { -aside } else { aside };
    let middle = from.midpoint(to);
    let beside = above * (0.3 * input.em_m);
    drawing.text_beside(input.fields.target.clone(), middle + beside, above);
    let under = kind.label.replace("{}", &input.fields.designation_2);
    let under = [under.trim(), &input.fields.equipment].join("\n");
    drawing.text_beside(under.trim(), middle - beside, -above);
}

/// A circle of a stated radius with a name inside (CIRCULAR1).
pub fn circular(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(&radius_m) = input.fields.distances_m.first() else { return };
    let center = input.points[0];
    let ring = circle(center, radius_m);
    if is_hatched(kind) {
        hatch(&ring, input, drawing);
    }
    drawing.ring(ring);
    if kind.code == "240502" {
        // The letters stand on four sides, the name inside.
        let up = input.up.normalize_or(DVec2::Y) * radius_m;
        [up, up.perp(), -up, -up.perp()].into_iter().for_each(|side| drawing.text("PAA", center + side));
        drawing.text(input.fields.labeled("{}"), center);
    } else {
        drawing.text(inner_text(kind, input), center);
    }
}

/// Rings of range about a weapon or sensor (CIRCULAR2), each with its distance and height.
pub fn range_rings(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let (center, up) = (input.points[0], input.up.normalize_or(DVec2::Y));
    for (index, &radius_m) in input.fields.distances_m.iter().enumerate() {
        drawing.ring(circle(center, radius_m));
        drawing.text(range_text(input, index, radius_m), center + up * radius_m);
    }
}

/// A sector of range (ARC1): for each pair of azimuths an arc at its distance, and an arrow along the middle.
pub fn range_sector(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let center = input.points[0];
    let fields = input.fields;
    let mut before_m = 0.0;
    for (index, (&radius_m, pair)) in
        fields.distances_m.iter().zip(fields.azimuths_deg.chunks_exact(2)).enumerate()
    {
        let [left, right] = [pair[0], pair[1]];
        let sweep_deg = (right - left).rem_euclid(360.0);
        let sweep_deg = if sweep_deg == 0.0 { 360.0 } else { sweep_deg };
        let bow = arc(center, heading(left) * radius_m, -sweep_deg.to_radians());
        drawing.text(range_text(input, index, radius_m), bow[bow.len() / 2]);
        drawing.line(bow);
        for side in [left, right] {
            drawing.line([center + heading(side) * before_m, center + heading(side) * radius_m]);
            let at = center + heading(side) * (radius_m.midpoint(before_m));
            drawing.text(format!("{side:.0}\u{b0}"), at);
        }
        before_m = radius_m;
    }
    if let (Some(pair), Some(&farthest_m)) =
        (fields.azimuths_deg.chunks_exact(2).next(), fields.distances_m.last())
    {
        let middle = heading(pair[0] + (pair[1] - pair[0]).rem_euclid(360.0) / 2.0);
        let tip = center + middle * farthest_m * ARROW;
        drawing.line([center, tip]);
        drawing.line(arrowhead(tip, middle, input.em_m, 0.6 * input.em_m));
    }
}

fn range_text(input: &GraphicInput<'_>, index: usize, radius_m: f64) -> String {
    let distance = if radius_m >= 1000.0 {
        format!("{} km", (radius_m / 100.0).round() / 10.0)
    } else {
        format!("{radius_m:.0} m")
    };
    match input.fields.heights.get(index) {
        Some(height) => format!("{distance}\n{height}"),
        None => distance,
    }
}

/// The principal direction of fire (LINE3): a vertex and two tips, the first the principal one.
pub fn principal_direction(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [vertex, principal, other] = [input.points[0], input.points[1], input.points[2]];
    drawing.line([principal, vertex, other]);
    for tip in [principal, other] {
        drawing.line(arrowhead(tip, direction(vertex, tip), 1.667 * input.em_m, 0.833 * input.em_m));
    }
    // The principal arm is a heavy line.
    let along = principal - vertex;
    let half = direction(vertex, principal).perp() * (0.17 * input.em_m);
    let [from, to] = [vertex + along * 0.1, vertex + along * 0.9];
    drawing.filled([from + half, from - half, to - half, to + half]);
}
