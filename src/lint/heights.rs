//! Heights in data compared with the ground: offsets like those between vertical datums, and ratios like that of feet to
//! meters.
//!
//! Receivers of satellites give heights above the ellipsoid, maps heights above a geoid, which lies up to 106 m below it and
//! 85 m above (EGM2008). A constant offset between the heights of a file and the ground, with a small spread, is most often
//! that. Heights that are 3.28 times the ground's, or of which the ground's are 3.28 times, are feet beside meters. On level
//! ground an offset and a ratio cannot be told apart: the one is found that explains the heights better.

use glam::DVec2;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::features::ModelPlacement;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::table_sources::{SourceRole, table_sources};
use sandtable_description::words::Clamp;
use sandtable_geom::length_unit::FOOT_M;
use sandtable_scene::attributes::Attributes;
use sandtable_scene::placed_model::Placement;
use sandtable_terrain::query::{Interpolation, ground_height};

/// Fewer heights say nothing.
const LEAST_HEIGHTS: usize = 8;
/// Smaller offsets are those of what stands on the ground, or of a coarse model.
const LEAST_OFFSET_M: f64 = 8.0;
/// The largest distance between ellipsoid and geoid, with some more for the model's own errors.
const MOST_OFFSET_M: f64 = 115.0;
/// Half of the offsets lie within so many meters, and within such a part of their median, where one surface lies over another.
const MOST_SPREAD_M: f64 = 6.0;
const MOST_SPREAD: f64 = 0.2;
/// The heights of one source that are compared are at most about this many.
const MOST_HEIGHTS: usize = 20_000;

/// Finds files with heights, and models at stated elevations, that lie off the ground by a constant or by the ratio of a
/// foot to a meter.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    for table in table_sources(context.document).iter().filter(|table| table.role != SourceRole::Above) {
        let Some(file) = &table.source.file else { continue };
        // What cannot be read was an error of building the scene.
        let Ok((crs, features)) = context.sources.features(&table.source) else { continue };
        let every =
            features.iter().map(|feature| feature.elevations_m().count()).sum::<usize>() / MOST_HEIGHTS + 1;
        let heights = features.iter().flat_map(Attributes::elevations_m).step_by(every);
        let pair = |(at, height_m): (DVec2, f64)| {
            let at = crs.transform(&context.scene.crs, at).ok()?;
            HeightPair::at(context, at, height_m)
        };
        let what = format!("the heights in '{}'", file.as_str());
        let span = table.source.span();
        sink.add_all(finding(&what, &heights.filter_map(pair).collect::<Vec<_>>()).map(
            |HeightMismatch { code, message, help }| context.finding(code, span, message).with_help(help),
        ));
    }
    let absolute = |table: &&ModelPlacement| table.clamp == Clamp::Absolute;
    for table in context.document.models.iter().filter(absolute) {
        let span = table.instances.as_ref().map(|source| source.span()).or_else(|| table.at.as_ref()?.span());
        let span = span.unwrap_or_default();
        let of_table =
            |feature: usize| context.scene.features.get(feature).is_some_and(|it| it.origin.span == span);
        let placements = context.scene.placements.iter();
        let placements = placements.filter(|model| model.feature.index().is_some_and(of_table));
        let pair = |model: &Placement| {
            let at = model.at.as_dvec2() + context.scene.lattice.origin();
            HeightPair::at(context, at, f64::from(context.scene.scale.elevation_m(model.height as f32)))
        };
        let pairs: Vec<HeightPair> = placements.filter_map(pair).collect();
        let found = finding("the elevations of the models", &pairs);
        sink.add_all(found.map(|HeightMismatch { code, message, help }| {
            context.finding(code, span.clone(), message).with_help(help)
        }));
    }
}

/// A height that data state, and the ground's at the same place, meters.
#[derive(Clone, Copy, Debug)]
struct HeightPair {
    stated_m: f64,
    ground_m: f64,
}

impl HeightPair {
    /// The pair at a place in the scene's system; `None` where there is no ground.
    fn at(context: &LintContext<'_>, at: DVec2, stated_m: f64) -> Option<Self> {
        let ground_m = ground_height(&context.scene.lattice, Interpolation::Planar, at).height_m()?;
        (stated_m - ground_m).is_finite().then_some(Self { stated_m, ground_m })
    }
}

/// How stated heights and the ground disagree.
struct HeightMismatch {
    code: FindingCode,
    message: String,
    help: &'static str,
}

