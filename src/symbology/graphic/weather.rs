//! Lines and areas of the weather and of the sea: fronts, limits, isopleths, bounded areas.
//!
//! Marks along a line are as many as fit at their pitch, evenly spread over all of it, as teeth are. Isopleths and the like run
//! through their points as a curve (Catmull and Rom 1974).

use std::f64::consts::{FRAC_PI_4, TAU};

use glam::DVec2;

use crate::graphic::area::{hatch, label_area};
use crate::graphic::drawing::{FillInk, GraphicDrawing, GraphicInput, TextCourse};
use crate::graphic::kind::{GraphicKind, GraphicTint};
use crate::graphic::plane::{arrowhead, bulge, circle, closed, leg_pitch_m, offset, turned};
use crate::graphic::teeth::{ToothBase, base_line, bases};
use sandtable_geom::polygon::{bounds, inner_point};
use sandtable_geom::polyline::Polyline;

/// Pieces of a curve between two points.
const CURVE_STEPS: u32 = 12;

fn line_of(kind: &GraphicKind, input: &GraphicInput<'_>) -> Option<Polyline> {
    if kind.is_area() { closed(input.points) } else { Polyline::new(input.points.iter().copied(), 0.0) }
}

/// The name on a line or inside an area.
pub(super) fn label(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if kind.is_area() {
        label_area(kind, input, drawing);
    } else {
        drawing.text_on(input.fields.labeled(kind.label), TextCourse::Once(input.points.to_vec()));
    }
}

/// A curve through points.
fn curved(points: &[DVec2]) -> Vec<DVec2> {
    let mut curve = vec![points[0]];
    for (index, leg) in points.windows(2).enumerate() {
        let before = if index > 0 { points[index - 1] } else { leg[0] };
        let after = points.get(index + 2).copied().unwrap_or(leg[1]);
        let tangents = [(leg[1] - before) / 2.0, (after - leg[0]) / 2.0];
        curve.extend((1..=CURVE_STEPS).map(|step| {
            let t = f64::from(step) / f64::from(CURVE_STEPS);
            let (t2, t3) = (t * t, t * t * t);
            leg[0] * (2.0 * t3 - 3.0 * t2 + 1.0)
                + tangents[0] * (t3 - 2.0 * t2 + t)
                + leg[1] * (3.0 * t2 - 2.0 * t3)
                + tangents[1] * (t3 - t2)
        }));
    }
    curve
}

/// A line as its points are.
pub fn plain(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(input.points);
    label(kind, input, drawing);
}

/// A dashed line.
pub fn dashed_line(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.dashed(input.points);
    label(kind, input, drawing);
}

/// A curve through the points.
pub fn curve(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(curved(input.points));
    label(kind, input, drawing);
}

/// A dashed curve.
pub fn dashed_curve(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.dashed(curved(input.points));
    label(kind, input, drawing);
}

/// An area with its name inside.
pub fn area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.ring(input.points);
    label(kind, input, drawing);
}

/// The outline of an area that is not closed.
pub fn open_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    plain(kind, input, drawing);
}

/// An area in dashes.
pub fn dashed_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if let Some(ring) = closed(input.points) {
        drawing.dashed(ring.points());
    }
    label(kind, input, drawing);
}

/// An area in dots.
pub fn dotted_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    dots(input, drawing);
    label(kind, input, drawing);
}

fn dots(input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// From dot to dot, and the radius of one, in text heights.
    const DOT_EM: [f64; 2] = [0.7, 0.14];
    let Some(ring) = closed(input.points) else { return };
    for base in bases(&ring, DOT_EM[0] * input.em_m) {
        drawing.filled(circle(base.at(0.5), DOT_EM[1] * input.em_m));
    }
}

fn ground(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if let GraphicTint::Fixed(color) = kind.tint {
        drawing.fill(input.points.to_vec(), FillInk::Ground(color));
    }
}

/// An area in its color.
pub fn filled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    ground(kind, input, drawing);
    area(kind, input, drawing);
}

/// An area in its color with a dashed outline.
pub fn dashed_filled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    ground(kind, input, drawing);
    dashed_area(kind, input, drawing);
}

/// An area in its color with a dotted outline.
pub fn dotted_filled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    ground(kind, input, drawing);
    dotted_area(kind, input, drawing);
}

