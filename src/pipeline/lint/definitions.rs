//! What the scene file defines and nothing uses.

use crate::description::finding_code::FindingCode;
use crate::pipeline::lint::context::LintContext;
use crate::pipeline::lint::sink::FindingSink;

/// Finds styles that no table names.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    for name in &context.document.unused_styles {
        let message = format!("no table names the style '{}'", name.as_str());
        let finding = context.finding(FindingCode::UnusedStyle, name.span().unwrap_or_default(), message);
        sink.add(finding.with_help(format!("add `style = \"{}\"` to a table, or remove it", name.as_str())));
    }
}
