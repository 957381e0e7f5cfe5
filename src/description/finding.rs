//! A finding of the check of a scene: a code, a place, a sentence with its numbers, and a remedy.
//!
//! ```text
//! hill.toml:12:10: warning[river-uphill]: river 'Ay' rises downstream by 14.2 m at 1.3 km
//!    |
//! 12 | points = [[750000, 4018000], [751000, 4019000]]
//!    |          ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
//!    |
//!    = help: reverse its points
//! ```

use std::cmp::Ordering;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::diagnostic::Diagnostic;
use crate::finding_code::FindingCode;
use crate::source_place::{SourcePlace, harmless};
use crate::source_text::SourceText;

/// The severity of a finding. The gravest comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The picture would be wrong: a check fails.
    Error,
    /// The picture may be wrong, or something has no effect: somebody should look.
    Warning,
    /// What was done that the scene file does not state.
    Note,
}

impl Severity {
    /// All of them, the gravest first.
    pub const ALL: [Self; 3] = [Self::Error, Self::Warning, Self::Note];

    /// Its word in messages.
    pub fn word(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// One finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The code.
    pub code: FindingCode,
    /// The bytes of the scene file that it is about; `None` where it is about none in particular.
    pub place: Option<SourcePlace>,
    /// A sentence with numbers and units.
    pub message: String,
    /// The remedy.
    pub help: Option<String>,
    /// The number of similar findings in the same table, of which this is the worst.
    pub more: usize,
}

impl Finding {
    /// A finding without a place and a remedy.
    pub fn new(code: FindingCode, message: impl Into<String>) -> Self {
        Self { code, place: None, message: message.into(), help: None, more: 0 }
    }

    /// This finding at the bytes `span` of `source`; without a place where `span` is empty and at the start.
    #[must_use]
    pub fn at(self, source: &Arc<SourceText>, span: Range<usize>) -> Self {
        let place = (span != (0..0)).then(|| SourcePlace::new(source, span));
        Self { place, ..self }
    }

    /// This finding with a remedy.
    #[must_use]
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// This finding as the worst of `more` further ones like it.
    #[must_use]
    pub fn and_more(self, more: usize) -> Self {
        Self { more, ..self }
    }

    /// The severity of the finding.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }

    /// The order of output: by place, findings without a place first; at one place the gravest first.
    pub fn order(&self, other: &Self) -> Ordering {
        let key = |finding: &Self| {
            let span = finding.place.as_ref().map(SourcePlace::span);
            (span.map(|span| span.start), finding.severity(), finding.code)
        };
        key(self).cmp(&key(other)).then_with(|| self.message.cmp(&other.message))
    }
}

impl From<&Diagnostic> for Finding {
    fn from(error: &Diagnostic) -> Self {
        Self {
            code: error.code(),
            place: Some(error.place().clone()),
            message: error.message(),
            help: error.help().map(str::to_owned),
            more: 0,
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = self.code.head();
        match (&self.place, &self.help) {
            (Some(place), help) => place.show(out, &head, &self.message, help.as_deref()),
            (None, None) => write!(out, "{head}: {}", harmless(&self.message)),
            (None, Some(help)) => {
                write!(out, "{head}: {}\n  = help: {}", harmless(&self.message), harmless(help))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_reads_as_place_code_line_carets_and_help() {
        let source = SourceText::new("hill.toml", "[[road]]\nwidth = 4\n");
        let finding = Finding::new(FindingCode::UnusedStyle, "m").at(&source, 9..14).with_help("h");
        let expected =
            "hill.toml:2:1: warning[unused-style]: m\n  |\n2 | width = 4\n  | ^^^^^\n  |\n  = help: h";
        assert_eq!(finding.to_string(), expected);
    }

    #[test]
    fn a_finding_without_a_place_shows_none_and_cannot_steer_the_terminal() {
        let source = SourceText::new("a", "x");
        let finding =
            Finding::new(FindingCode::UnusedStyle, "m\u{1b}").at(&source, 0..0).with_help("h\u{202e}");
        assert_eq!(finding.to_string(), "warning[unused-style]: m\u{fffd}\n  = help: h\u{fffd}");
    }

    #[test]
    fn findings_are_in_the_order_of_the_file_and_the_gravest_first() {
        let source = SourceText::new("a", "xyz");
        let at = |code, span| Finding::new(code, "m").at(&source, span);
        let mut found = [
            at(FindingCode::UnusedStyle, 2..3),
            at(FindingCode::UnusedStyle, 1..2),
            at(FindingCode::UnknownKey, 1..2),
            at(FindingCode::UnusedStyle, 0..0),
        ];
        found.sort_by(Finding::order);
        let starts = found.clone().map(|finding| finding.place.map(|place| place.span().start));
        assert_eq!(starts, [None, Some(1), Some(1), Some(2)]);
        assert_eq!(found[1].code, FindingCode::UnknownKey);
    }
}
