//! Roads and bridges that are too steep for vehicles, and embankments and cuttings that are too high or deep to be
//! built.
//!
//! A road that lies on the ground is as steep as that; it is measured on the scene's ground, after all earthworks. A road
//! that the ground follows keeps its grade, and pays for it in earth: its design is compared with the ground before. A bridge
//! runs from the ground at one end to the ground at the other, unless its level is stated; it is held to what its road
//! states as `max_grade`, else to what bridges have.

use crate::context::LintContext;
use crate::ground_line::{ground_along, place};
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_earthworks::alignment::Support;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::roads::profiles::RoadProfile;

/// The steepest road, meters a meter: the steepest paved street of the world, Baldwin Street in Dunedin, rises by 34.8 %.
/// Lower, and streets of San Francisco would be found; higher, and no road is as steep.
const STEEPEST: f64 = 0.35;

/// Grades are measured over this many meters at least: over less, a curb or a post that is off is a cliff.
const GRADE_OVER_M: f64 = 30.0;

/// And over so many cells: the slope of a single cell is mostly the error of its posts.
const GRADE_OVER_CELLS: f64 = 2.0;

/// The steepest deck, meters a meter: bridges for vehicles have up to 6 %, such as Eshima Ohashi in Japan, and ramps that
/// are climbed in the wet up to about 15 %.
const STEEPEST_DECK: f64 = 0.15;

/// How much steeper than its road states a deck may be, meters a meter: stations are rounded.
const GRADE_SLACK: f64 = 0.005;

/// The highest embankment in meters: where more fill is needed, a viaduct costs less.
const HIGHEST_FILL_M: f64 = 15.0;

/// The deepest cutting in meters: where more is dug, a tunnel costs less, and slopes need more care than a rule gives.
const DEEPEST_CUT_M: f64 = 25.0;

/// Finds roads and bridges that are too steep, and roads on too much earth.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    steep(context, sink);
    steep_decks(context, sink);
    earthworks(context, sink);
}

/// The meters over which grades are measured.
fn grade_base_m(context: &LintContext<'_>) -> f64 {
    GRADE_OVER_M.max(GRADE_OVER_CELLS * context.scene.lattice.measured_cell().max_element())
}

fn steep(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    let base_m = grade_base_m(context);
    let mut worst = WorstOfTables::default();
    let driven = context.roads_on_ground().filter(|road| is_for_wheels(road.surface));
    for road in driven.filter(|road| road.alignment.level.is_none()) {
        let line = &road.alignment.line;
        if line.length() < base_m {
            continue;
        }
        let steepest = ground_along(scene, line).and_then(|ground| ground.steepest_over(base_m));
        let Some((grade, from_m)) = steepest.filter(|(grade, _)| *grade > STEEPEST) else { continue };
        worst.add(context.origin(road.feature), grade, || {
            format!(
                "{} is {:.0} % steep over the {base_m:.0} m from station {from_m:.0} m at {}; the steepest street of the \
                 world has 35 %",
                context.name(road.feature),
                grade * 100.0,
                place(scene, line.at(from_m))
            )
        });
    }
    let help = "set `profile = \"conform\"`, so that the ground follows the road, or let it wind; where the ground itself is \
                wrong there, it is the elevation model's trees or houses";
    worst.report(context, FindingCode::RoadSteep, help, sink);
}

fn steep_decks(context: &LintContext<'_>, sink: &mut FindingSink) {
    let base_m = grade_base_m(context);
    let mut worst = WorstOfTables::default();
    for bridge in context.scene.bridge_profiles.iter().filter(|bridge| is_for_wheels(bridge.surface)) {
        let [first, last] = bridge.level.span();
        // Of shorter ones the ground at both ends says too little.
        let (most, whose) = match bridge.max_grade {
            Some(stated) => {
                (stated + GRADE_SLACK, format!("its road states at most {:.1} %", stated * 100.0))
            }
            None => (STEEPEST_DECK, format!("bridges have less than {:.0} %", STEEPEST_DECK * 100.0)),
        };
        let steepest = bridge.level.steepest_over(base_m);
        let Some((grade, from_m)) = steepest.filter(|(grade, _)| *grade > most) else { continue };
        worst.add(context.origin(bridge.feature), grade - most, || {
            format!(
                "{} is {:.0} % steep over the {base_m:.0} m from station {from_m:.0} m at {}: its deck runs from {:.1} m to \
                 {:.1} m; {whose}",
                context.name(bridge.feature),
                grade * 100.0,
                place(context.scene, bridge.line.at(from_m)),
                bridge.level.at(first),
                bridge.level.at(last)
            )
        });
    }
    let help = "let it begin and end where the ground is as high, state the level of a [[bridge]] with `deck`, or allow its \
                road a higher `max_grade`";
    worst.report(context, FindingCode::BridgeSteep, help, sink);
}

/// Whether vehicles drive on a road. Paths and tracks climb what feet climb.
fn is_for_wheels(surface: RibbonSurface) -> bool {
    !matches!(surface, RibbonSurface::Track | RibbonSurface::TrackJunction)
}

fn earthworks(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    let mut worst = [WorstOfTables::default(), WorstOfTables::default()];
    for road in &scene.profiles {
        for (worst, (sign, most_m, what)) in worst
            .iter_mut()
            .zip([(1.0, HIGHEST_FILL_M, "on an embankment of"), (-1.0, DEEPEST_CUT_M, "in a cutting of")])
        {
            let Some((rise_m, station_m)) = greatest(road, sign).filter(|(rise_m, _)| *rise_m > most_m)
            else {
                continue;
            };
            worst.add(context.origin(road.feature), rise_m, || {
                format!(
                    "{} runs {what} {rise_m:.1} m at station {station_m:.0} m at {}; more than {most_m:.0} m are hardly ever \
                     built",
                    context.name(road.feature),
                    place(scene, road.line.at(station_m))
                )
            });
        }
    }
    for (worst, help) in worst.into_iter().zip([
        "let a bridge stand there: `max_fill = 15`; or allow a higher `max_grade`, or another line",
        "let a tunnel run there: `max_cut = 25`; or allow a higher `max_grade`, or another line",
    ]) {
        worst.report(context, FindingCode::DeepEarthwork, help, sink);
    }
}

/// How far the design lies above the ground at most, times `sign`, where the ground carries the road, with the station.
fn greatest(road: &RoadProfile, sign: f64) -> Option<(f64, f64)> {
    let stations = road.design.stations().iter().zip(road.design.values().iter().zip(road.ground.values()));
    let carried = stations.zip(&road.supports).filter(|(_, support)| **support == Support::Ground);
    let rises =
        carried.map(|((&station_m, (design_m, ground_m)), _)| ((design_m - ground_m) * sign, station_m));
    rises
        .filter(|(rise_m, _)| rise_m.is_finite())
        .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)))
}
