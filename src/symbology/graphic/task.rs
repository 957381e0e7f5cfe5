//! Mission tasks and obstacle effects: figures of a fixed number of points, with a letter.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{arc, arrowhead, bulge, circle, direction, gapped, text_m, turned};
use sandtable_geom::polyline::Polyline;

/// Length and half width of an open arrowhead, in text heights.
const HEAD_EM: [f64; 2] = [1.5, 0.9];

/// The barbs of breach, bypass and canalize in text heights.
const BARB_EM: f64 = 1.667;

/// Adds an open arrowhead of the usual size.
fn head(tip: DVec2, toward: DVec2, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(arrowhead(tip, toward, HEAD_EM[0] * input.em_m, HEAD_EM[1] * input.em_m));
}

/// Adds a line with the letter of a kind in a gap at a share of its length.
pub fn lettered(
    points: &[DVec2],
    share: f64,
    kind: &GraphicKind,
    input: &GraphicInput<'_>,
    drawing: &mut GraphicDrawing,
) {
    let Some(line) = Polyline::new(points.iter().copied(), 0.0) else { return };
    let half_m =
        if kind.label.is_empty() { 0.0 } else { text_m(kind.label, input.em_m) / 2.0 + 0.35 * input.em_m };
    let at = share * line.length();
    gapped(&line, &[(at, half_m)]).into_iter().for_each(|piece| drawing.line(piece));
    drawing.text(kind.label, line.at(at));
}

/// Block (AREA11, AREA24): a T of two ends and the end of the stem.
pub fn block(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [a, b, stem] = [input.points[0], input.points[1], input.points[2]];
    drawing.line([a, b]);
    lettered(&[a.midpoint(b), stem], 0.5, kind, input, drawing);
}

/// Penetrate (AREA17): an arrow to a line; clear (LINE23): three.
pub fn arrows_to_line(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [a, b, rear] = [input.points[0], input.points[1], input.points[2]];
    let middle = a.midpoint(b);
    drawing.line([a, b]);
    lettered(&[middle, rear], 0.5, kind, input, drawing);
    let toward = direction(rear, middle);
    head(middle, toward, input, drawing);
    if kind.code == "340500" {
        for tip in [a.lerp(b, 0.25), a.lerp(b, 0.75)] {
            drawing.line([tip, tip + (rear - middle)]);
            head(tip, toward, input, drawing);
        }
    }
}

/// Breach (LINE22), bypass and canalize (POINT12): a bracket with an opening between points 1 and 2.
pub fn bracket(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [a, b, back] = [input.points[0], input.points[1], input.points[2]];
    let depth = back - a.midpoint(b);
    drawing.line([b, b + depth]);
    drawing.line([a, a + depth]);
    match kind.code {
        "270602" => drawing.line(zigzag(b + depth, a + depth, input)),
        "270603" => {
            // Two bars across a gap of the back.
            let (middle, along) = (back, direction(b, a) * (0.69 * input.em_m));
            let bar = depth.normalize_or_zero() * (0.69 * input.em_m);
            for (end, side) in [(b + depth, -1.0), (a + depth, 1.0)] {
                drawing.line([end, middle + along * side]);
                drawing.line([middle + along * side - bar, middle + along * side + bar]);
            }
        }
        _ => lettered(&[b + depth, a + depth], 0.5, kind, input, drawing),
    }
    let inward = depth.normalize_or_zero() * (BARB_EM * input.em_m);
    // Which way point 1 lies as seen along the depth.
    let side = depth.perp_dot(a - b).signum();
    for (end, side) in [(a, side), (b, -side)] {
        let slash = |angle: f64| turned(inward, side * angle);
        match kind.code {
            "340200" => drawing.line([end + slash(FRAC_PI_4), end - slash(FRAC_PI_4)]),
            "340400" => drawing.line([end + slash(-FRAC_PI_4), end - slash(-FRAC_PI_4)]),
            _ => drawing.line([end + slash(FRAC_PI_4), end, end + slash(-FRAC_PI_4)]),
        }
    }
}

