//! Errors in a scene file: each points at its place, and all are reported at once.

use std::error::Error;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::finding_code::FindingCode;
use crate::source_place::SourcePlace;
use crate::source_text::{LineColumn, SourceText};
use sandtable_base::message::chain::error_text;

/// One error in a scene file: its cause, its place, and a remedy.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    code: FindingCode,
    place: SourcePlace,
    cause: Arc<dyn Error + Send + Sync>,
    help: Option<String>,
}

impl Diagnostic {
    /// An error about the bytes `span` of `source`; `cause` is an error or a sentence. Its code is that of a wrong value.
    pub fn new(
        source: &Arc<SourceText>,
        span: Range<usize>,
        cause: impl Into<Box<dyn Error + Send + Sync>>,
    ) -> Self {
        let (code, place) = (FindingCode::WrongValue, SourcePlace::new(source, span));
        Self { code, place, cause: cause.into().into(), help: None }
    }

    /// This error with another code.
    #[must_use]
    pub fn with_code(self, code: FindingCode) -> Self {
        Self { code, ..self }
    }

    /// This error with a remedy.
    #[must_use]
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// The cause and its own causes in one sentence.
    pub fn message(&self) -> String {
        error_text(self.cause.as_ref())
    }

    /// The remedy.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The code of the error.
    pub fn code(&self) -> FindingCode {
        self.code
    }

    /// The place of the error.
    pub fn place(&self) -> &SourcePlace {
        &self.place
    }

    /// The line and column where the error starts.
    pub fn position(&self) -> LineColumn {
        self.place.position()
    }

    fn is_same(&self, other: &Self) -> bool {
        self.place.span() == other.place.span() && self.message() == other.message()
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.place.show(out, &self.code.head(), &self.message(), self.help())
    }
}

impl Error for Diagnostic {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(self.cause.as_ref())
    }
}

/// All errors in a scene file, in the order of the file; never empty.
#[derive(Clone, Debug)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    omitted: usize,
}

/// The most errors that are kept of one scene. Bounds the output for a hostile file.
const MAX_ERRORS: usize = 50;

impl Diagnostics {
    /// The errors that are kept.
    pub fn as_slice(&self) -> &[Diagnostic] {
        &self.list
    }

    /// The number of further errors, which are not kept.
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
            write!(out, "{}{diagnostic}", if index > 0 { "\n\n" } else { "" })?;
        }
        match self.omitted {
            0 => Ok(()),
            1 => out.write_str("\n\nand 1 more error"),
            more => write!(out, "\n\nand {more} more errors"),
        }
    }
}

impl Error for Diagnostics {}

/// Collects errors, so that work continues after the first.
#[derive(Debug)]
pub struct DiagnosticSink {
    source: Arc<SourceText>,
    list: Vec<Diagnostic>,
    omitted: usize,
}

impl DiagnosticSink {
    /// No errors yet, about a scene file.
    pub fn new(source: Arc<SourceText>) -> Self {
        Self { source, list: Vec::new(), omitted: 0 }
    }

    /// The scene file.
    pub fn source(&self) -> &Arc<SourceText> {
        &self.source
    }

    /// Whether there is none so far.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether more errors are only counted.
    pub fn is_full(&self) -> bool {
        self.list.len() >= MAX_ERRORS
    }

    /// Adds an error about the bytes `span`, with a remedy.
    pub fn error(
        &mut self,
        span: Range<usize>,
        cause: impl Into<Box<dyn Error + Send + Sync>>,
        help: impl Into<String>,
    ) {
        self.add(Diagnostic::new(&self.source, span, cause).with_help(help));
    }

    /// As [`Self::error`], with a code of its own.
    pub fn coded(
        &mut self,
        code: FindingCode,
        span: Range<usize>,
        cause: impl Into<Box<dyn Error + Send + Sync>>,
        help: impl Into<String>,
    ) {
        self.add(Diagnostic::new(&self.source, span, cause).with_help(help).with_code(code));
    }

    /// Adds an error unless it is a repetition: a style is read for every table that names it.
    pub fn add(&mut self, error: Diagnostic) {
        if self.is_full() {
            self.omitted += 1;
        } else if !self.list.iter().any(|other| other.is_same(&error)) {
            self.list.push(error);
        }
    }

