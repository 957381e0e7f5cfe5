//! Lines with teeth: the forward line of own troops, fortified lines and areas, obstacle lines, ditches.
//!
//! Teeth stand on the left of a line, toward the enemy (MIL-STD-2525D, LINE1), and outside of an area. They are as many as
//! fit at their pitch, evenly spread over the whole line whatever its legs are, so that a finely digitized line has as many
//! as a coarse one.

use glam::DVec2;

use crate::graphic::area::{hatch, is_hatched, label_area};
use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::lines::label_ends;
use crate::graphic::plane::{bulge, circle, closed};
use sandtable_geom::polygon::doubled_area;
use sandtable_geom::polyline::Polyline;

/// The most teeth of a line; they grow with a longer one.
const MOST_TEETH: f64 = 2000.0;

/// From tooth to tooth, of arcs, squares and triangles, in text heights.
const PITCH_EM: f64 = 1.72;
/// Of ditches.
const DITCH_PITCH_EM: f64 = 1.02;

/// Of an encirclement.
const ENCIRCLEMENT_EM: f64 = 1.72;

/// The height of squares, ticks and triangles.
const TOOTH_EM: f64 = 0.833;
/// The height of a ditch's triangles.
const DITCH_TOOTH_EM: f64 = 1.25;

/// A stretch of a line with one tooth.
#[derive(Clone, Copy)]
pub(super) struct ToothBase<'a> {
    line: &'a Polyline,
    from_m: f64,
    to_m: f64,
}

impl ToothBase<'_> {
    /// A place on the stretch.
    pub(super) fn at(&self, share: f64) -> DVec2 {
        self.line.at(self.from_m + (self.to_m - self.from_m) * share)
    }

    /// The line between two places.
    pub(super) fn between(&self, from: f64, to: f64) -> Vec<DVec2> {
        let station = |share: f64| self.from_m + (self.to_m - self.from_m) * share;
        self.line.between(station(from), station(to))
    }

    /// Its halves, a tooth each.
    pub(super) fn halves(&self) -> [Self; 2] {
        let middle_m = self.from_m.midpoint(self.to_m);
        [Self { to_m: middle_m, ..*self }, Self { from_m: middle_m, ..*self }]
    }

    /// To the left, of length 1.
    pub(super) fn left(&self) -> DVec2 {
        (self.at(1.0) - self.at(0.0)).normalize_or_zero().perp()
    }

    pub(super) fn length_m(&self) -> f64 {
        self.to_m - self.from_m
    }
}

/// The stretches of a line with one tooth each, about `pitch_m` long.
pub(super) fn bases(line: &Polyline, pitch_m: f64) -> impl Iterator<Item = ToothBase<'_>> {
    let count = (line.length() / pitch_m).floor().clamp(1.0, MOST_TEETH);
    let step_m = line.length() / count;
    (0..count as u32).map(move |index| ToothBase {
        line,
        from_m: f64::from(index) * step_m,
        to_m: f64::from(index + 1) * step_m,
    })
}

/// A line, or the outline of an area with its outside on the left.
pub(super) fn base_line(kind: &GraphicKind, input: &GraphicInput<'_>) -> Option<Polyline> {
    if !kind.is_area() {
        return Polyline::new(input.points.iter().copied(), 0.0);
    }
    let ring = closed(input.points)?;
    Some(if doubled_area(input.points) > 0.0 { ring.reversed() } else { ring })
}

/// The forward line of own troops: arcs toward the enemy.
pub fn flot(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    drawing.line(arcs(&line, input.em_m));
    label_ends(kind, input, drawing);
    hostile_ends(input, drawing);
}

/// Adds the mark of the enemy over both ends of a line.
fn hostile_ends(input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let points = input.points;
    let (up, before) = (input.up.normalize_or(DVec2::Y), drawing.texts.len());
    for end in [points[0], points[points.len() - 1]] {
        drawing.text_beside(input.fields.hostile.clone(), end + up * (1.2 * input.em_m), up);
    }
    drawing.yield_texts(before);
}

/// An encirclement: triangles on the outside of its outline.
pub fn encirclement(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    drawing.ring(input.points);
    for base in bases(&line, ENCIRCLEMENT_EM * input.em_m) {
        let apex = base.at(0.5) + base.left() * TOOTH_EM * input.em_m;
        drawing.line([base.at(0.25), apex, base.at(0.75)]);
    }
    label_area(kind, input, drawing);
}