/// A zigzag along a line.
fn zigzag(from: DVec2, to: DVec2, input: &GraphicInput<'_>) -> Vec<DVec2> {
    /// From corner to corner, and how far they are aside, in text heights.
    const ZIGZAG_EM: [f64; 2] = [0.74, 1.11];
    let count = (from.distance(to) / (ZIGZAG_EM[0] * input.em_m)).floor().clamp(2.0, 400.0);
    let aside = direction(from, to).perp() * (ZIGZAG_EM[1] * input.em_m);
    let corner = |step: u32| {
        let side = if step.is_multiple_of(2) { 1.0 } else { -1.0 };
        from.lerp(to, (f64::from(step) + 0.5) / count) + aside * side
    };
    let mut line = vec![from];
    line.extend((0..count as u32).map(corner));
    line.push(to);
    line
}

/// Disrupt as an obstacle's effect (AREA12) and as a task (AREA25): two ends of the back line and the tip of the longest of
/// three arrows.
pub fn disrupt(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [a, b, tip] = [input.points[0], input.points[1], input.points[2]];
    let (is_effect, middle) = (kind.label.is_empty(), a.midpoint(b));
    // The effect's longest arrow begins at point 1, the task's at point 2.
    let [long, short] = if is_effect { [a, b] } else { [b, a] };
    let reach = tip - long;
    let toward = reach.normalize_or_zero();
    drawing.line([a, b]);
    let shafts = [[long, tip], [middle - reach * 0.2, middle + reach * 0.8], [short, short + reach * 0.6]];
    let length_m = 0.16 * a.distance(b);
    for (index, [from, to]) in shafts.into_iter().enumerate() {
        if index == 0 {
            lettered(&[from, to], 0.36, kind, input, drawing)
        } else {
            drawing.line([from, to])
        }
        let barbs = arrowhead(to, toward, length_m, 0.6 * length_m);
        if is_effect { drawing.filled(barbs) } else { drawing.line(barbs) }
    }
}

/// Turn (LINE10): a quarter of a circle from the rear to the tip, on the side of point 3.
pub fn turn(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, rear, side] = [input.points[0], input.points[1], input.points[2]];
    /// The sagitta of a quarter of a circle in chords.
    const QUARTER: f64 = 0.207_106_781_186_547_5;
    let way = if (tip - rear).perp_dot(side - rear) > 0.0 { QUARTER } else { -QUARTER };
    let curve = bulge(rear, tip, way);
    let toward = direction(curve[curve.len() - 2], tip);
    let [length, half] = [1.2 * input.em_m, 0.7 * input.em_m];
    drawing.filled(arrowhead(tip, toward, length, half));
    lettered(&curve, 0.5, kind, input, drawing);
}

/// Delay, withdraw and retire (LINE24): an arrow with its tip at point 1 and a half circle from point 2 to point 3.
pub fn delay(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, turn] = [input.points[0], input.points[1]];
    /// The half circle's width in lengths of the arrow where no point 3 says it (2525E), on the arrow's left.
    const BOW: f64 = 0.3;
    let end = input.points.get(2).copied().unwrap_or(turn + (tip - turn).perp() * BOW);
    lettered(&[turn, tip], 0.5, kind, input, drawing);
    let toward = direction(turn, tip);
    drawing.line(arrowhead(tip, toward, 1.5 * input.em_m, 1.2 * input.em_m));
    // The half circle goes on where the line ends, toward the side of point 3.
    let way = if toward.perp_dot(end - turn) > 0.0 { 1.0 } else { -1.0 };
    let radius = toward.perp() * (way * turn.distance(end) / 2.0);
    drawing.line(arc(turn + radius, -radius, -way * PI));
    let below = (turn - tip).perp().normalize_or_zero() * way;
    drawing.text_beside(input.fields.times(), turn.lerp(tip, 0.3) + below * input.em_m, below);
}

