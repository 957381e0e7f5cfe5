//! Definitions of the scene file that nothing uses, or that are repeated.

use std::collections::BTreeMap;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_base::message::suggest::quoted;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::unused::UnusedInclude;
use sandtable_scene::feature::FeatureKind;

/// Finds styles and phases that no table names, included files without effect, and names that several tables have.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let unused = &context.document.unused;
    for name in &unused.styles {
        let message = format!("no table names the style '{}'", quoted(name));
        let finding = context.finding(FindingCode::UnusedStyle, name.span().unwrap_or_default(), message);
        sink.add(finding.with_help(format!("add `style = \"{}\"` to a table, or remove it", quoted(name))));
    }
    for name in &unused.phases {
        let message = format!("no table names the phase '{}': it shows what is always there", quoted(name));
        let finding = context.finding(FindingCode::UnusedPhase, name.span().unwrap_or_default(), message);
        sink.add(
            finding.with_help(format!("add `phases = [\"{}\"]` to a table, or remove it", quoted(name))),
        );
    }
    for UnusedInclude { name, is_empty } in &unused.includes {
        let file = quoted(name);
        let (message, help) = if *is_empty {
            (
                format!("the included file '{file}' states nothing"),
                "remove it from `include`, or write the tables that are meant",
            )
        } else {
            (
                format!(
                    "nothing of the included file '{file}' has effect: all of its keys are stated again after it"
                ),
                "remove it from `include`, or remove the keys that are meant to come from it",
            )
        };
        let span = name.span().unwrap_or_default();
        sink.add(context.finding(FindingCode::UnusedInclude, span, message).with_help(help));
    }
    repeated_names(context, sink);
}

/// Finds names that several tables give to features of one kind. Files may repeat a name: a road is drawn in pieces.
fn repeated_names(context: &LintContext<'_>, sink: &mut FindingSink) {
    let mut first: BTreeMap<(FeatureKind, &str), usize> = BTreeMap::new();
    for feature in &context.scene.features {
        let span = &feature.origin.span;
        if feature.name.is_empty() || feature.origin.number.is_some() || *span == (0..0) {
            continue;
        }
        // A model is named after its file where it has no name; a road on a bridge is two features of one table.
        let is_file = feature.kind == FeatureKind::Model && feature.name.contains(['.', '/']);
        let is_built_in = feature.kind == FeatureKind::Model
            && !context.document.models.iter().any(|table| table.name.as_ref() == Some(&feature.name));
        let known = *first.entry((feature.kind, &feature.name)).or_insert(span.start);
        if is_file || is_built_in || known == span.start {
            continue;
        }
        let line = context.document.source.line_column(known).line;
        let noun = feature.kind.noun(1);
        let message = format!("the {noun} on line {line} is called '{}' too", quoted(&feature.name));
        let finding = context.finding(FindingCode::RepeatedName, span.clone(), message);
        sink.add(finding.with_help(format!(
            "give each {noun} a name of its own: reports and labels tell them apart by it"
        )));
    }
}
