//! The findings of building a scene, for the user.

use std::ops::Range;
use std::sync::Arc;

use crate::feature::FeatureKind;
use sandtable_base::message::suggest::quoted;
use sandtable_description::document::Document;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::source_text::SourceText;

/// Findings so far, about one scene file.
#[derive(Clone, Debug)]
pub struct SceneFindings {
    source: Arc<SourceText>,
    list: Vec<Finding>,
}

/// A table of features, for messages about features that were left out.
#[derive(Clone, Copy, Debug)]
pub struct FeatureTable<'a> {
    /// What its features are.
    pub kind: FeatureKind,
    /// The name that it states.
    pub name: Option<&'a str>,
    /// Where its features come from.
    pub source: &'a FeatureSource,
}

impl SceneFindings {
    /// No findings yet, about the file of `document`.
    pub fn new(document: &Document) -> Self {
        Self { source: Arc::clone(&document.source), list: Vec::new() }
    }

    /// The scene file.
    pub fn source(&self) -> &Arc<SourceText> {
        &self.source
    }

    /// Adds a finding about the bytes `span` of the scene file; about none in particular where `span` is `0..0`.
    pub fn add(&mut self, code: FindingCode, span: Range<usize>, message: impl Into<String>) {
        self.push(Finding::new(code, message).at(&self.source, span));
    }

    /// [`Self::add`] with a remedy.
    pub fn add_with_help(&mut self, code: FindingCode, span: Range<usize>, message: String, help: &str) {
        self.push(Finding::new(code, message).at(&self.source, span).with_help(help));
    }

    /// Adds a finding.
    pub fn push(&mut self, finding: Finding) {
        self.list.push(finding);
    }

    /// Whether one of them has this message.
    pub fn state(&self, message: &str) -> bool {
        self.list.iter().any(|finding| finding.message == message)
    }

    /// Adds how many features of a table were left out, where any were, and why.
    pub fn left_out(&mut self, count: usize, table: &FeatureTable<'_>, why: &str) {
        if count > 0 {
            let what = table.name.map(|name| format!(" of '{name}'")).unwrap_or_default();
            let message = format!("{count} {}{what} left out: {why}", table.kind.noun(count));
            self.add(FindingCode::LeftOut, table.source.span(), message);
        }
    }

    /// Adds how many features of a table have no length or area and were left out, where any were, and why.
    pub fn without_extent(&mut self, count: usize, table: &FeatureTable<'_>, why: &str) {
        if count > 0 {
            let what = table.name.map(|name| format!(" of '{}'", quoted(name))).unwrap_or_default();
            let message = format!("{count} {}{what} left out: {why}", table.kind.noun(count));
            self.add(FindingCode::EmptyShape, table.source.span(), message);
        }
    }

    /// The findings in the order in which they were added.
    pub fn into_vec(self) -> Vec<Finding> {
        self.list
    }
}
