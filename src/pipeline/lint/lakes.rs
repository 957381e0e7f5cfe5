//! Lakes whose level does not fit the ground along their shores.
//!
//! The ground is cut and filled to meet the water, so that no gap shows in the picture; how much it takes says whether the
//! level is right.

use crate::description::finding::Finding;
use crate::description::finding_code::FindingCode;
use crate::draw::list::FeatureId;
use crate::pipeline::lint::context::LintContext;
use crate::pipeline::lint::sink::FindingSink;
use crate::pipeline::lint::worst::WorstOfTables;
use crate::scene::FeatureKind;
use crate::scene::report::LakeRow;

/// A level farther than this from all ground along the shore is a slip of the pen, or of another datum or unit, meters.
const ABSURD_M: f64 = 100.0;

/// A level farther than this from the shore is told, meters: the relative error that the makers of global elevation models
/// promise (Farr et al. 2007). Less is as likely the model's fault.
const GAP_M: f64 = 10.0;

/// Finds lakes that lie far above or below their shores.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let features = context.scene.features.iter().enumerate();
    let lakes = features.filter(|(_, feature)| feature.kind == FeatureKind::Lake);
    let mut gaps = WorstOfTables::default();
    // Every lake has a row, in the order of their features.
    for ((index, _), row) in lakes.zip(&context.scene.report.lakes) {
        let lake = FeatureId(FeatureId::GROUND.0 + 1 + index as u32);
        let (Some(lowest_m), Some(highest_m)) = (row.lowest_shore, row.highest_shore) else { continue };
        let off_m = (lowest_m - row.level).max(row.level - highest_m);
        if off_m > ABSURD_M {
            sink.add(absurd(context, lake, row, [lowest_m, highest_m]));
        } else if let Some((gap_m, message)) = gap(row, lowest_m) {
            gaps.add(context.origin(lake), gap_m, || format!("{} {message}", context.name(lake)));
        }
    }
    let help =
        "state its `level` as the elevation model has it, or draw its shore where the model has the water";
    for (span, message) in gaps.into_messages(|more| format!("{more} more lakes of this table do not fit")) {
        sink.add(context.finding(FindingCode::LakeShoreGap, span, message).with_help(help));
    }
}

fn absurd(
    context: &LintContext<'_>,
    lake: FeatureId,
    row: &LakeRow,
    [lowest_m, highest_m]: [f64; 2],
) -> Finding {
    let where_to = if row.level < lowest_m { "below" } else { "above" };
    let off_m = if row.level < lowest_m { lowest_m - row.level } else { row.level - highest_m };
    let message = format!(
        "{} lies level at {:.0} m, {off_m:.0} m {where_to} all ground along its shore, which is {lowest_m:.0} to \
         {highest_m:.0} m high",
        context.name(lake),
        row.level
    );
    let help = "state its `level` in meters above what the elevation model counts from, or remove it: the shore gives one";
    context.about(FindingCode::LakeLevelWrong, lake, message).with_help(help)
}

/// How far the water is from where its shore would have it, and what a message says of it; `None` where it fits.
fn gap(row: &LakeRow, lowest_m: f64) -> Option<(f64, String)> {
    let median_m = row.median_shore?;
    let level_m = row.level;
    let (over_m, pit_m, bank_m) = (level_m - lowest_m, lowest_m - level_m, median_m - level_m);
    if over_m > GAP_M {
        let message = format!(
            "stands {over_m:.1} m above the lowest ground of its shore: at {level_m:.1} m, over {lowest_m:.1} m; the ground \
             is filled up to hold it"
        );
        return Some((over_m, message));
    }
    if pit_m > GAP_M {
        let message = format!(
            "lies {pit_m:.1} m below the lowest ground of its shore: at {level_m:.1} m, under {lowest_m:.1} m; the ground is \
             cut down to it"
        );
        return Some((pit_m, message));
    }
    (bank_m > GAP_M).then(|| {
        let message = format!(
            "lies at {level_m:.1} m, and half of its shore more than {bank_m:.1} m above that; the ground is cut down to it"
        );
        (bank_m, message)
    })
}
