//! Areas: draw rules AREA1 to AREA3, AREA9, AREA20 and AREA23, mined and contaminated areas, and hatching.

use glam::DVec2;

use crate::graphic::drawing::{FillInk, GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{closed, gapped, text_m};
use crate::graphic::wire::crosses;
use sandtable_geom::polygon::{bounds, inner_point};
use sandtable_geom::polyline::Polyline;

/// From line to line of hatching in text heights.
const HATCH_EM: f64 = 1.6;

/// The most lines of an area's hatching; they are farther apart on a larger one.
const MOST_HATCHES: f64 = 400.0;

/// The yellow of contaminated ground.
const CONTAMINATED: [u8; 3] = [255, 216, 0];

/// A closed line with its name inside (AREA1).
pub fn area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    if is_hatched(kind) {
        hatch(input.points, input, drawing);
    }
    label_area(kind, input, drawing);
}

/// Whether the standard hatches an area.
pub fn is_hatched(kind: &GraphicKind) -> bool {
    matches!(kind.code, "151100" | "172000" | "240301" | "240302" | "240303" | "270400")
}

/// Adds hatching that rises to the right within a ring.
pub fn hatch(ring: &[DVec2], input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let up = input.up.normalize_or(DVec2::Y);
    let (along, across) = (up - up.perp(), (up + up.perp()).normalize_or_zero());
    let along = along.normalize_or_zero();
    let span = |line: &[DVec2]| {
        line.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], at| {
            let far = at.dot(across);
            [least.min(far), most.max(far)]
        })
    };
    let [least, most] = span(ring);
    let pitch_m = (HATCH_EM * input.em_m).max((most - least) / MOST_HATCHES);
    let mut far = least + pitch_m / 2.0;
    while far < most {
        let mut cuts: Vec<f64> = Vec::new();
        for (index, &from) in ring.iter().enumerate() {
            let to = ring[(index + 1) % ring.len()];
            let [a, b] = [from.dot(across) - far, to.dot(across) - far];
            if (a < 0.0) != (b < 0.0) {
                cuts.push(from.lerp(to, a / (a - b)).dot(along));
            }
        }
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.chunks_exact(2) {
            drawing.hatch([across * far + along * pair[0], across * far + along * pair[1]]);
        }
        far += pitch_m;
    }
}

/// The texts inside of an area, line under line: its name, second name, elevations, further text and times.
pub fn inner_text(kind: &GraphicKind, input: &GraphicInput<'_>) -> String {
    let fields = input.fields;
    let shown = |letters: &str, text: String| if kind.shows(letters) { text } else { String::new() };
    let further = if kind.label.contains("{H}") { String::new() } else { fields.further.clone() };
    let lines = [
        shown("AP", fields.target.clone()),
        fields.named(kind.label),
        shown("T1", fields.designation_2.clone()),
        fields.heights.join("\u{2013}"),
        shown("Y", fields.location.clone()),
        further,
        fields.times(),
    ];
    lines.into_iter().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
}

/// Adds the mark of the enemy on two sides of an area: in the middles of its first leg and of the one opposite.
pub fn mark_hostile(input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let (points, hostile) = (input.points, &input.fields.hostile);
    let (count, before) = (points.len(), drawing.texts.len());
    for leg in [0, count / 2] {
        drawing.text(hostile.clone(), points[leg].midpoint(points[(leg + 1) % count]));
    }
    drawing.yield_texts(before);
}

/// An airfield zone (AREA20): crossed runways inside.
pub fn airfield_zone(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    let middle = bounds(input.points).center();
    let up = input.up.normalize_or(DVec2::Y) * input.em_m;
    let right = -up.perp();
    /// Half of a runway, how far the second one rises, and how far its ends are from a text, in text heights.
    const RUNWAY_EM: [f64; 3] = [2.9, 1.46, 3.2];
    let [half, rise, beside] = RUNWAY_EM;
    // The foot of the second runway is on the level of the first one's middle, as on charts.
    drawing.line([middle - right * half, middle + right * half]);
    drawing.line([middle - right * half - up * rise, middle + right * half + up * rise]);
    drawing.text_beside(input.fields.further.clone(), middle + right * beside, right.normalize_or_zero());
}

/// An airhead line: its name at the foot of its outline.
pub fn airhead(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    let down = -input.up.normalize_or(DVec2::Y);
    drawing.text(kind.label, farthest(input.points, down));
}

/// A closed line with its name in a gap at its top (AREA9), or on the contour of a dose rate.
pub fn top_labeled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    let top = farthest(input.points, input.up.normalize_or(DVec2::Y));
    drawing.text(input.fields.labeled(kind.label), top);
}

/// The corner of a ring that lies farthest in a direction.
fn farthest(ring: &[DVec2], toward: DVec2) -> DVec2 {
    let far = |at: &&DVec2| at.dot(toward);
    ring.iter().max_by(|a, b| far(a).total_cmp(&far(b))).copied().unwrap_or_default()
}

/// A position area for artillery: its letters on four sides, its name inside.
pub fn position_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    let Some(ring) = closed(input.points) else { return };
    for share in [0.125, 0.375, 0.625, 0.875] {
        drawing.text(kind.label, ring.at(share * ring.length()));
    }
    let rings = [input.points];
    if let Some((at, _)) = inner_point(rings, &bounds(input.points)) {
        drawing.text(input.fields.labeled("{}"), at);
    }
}

/// Contaminated ground: yellow, with the letter of its kind.
pub fn contaminated(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.fill(input.points.to_vec(), FillInk::Ground(CONTAMINATED));
    drawing.ring(input.points);
    hatch(input.points, input, drawing);
    if let Some((at, _)) = inner_point([input.points], &bounds(input.points)) {
        let name = input.fields.labeled("{}");
        let text = if name.is_empty() { kind.label.to_owned() } else { format!("{}\n{name}", kind.label) };
        drawing.text(text, at);
    }
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
        drawing.text(inner_text(kind, input), at);
    }
}

/// A battle position (AREA3): the echelon in a gap of the outline.
pub fn battle_position(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if kind.code == "151202" {
        dashed_area(kind, input, drawing);
        return;
    }
    let echelon = &input.fields.echelon;
    let marks = if echelon.is_empty() { vec![] } else { vec![(longest_leg(input.points), echelon.as_str())] };
    marked_ring(input, &marks, drawing);
    label_area(kind, input, drawing);
}

/// A mined area: `M` in four gaps of the outline, and what is known of it inside.
pub fn mined_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    marked_ring(input, &[(0.125, "M"), (0.375, "M"), (0.625, "M"), (0.875, "M")], drawing);
    if kind.code == "270801"
        && let Some(ring) = closed(input.points)
    {
        crosses(&ring, input, drawing);
    }
    let fields = input.fields;
    let up = input.up.normalize_or(DVec2::Y);
    let [top, foot] = [up, -up].map(|toward| farthest(input.points, toward) + toward * (0.6 * input.em_m));
    drawing.text_beside(fields.further.clone(), top, up);
    drawing.text_beside(fields.times(), foot, -up);
    let before = drawing.texts.len();
    if !fields.hostile.is_empty() {
        let right = -up.perp();
        for side in [right, -right] {
            let at = farthest(input.points, side) + side * (0.6 * input.em_m);
            drawing.text_beside(fields.hostile.clone(), at, side);
        }
    }
    drawing.yield_texts(before);
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
