//! Lines with texts: draw rules LINE1, LINE2, LINE7 and LINE21, and the boundary.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput, TextCourse};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{arrowhead, direction, gapped, text_m};
use sandtable_geom::polyline::Polyline;

/// How far the arrows of traffic are from the line in text heights: of one way, and of the other.
const BESIDE_EM: [f64; 2] = [0.83, 2.08];

/// The shortest leg with arrows of traffic in text heights.
const SHORTEST_EM: f64 = 6.0;

/// Sides of an arrowhead of traffic, in text heights.
const TRAFFIC_EM: [f64; 2] = [0.83, 0.42];

/// A line with its name at both ends (LINE2).
pub fn end_labeled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let points = input.points;
    if kind.code == "141200" {
        drawing.dashed(points);
    } else {
        drawing.line(points);
    }
    drawing.text_on(input.fields.named(kind.label), TextCourse::Ends(points.to_vec()));
    // The times stand under the line, near both ends.
    let times = input.fields.times();
    let half_m = text_m(&times, input.em_m) / 2.0;
    let last = points.len() - 1;
    for [end, inner] in [[0, 1], [last, last - 1]] {
        let inward = direction(points[end], points[inner]);
        let under = below(inward, input);
        let at = points[end] + inward * half_m.min(points[end].distance(points[inner]) / 2.0);
        drawing.text_beside(times.clone(), at + under * (0.5 * input.em_m), under);
    }
}

/// The normal of a direction that points down on the picture.
fn below(along: DVec2, input: &GraphicInput<'_>) -> DVec2 {
    let aside = along.perp();
    if aside.dot(input.up) > 0.0 { -aside } else { aside }
}

/// A navigational line (LINE4): a barb over its start and one under its end.
pub fn navigational(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// How far a barb reaches along the line and aside, in text heights.
    const BARB_EM: f64 = 0.83;
    let [from, to] = [input.points[0], input.points[1]];
    let along = direction(from, to);
    let barb = (along - below(along, input)) * (BARB_EM * input.em_m);
    drawing.line([from + barb, from, to, to - barb]);
}

/// A bearing line (LINE5): its letters in the middle, further text over it; of an ambiguous one dashed.
pub fn bearing(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if kind.code == "220104" {
        drawing.dashed(input.points);
    } else {
        drawing.line(input.points);
    }
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let middle = line.length() / 2.0;
    drawing.text(kind.label, line.at(middle));
    let points = input.points;
    let last = points.len() - 1;
    let outward = direction(points[last - 1], points[last]);
    drawing.text_beside(input.fields.further.clone(), points[last] + outward * (0.4 * input.em_m), outward);
}

/// A line with its letters in the middle of every leg.
pub fn segment_labeled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(input.points);
    for leg in input.points.windows(2) {
        let under = below(direction(leg[0], leg[1]), input);
        drawing.text_beside(kind.label, leg[0].midpoint(leg[1]) - under * (0.4 * input.em_m), -under);
    }
}

/// An overhead wire: a pylon at each of its points.
pub fn overhead_wire(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let up = input.up * input.em_m;
    let right = -input.up.normalize_or(DVec2::Y).perp() * input.em_m;
    /// A pylon's parts in text heights.
    const FRAME: [[f64; 2]; 5] = [[0.0, 0.42], [-0.42, 0.0], [0.0, 1.67], [0.42, 0.0], [0.0, 0.42]];
    const BAR: [[f64; 2]; 2] = [[-0.17, 0.83], [0.17, 0.83]];
    const ARMS: [[f64; 2]; 4] = [[-0.58, 1.42], [-0.42, 1.67], [0.42, 1.67], [0.58, 1.42]];
    const WIRE: [[f64; 2]; 2] = [[0.0, 1.67], [0.67, 1.0]];
    for &foot in input.points {
        let place = |[x, y]: [f64; 2]| foot + right * x + up * y;
        drawing.line(FRAME.map(place));
        drawing.line(BAR.map(place));
        drawing.line(ARMS.map(place));
        drawing.line(WIRE.map(place));
    }
    drawing.line(input.points);
    let [first, second] = [input.points[0], input.points[1]];
    drawing.text_beside(
        input.fields.heights.join("\u{2013}"),
        first.midpoint(second) + up * 0.4,
        up.normalize_or_zero(),
    );
}

