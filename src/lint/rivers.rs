//! Draped rivers that rise downstream.
//!
//! The ground is cut along water that falls, and where no cut as deep as `max_cut` would do, building finds that. Draped
//! water lies on the ground as that is; it is found here where it rises by more than an elevation model may be off.

use std::ops::Range;

use crate::context::LintContext;
use crate::ground_line::{ground_along, place};
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::Water;
use sandtable_geom::profile::Profile;

/// A rise up to this is not told, meters: the relative error that the makers of global elevation models promise
/// (Farr et al. 2007). Less is as likely the model's fault.
const MOST_RISE_M: f64 = 10.0;

/// A stretch along which the ground rises.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RiverRise {
    from_m: f64,
    to_m: f64,
    rise_m: f64,
}

/// Finds draped rivers that rise downstream, with the reach.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    let mut worst = WorstOfTables::default();
    let draped = context.document.rivers.iter().filter(|table| table.water == Water::Drape);
    let draped: Vec<Range<usize>> = draped.map(|table| table.source.span()).collect();
    for river in scene.symbols.iter().filter(|symbol| symbol.is_river()) {
        let (span, line) = (context.origin(river.feature), &river.alignment.line);
        if !draped.contains(&span) {
            continue;
        }
        let rise = ground_along(scene, line).and_then(|ground| greatest_rise(&ground));
        let Some(RiverRise { from_m, to_m, rise_m }) = rise.filter(|rise| rise.rise_m > MOST_RISE_M) else {
            continue;
        };
        worst.add(span, rise_m, || {
            format!(
                "{} rises downstream by {rise_m:.1} m between stations {from_m:.0} m at {} and {to_m:.0} m at {}",
                context.name(river.feature),
                place(scene, line.at(from_m)),
                place(scene, line.at(to_m))
            )
        });
    }
    let help = "draw its line along the valley of the elevation model, or say `water = \"falls\"`, which cuts the ground";
    worst.report(context, FindingCode::RiverUphill, help, sink);
}

/// The greatest rise from a station to a later one without a hole between them; `None` where the ground nowhere rises.
fn greatest_rise(ground: &Profile) -> Option<RiverRise> {
    let (mut lowest, mut greatest): (Option<(f64, f64)>, Option<RiverRise>) = (None, None);
    for (&station_m, &height_m) in ground.stations().iter().zip(ground.values()) {
        if height_m.is_nan() {
            lowest = None;
            continue;
        }
        let (from_m, low_m) = *lowest.get_or_insert((station_m, height_m));
        if height_m <= low_m {
            lowest = Some((station_m, height_m));
        }
        let rise_m = height_m - low_m;
        if rise_m > greatest.map_or(0.0, |greatest| greatest.rise_m) {
            greatest = Some(RiverRise { from_m, to_m: station_m, rise_m });
        }
    }
    greatest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_rise_runs_from_the_last_low_to_the_highest_after_it() {
        let at = |values: &[f64]| {
            let stations = (0..values.len()).map(|index| index as f64).collect();
            greatest_rise(&Profile::new(stations, values.to_vec()).expect("stations rise"))
        };
        assert_eq!(at(&[9.0, 8.0, 8.0, 1.0]), None);
        let rise = RiverRise { from_m: 2.0, to_m: 5.0, rise_m: 7.0 };
        assert_eq!(at(&[9.0, 4.0, 3.0, 5.0, 4.0, 10.0, 2.0, 6.0]), Some(rise));
        assert_eq!(at(&[1.0, f64::NAN, 9.0, 8.0]), None, "a hole is no rise");
    }
}
