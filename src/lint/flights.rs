//! Flights that cannot be flown, and what reading their files left out: a scene is built without them.

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::finding::Finding;
use sandtable_scene::flights::flight;

/// Finds what is wrong with the flights of a scene.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    for table in &context.document.flights {
        match flight(context.document, table, context.sources.assets, context.scene) {
            Ok(flight) => sink.add_all(flight.findings),
            Err(error) => sink.add(Finding::from(&error)),
        }
    }
}