/// A hatched area.
pub fn hatched(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    hatch(input.points, input, drawing);
    area(kind, input, drawing);
}

/// A hatched area with a dashed outline.
pub fn dashed_hatched(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    hatch(input.points, input, drawing);
    dashed_area(kind, input, drawing);
}

/// A wave along the line: trough axes, instability and shear lines.
pub fn wave(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// Length and height of a wave in text heights.
    const WAVE_EM: [f64; 2] = [5.0, 0.83];
    let points = waved(input, WAVE_EM);
    if kind.code == "110402" {
        drawing.line(points)
    } else {
        drawing.dashed(points)
    }
    label(kind, input, drawing);
}

/// A submarine cable: a steep wave.
pub fn cable(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// Length and height of a wave in text heights.
    const WAVE_EM: [f64; 2] = [3.3, 1.6];
    drawing.line(waved(input, WAVE_EM));
    label(kind, input, drawing);
}

/// A wave of a stated length and height on every leg; what is left of a leg is straight.
fn waved(input: &GraphicInput<'_>, [length, height]: [f64; 2]) -> Vec<DVec2> {
    const STEPS: u32 = 16;
    let wave_m = leg_pitch_m(input.points, length * input.em_m);
    let mut points = vec![input.points[0]];
    for leg in input.points.windows(2) {
        let leg_m = leg[0].distance(leg[1]);
        let along = (leg[1] - leg[0]) / leg_m;

        // The first bow is on the upper side on the picture.
        let aside = along.perp() * (height * input.em_m);
        let left = if aside.dot(input.up) < 0.0 { -aside } else { aside };
        for wave in 0..(leg_m / wave_m) as u32 {
            points.extend((1..=STEPS).map(|step| {
                let share = f64::from(step) / f64::from(STEPS);
                leg[0] + along * (wave_m * (f64::from(wave) + share)) + left * libm::sin(share * TAU)
            }));
        }
        points.push(leg[1]);
    }
    points
}

/// A ridge axis: saw teeth.
pub fn ridge(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    toothed(kind, input, 1.667, &[[0.5, 1.6], [1.0, 0.0]], drawing);
}

/// A reef: uneven teeth.
pub fn reef(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    toothed(kind, input, 3.333, &[[0.35, 3.33], [0.4, 2.0], [0.75, 4.5], [1.0, 0.0]], drawing);
}

/// A line of teeth: the corners of one by share of its stretch and text heights to the left.
fn toothed(
    kind: &GraphicKind,
    input: &GraphicInput<'_>,
    pitch_em: f64,
    corners: &[[f64; 2]],
    drawing: &mut GraphicDrawing,
) {
    let pitch_m = leg_pitch_m(input.points, pitch_em * input.em_m);
    let mut points = vec![input.points[0]];
    for leg in input.points.windows(2) {
        let Some(line) = Polyline::new(leg.iter().copied(), 0.0) else { continue };
        for base in bases(&line, pitch_m) {
            let left = base.left() * input.em_m;
            points.extend(corners.iter().map(|&[share, high]| base.at(share) + left * high));
        }
    }
    drawing.line(points);
    label(kind, input, drawing);
}

/// A severe squall line: dashes with a V between.
pub fn squall(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = line_of(kind, input) else { return };
    for base in bases(&line, 2.5 * input.em_m) {
        drawing.line(base.between(0.0, 0.667));
        let left = base.left() * (0.42 * input.em_m);
        drawing.line([base.at(0.667) + left, base.at(0.833) - left, base.at(1.0) + left]);
    }
    label(kind, input, drawing);
}

/// A convergence line: slanted ticks to both sides in turn.
pub fn convergence(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = line_of(kind, input) else { return };
    drawing.line(input.points);
    for (index, base) in bases(&line, 0.6 * input.em_m).enumerate() {
        let along = -base.left().perp();
        let side = if index % 2 == 0 { base.left() } else { -base.left() };
        drawing.line([base.at(0.5), base.at(0.5) + (along + side) * (0.42 * input.em_m)]);
    }
    label(kind, input, drawing);
}

/// Dashes of two colors in turn.
pub fn alternating(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = line_of(kind, input) else { return };
    for base in bases(&line, 2.4 * input.em_m) {
        drawing.line(base.between(0.07, 0.43));
        drawing.opposing(base.between(0.57, 0.93));
    }
    label(kind, input, drawing);
}