/// The line of contact: the forward lines of both sides, face to face.
pub fn contact(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    let own = arcs(&line, input.em_m);
    drawing.line(own);
    let mut facing = Vec::new();
    for base in bases(&line, PITCH_EM * input.em_m) {
        // As far off as both arcs are deep.
        let off = base.left() * base.length_m() * 1.05;
        facing.extend(bulge(base.at(0.0) + off, base.at(1.0) + off, -0.5));
    }
    drawing.opposing(facing);
    label_ends(kind, input, drawing);
    hostile_ends(input, drawing);
}

fn arcs(line: &Polyline, em_m: f64) -> Vec<DVec2> {
    bases(line, PITCH_EM * em_m).flat_map(|base| bulge(base.at(0.0), base.at(1.0), 0.5)).collect()
}

/// A fortified line or area: battlements.
pub fn fortified(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    let mut outline = vec![line.at(0.0)];
    for base in bases(&line, PITCH_EM * input.em_m) {
        let up = base.left() * TOOTH_EM * input.em_m;
        outline.extend(base.between(0.0, 0.5));
        outline.extend([base.at(0.5) + up, base.at(1.0) + up, base.at(1.0)]);
    }
    drawing.line(outline);
    label_area(kind, input, drawing);
}

/// A strong point: ticks outward (AREA4).
pub fn strong_point(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    drawing.ring(input.points);
    for base in bases(&line, PITCH_EM * input.em_m) {
        drawing.line([base.at(0.5), base.at(0.5) + base.left() * TOOTH_EM * input.em_m]);
    }
    label_area(kind, input, drawing);
}

/// An obstacle line, belt or zone: triangles with a flat stretch between; those of an obstacle-free zone point inward.
pub fn obstacle(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    let side = if matches!(kind.code, "270300" | "270400") { -1.0 } else { 1.0 };
    let mut outline = vec![line.at(0.0)];
    for base in bases(&line, PITCH_EM * input.em_m) {
        outline.extend(base.between(0.0, 0.5));
        outline.push(base.at(0.75) + base.left() * side * TOOTH_EM * input.em_m);
        outline.extend([base.at(1.0)]);
    }
    drawing.line(outline);
    if is_hatched(kind) {
        hatch(input.points, input, drawing);
    }
    if kind.is_area() {
        label_area(kind, input, drawing);
    } else {
        let middle = line.at(line.length() / 2.0);
        drawing.text(input.fields.designation.clone(), middle - line_left(&line) * 1.2 * input.em_m);
    }
}

fn line_left(line: &Polyline) -> DVec2 {
    let half = line.length() / 2.0;
    (line.at(half + 1.0) - line.at(half - 1.0)).normalize_or_zero().perp()
}

/// An antitank ditch: triangles, filled where it is completed; with mines between its triangles where it is reinforced.
pub fn ditch(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    drawing.line(line.points());
    let is_mined = kind.code == "290203";
    let pitch_m = DITCH_PITCH_EM * input.em_m * if is_mined { 2.0 } else { 1.0 };
    for base in bases(&line, pitch_m) {
        let share = if is_mined { 0.5 } else { 1.0 };
        let side = if is_mined { -1.0 } else { 1.0 };
        let apex = base.at(share / 2.0) + base.left() * side * DITCH_TOOTH_EM * input.em_m;
        let triangle = [base.at(0.0), base.at(share), apex];
        if kind.code == "290201" {
            drawing.line([triangle[0], apex, triangle[1]]);
        } else {
            drawing.filled(triangle);
        }
        if is_mined {
            let radius_m = 0.35 * input.em_m;
            drawing.filled(circle(base.at(0.75) - base.left() * 1.6 * radius_m, radius_m));
        }
    }
}

/// An antitank wall: a line with short squares on it.
pub fn wall(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    drawing.line(line.points());
    for base in bases(&line, PITCH_EM * input.em_m) {
        let up = base.left() * (TOOTH_EM * input.em_m);
        drawing.filled([base.at(0.25), base.at(0.75), base.at(0.75) + up, base.at(0.25) + up]);
    }
}

/// A mine line: mines along it.
pub fn mine_line(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    drawing.line(line.points());
    let radius_m = 0.4 * input.em_m;
    for base in bases(&line, 2.0 * PITCH_EM * input.em_m) {
        drawing.filled(circle(base.at(0.5), radius_m));
    }
    let middle = line.at(line.length() / 2.0);
    drawing.text(input.fields.hostile.clone(), middle - line_left(&line) * input.em_m);
}