    /// The errors in the order of the file; `None` where there are none.
    pub fn into_diagnostics(mut self) -> Option<Diagnostics> {
        self.list.sort_by_key(|diagnostic| diagnostic.place.span().start);
        (!self.list.is_empty()).then_some(Diagnostics { list: self.list, omitted: self.omitted })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source_place::WIDTH;

    fn shown(text: &str, span: Range<usize>) -> String {
        Diagnostic::new(&SourceText::new("a", text), span, "m").to_string()
    }

    #[test]
    fn a_diagnostic_reads_as_place_line_carets_and_help() {
        let source = SourceText::new("hill.toml", "[[road]]\nwidht = 4\n");
        let shown = Diagnostic::new(&source, 9..14, "unknown key `widht`").with_help("did you mean `width`?");
        let expected = "hill.toml:2:1: error[wrong-value]: unknown key `widht`\n  |\n2 | widht = 4\n  | ^^^^^\n  |\n  = help: did you mean `width`?";
        assert_eq!(shown.to_string(), expected);
    }

    #[test]
    fn a_diagnostic_keeps_its_cause_and_states_each_cause_once() {
        #[derive(Debug, thiserror::Error)]
        #[error("it cannot be read")]
        struct Unreadable(#[source] std::fmt::Error);
        let source = SourceText::new("a", "x");
        let error = Diagnostic::new(&source, 0..1, Unreadable(std::fmt::Error));
        assert!(error.source().is_some_and(|cause| cause.is::<Unreadable>()));
        assert_eq!(error.message(), format!("it cannot be read: {}", std::fmt::Error));
    }

    #[test]
    fn what_a_message_quotes_cannot_steer_the_terminal() {
        let source = SourceText::new("a\u{1b}", "x\u{1b}[2J\u{9b}\u{202e}");
        let shown = Diagnostic::new(&source, 0..1, "m\u{1b}").with_help("h\n\u{202e}").to_string();
        assert!(!shown.contains(['\u{1b}', '\u{9b}', '\u{202e}']), "{shown}");
        assert_eq!(shown.lines().count(), 6, "{shown}");
    }

    #[test]
    fn carets_stand_under_their_characters_whatever_their_width() {
        let under = |line: &str, word: &str| {
            let start = line.find(word).expect("the word is in the line");
            shown(line, start..start + word.len()).lines().last().expect("carets").to_owned()
        };
        assert_eq!(under("width = 3", "3"), "  |         ^");
        assert_eq!(under("\twidth = 3", "width"), "  |     ^^^^^");
        assert_eq!(under("名前 = 坏", "坏"), "  |        ^^");
    }

    #[test]
    fn an_empty_span_gets_one_caret_where_it_is() {
        for (text, span, carets) in [
            ("a =", 3..3, "  |    ^"),
            ("[terrain]", 0..0, "  | ^"),
            ("", 0..0, "  | ^"),
            ("a = 1", 9..12, "  |      ^"),
        ] {
            assert_eq!(shown(text, span).lines().last(), Some(carets), "{text}");
        }
        assert!(shown("x = 1\n", 90..99).starts_with("a:2:1: error[wrong-value]: m"));
    }

    #[test]
    fn long_lines_are_cut_around_the_span() {
        let line = format!("{}BAD{}", "x".repeat(500), "y".repeat(500));
        let shown = shown(&line, 500..503);
        let [.., line, carets] = shown.lines().collect::<Vec<_>>()[..] else { panic!("{shown}") };
        assert!(line.chars().count() <= WIDTH && carets.chars().count() <= WIDTH, "{shown}");
        assert_eq!(line.find("BAD"), carets.find("^^^"), "{shown}");
    }

    #[test]
    fn errors_beyond_the_limit_are_counted() {
        let mut report = DiagnosticSink::new(SourceText::new("a", "x"));
        for number in 0..MAX_ERRORS + 3 {
            report.error(0..1, format!("m{number}"), "");
        }
        let all = report.into_diagnostics().expect("errors");
        assert_eq!((all.as_slice().len(), all.omitted()), (MAX_ERRORS, 3));
        assert!(all.to_string().ends_with("and 3 more errors"));
    }
}