/// A jet stream or stream line: a curve with arrowheads toward its first point.
pub fn arrow(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let points = input.points;
    let curve = curved(points);
    for index in 0..points.len() - 1 {
        let at = index * CURVE_STEPS as usize;
        let toward = (curve[at] - curve[at + 1]).normalize_or_zero();
        drawing.line(arrowhead(curve[at], toward, 0.83 * input.em_m, 0.83 * input.em_m));
    }
    drawing.line(curve);
    label(kind, input, drawing);
}

/// A current: a curve with an arrowhead at its end; that of the flood is feathered.
pub fn current(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let curve = curved(input.points);
    let last = curve.len() - 1;
    let toward = (curve[last] - curve[last - 1]).normalize_or_zero();
    drawing.line(arrowhead(curve[last], toward, 0.85 * input.em_m, 0.83 * input.em_m));
    if kind.code == "120703"
        && let Some(line) = Polyline::new(curve.iter().copied(), 0.0)
    {
        for station in [2.2, 3.0].map(|em| em * input.em_m).into_iter().filter(|&at| at < line.length()) {
            let along = (line.at(station) - line.at(station - 1.0)).normalize_or_zero();
            let feather = turned(-along, FRAC_PI_4) * (1.2 * input.em_m);
            drawing.line([line.at(station), line.at(station) + feather]);
        }
    }
    drawing.line(curve);
    label(kind, input, drawing);
}

/// Arcs inside of an outline, or on the right of a line.
pub fn scallops(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    let arcs = |base: ToothBase<'_>| bulge(base.at(0.0), base.at(1.0), -0.5);
    drawing.line(bases(&line, 1.22 * input.em_m).flat_map(arcs).collect::<Vec<_>>());
    label(kind, input, drawing);
}

/// A limit of undercast: arcs on the left of a line.
pub fn bumps(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = line_of(kind, input) else { return };
    let arcs = |base: ToothBase<'_>| bulge(base.at(0.0), base.at(1.0), -0.5);
    drawing.line(bases(&line, 1.72 * input.em_m).flat_map(arcs).collect::<Vec<_>>());
    label(kind, input, drawing);
}

/// An area of icing: dashes with a tick inward.
pub fn icing(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = base_line(kind, input) else { return };
    for base in bases(&line, 1.25 * input.em_m) {
        drawing.line(base.between(0.1, 0.77));
        drawing.line([base.at(0.43), base.at(0.43) - base.left() * (0.42 * input.em_m)]);
    }
    label(kind, input, drawing);
}

/// A limit of visual observation, of S marks without a line; of radar, with crosses between them.
pub fn ticked(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let em_m = input.em_m;
    let is_radar = kind.code == "110503";
    let pitch_m = leg_pitch_m(input.points, if is_radar { 3.333 } else { 1.93 } * em_m);
    let legs = input.points.windows(2).filter_map(|leg| Polyline::new(leg.iter().copied(), 0.0));
    for leg in legs {
        let along = (leg.at(leg.length()) - leg.at(0.0)).normalize_or_zero();
        for number in 0..=(leg.length() / pitch_m) as u32 {
            let from = leg.at(f64::from(number) * pitch_m);
            let reach = along * (0.55 * em_m);
            let mut curl = bulge(from - reach, from, -0.4);
            curl.extend(bulge(from, from + reach, 0.4));
            drawing.line(curl);
            let middle_m = (f64::from(number) + 0.5) * pitch_m;
            if is_radar && middle_m < leg.length() {
                for arm in [along + along.perp(), along - along.perp()].map(|arm| arm * (0.42 * em_m)) {
                    drawing.line([leg.at(middle_m) - arm, leg.at(middle_m) + arm]);
                }
            }
        }
    }
    label(kind, input, drawing);
}

/// An edge of the ice from radar: a curve with crosses.
pub fn radar_edge(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let curve = curved(input.points);
    if let Some(line) = Polyline::new(curve.iter().copied(), 0.0) {
        for base in bases(&line, 3.0 * input.em_m) {
            for arm in [FRAC_PI_4, -FRAC_PI_4].map(|angle| turned(base.left(), angle) * (0.42 * input.em_m)) {
                drawing.line([base.at(0.5) - arm, base.at(0.5) + arm]);
            }
        }
    }
    drawing.line(curve);
    label(kind, input, drawing);
}

