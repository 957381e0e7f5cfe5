//! Axes of advance: draw rules AXIS1 and AXIS2.
//!
//! Points 1 to N-1 are the center line from the tip backward; point N is a corner of the arrowhead's base, or the width is
//! stated. Point N on the normal through the first leg gives the base of the head and its half width; the shaft is half as
//! wide as the head.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::letters::{CAPITAL, letter_lines};
use crate::graphic::plane::{arrowhead, direction, offset, turned};
use sandtable_geom::polyline::Polyline;

/// The half width of the shaft, as a share of that of the head.
const SHAFT: f64 = 0.5;

/// How far behind its tip a counterattack by fire has its apex and, at least, the base of its head, in text heights.
const BY_FIRE_EM: [f64; 2] = [3.75, 4.3];

/// The length of a head whose width is stated, in half widths.
const HEAD_LENGTH: f64 = 0.5;

/// The head of an axis: how far behind the tip its base is, and its half width, meters.
pub fn head_m(points: &[DVec2], width_m: Option<f64>) -> [f64; 2] {
    if let Some(width_m) = width_m {
        return [HEAD_LENGTH * width_m / 2.0, width_m / 2.0];
    }
    let corner = points[points.len() - 1] - points[0];
    let toward = direction(points[1], points[0]);
    [-corner.dot(toward), toward.perp_dot(corner).abs()]
}

/// The points of the center line: all but the last, where that gives the width.
pub fn center_line(points: &[DVec2], width_m: Option<f64>) -> &[DVec2] {
    if width_m.is_some() { points } else { &points[..points.len() - 1] }
}

/// The parts of an axis of advance.
struct AxisPlan {
    /// The center line from the tip backward.
    center: Vec<DVec2>,
    /// From the rear to the tip, of length 1.
    toward: DVec2,
    /// The middle of the head's base.
    base: DVec2,
    /// The foremost point of the head.
    apex: DVec2,
    /// The half width of the head.
    half_m: f64,
}

impl AxisPlan {
    fn new(kind: &GraphicKind, input: &GraphicInput<'_>) -> Self {
        let center = center_line(input.points, input.width_m).to_vec();
        let [length_m, half_m] = head_m(input.points, input.width_m);
        let (tip, toward) = (center[0], direction(center[1], center[0]));
        // By fire: the head keeps clear of the arrow before it.
        let reach_m = BY_FIRE_EM.map(|em| (em * input.em_m).min(0.5 * tip.distance(center[1])));
        let [head, apex] =
            if kind.code == "340700" { [length_m.max(reach_m[1]), reach_m[0]] } else { [length_m, 0.0] };
        Self { base: tip - toward * head, apex: tip - toward * apex, toward, half_m, center }
    }

    fn tip(&self) -> DVec2 {
        self.center[0]
    }

    /// A place at a distance along the axis from another, and to the left of it.
    fn from(&self, at: DVec2, far: f64, aside: f64) -> DVec2 {
        at + self.toward * far + self.toward.perp() * aside
    }
}

/// An axis of advance.
pub fn axis(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let plan = AxisPlan::new(kind, input);
    let AxisPlan { base, apex, toward, half_m, .. } = plan;
    // From the base of the head backward, so that its left is on the left of the attack's rear.
    let shaft: Vec<DVec2> = std::iter::once(base).chain(plan.center[1..].iter().copied()).collect();
    let mut sides = [1.0, -1.0].map(|side: f64| offset(&shaft, -side * SHAFT * half_m));
    let wings = [1.0, -1.0].map(|side| base + toward.perp() * (side * half_m));
    let is_crossed = matches!(kind.code, "151401" | "151402");
    let is_dashed = matches!(kind.code, "340600" | "340700");
    let mut line = |points: Vec<DVec2>| if is_dashed { drawing.dashed(points) } else { drawing.line(points) };
    if is_crossed {
        let ends = [sides[0][0], sides[1][0]];
        (sides[0][0], sides[1][0]) = (ends[1], ends[0]);
        let [left, right] = ends;
        line(vec![left, wings[0], apex, wings[1], right]);
    } else if kind.code == "151403" {
        line(vec![apex, wings[0], wings[1], apex]);
    } else {
        line(vec![sides[0][0], wings[0], apex, wings[1], sides[1][0]]);
    }
    sides.iter().for_each(|side| line(side.clone()));
    match kind.code {
        "151406" => {
            let ahead = plan.from(plan.tip(), 0.5 * plan.tip().distance(base), 0.0);
            let wing = |side: f64| plan.from(base, 0.0, side * 1.5 * half_m);
            drawing.dashed([wing(1.0), ahead, wing(-1.0)]);
        }
        "151402" => rotor(base.midpoint(plan.center[1]), toward, half_m, drawing),
        "340700" => by_fire(&plan, input, drawing),
        "152700" => frontal(&plan, drawing),
        "152900" => turning(&plan, drawing),
        "342900" => contact(&plan, drawing),
        _ => {}
    }
    // Inside the shaft.
    if let Some(line) = Polyline::new(plan.center.iter().copied(), 0.0) {
        let station = line.length() * if is_crossed { 0.75 } else { 0.55 };
        drawing.text(input.fields.labeled(kind.label), line.at(station));
    }
}

