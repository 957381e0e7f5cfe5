//! A tolerance of the drawn ground that is so large that its error shows, or too small to be of use.

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::finding_code::FindingCode;

/// The greatest error of the drawn ground in pixels that is not told: four pixels are as thick as a road's line, so that
/// more moves what stands on the ground off its place for everyone to see.
const MOST_PX: f64 = 4.0;

/// The least tolerance that gives more than triangles, in pixels: less than a tenth of a pixel changes no color.
const LEAST_PX: f64 = 0.1;

/// Finds a `tolerance_px` that is too large to be trusted, or too small to be of use.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let tolerance_px = &context.document.terrain.tolerance_px;
    let px = **tolerance_px;
    let found = |message: String, help: &str| {
        context
            .finding(FindingCode::ToleranceBudget, tolerance_px.span().unwrap_or_default(), message)
            .with_help(help)
    };
    if px > MOST_PX {
        let message = format!(
            "the drawn ground may be off by {px} pixels; more than {MOST_PX} moves what stands on it off its place"
        );
        sink.add(found(message, "leave it out: 1 pixel is what an eye can just see"));
    } else if px < LEAST_PX {
        let message = format!(
            "the drawn ground may be off by {px} pixels; less than {LEAST_PX} changes no pixel and costs triangles"
        );
        sink.add(found(message, "leave it out: 1 pixel is what an eye can just see"));
    }
}
