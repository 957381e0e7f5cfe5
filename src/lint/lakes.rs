//! Lakes whose level does not fit the ground along their shores.
//!
//! The ground is cut and filled to meet the water, so that no gap shows in the picture; how much it takes says whether the
//! level is right. One that is far off all of the shore is found while the scene is built.

use crate::context::LintContext;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::list::FeatureId;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::report::LakeRow;
use sandtable_scene::water::lake_level::far_off_m;

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
        let lake = FeatureId::of_index(index);
        let (Some(lowest_m), Some(highest_m)) = (row.lowest_shore, row.highest_shore) else { continue };
        let is_far_off = far_off_m(row.level, [lowest_m, highest_m]).is_some();
        if let Some((gap_m, message)) = gap(row, lowest_m).filter(|_| !is_far_off) {
            gaps.add(context.origin(lake), gap_m, || format!("{} {message}", context.name(lake)));
        }
    }
    let help =
        "state its `level` as the elevation model has it, or draw its shore where the model has the water";
    gaps.report(context, FindingCode::LakeShoreGap, help, sink);
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
            "lies at {level_m:.1} m, and half of its shore at least {bank_m:.1} m above that; the ground is cut down to it"
        );
        (bank_m, message)
    })
}