/// Isolate, area defense and cordons (AREA15), occupy (AREA16), retain (AREA6) and secure (AREA19): a circle about point 1 that begins at point 2 and
/// runs clockwise almost to itself.
pub fn circle_task(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [center, start] = [input.points[0], input.points[1]];
    let radius = start - center;
    /// What is left of the circle, in radians: as much as the arrowhead needs.
    const OPEN_RAD: f64 = 0.384;
    let is_toothed = matches!(kind.code, "341500" | "152600" | "342600" | "342700");
    let open = if is_toothed { PI / 6.0 } else { OPEN_RAD };
    let curve = arc(center, radius, open - 2.0 * PI);
    let end = curve[curve.len() - 1];
    // Clockwise: to the right of the radius.
    let toward = -(end - center).perp().normalize_or_zero();
    match kind.code {
        "341700" => {
            let arm = BARB_EM * input.em_m;
            for angle in [FRAC_PI_4, -FRAC_PI_4] {
                let arm = turned(toward, angle) * arm;
                drawing.line([end - arm, end + arm]);
            }
        }
        _ => head(end, toward, input, drawing),
    }
    if is_toothed || kind.code == "151205" {
        /// The parts of the circle: of isolate every third has a tooth inward, of retain each a tick outward.
        const PARTS: u32 = 25;
        const TOOTH: f64 = 0.2;
        const DEFENSE_TOOTH: f64 = 0.25;
        let at = |part: u32| turned(radius, (open - 2.0 * PI) * f64::from(part) / f64::from(PARTS));
        for part in 1..PARTS - 1 {
            if is_toothed && part.is_multiple_of(3) {
                let share = if kind.code == "152600" { 1.0 + DEFENSE_TOOTH } else { 1.0 - TOOTH };
                let tooth = [center + at(part - 1), center + at(part) * share, center + at(part + 1)];
                if kind.code == "152600" { drawing.filled(tooth) } else { drawing.line(tooth) }
            } else if kind.code == "151205" {
                let tick = at(part).normalize_or_zero() * (BARB_EM * input.em_m);
                drawing.line([center + at(part), center + at(part) + tick]);
            }
        }
    }
    lettered(&curve, 0.5, kind, input, drawing);
}

/// Cover, guard and screen (LINE26): two lightning arrows from point 1 to points 2 and 3, or from points 2 and 3 to 1 and 4.
pub fn screen(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    // Two arrows from one place, or (2525E) each from a place of its own.
    let arrows = match *input.points {
        [first, from, other, last] => [[from, first], [other, last]],
        [center, first, last, ..] => [[center, first], [center, last]],
        _ => return,
    };
    let is_split = input.points.len() > 3;
    let tips = arrows.map(|[_, tip]| tip);
    let middle = arrows[0][0].midpoint(arrows[1][0]);
    /// The gap at the center in text heights, and half of the jag as a share of the first arrow.
    const GAP_EM: f64 = 2.5;
    const JAG: f64 = 0.0472;
    let away = middle - tips[0].midpoint(tips[1]);
    let jag_m = JAG * arrows[0][0].distance(tips[0]);
    for [center, tip] in arrows {
        let (along, length_m) = (direction(center, tip), center.distance(tip));
        let gap_m = if is_split { 0.0 } else { (GAP_EM * input.em_m).min(length_m / 4.0) };
        let side = if along.perp().dot(away) < 0.0 { -along.perp() } else { along.perp() };
        let middle = center + along * (length_m + gap_m) / 2.0;
        let jag = |way: f64| middle + (along * way + side * way) * jag_m;
        drawing.line([center + along * gap_m, jag(1.0), jag(-1.0), tip]);
        drawing.line(arrowhead(tip, along, jag_m, jag_m));
        drawing.text(kind.label, center + along * (gap_m - 0.75 * input.em_m));
    }
}

/// Seize (LINE27): a circle about point 1 through point 2 and an arc from it to the last point, on the side of point 3.
pub fn seize(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let points = input.points;
    let [center, side, tip] = [points[0], points[2], points[points.len() - 1]];
    let radius_m = center.distance(points[1]);
    let toward = direction(center, tip);
    let way = if toward.perp_dot(side - center) < 0.0 { -1.0 } else { 1.0 };
    /// The arc leaves the circle so far from the straight way; its sagitta in chords.
    const LEAVES_RAD: f64 = 0.64;
    const SAGITTA: f64 = 1.0 / 6.0;
    drawing.ring(circle(center, radius_m));
    let from = center + turned(toward, way * LEAVES_RAD) * radius_m;
    let curve = bulge(from, tip, way * SAGITTA);
    let barb = 0.5 * radius_m;
    drawing.line(arrowhead(tip, direction(curve[curve.len() - 2], tip), barb, barb));
    lettered(&curve, 0.5, kind, input, drawing);
}