/// What is wrong with heights that lie off the ground by a constant or a ratio; `None` where they do not.
fn finding(what: &str, pairs: &[HeightPair]) -> Option<HeightMismatch> {
    if pairs.len() < LEAST_HEIGHTS {
        return None;
    }
    let offset_m = middle(pairs.iter().map(|pair| pair.stated_m - pair.ground_m));
    let spread_m = middle(pairs.iter().map(|pair| (pair.stated_m - pair.ground_m - offset_m).abs()));
    in_feet(what, pairs, offset_m.abs(), spread_m).or_else(|| off_by(what, pairs.len(), offset_m, spread_m))
}

/// The finding where one of the two is in feet: one of two ratios leaves little of the offset, and less than its spread.
fn in_feet(what: &str, pairs: &[HeightPair], offset_m: f64, spread_m: f64) -> Option<HeightMismatch> {
    let (stated_too_high, ground_too_high) = (
        middle(pairs.iter().map(|pair| (pair.stated_m * FOOT_M - pair.ground_m).abs())),
        middle(pairs.iter().map(|pair| (pair.stated_m - pair.ground_m * FOOT_M).abs())),
    );
    let (rest_m, ratio) = if stated_too_high < ground_too_high {
        (stated_too_high, "3.28 times the ground's: they seem to be feet")
    } else {
        (ground_too_high, "the ground's divided by 3.28: the elevation model seems to be in feet")
    };
    let is_explained = rest_m <= MOST_SPREAD_M && rest_m <= MOST_SPREAD * offset_m && rest_m < spread_m;
    (offset_m >= LEAST_OFFSET_M && is_explained).then(|| HeightMismatch {
        code: FindingCode::HeightsInFeet,
        message: format!(
            "{what} are {ratio}; half of {} agree within {rest_m:.1} m once converted",
            pairs.len()
        ),
        help: "convert what is in feet to meters: multiply its heights by 0.3048",
    })
}

/// The finding where the heights lie off the ground by nearly the same everywhere.
fn off_by(what: &str, count: usize, offset_m: f64, spread_m: f64) -> Option<HeightMismatch> {
    let is_constant = spread_m <= MOST_SPREAD_M && spread_m <= MOST_SPREAD * offset_m.abs();
    let is_geoid = (LEAST_OFFSET_M..=MOST_OFFSET_M).contains(&offset_m.abs());
    let side = if offset_m > 0.0 { "above" } else { "below" };
    (is_constant && is_geoid).then(|| HeightMismatch {
        code: FindingCode::GeoidOffset,
        message: format!(
            "{what} lie {:.1} m {side} the ground nearly everywhere: half of {count} within {spread_m:.1} m of that",
            offset_m.abs()
        ),
        help: "one of the two is above the ellipsoid and the other above a geoid, most likely: bring both to one vertical datum, \
               for example with PROJ's cs2cs",
    })
}

/// The median of at least one value.
fn middle(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_offset_is_found_and_a_spread_one_is_not() {
        let found = |offset: fn(usize) -> f64| {
            let pair = |at: usize| HeightPair { stated_m: 700.0 + offset(at), ground_m: 700.0 };
            finding("x", &(0..40).map(pair).collect::<Vec<_>>()).map(|found| found.message)
        };
        let message = found(|at| 32.0 + (at % 5) as f64 * 0.5).expect("constant");
        assert!(
            message.starts_with("x lie 33.0 m above the ground nearly everywhere: half of 40 within 0.5 m"),
            "{message}"
        );
        assert!(found(|at| -31.0 - (at % 3) as f64).is_some_and(|message| message.contains("below")));
        assert!(found(|at| (at % 7) as f64).is_none(), "on the ground");
        assert!(found(|at| 30.0 + (at * 3) as f64).is_none(), "birds");
        assert!(found(|at| 500.0 + (at % 2) as f64).is_none(), "an airplane");
        let pair = HeightPair { stated_m: 732.0, ground_m: 700.0 };
        assert!(finding("x", &[pair; 5]).is_none(), "too few");
    }

    #[test]
    fn feet_are_found_on_either_side_and_not_where_an_offset_explains_as_much() {
        let code = |stated: fn(f64) -> f64, relief_m: f64| {
            let ground = |at: usize| 40.0 + relief_m * (at % 10) as f64;
            let pair = |at| HeightPair { stated_m: stated(ground(at)), ground_m: ground(at) };
            finding("x", &(0..40).map(pair).collect::<Vec<_>>()).map(|found| found.code)
        };
        assert_eq!(code(|ground| ground / 0.3048 + 1.0, 3.0), Some(FindingCode::HeightsInFeet));
        assert_eq!(code(|ground| ground * 0.3048, 3.0), Some(FindingCode::HeightsInFeet));
        assert_eq!(code(|ground| ground / 0.3048 + 1.0, 0.0), Some(FindingCode::GeoidOffset), "level ground");
        assert_eq!(code(|ground| ground * 2.5, 3.0), None);
    }
}
