//! Lines with texts: draw rules LINE1, LINE2, LINE7 and LINE21, and the boundary.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput, TextCourse};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{arrowhead, direction, gapped, text_m};
use sandtable_geom::polyline::Polyline;

/// From arrow to arrow of traffic, in widths of the route's name.
const ARROW_EVERY: f64 = 6.0;

/// Sides of an arrowhead of traffic, in text heights.
const TRAFFIC_EM: [f64; 2] = [0.8, 0.5];

/// A line with its name at both ends (LINE2).
pub fn end_labeled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(input.points);
    drawing.text_on(input.fields.labeled(kind.label), TextCourse::Ends(input.points.to_vec()));
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
    drawing.line(input.points);
    drawing.text_on(input.fields.labeled(kind.label), TextCourse::Once(input.points.to_vec()));
}

/// A line with its name along it again and again (LINE21), and arrows of one-way traffic or both ways'.
pub fn route(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    drawing.line(input.points);
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let text = input.fields.labeled(kind.label);
    let every_m = (ARROW_EVERY * text_m(&text, input.em_m)).max(line.length() / 64.0);
    drawing.text_on(text, TextCourse::Repeated(input.points.to_vec()));
    let ways: &[f64] = match kind.code {
        "330301" | "330401" => &[1.0],
        "330302" | "330402" => &[1.0, -1.0],
        _ => return,
    };
    let count = (line.length() / every_m).floor().max(1.0);
    let half_m = 2.5 * input.em_m;
    for number in 0..count as u32 {
        let station = line.length() * (f64::from(number) + 0.5) / count;
        if !(half_m..=line.length() - half_m).contains(&station) {
            continue;
        }
        for (place, &way) in ways.iter().enumerate() {
            let along = direction(line.at(station - half_m), line.at(station + half_m)) * way;
            let aside = -(along * way).perp() * input.em_m * (0.9 + 0.7 * place as f64);
            let tip = line.at(station + way * half_m) + aside;
            drawing.line([line.at(station - way * half_m) + aside, tip]);
            let [length, half] = TRAFFIC_EM.map(|size| size * input.em_m);
            drawing.line(arrowhead(tip, along, length, half));
        }
    }
}

/// A boundary (LINE7): the echelon in a gap of the line, and the texts on either side.
pub fn boundary(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let (fields, em_m, middle) = (input.fields, input.em_m, line.length() / 2.0);
    let gap_m =
        if fields.echelon.is_empty() { 0.0 } else { text_m(&fields.echelon, em_m) / 2.0 + 0.4 * em_m };
    gapped(&line, &[(middle, gap_m)]).into_iter().for_each(|piece| drawing.line(piece));
    drawing.text(fields.echelon.clone(), line.at(middle));
    let along = direction(line.at(middle - em_m), line.at(middle + em_m));
    let sides = [(&fields.designation, along.perp()), (&fields.designation_2, -along.perp())];
    for (name, aside) in sides {
        let text = if fields.country.is_empty() || name.is_empty() {
            name.clone()
        } else {
            format!("{name} ({})", fields.country)
        };
        drawing.text_beside(text, line.at(middle) + aside * (0.6 * em_m), aside);
    }
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