/// Attack by fire (AREA7): an arrow from the middle of a back line with flanges; support by fire (AREA8): from both ends.
pub fn by_fire(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let points = input.points;
    let is_support = kind.code == "152100";
    let [a, b] = if is_support { [points[0], points[1]] } else { [points[1], points[2]] };
    let shafts =
        if is_support { vec![[a, points[2]], [b, points[3]]] } else { vec![[a.midpoint(b), points[0]]] };
    let front = shafts.iter().map(|shaft| shaft[1]).sum::<DVec2>() / shafts.len() as f64;
    drawing.line([a, b]);
    let back = (b - a).perp().normalize_or_zero();
    let back = if back.dot(front - a.midpoint(b)) > 0.0 { -back } else { back };
    let flange_m = a.distance(b) * if is_support { 0.2 } else { 0.25 };
    for (end, outward) in [(a, direction(b, a)), (b, direction(a, b))] {
        drawing.line([end, end + (outward + back) * (std::f64::consts::FRAC_1_SQRT_2 * flange_m)]);
    }
    for [from, tip] in shafts {
        drawing.line([from, tip]);
        head(tip, direction(from, tip), input, drawing);
    }
    let text = input.fields.labeled("{}");
    drawing.text_beside(text, a.midpoint(b) + back * (0.5 * input.em_m), back);
}

/// Ambush (LINE29): an arrow from the middle of an arc between points 2 and 3, with ticks behind the arc.
pub fn ambush(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, a, b] = [input.points[0], input.points[1], input.points[2]];
    /// The arc's sagitta and the length of a tick, in chords, and the number of ticks.
    const SAGITTA: f64 = 0.198;
    const TICK: f64 = 0.236;
    const TICKS: usize = 8;
    let way = if (b - a).perp_dot(tip - a) > 0.0 { SAGITTA } else { -SAGITTA };
    let curve = bulge(a, b, way);
    let Some(line) = Polyline::new(curve.iter().copied(), 0.0) else { return };
    let back = (b - a).perp() * -way.signum() * TICK;
    for tick in 0..TICKS {
        let at = line.at(line.length() * (tick as f64 + 0.95) / (TICKS as f64 + 0.85));
        drawing.line([at, at + back]);
    }
    let middle = line.at(line.length() / 2.0);
    drawing.line([middle, tip]);
    head(tip, direction(middle, tip), input, drawing);
    drawing.line(curve);
}

/// Follow and assume, follow and support (LINE25): an arrow from point 2 to its tip at point 1.
pub fn follow(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [tip, rear] = [input.points[0], input.points[1]];
    let (along, em_m) = (direction(rear, tip), input.em_m);
    let before_tip = |[far, aside]: [f64; 2]| tip - (along * far + along.perp() * aside) * em_m;
    let after_rear = |[far, aside]: [f64; 2]| rear + (along * far + along.perp() * aside) * em_m;
    let (from, to) = if kind.code == "341300" {
        let head = [[1.75, 0.875], [0.0, 0.0], [1.75, -0.875]];
        drawing.filled(head.map(before_tip));
        let tail = [[0.0, 0.875], [2.375, 0.875], [4.07, 0.0], [2.375, -0.875], [0.0, -0.875], [1.69, 0.0]];
        drawing.ring(tail.map(after_rear));
        (after_rear([4.07, 0.0]), before_tip([1.75, 0.0]))
    } else {
        let head = [[1.25, 0.625], [0.0, 0.0], [1.25, -0.625], [2.18, -0.625], [0.93, 0.0], [2.18, 0.625]];
        drawing.ring(head.map(before_tip));
        let tail = [[0.0, 0.625], [1.25, 0.625], [2.5, 0.0], [1.25, -0.625], [0.0, -0.625]];
        drawing.ring(tail.map(after_rear));
        (after_rear([2.5, 0.0]), before_tip([0.93, 0.0]))
    };
    drawing.line([from, to]);
    let aside = along.perp();
    drawing.text_beside(input.fields.labeled("{}"), rear.midpoint(tip) + aside * (0.5 * em_m), aside);
}

/// Contain (AREA5): a half circle over points 1 and 2 with teeth inward, and an arrow to its center from point 3.
pub fn contain(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [a, b, rear] = [input.points[0], input.points[1], input.points[2]];
    let center = a.midpoint(b);
    // The half circle is on the side away from point 3.
    let way = if (b - a).perp_dot(rear - a) > 0.0 { 1.0 } else { -1.0 };
    drawing.line(arc(center, a - center, way * PI));
    for tooth in 0..9 {
        let radius = turned(a - center, way * PI * f64::from(tooth) / 8.0);
        drawing.line([center + radius, center + radius / 2.0]);
    }
    lettered(&[rear, center], 0.5, kind, input, drawing);
    // What is contained is the enemy, whoever contains it.
    drawing.text("ENY", center + direction(rear, center) * (0.3 * a.distance(center)));
    head(center, direction(rear, center), input, drawing);
}
