//! Zones by a few numbers: rectangles, ellipses, sectors and circles about points, and pairs of rings.

use glam::DVec2;

use crate::graphic::area::{hatch, inner_text, is_hatched};
use crate::graphic::corridor::corridor_width_m;
use crate::graphic::drawing::{FillInk, GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{arc, bulge, circle, direction, turned};
use sandtable_geom::azimuth::heading;

/// Corners of an ellipse.
const ELLIPSE_CORNERS: u32 = 72;

/// The colors of areas at sea that are filled whoever owns them.
fn ground_color(kind: &GraphicKind) -> Option<[u8; 3]> {
    match kind.code {
        "200101" => Some([255, 155, 0]),
        "200201" | "200202" | "200600" => Some([85, 119, 136]),
        "200700" => Some([51, 136, 136]),
        _ => None,
    }
}

fn outlined(kind: &GraphicKind, ring: Vec<DVec2>, drawing: &mut GraphicDrawing) {
    if let Some(color) = ground_color(kind) {
        drawing.fill(ring.clone(), FillInk::Ground(color));
    }
    drawing.ring(ring);
}

/// The corners of a rectangle: the middles of two sides and the width between the others (RECTANGULAR1).
fn corners(input: &GraphicInput<'_>) -> Option<[DVec2; 4]> {
    let [from, to] = [input.points[0], input.points[1]];
    let half = direction(from, to).perp() * (corridor_width_m(input)? / 2.0);
    Some([from + half, to + half, to - half, from - half])
}

/// A rectangle about the line between two points (RECTANGULAR1).
pub fn rectangle(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(corners) = corners(input) else { return };
    outlined(kind, corners.to_vec(), drawing);
    if is_hatched(kind) {
        hatch(&corners, input, drawing);
    }
    let middle = (corners[0] + corners[2]) / 2.0;
    if kind.code == "240501" {
        // The letters stand on every side, the name inside.
        for side in 0..4 {
            drawing.text(kind.label, corners[side].midpoint(corners[(side + 1) % 4]));
        }
        drawing.text(input.fields.labeled("{}"), middle);
    } else {
        drawing.text(inner_text(kind, input), middle);
    }
}

/// A rectangle with a cross in its middle (RECTANGULAR3).
pub fn single_target(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(corners) = corners(input) else { return };
    drawing.ring(corners);
    let middle = (corners[0] + corners[2]) / 2.0;
    /// Half of an arm of the cross in text heights.
    const ARM_EM: f64 = 4.0;
    let up = input.up.normalize_or(DVec2::Y) * (ARM_EM * input.em_m);
    for arm in [up, up.perp()] {
        drawing.line([middle - arm, middle + arm]);
    }
    drawing.text_beside(
        input.fields.named("{}"),
        middle + (up - up.perp()) * 0.12,
        -up.perp().normalize_or_zero(),
    );
}

/// Two distances and the azimuth of the first; a circle's or a square's where there is one distance.
fn spans(input: &GraphicInput<'_>) -> [DVec2; 2] {
    let fields = input.fields;
    let azimuth_deg = fields.azimuths_deg.first().copied().unwrap_or(0.0);
    let first_m = fields.distances_m.first().copied().unwrap_or(0.0);
    let second_m = fields.distances_m.get(1).copied().unwrap_or(first_m);
    let along = heading(azimuth_deg);
    [along * first_m, -along.perp() * second_m]
}

/// An ellipse by its half axes and the azimuth of the first (ELLIPSE1).
pub fn ellipse(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let (center, [along, across]) = (input.points[0], spans(input));
    let corner = |step: u32| {
        let unit = turned(DVec2::X, std::f64::consts::TAU * f64::from(step) / f64::from(ELLIPSE_CORNERS));
        center + along * unit.x + across * unit.y
    };
    outlined(kind, (0..ELLIPSE_CORNERS).map(corner).collect(), drawing);
    drawing.text(inner_text(kind, input), center);
}

/// A rectangle by its length, its width and the azimuth of its length (RECTANGULAR2, POINT17).
pub fn box_about(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let (center, [along, across]) = (input.points[0], spans(input).map(|span| span / 2.0));
    let corners = [along + across, along - across, -along - across, across - along];
    outlined(kind, corners.map(|corner| center + corner).to_vec(), drawing);
    let fields = input.fields;
    let text = if fields.target.is_empty() { fields.named(kind.label) } else { fields.target.clone() };
    drawing.text(text, center);
}

/// The ground between two ranges and two azimuths (POINT18).
pub fn radar_search(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let (center, fields) = (input.points[0], input.fields);
    let (Some(&near_m), Some(&far_m)) = (fields.distances_m.first(), fields.distances_m.last()) else {
        return;
    };
    let [left, right] = [0, 1].map(|index| fields.azimuths_deg.get(index).copied().unwrap_or(0.0));
    let sweep_rad = (right - left).rem_euclid(360.0).to_radians();
    let near_m = if fields.distances_m.len() > 1 { near_m } else { 0.0 };
    let mut ring = arc(center, heading(left) * far_m, -sweep_rad);
    ring.extend(arc(center, heading(left) * near_m, -sweep_rad).into_iter().rev());
    ring.dedup();
    outlined(kind, ring, drawing);
    let middle = turned(heading(left), -sweep_rad / 2.0) * near_m.midpoint(far_m);
    drawing.text(fields.named(kind.label), center + middle);
}

/// Circles about point 1 through each other point, numbered (AREA14).
pub fn safe_distances(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    for (index, &point) in input.points.iter().enumerate().skip(1) {
        drawing.ring(circle(input.points[0], input.points[0].distance(point)));
        drawing.text(index.to_string(), point);
    }
}

/// Two numbered rings, the first of half of the points (AREA26).
pub fn strike_warning(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let (first, second) = input.points.split_at(input.points.len() / 2);
    for (number, ring) in [("1", first), ("2", second)] {
        drawing.ring(ring);
        drawing.text(number, ring[0].midpoint(ring[1]));
    }
}

/// A dashed half circle over two points, on the right of the way from the first to the second (AREA13).
pub fn mine_cluster(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [from, to] = [input.points[0], input.points[1]];
    drawing.dashed([from, to]);
    drawing.dashed(bulge(from, to, -0.5));
}