/// Counterattack by fire: a position of fire before the head, and its arrow.
fn by_fire(plan: &AxisPlan, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let tip = plan.tip();
    let unit_m = plan.apex.distance(tip) / BY_FIRE_EM[0];
    let half_m = SHAFT * plan.half_m + 0.42 * unit_m;
    let bar = |far: f64, aside: f64| plan.from(tip, far * unit_m, aside);
    drawing.dashed([
        bar(-3.33, half_m + 0.83 * unit_m),
        bar(-2.5, half_m),
        bar(-2.5, -half_m),
        bar(-3.33, -half_m - 0.83 * unit_m),
    ]);
    drawing.dashed([bar(-2.5, 0.0), tip]);
    drawing.line(arrowhead(tip, plan.toward, 1.25 * unit_m.min(input.em_m), 0.625 * unit_m.min(input.em_m)));
}

/// A frontal attack: a bar across the tip, and an A in the head.
fn frontal(plan: &AxisPlan, drawing: &mut GraphicDrawing) {
    let bar = |side: f64| plan.from(plan.tip(), 0.0, side * plan.half_m);
    drawing.line([bar(1.0), bar(-1.0)]);
    head_letter("A", plan, drawing);
}

/// A turning movement: a bar across the last leg, and a T in the head.
fn turning(plan: &AxisPlan, drawing: &mut GraphicDrawing) {
    let last = plan.center.len() - 1;
    let [rear, before] = [plan.center[last], plan.center[last - 1]];
    let across = direction(rear, before).perp() * plan.half_m;
    let middle = rear.midpoint(before);
    drawing.line([middle + across, middle - across]);
    head_letter("T", plan, drawing);
}

/// A letter in the head, upright as seen from the right of the attack, as high as the shaft is wide.
fn head_letter(letter: &str, plan: &AxisPlan, drawing: &mut GraphicDrawing) {
    let middle = plan.base.lerp(plan.apex, 0.25);
    let high_m = 2.0 * SHAFT * plan.half_m;
    let wide = (0.5 * plan.base.distance(plan.apex) / high_m).min(0.8);
    for line in letter_lines(letter, high_m / CAPITAL) {
        let turned = line.into_iter().map(|at| plan.from(middle, at.x * wide, at.y));
        drawing.line(turned.collect::<Vec<_>>());
    }
}

/// A movement to contact: two lightning arrows that spread from the head.
fn contact(plan: &AxisPlan, drawing: &mut GraphicDrawing) {
    /// Corners of an arrow ahead of the tip and aside, and a leg of its head, in half widths.
    const CORNERS: [[f64; 2]; 4] = [[-0.02, 0.6], [0.917, 1.204], [0.818, 0.908], [1.76, 1.507]];
    const HEAD: f64 = 0.155;
    for side in [1.0, -1.0] {
        let arrow =
            CORNERS.map(|[far, aside]| plan.from(plan.tip(), far * plan.half_m, side * aside * plan.half_m));
        let toward = direction(arrow[2], arrow[3]);
        let length_m = HEAD * plan.half_m;
        drawing.filled(arrowhead(arrow[3], toward, length_m, 0.6 * length_m));
        drawing.line(arrow);
    }
}

/// The mark of attack helicopters where the sides of the shaft cross: an arrow through a bow tie.
fn rotor(middle: DVec2, toward: DVec2, half_m: f64, drawing: &mut GraphicDrawing) {
    let up = toward.perp();
    drawing.line([middle - up * half_m, middle + up * half_m]);
    let tip = middle + up * half_m;
    let barb = |side: f64| tip - up * (0.5 * half_m) + toward * (side * 0.25 * half_m);
    drawing.line([barb(1.0), tip, barb(-1.0)]);
    let foot = middle - up * half_m;
    drawing.line([foot - toward * (0.25 * half_m), foot + toward * (0.25 * half_m)]);
}

/// The zigzag and the arrow of fix (LINE9, LINE28): tip and rear.
pub fn fix(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, rear] = [input.points[0], input.points[1]];
    let (along, length_m) = (direction(rear, tip), rear.distance(tip));
    let at = |far: f64, aside: f64| rear + (along * far + along.perp() * aside) * length_m;
    /// Lead, half period and amplitude as shares of the length; corners of the zigzag.
    const LEAD: f64 = 1.0 / 15.0;
    const HALF: f64 = 2.0 / 45.0;
    const CORNERS: u32 = 19;
    let corner = |step: u32| {
        let side = if step.is_multiple_of(2) { -LEAD } else { LEAD };
        at(LEAD + HALF * (f64::from(step) + 0.5), side)
    };
    let mut line = vec![rear, at(LEAD, 0.0)];
    line.extend((0..CORNERS).map(corner));
    line.extend([at(LEAD + HALF * f64::from(CORNERS), 0.0), tip]);
    drawing.line(line);
    let barb = 0.063 * length_m;
    let barbs = [1.0, -1.0].map(|side| tip - turned(along, side * std::f64::consts::FRAC_PI_4) * barb);
    if kind.label.is_empty() {
        drawing.filled([barbs[0], tip, barbs[1]]);
    } else {
        drawing.line([barbs[0], tip, barbs[1]]);
        drawing.text(kind.label, at(LEAD / 2.0, 0.0));
    }
}
