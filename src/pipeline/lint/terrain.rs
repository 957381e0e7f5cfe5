//! Features that lie partly off the elevation model.

use std::ops::Range;

use crate::description::finding_code::FindingCode;
use crate::message::suggest::quoted;
use crate::pipeline::lint::context::LintContext;
use crate::pipeline::lint::sink::FindingSink;
use crate::pipeline::lint::table_sources::{SourceRole, table_sources};
use crate::scene::source_reach::SourceOverlap;

/// A smaller share of a feature or a file off the model is the width of a pen.
const LEAST_SHARE: f64 = 0.01;

/// Finds features that lie partly off the model, whether the scene file states their points or names their file. Where it
/// names a part of the model as well, files are meant to reach beyond.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let tables = table_sources(context.document);
    let is_part = context.document.terrain.extent.is_some();
    let covers = |span: &Range<usize>| {
        tables.iter().any(|table| table.role == SourceRole::Over && table.source.span() == *span)
    };
    for overlap in context.scene.overlaps.iter().filter(|overlap| overlap.off < overlap.shapes) {
        let SourceOverlap { span, file, shapes, off, partly, share_off } = overlap.clone();
        let is_grave = share_off >= LEAST_SHARE && !covers(&span);
        let percent = share_off * 100.0;
        match file {
            None if is_grave => {
                let message = format!("{percent:.0} % of the feature lies off the elevation model");
                let finding = context.finding(FindingCode::PartlyOffTerrain, span, message);
                sink.add(finding.with_help("move its points onto the model, or take a larger one"));
            }
            Some(file) if off + partly > 0 => {
                let message = format!(
                    "of {shapes} features of '{}' that are taken, {off} lie off the elevation model and {partly} reach \
                     beyond its border",
                    quoted(&file)
                );
                if is_grave && !is_part {
                    let message = format!("{message}: {percent:.0} % of all vertices");
                    let help = "take a larger model, choose the features on it by `where`, or cut the file to it, for example \
                                with: ogr2ogr -clipsrc";
                    sink.add(context.finding(FindingCode::PartlyOffTerrain, span, message).with_help(help));
                } else {
                    sink.add(context.finding(FindingCode::ReachesBeyond, span, message));
                }
            }
            _ => {}
        }
    }
}
