//! Heights that data state, against the ground: offsets that are those of another vertical datum.
//!
//! Receivers of satellites give heights above the ellipsoid, maps heights above a geoid, which lies up to 106 m below it and
//! 85 m above (EGM2008). A constant offset between the heights of a file and the ground, with a small spread, is most often
//! that.

use glam::DVec2;

use crate::description::features::ModelPlacement;
use crate::description::finding_code::FindingCode;
use crate::description::words::Clamp;
use crate::pipeline::lint::context::LintContext;
use crate::pipeline::lint::sink::FindingSink;
use crate::pipeline::lint::table_sources::table_sources;
use crate::scene::Placement;
use crate::scene::attributes::Attributes;
use crate::terrain::query::{Interpolation, ground_height};

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

/// Finds files with heights, and models at stated elevations, that lie off the ground by a constant.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    for table in table_sources(context.document).iter().filter(|table| !table.is_raised) {
        let Some(file) = &table.source.file else { continue };
        // What cannot be read was an error of building the scene.
        let Ok((crs, features)) = context.sources.features(&table.source) else { continue };
        let every =
            features.iter().map(|feature| feature.elevations_m().count()).sum::<usize>() / MOST_HEIGHTS + 1;
        let heights = features.iter().flat_map(Attributes::elevations_m).step_by(every);
        let offset = |(at, height_m): (DVec2, f64)| {
            let at = crs.transform(&context.scene.crs, at).ok()?;
            offset_m(context, at, height_m)
        };
        let what = format!("the heights in '{}'", file.as_str());
        let span = table.source.span();
        sink.add_all(
            finding(&what, heights.filter_map(offset).collect()).map(|(message, help)| {
                context.finding(FindingCode::GeoidOffset, span, message).with_help(help)
            }),
        );
    }
    let absolute = |table: &&ModelPlacement| table.clamp == Clamp::Absolute;
    for table in context.document.models.iter().filter(absolute) {
        let span = table.instances.as_ref().map(|source| source.span()).or_else(|| table.at.as_ref()?.span());
        let span = span.unwrap_or_default();
        let of_table =
            |feature: usize| context.scene.features.get(feature).is_some_and(|it| it.origin.span == span);
        let placements = context.scene.placements.iter();
        let placements = placements.filter(|model| model.feature.index().is_some_and(of_table));
        let offset = |model: &Placement| {
            let at = model.at.as_dvec2() + context.scene.lattice.origin();
            offset_m(context, at, f64::from(context.scene.scale.elevation_m(model.height as f32)))
        };
        let found = finding("the elevations of the models", placements.filter_map(offset).collect());
        sink.add_all(found.map(|(message, help)| {
            context.finding(FindingCode::GeoidOffset, span.clone(), message).with_help(help)
        }));
    }
}

fn offset_m(context: &LintContext<'_>, at: DVec2, height_m: f64) -> Option<f64> {
    let ground_m = ground_height(&context.scene.lattice, Interpolation::Planar, at).height_m()?;
    Some(height_m - ground_m).filter(|offset| offset.is_finite())
}

/// The message and the remedy where `offsets` above the ground are nearly all the same.
fn finding(what: &str, mut offsets: Vec<f64>) -> Option<(String, String)> {
    if offsets.len() < LEAST_HEIGHTS {
        return None;
    }
    let middle = |values: &mut Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let median = middle(&mut offsets);
    let spread = middle(&mut offsets.iter().map(|offset| (offset - median).abs()).collect());
    let is_constant = spread <= MOST_SPREAD_M && spread <= MOST_SPREAD * median.abs();
    let is_geoid = (LEAST_OFFSET_M..=MOST_OFFSET_M).contains(&median.abs());
    let side = if median > 0.0 { "above" } else { "below" };
    (is_constant && is_geoid).then(|| {
        let message = format!(
            "{what} lie {:.1} m {side} the ground nearly everywhere: half of {} within {spread:.1} m of that",
            median.abs(),
            offsets.len()
        );
        let help = "one of the two is above the ellipsoid and the other above a geoid, most likely: bring both to one vertical \
                    datum, for example with PROJ's cs2cs";
        (message, help.to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_offset_is_found_and_a_spread_one_is_not() {
        let offsets = |of: fn(usize) -> f64| (0..40).map(of).collect::<Vec<f64>>();
        let (message, _) = finding("x", offsets(|at| 32.0 + (at % 5) as f64 * 0.5)).expect("constant");
        assert!(
            message.starts_with("x lie 33.0 m above the ground nearly everywhere: half of 40 within 0.5 m"),
            "{message}"
        );
        assert!(finding("x", offsets(|at| -31.0 - (at % 3) as f64)).is_some_and(|it| it.0.contains("below")));
        assert!(finding("x", offsets(|at| (at % 7) as f64)).is_none(), "on the ground");
        assert!(finding("x", offsets(|at| 30.0 + (at * 3) as f64)).is_none(), "birds");
        assert!(finding("x", offsets(|at| 500.0 + (at % 2) as f64)).is_none(), "an airplane");
        assert!(finding("x", vec![32.0; 5]).is_none(), "too few");
    }
}