/// The texts of LINE2, beyond the ends of a line that they cannot lie on.
pub fn label_ends(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let points = input.points;
    let last = points.len() - 1;
    let text = input.fields.labeled(kind.label);
    for [end, inner] in [[0, 1], [last, last - 1]] {
        let outward = direction(points[inner], points[end]);
        drawing.text_beside(text.clone(), points[end] + outward * (0.4 * input.em_m), outward);
    }
}

/// A line with its name once, near its middle (LINE7).
pub fn middle_labeled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    if kind.code == "260200" {
        drawing.dashed(input.points);
    } else {
        drawing.line(input.points);
    }
    drawing.text_on(input.fields.labeled(kind.label), TextCourse::Once(input.points.to_vec()));
}

/// A line with its name along it again and again (LINE21), and arrows of one-way traffic or both ways'.
pub fn route(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(input.points);
    let text = input.fields.labeled(kind.label);
    drawing.text_on(text, TextCourse::Repeated(input.points.to_vec()));
    let ways: &[f64] = match kind.code {
        "330301" | "330401" | "330501" => &[1.0],
        "330302" | "330402" => &[1.0, -1.0],
        "330303" | "330403" | "330502" => &[1.0],
        _ => return,
    };
    let alternates = matches!(kind.code, "330303" | "330403" | "330502");
    let [length, half] = TRAFFIC_EM.map(|size| size * input.em_m);
    // More arrows of one route would crowd a sheet: they are left out of its shortest legs.
    for leg in input.points.windows(2).filter(|leg| leg[0].distance(leg[1]) > SHORTEST_EM * input.em_m) {
        let (quarter, left) = ((leg[1] - leg[0]) / 4.0, direction(leg[0], leg[1]).perp() * input.em_m);
        for (beside, &way) in BESIDE_EM.into_iter().zip(ways) {
            let middle = leg[0].midpoint(leg[1]) + left * beside;
            let [tail, tip] = [middle - quarter * way, middle + quarter * way];
            drawing.line([tail, tip]);
            drawing.line(arrowhead(tip, direction(tail, tip), length, half));
            if alternates {
                drawing.line(arrowhead(tail, direction(tip, tail), length, half));
                drawing.text("ALT", middle + left * 0.7);
            }
        }
    }
}

/// An engineer work line: its letters at both ends, the units on both sides of its middle.
pub fn work_line(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(input.points);
    drawing.text_on(kind.label, TextCourse::Ends(input.points.to_vec()));
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let (em_m, middle) = (input.em_m, line.length() / 2.0);
    let along = direction(line.at(middle - em_m), line.at(middle + em_m));
    for (name, aside) in unit_names(input).into_iter().zip([along.perp(), -along.perp()]) {
        drawing.text_beside(name, line.at(middle) + aside * (0.6 * em_m), aside);
    }
}

/// The names of the units on the left and on the right of a line, with their country.
fn unit_names(input: &GraphicInput<'_>) -> [String; 2] {
    let fields = input.fields;
    [&fields.designation, &fields.designation_2].map(|name| {
        if fields.country.is_empty() || name.is_empty() {
            name.clone()
        } else {
            format!("{name} ({})", fields.country)
        }
    })
}

