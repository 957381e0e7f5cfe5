//! Areas: draw rules AREA1, AREA3 and AREA23, and mined areas.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{closed, gapped, text_m};
use sandtable_geom::polygon::{bounds, inner_point};
use sandtable_geom::polyline::Polyline;

/// A closed line with its name inside (AREA1).
pub fn area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    label_area(kind, input, drawing);
}

/// A closed line that is dashed whatever its status, with its name inside.
pub fn dashed_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(ring) = closed(input.points) else { return };
    drawing.dashed(ring.points());
    label_area(kind, input, drawing);
}

/// The name inside an area.
pub fn label_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if !kind.is_area() {
        return;
    }
    let rings = [input.points];
    if let Some((at, _)) = inner_point(rings, &bounds(input.points)) {
        let fields = input.fields;
        let mut text = fields.labeled(kind.label);
        for more in [fields.heights.join("\u{2013}"), fields.further.clone()] {
            if !more.is_empty() {
                text = if text.is_empty() { more } else { format!("{text}\n{more}") };
            }
        }
        drawing.text(text, at);
    }
}

/// A battle position (AREA3): the echelon in a gap of the outline.
pub fn battle_position(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let echelon = &input.fields.echelon;
    let marks = if echelon.is_empty() { vec![] } else { vec![(longest_leg(input.points), echelon.as_str())] };
    marked_ring(input, &marks, drawing);
    label_area(kind, input, drawing);
}

/// A mined area: `M` in four gaps of the outline, and what is known of it inside.
pub fn mined_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    marked_ring(input, &[(0.125, "M"), (0.375, "M"), (0.625, "M"), (0.875, "M")], drawing);
    if !input.fields.hostile.is_empty() {
        let outline = bounds(input.points);
        drawing.text(input.fields.hostile.clone(), DVec2::new(outline.center().x, outline.max.y));
    }
    label_area(kind, input, drawing);
}

/// An area with a mark on its outline: wire crosses of a fenced one, or the like.
pub fn marked_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    marked_ring(input, &[(0.0, kind.label), (0.5, kind.label)], drawing);
}

/// The share of a ring's length at the middle of its longest leg.
fn longest_leg(ring: &[DVec2]) -> f64 {
    let Some(line) = closed(ring) else { return 0.0 };
    let stations = line.stations();
    let longest = |best: usize, leg: usize| {
        let length = |leg: usize| stations[leg + 1] - stations[leg];
        if length(leg) > length(best) { leg } else { best }
    };
    let leg = (0..stations.len() - 1).fold(0, longest);
    (stations[leg] + stations[leg + 1]) / 2.0 / line.length()
}

/// A ring with texts in gaps, at shares of its length.
fn marked_ring(input: &GraphicInput<'_>, marks: &[(f64, &str)], drawing: &mut GraphicDrawing) {
    let Some(ring) = closed(input.points) else { return };
    let gaps: Vec<(f64, f64)> = marks
        .iter()
        .map(|&(share, text)| (share * ring.length(), text_m(text, input.em_m) / 2.0 + 0.3 * input.em_m))
        .collect();
    pieces(&ring, &gaps).into_iter().for_each(|piece| drawing.line(piece));
    for &(share, text) in marks {
        drawing.text(text, ring.at(share * ring.length()));
    }
}

/// The pieces of a ring; all of it where the gaps would leave nothing.
fn pieces(ring: &Polyline, gaps: &[(f64, f64)]) -> Vec<Vec<DVec2>> {
    let taken: f64 = gaps.iter().map(|(_, half)| 2.0 * half).sum();
    if taken > 0.8 * ring.length() { vec![ring.points().to_vec()] } else { gapped(ring, gaps) }
}

/// An area target: its number inside.
pub fn target_area(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    if let Some((at, _)) = inner_point([input.points], &bounds(input.points)) {
        drawing.text(input.fields.target.clone(), at);
    }
}
