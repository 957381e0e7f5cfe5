//! Features that lie partly off the elevation model.

use crate::description::finding_code::FindingCode;
use crate::message::suggest::quoted;
use crate::pipeline::lint::context::LintContext;
use crate::pipeline::lint::sink::FindingSink;
use crate::scene::source_reach::SourceOverlap;

/// A smaller share of a feature off the model is the width of a pen.
const LEAST_SHARE: f64 = 0.01;

/// Finds features whose points the scene file states that lie partly off the model, and files that reach beyond it.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    for overlap in context.scene.overlaps.iter().filter(|overlap| overlap.off < overlap.shapes) {
        let SourceOverlap { span, file, shapes, off, partly, share_off } = overlap.clone();
        match file {
            None if share_off >= LEAST_SHARE => {
                let message =
                    format!("{:.0} % of the feature lies off the elevation model", share_off * 100.0);
                let finding = context.finding(FindingCode::PartlyOffTerrain, span, message);
                sink.add(finding.with_help("move its points onto the model, or take a larger one"));
            }
            Some(file) if off + partly > 0 => {
                let message = format!(
                    "of {shapes} features of '{}' that are taken, {off} lie off the elevation model and {partly} reach \
                     beyond its border",
                    quoted(&file)
                );
                sink.add(context.finding(FindingCode::ReachesBeyond, span, message));
            }
            _ => {}
        }
    }
}