/// A boundary (LINE7): the echelon in a gap of the line and the texts on either side, on every leg that has the length for
/// them, at least on the longest.
pub fn boundary(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// The least length of a leg with texts of its own, in widths of the longest of them.
    const LEAST_WIDTHS: f64 = 3.0;
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let (fields, em_m) = (input.fields, input.em_m);
    let names = unit_names(input);
    let texts = [&names[0], &names[1], &fields.echelon];
    let widest_m = texts.iter().map(|text| text_m(text, em_m)).fold(4.0 * em_m, f64::max);
    let middles = labeled_legs(&line, LEAST_WIDTHS * widest_m);
    let gap_m =
        if fields.echelon.is_empty() { 0.0 } else { text_m(&fields.echelon, em_m) / 2.0 + 0.4 * em_m };
    let gaps: Vec<(f64, f64)> = middles.iter().map(|&middle| (middle, gap_m)).collect();
    gapped(&line, &gaps).into_iter().for_each(|piece| drawing.line(piece));
    let mut after_first = None;
    for middle in middles {
        drawing.text(fields.echelon.clone(), line.at(middle));
        let along = direction(line.at(middle - em_m), line.at(middle + em_m));
        for (name, aside) in names.iter().zip([along.perp(), -along.perp()]) {
            drawing.text_beside(name.clone(), line.at(middle) + aside * (0.6 * em_m), aside);
        }
        after_first.get_or_insert(drawing.texts.len());
    }
    drawing.yield_texts(after_first.unwrap_or_default());
}

/// The stations of the middles of legs at least so long, the longest first; of a line without such a leg its middle.
fn labeled_legs(line: &Polyline, least_m: f64) -> Vec<f64> {
    /// More texts of one line would crowd a sheet.
    const MOST_LABELS: usize = 64;
    let mut legs: Vec<[f64; 2]> = line.stations().windows(2).map(|leg| [leg[0], leg[1]]).collect();
    legs.retain(|leg| leg[1] - leg[0] >= least_m);
    legs.sort_by(|a, b| (b[1] - b[0]).total_cmp(&(a[1] - a[0])));
    let middles: Vec<f64> = legs.iter().map(|leg| leg[0].midpoint(leg[1])).take(MOST_LABELS).collect();
    if middles.is_empty() { vec![line.length() / 2.0] } else { middles }
}

/// The direction of attack (LINE1, from its tip): supporting, main, aviation and feint.
pub fn direction_of_attack(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// Length and half width of an arrowhead, of the main attack's and of aviation's, in text heights.
    const HEAD_EM: [f64; 2] = [2.08, 1.04];
    const MAIN_EM: [f64; 2] = [3.08, 1.54];
    const AVIATION_EM: [f64; 2] = [1.0, 0.5];
    let em_m = input.em_m;
    let mut shaft: Vec<DVec2> = input.points.iter().rev().copied().collect();
    let last = shaft.len() - 1;
    let (tip, toward) = (shaft[last], direction(shaft[last - 1], shaft[last]));
    let head = |size: [f64; 2], tip: DVec2| arrowhead(tip, toward, size[0] * em_m, size[1] * em_m);
    match kind.code {
        "140602" => {
            let outer = head(MAIN_EM, tip);
            shaft[last] = tip - toward * (HEAD_EM[1] * em_m);
            let inner = head(HEAD_EM, shaft[last]);
            drawing.ring([outer[0], outer[1], outer[2], inner[2], inner[1], inner[0]]);
        }
        "140601" => {
            drawing.line(head(AVIATION_EM, tip));
            // The bow tie stands in the middle of the last leg, in a gap of it.
            let middle = shaft[last - 1].midpoint(tip);
            let [half, high] = [1.04 * em_m, 0.5 * em_m];
            let [back, front] = [middle - toward * half, middle + toward * half];
            let aside = toward.perp() * high;
            drawing.ring([back + aside, front - aside, front + aside, back - aside]);
            shaft[last] = back;
            drawing.line([front, tip]);
        }
        _ => drawing.line(head(HEAD_EM, tip)),
    }
    drawing.line(shaft);
    if kind.code == "140605" {
        drawing.dashed(head(HEAD_EM.map(|size| 1.5 * size), tip + toward * (HEAD_EM[1] * em_m)));
    }
    let points = input.points;
    drawing.text_beside(
        input.fields.labeled(kind.label),
        points[points.len() - 1],
        -direction(points[points.len() - 1], points[points.len() - 2]),
    );
}
