//! Corridors: draw rules CORRIDOR1, POLYLINE1 and LINE14.

use std::f64::consts::FRAC_PI_4;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput, TextCourse};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::{circle, direction, offset, turned};

/// The barbs of a lane in text heights.
const LANE_EM: f64 = 2.95;

/// An air corridor (CORRIDOR1): legs between circles about its points.
pub fn air_corridor(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let Some(width_m) = corridor_width_m(input) else { return };
    let half_m = width_m / 2.0;
    for leg in input.points.windows(2) {
        let aside = direction(leg[0], leg[1]).perp() * half_m;
        drawing.line([leg[0] + aside, leg[1] + aside]);
        drawing.line([leg[0] - aside, leg[1] - aside]);
    }
    for &point in input.points {
        drawing.ring(circle(point, half_m));
    }
    drawing.text_on(input.fields.named(kind.label), TextCourse::Once(input.points.to_vec()));
    let [from, to] = [input.points[0], input.points[1]];
    let aside = direction(from, to).perp();
    let over = if aside.dot(input.up) < 0.0 { -aside } else { aside };
    drawing.text_beside(
        box_text(input, width_m),
        from.midpoint(to) + over * (half_m + 0.3 * input.em_m),
        over,
    );
}

/// The text in the box of a corridor: its name, width, elevations and times, as far as they are stated.
fn box_text(input: &GraphicInput<'_>, width_m: f64) -> String {
    let fields = input.fields;
    let titled = |title: &str, text: Option<&String>| {
        text.filter(|text| !text.is_empty()).map(|text| format!("{title}: {text}"))
    };
    let lines = [
        titled("Name", Some(&fields.designation)),
        Some(format!("Width: {width_m:.0} m")),
        titled("Min alt", fields.heights.first()),
        titled("Max alt", fields.heights.get(1)),
        titled("DTG start", Some(&fields.from)),
        titled("DTG end", Some(&fields.until)),
    ];
    lines.into_iter().flatten().collect::<Vec<_>>().join("\n")
}

/// The width of a corridor in meters: stated as `width` or as the first distance.
pub fn corridor_width_m(input: &GraphicInput<'_>) -> Option<f64> {
    input.width_m.or_else(|| input.fields.distances_m.first().copied())
}

/// A lane along a line, as wide to either side as its last point is off (POLYLINE1).
pub fn infiltration_lane(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let last = input.points.len() - 1;
    let (center, side) = (&input.points[..last], input.points[last]);
    let end = [center[last - 2], center[last - 1]];
    let along = direction(end[0], end[1]);
    let half_m = input.width_m.map_or_else(|| along.perp_dot(side - end[0]).abs(), |width_m| width_m / 2.0);
    drawing.line(offset(center, half_m));
    drawing.line(offset(center, -half_m));
    let text = input.fields.labeled(kind.label);
    drawing.text_on(text, TextCourse::Once(center.to_vec()));
}

/// A lane through an obstacle (LINE14): a line with barbs that open outward.
pub fn lane(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [from, to] = [input.points[0], input.points[1]];
    drawing.line([from, to]);
    for (end, outward) in [(to, direction(from, to)), (from, direction(to, from))] {
        let barb = |side: f64| end + turned(outward, side * FRAC_PI_4) * (LANE_EM * input.em_m);
        drawing.line([barb(1.0), end, barb(-1.0)]);
    }
    drawing.text_on(input.fields.labeled(kind.label), TextCourse::Once(vec![from, to]));
}
