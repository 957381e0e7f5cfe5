//! Corridors: draw rules CORRIDOR1, POLYLINE1 and LINE14.

use std::f64::consts::FRAC_PI_4;

use crate::geom::polyline::Polyline;
use crate::geom::segment;
use crate::symbology::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::symbology::graphic::kind::GraphicKind;
use crate::symbology::graphic::lines::label_at;
use crate::symbology::graphic::plane::{circle, direction, offset, turned};

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
    let mut text = input.fields.labeled(kind.label);
    if !input.fields.heights.is_empty() {
        text = format!("{text}\n{}", input.fields.heights.join("\u{2013}"));
    }
    label_middle(input, text, drawing);
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
    if let Some(line) = Polyline::new(center.iter().copied(), 0.0) {
        let mut over = GraphicDrawing::default();
        label_at(&line, line.length() / 2.0, text, input, &mut over);
        drawing.texts.extend(over.texts);
    }
}

/// A lane through an obstacle (LINE14): a line with barbs that open outward.
pub fn lane(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let [from, to] = [input.points[0], input.points[1]];
    drawing.line([from, to]);
    for (end, outward) in [(to, direction(from, to)), (from, direction(to, from))] {
        let barb = |side: f64| end + turned(outward, side * FRAC_PI_4) * (LANE_EM * input.em_m);
        drawing.line([barb(1.0), end, barb(-1.0)]);
    }
    label_middle(input, input.fields.labeled(kind.label), drawing);
}

fn label_middle(input: &GraphicInput<'_>, text: String, drawing: &mut GraphicDrawing) {
    let Some(line) = Polyline::new(input.points.iter().copied(), 0.0) else { return };
    let longest = input.points.windows(2).max_by(|a, b| segment_m(a).total_cmp(&segment_m(b)));
    let Some(leg) = longest else { return };
    let middle = leg[0].midpoint(leg[1]);
    let station = line
        .legs()
        .enumerate()
        .min_by(|(_, a), (_, b)| {
            let off = |leg: &[glam::DVec2; 2]| segment::distance_squared((leg[0], leg[1]), middle);
            off(a).total_cmp(&off(b))
        })
        .map_or(0.0, |(index, leg)| line.stations()[index] + leg[0].distance(middle));
    label_at(&line, station, text, input, drawing);
}

fn segment_m(leg: &[glam::DVec2]) -> f64 {
    leg[0].distance(leg[1])
}
