//! Weather fronts: lines with the marks of cold and warm air.
//!
//! ```text
//!  cold ─▼──▼─   warm ─◗──◗─   occluded ─◗▼─◗▼─   stationary ─◖──▼──◖─
//! ```

use glam::DVec2;

use crate::graphic::drawing::{FillInk, GraphicDrawing, GraphicInput, StrokeDash, StrokeSide};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{bulge, circle, leg_pitch_m};
use crate::graphic::teeth::{ToothBase, bases};
use crate::graphic::weather::label;
use sandtable_geom::polyline::Polyline;

/// Half of the base of a front's triangle and the radius of its arcs, and how high a triangle is, in text heights.
const FRONT_EM: [f64; 2] = [0.833, 1.6];

/// From mark to mark of a front in text heights; of warm air, and from pair to pair of an occluded one.
const FRONT_PITCH_EM: f64 = 5.0;
const WARM_EM: f64 = 3.333;
const OCCLUDED_EM: f64 = 4.167;

/// A front: triangles of cold air, arcs of warm air, both of an occluded or stationary one. An upper one is not filled; one
/// that forms is dashed with dots between its marks, one that dissolves with bars.
pub fn front(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let number: u32 = kind.code[4..].parse().unwrap_or(1);
    // Cold, warm, occluded and stationary fronts, in four forms each; nothing forms an occluded front.
    let [family, form] = match number {
        1..=8 => [(number - 1) / 4, (number - 1) % 4],
        9..=11 => [2, [0, 1, 3][number as usize - 9]],
        _ => [3, (number - 12) % 4],
    };
    let em_m = input.em_m;
    let is_filled = form != 1;
    // Marks of an occluded front stand in pairs.
    let (pitch_em, in_pairs) = match (family, form) {
        (1, 0 | 1) => (WARM_EM, false),
        (2, 0 | 1) => (OCCLUDED_EM, true),
        _ => (FRONT_PITCH_EM, false),
    };
    let pitch_m = leg_pitch_m(input.points, pitch_em * em_m);
    let legs: Vec<Polyline> =
        input.points.windows(2).filter_map(|leg| Polyline::new(leg.iter().copied(), 0.0)).collect();
    let marks: Vec<ToothBase<'_>> = legs
        .iter()
        .flat_map(|leg| bases(leg, pitch_m))
        .flat_map(|base| if in_pairs { base.halves().to_vec() } else { vec![base] })
        .collect();
    let is_arc = |index: usize| match family {
        0 => false,
        1 => true,
        2 => index.is_multiple_of(2),
        _ => index % 3 != 2,
    };
    for (index, base) in marks.iter().enumerate() {
        let is_cold = family == 3 && !is_arc(index);
        let whose = if is_cold { StrokeSide::Opposing } else { StrokeSide::Own };
        let ink = if is_cold { FillInk::Opposing } else { FillInk::Own };
        // Cold air advances to the right of the line; warm air of a stationary front to its left.
        let side = if family == 3 && is_arc(index) { 1.0 } else { -1.0 };
        let ring = front_mark(base, is_arc(index), side, em_m);
        if is_filled {
            drawing.fill(ring.clone(), ink);
        }
        let outline = [ring.as_slice(), &ring[..1]].concat();
        drawing.stroke(outline, StrokeDash::Hatch, whose);
        let dash = if form >= 2 { StrokeDash::Dashed } else { StrokeDash::Status };
        drawing.stroke(base.between(0.0, 1.0), dash, whose);
        let between = base.at(0.06);
        match form {
            2 => drawing.fill(circle(between, 0.2 * em_m), ink),
            3 => {
                let bar = base.left() * (0.3 * em_m);
                drawing.stroke(vec![between - bar, between + bar], StrokeDash::Hatch, whose);
            }
            _ => {}
        }
    }
    label(kind, input, drawing);
}

/// The outline of a front's mark on a stretch.
fn front_mark(base: &ToothBase<'_>, is_arc: bool, side: f64, em_m: f64) -> Vec<DVec2> {
    let [half, high] = FRONT_EM.map(|size| size * em_m);
    let share = (half / base.length_m()).min(0.45);
    let [from, to] = [base.at(0.5 - share), base.at(0.5 + share)];
    if is_arc {
        bulge(from, to, 0.5 * side)
    } else {
        vec![from, base.at(0.5) + base.left() * (side * high), to]
    }
}
