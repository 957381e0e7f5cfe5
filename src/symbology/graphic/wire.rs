//! Wire obstacles: crosses on a line, or loops of concertina.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{offset, turned};
use sandtable_geom::polyline::Polyline;

/// From cross to cross in text heights.
const PITCH_EM: f64 = 1.667;

/// From cross to cross of a fence around an area.
const FENCE_EM: f64 = 0.833;

/// Half of a cross's arms, and the half height and half width of a loop, in text heights.
const ARM_EM: f64 = 0.62;
const LOOP_EM: [f64; 2] = [0.6, 0.34];

/// The most marks on a line; they are farther apart on a longer one.
const MOST_MARKS: f64 = 2000.0;

/// Sides of a loop.
const LOOP_SIDES: u32 = 16;

/// Adds the crosses of a fence along a line.
pub fn crosses(line: &Polyline, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let em_m = input.em_m;
    let count = (line.length() / (FENCE_EM * em_m)).floor().clamp(1.0, MOST_MARKS);
    let pitch_m = line.length() / count;
    for number in 0..count as u32 {
        let (station, half) = ((f64::from(number) + 0.5) * pitch_m, 0.25 * em_m);
        let along = (line.at(station + half) - line.at(station - half)).normalize_or_zero();
        cross(line.at(station), along, em_m, drawing);
    }
}

/// Adds one cross.
fn cross(at: DVec2, along: DVec2, em_m: f64, drawing: &mut GraphicDrawing) {
    let [rising, falling] = [along + along.perp(), along - along.perp()];
    for arm in [rising, falling].map(|arm| arm * (ARM_EM * em_m)) {
        drawing.line([at - arm, at + arm]);
    }
}

/// A fence or a roll of wire: which lines run along it, which marks it has, and where they are.
pub fn wire(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let em_m = input.em_m;
    // The lines along it, in text heights beside it; and its marks, by their places in a period of so many pitches.
    const EVERY: (f64, &[f64]) = (1.0, &[0.5]);
    let (lines, (period, marks), is_loop): (&[f64], (f64, &[f64]), bool) = match kind.code {
        "290301" => (&[], EVERY, false),
        "290302" => (&[0.0], (3.5, &[0.5]), false),
        "290303" => (&[0.0], (5.0, &[0.5, 1.5]), false),
        "290305" => (&[-0.62], EVERY, false),
        "290306" => (&[-0.62, 0.62], EVERY, false),
        "290307" => (&[0.0], EVERY, true),
        "290308" => (&[-0.31, 0.31], EVERY, true),
        "290309" => (&[-0.5, 0.0, 0.5], EVERY, true),
        _ => (&[0.0], EVERY, false),
    };
    lines.iter().for_each(|&aside| drawing.line(offset(line.points(), aside * em_m)));
    let period_m = period * PITCH_EM * em_m;
    let count = (line.length() / period_m).floor().clamp(1.0, MOST_MARKS);
    let pitch_m = line.length() / (count * period);
    let numbers = 0..count as u32;
    let stations = numbers
        .flat_map(|number| marks.iter().map(move |mark| (f64::from(number) * period + mark) * pitch_m));
    for station in stations {
        let (at, half) = (line.at(station), 0.25 * em_m);
        let along = (line.at(station + half) - line.at(station - half)).normalize_or_zero();
        if is_loop {
            let corner = |step: u32| {
                let angle = std::f64::consts::TAU * f64::from(step) / f64::from(LOOP_SIDES);
                let on_circle = turned(DVec2::X, angle);
                at + along.perp() * (on_circle.x * LOOP_EM[0] * em_m)
                    + along * (on_circle.y * LOOP_EM[1] * em_m)
            };
            drawing.ring((0..LOOP_SIDES).map(corner).collect::<Vec<_>>());
        } else {
            cross(at, along, em_m, drawing);
        }
    }
}
