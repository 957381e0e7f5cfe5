//! A message that points at a place in the scene file.
//!
//! Rendered as text without color, so that it reads the same on a terminal, in a log and in a test:
//!
//! ```text
//! hill.toml:12:1: error: unknown key `widht` in [[road]]
//!    |
//! 12 | widht = 4
//!    | ^^^^^
//!    = help: did you mean `width`?
//! ```

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::description::snippet::{harmless, snippet};
use crate::description::source_text::{LineColumn, SourceText};

/// One thing wrong with a scene file, where, and what to do about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    source: Arc<SourceText>,
    span: Range<usize>,
    message: String,
    label: Option<String>,
    help: Option<String>,
}

impl Diagnostic {
    /// `message` about the bytes `span` of `source`.
    pub fn new(source: &Arc<SourceText>, span: Range<usize>, message: impl Into<String>) -> Self {
        Self { source: Arc::clone(source), span, message: message.into(), label: None, help: None }
    }

    /// The same with a remedy.
    #[must_use]
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// The same with a few words beside the underlined text.
    #[must_use]
    pub fn with_label(self, label: impl Into<String>) -> Self {
        Self { label: Some(label.into()), ..self }
    }

    /// What is wrong, one sentence.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// What to do about it.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The bytes it is about.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Where it starts.
    pub fn position(&self) -> LineColumn {
        self.source.line_column(self.span.start)
    }

    /// The text it points into.
    pub fn source_text(&self) -> &Arc<SourceText> {
        &self.source
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = self.position();
        let line = self.source.line_at(self.span.start);
        let mark = self.span.start.saturating_sub(line.start)..self.span.end.saturating_sub(line.start);
        let shown = snippet(&self.source.text()[line], mark);
        let number = at.line.to_string();
        let gutter = " ".repeat(number.len());
        let (name, message) = (harmless(self.source.name_at(self.span.start)), harmless(&self.message));
        writeln!(out, "{name}:{}:{}: error: {message}", at.line, at.column)?;
        writeln!(out, "{gutter} |")?;
        writeln!(out, "{}", format!("{number} | {}", shown.line).trim_end())?;
        write!(out, "{gutter} | {}", shown.carets)?;
        if let Some(label) = &self.label {
            write!(out, " {}", harmless(label))?;
        }
        if let Some(help) = &self.help {
            write!(out, "\n{gutter} = help: {}", harmless(help))?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

/// Everything wrong with a scene file, in the order of the file; never empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    omitted: usize,
}

/// The most errors kept of one file: more than anybody mends before the next run, few enough to bound what
/// a hostile file can make us print.
const MAX_ERRORS: usize = 50;

impl Diagnostics {
    /// `list` in the order of the file, shortened to what anybody reads; `None` where it is empty.
    pub fn new(list: Vec<Diagnostic>) -> Option<Self> {
        Self::with_omitted(list, 0)
    }

    fn with_omitted(mut list: Vec<Diagnostic>, omitted: usize) -> Option<Self> {
        list.sort_by_key(|diagnostic| diagnostic.span.start);
        let omitted = omitted + list.len().saturating_sub(MAX_ERRORS);
        list.truncate(MAX_ERRORS);
        (!list.is_empty()).then_some(Self { list, omitted })
    }

    /// All that are kept.
    pub fn as_slice(&self) -> &[Diagnostic] {
        &self.list
    }

    /// How many more there were.
    pub fn omitted(&self) -> usize {
        self.omitted
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(only: Diagnostic) -> Self {
        Self { list: vec![only], omitted: 0 }
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, diagnostic) in self.list.iter().enumerate() {
            if index > 0 {
                out.write_str("\n\n")?;
            }
            diagnostic.fmt(out)?;
        }
        match self.omitted {
            0 => Ok(()),
            1 => out.write_str("\n\nand 1 more error"),
            more => write!(out, "\n\nand {more} more errors"),
        }
    }
}

impl std::error::Error for Diagnostics {}

/// Collects what is wrong while reading goes on.
#[derive(Debug)]
pub(super) struct DiagnosticSink {
    source: Arc<SourceText>,
    list: Vec<Diagnostic>,
    omitted: usize,
}

impl DiagnosticSink {
    /// Nothing wrong yet.
    pub fn new(source: Arc<SourceText>) -> Self {
        Self { source, list: Vec::new(), omitted: 0 }
    }

    /// The text that is read.
    pub fn source(&self) -> &SourceText {
        &self.source
    }

    /// Whether more errors are only counted, so that no thought need be given to their wording.
    pub fn is_full(&self) -> bool {
        self.list.len() >= MAX_ERRORS
    }

    /// Notes one error.
    pub fn error(&mut self, span: Range<usize>, message: impl Into<String>, help: Option<String>) {
        if self.is_full() {
            self.omitted += 1;
            return;
        }
        let error = Diagnostic { help, ..Diagnostic::new(&self.source, span, message) };
        // A style is read once for each table that takes its keys.
        if !self.list.contains(&error) {
            self.list.push(error);
        }
    }

    /// Everything noted, in the order of the file; `None` where there was nothing.
    pub fn into_diagnostics(self) -> Option<Diagnostics> {
        Diagnostics::with_omitted(self.list, self.omitted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagnostic_reads_as_place_line_carets_and_help() {
        let source = SourceText::new("hill.toml", "[[road]]\nwidht = 4\n");
        let shown = Diagnostic::new(&source, 9..14, "unknown key `widht`")
            .with_label("here")
            .with_help("did you mean `width`?");
        let expected = "hill.toml:2:1: error: unknown key `widht`\n  |\n2 | widht = 4\n  | ^^^^^ here\n  = help: did you mean `width`?";
        assert_eq!(shown.to_string(), expected);
    }

    #[test]
    fn what_a_message_quotes_cannot_steer_the_terminal() {
        let source = SourceText::new("a\u{1b}", "x\u{1b}[2J");
        let shown = Diagnostic::new(&source, 0..1, "m\u{1b}").with_help("h\n\u{202e}").to_string();
        assert!(!shown.contains(['\u{1b}', '\u{202e}']) && shown.lines().count() == 5, "{shown}");
    }

    #[test]
    fn a_span_past_the_end_is_shown_at_the_end() {
        let source = SourceText::new("a", "x = 1\n");
        assert!(Diagnostic::new(&source, 90..99, "m").to_string().starts_with("a:2:1: error: m"));
    }

    #[test]
    fn errors_beyond_the_limit_are_counted() {
        let mut report = DiagnosticSink::new(SourceText::new("a", "x"));
        for number in 0..MAX_ERRORS + 3 {
            report.error(0..1, format!("m{number}"), None);
        }
        let all = report.into_diagnostics().expect("errors");
        assert_eq!((all.as_slice().len(), all.omitted()), (MAX_ERRORS, 3));
        assert!(all.to_string().ends_with("and 3 more errors"));
    }
}
