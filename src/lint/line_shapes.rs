//! Roads, rivers and shores whose lines have impossible shapes: too narrow, folded, crossing or coming back on
//! themselves.

use crate::context::LintContext;
use crate::ground_line::place;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_earthworks::alignment::Width;
use sandtable_geom::own_crossing::own_crossing;
use sandtable_geom::tight_bend::{REVERSAL_RAD, TightBend, tight_bends, turns};
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::symbols::LineSymbol;

/// The narrowest road in meters: what one foot before the other needs.
const NARROWEST_ROAD_M: f64 = 0.3;

/// The narrowest river in meters: a ditch that a spade digs.
const NARROWEST_RIVER_M: f64 = 0.1;

/// A bend that is shorter is called a corner, in meters: nothing as wide as a path can follow it, and its radius would be
/// written as 0.0 m.
const CORNER_M: f64 = 0.5;

/// Finds roads and rivers whose lines have such a shape.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let [mut narrow, mut tight, mut crossed, mut back] = std::array::from_fn(|_| WorstOfTables::default());
    for line in &context.scene.symbols {
        if line.is_shore() {
            add_crossed(context, line, &mut crossed);
            continue;
        }
        let kind = context.kind(line.feature);
        if !matches!(kind, Some(FeatureKind::Road | FeatureKind::River)) {
            continue;
        }
        let least_m = if kind == Some(FeatureKind::Road) { NARROWEST_ROAD_M } else { NARROWEST_RIVER_M };
        add_narrow(context, line, least_m, &mut narrow);
        add_tight(context, line, &mut tight);
        add_crossed(context, line, &mut crossed);
        add_reversals(context, line, &mut back);
    }
    for (worst, code, help) in [
        (narrow, FindingCode::NarrowWidth, "widths are meters: 3.5 for a lane"),
        (
            tight,
            FindingCode::TightCurve,
            "draw the curve wider, or the road narrower: its inner edge folds over itself there",
        ),
        (crossed, FindingCode::CrossesItself, "split the line there, or mend the order of its points"),
        (back, FindingCode::DoublesBack, "remove the point that the line comes back from"),
    ] {
        worst.report(context, code, help, sink);
    }
}

fn add_narrow(context: &LintContext<'_>, line: &LineSymbol, least_m: f64, worst: &mut WorstOfTables) {
    let narrowest_m = match &line.alignment.width {
        Width::Constant(width_m) => *width_m,
        Width::Varying(widths) => widths.values().iter().copied().fold(f64::INFINITY, f64::min),
    };
    if narrowest_m < least_m {
        worst.add(context.origin(line.feature), -narrowest_m, || {
            format!(
                "{} is {narrowest_m} m wide; none is narrower than {least_m} m",
                context.name(line.feature)
            )
        });
    }
}

fn add_tight(context: &LintContext<'_>, line: &LineSymbol, worst: &mut WorstOfTables) {
    let alignment = &line.alignment;
    for bend in tight_bends(&alignment.line, |station_m| alignment.width.at(station_m) / 2.0) {
        let half_m = alignment.width.at(bend.from) / 2.0;
        worst.add(context.origin(line.feature), half_m / bend.radius, || {
            let at = place(context.scene, alignment.line.at(bend.from));
            format!("{} {}; half its width is {half_m:.1} m", context.name(line.feature), shape(&bend, &at))
        });
    }
}

/// What a bend that begins at the place `at` is: a curve with its radius, or a corner.
fn shape(bend: &TightBend, at: &str) -> String {
    let TightBend { from, to, turn_rad, radius } = *bend;
    let (turn_deg, length_m) = (turn_rad.to_degrees(), to - from);
    if length_m < CORNER_M {
        let length_m = (length_m * 100.0).ceil() / 100.0;
        return format!(
            "has a corner at station {from:.1} m at {at}: it turns by {turn_deg:.0}° within {length_m:.2} m"
        );
    }
    let decimals = if radius < 0.1 { 3 } else { 1 };
    format!(
        "turns by {turn_deg:.0}° from station {from:.1} to {to:.1} m at {at}, with a radius of {radius:.decimals$} m"
    )
}

fn add_crossed(context: &LintContext<'_>, line: &LineSymbol, worst: &mut WorstOfTables) {
    let Some(crossing) = own_crossing(line.alignment.line.points(), false) else { return };
    worst.add(context.origin(line.feature), 1.0, || {
        let stations = line.alignment.line.stations();
        let [one, other] = crossing.legs.map(|leg| stations[leg]);
        let (name, at) = (context.name(line.feature), place(context.scene, crossing.at));
        format!("{name} crosses itself at {at}: its stretches from {one:.0} m and from {other:.0} m on")
    });
}

fn add_reversals(context: &LintContext<'_>, line: &LineSymbol, worst: &mut WorstOfTables) {
    let turns = turns(&line.alignment.line);
    let sharpest =
        (0..turns.len()).max_by(|&a, &b| turns[a].abs().total_cmp(&turns[b].abs()).then(b.cmp(&a)));
    let Some(vertex) = sharpest.filter(|&vertex| turns[vertex].abs() >= REVERSAL_RAD) else { return };
    worst.add(context.origin(line.feature), turns[vertex].abs(), || {
        let (points, stations) = (line.alignment.line.points(), line.alignment.line.stations());
        let (name, at) = (context.name(line.feature), place(context.scene, points[vertex]));
        format!("{name} comes back on itself at station {:.1} m at {at}", stations[vertex])
    });
}