/// A crack at a known place: a curve with ticks across.
pub fn crack(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let curve = curved(input.points);
    if let Some(line) = Polyline::new(curve.iter().copied(), 0.0) {
        for base in bases(&line, 0.6 * input.em_m) {
            let half = base.left() * (0.42 * input.em_m);
            drawing.line([base.at(0.5) - half, base.at(0.5) + half]);
        }
    }
    drawing.line(curve);
    label(kind, input, drawing);
}

/// A lead: two curves side by side; with ticks between where it is frozen.
pub fn lead(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let half_m = 0.42 * input.em_m;
    let curve = curved(input.points);
    drawing.line(offset(&curve, half_m));
    drawing.line(offset(&curve, -half_m));
    if kind.code == "110604"
        && let Some(line) = Polyline::new(curve.iter().copied(), 0.0)
    {
        for base in bases(&line, 0.6 * input.em_m) {
            let half = base.left() * half_m;
            drawing.line([base.at(0.5) - half, base.at(0.5) + half]);
        }
    }
    label(kind, input, drawing);
}

/// An area of depth: three tints, each inside of the one before.
pub fn depth_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// How far one tint lies inside of another in text heights.
    const INSET_EM: f64 = 1.17;
    const TINTS: [[u8; 3]; 3] = [[30, 144, 255], [153, 204, 255], [255, 255, 255]];
    let Some(line) = base_line(kind, input) else { return };
    let mut ring = line.points().to_vec();
    ring.pop();
    let count = ring.len();
    // The ring with its neighbors at both ends, so that the offset is mitered at every corner.
    let wrapped: Vec<DVec2> = (0..count + 2).map(|index| ring[(index + count - 1) % count]).collect();
    for (step, tint) in TINTS.into_iter().enumerate() {
        let inset = offset(&wrapped, -INSET_EM * input.em_m * step as f64);
        let inset = inset[1..=count].to_vec();
        drawing.fill(inset.clone(), FillInk::Ground(tint));
        drawing.ring(inset);
    }
    label(kind, input, drawing);
}

/// An anchorage: half circles along a line or outline, on its right.
pub fn anchorage(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = line_of(kind, input) else { return };
    for base in bases(&line, 3.6 * input.em_m) {
        let share = (0.833 * input.em_m / base.length_m()).min(0.45);
        drawing.ring(bulge(base.at(0.5 - share), base.at(0.5 + share), -0.5));
    }
    label(kind, input, drawing);
}

/// A leading line: a curve, dashed in its second half.
pub fn leading_line(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if let Some(line) = Polyline::new(curved(input.points), 0.0) {
        let half = line.length() / 2.0;
        drawing.line(line.between(0.0, half));
        drawing.dashed(line.between(half, line.length()));
    }
    label(kind, input, drawing);
}

/// The limit of a restricted area: dashes with a tick on their right.
pub fn restricted(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = line_of(kind, input) else { return };
    for base in bases(&line, 1.25 * input.em_m) {
        drawing.line(base.between(0.0, 0.667));
        drawing.line([base.at(0.333), base.at(0.333) - base.left() * (0.83 * input.em_m)]);
    }
    label(kind, input, drawing);
}

/// A training area: dashed, with an exclamation mark in a circle.
pub fn training_area(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(ring) = closed(input.points) else { return };
    drawing.dashed(ring.points());
    let Some((at, _)) = inner_point([input.points], &bounds(input.points)) else { return };
    let up = input.up.normalize_or(DVec2::Y) * input.em_m;
    drawing.ring(circle(at, 1.67 * input.em_m));
    drawing.line([at + up, at]);
    drawing.line([at - up * 0.5, at - up * 0.75]);
    let below = at - up * 2.0;
    drawing.text_beside(input.fields.labeled(kind.label), below, -up.normalize_or_zero());
}

/// A pipeline: a line with beads.
pub fn pipeline(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = line_of(kind, input) else { return };
    drawing.line(input.points);
    for base in bases(&line, 1.67 * input.em_m) {
        drawing.filled(circle(base.at(0.5), 0.42 * input.em_m));
    }
    label(kind, input, drawing);
}
