//! Features that lie partly off the elevation model.

use std::ops::Range;

use glam::DVec2;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_base::message::suggest::quoted;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::table_sources::{SourceRole, table_sources};
use sandtable_geom::rect::Rect;
use sandtable_scene::source_reach::SourceOverlap;

/// A smaller share of a feature or a file off the model is the width of a pen.
const LEAST_SHARE: f64 = 0.01;

/// A file whose features reach beyond the model by this share of its side, and leave as much of it without any on the other
/// side, is of another area. Others hold more than the scene shows, as maps do.
const BESIDE: f64 = 0.25;

/// Finds features whose points the scene file states that lie partly off the model, and files that reach beyond it.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let tables = table_sources(context.document);
    let covers = |span: &Range<usize>| {
        tables.iter().any(|table| table.role == SourceRole::Over && table.source.span() == *span)
    };
    let extent = context.scene.lattice.extent();
    for overlap in context.scene.overlaps.iter().filter(|overlap| overlap.off < overlap.shapes) {
        let SourceOverlap { span, file, shapes, off, partly, share_off, around } = overlap.clone();
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
                if is_grave && lies_beside(&around, &extent) {
                    let message = format!(
                        "{message}, to one side of it, with {percent:.0} % of all vertices: coordinates that are wrong, or \
                         another area's"
                    );
                    let help =
                        "take a model and a file of one area, or choose the features on the model by `where`";
                    sink.add(context.finding(FindingCode::PartlyOffTerrain, span, message).with_help(help));
                } else {
                    sink.add(context.finding(FindingCode::ReachesBeyond, span, message));
                }
            }
            _ => {}
        }
    }
}

/// Whether features in a rectangle lie to one side of the model.
fn lies_beside(around: &Rect, extent: &Rect) -> bool {
    let least = extent.size() * BESIDE;
    let (before, beyond) = (extent.min - around.min, around.max - extent.max);
    let is_toward = |out: DVec2, back: DVec2| out.cmpge(least) & back.cmple(-least);
    let is_beside = is_toward(before, beyond) | is_toward(beyond, before);
    let is_beyond_both = before.cmpge(least) & beyond.cmpge(least);
    is_beside.any() && !is_beyond_both.any()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_beside_the_model_reach_beyond_one_side_and_not_to_the_other() {
        let extent = Rect { min: DVec2::ZERO, max: DVec2::splat(100.0) };
        let beside =
            |min: [f64; 2], max: [f64; 2]| lies_beside(&Rect { min: min.into(), max: max.into() }, &extent);
        assert!(beside([60.0, 10.0], [150.0, 90.0]) && beside([10.0, -90.0], [90.0, 40.0]));
        assert!(!beside([-500.0, -500.0], [600.0, 600.0]), "a map of a larger area");
        assert!(!beside([40.0, -500.0], [60.0, 600.0]), "a road across it");
        assert!(!beside([60.0, -500.0], [150.0, 600.0]), "another road across it");
        assert!(!beside([10.0, 10.0], [150.0, 90.0]), "nearly all of it");
    }
}
