//! A place in the scene file, and messages about it.
//!
//! Rendered by the crate `annotate-snippets` as text without color, so that it reads the same on a terminal, in a log
//! and in a test:
//!
//! ```text
//! hill.toml:12:1: error[unknown-key]: unknown key `widht` in [[road]]
//!    |
//! 12 | widht = 4
//!    | ^^^^^
//!    |
//!    = help: did you mean `width`?
//! ```
//!
//! The crate expands tabs, counts wide characters and cuts long lines. It passes some control characters on, so they
//! are replaced before.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::source_text::{LineColumn, SourceText};

/// Bytes of a scene file, or of a file that it includes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourcePlace {
    source: Arc<SourceText>,
    span: Range<usize>,
}

/// The cells of a terminal that a line and its number take at most.
pub(super) const WIDTH: usize = 120;

impl SourcePlace {
    /// The bytes `span` of `source`.
    pub fn new(source: &Arc<SourceText>, span: Range<usize>) -> Self {
        Self { source: Arc::clone(source), span }
    }

    /// The name of the file in messages.
    pub fn file(&self) -> &str {
        self.source.name_at(self.span.start)
    }

    /// The line and column where it starts.
    pub fn position(&self) -> LineColumn {
        self.source.line_column(self.span.start)
    }

    /// The bytes of the concatenated text of the scene's files.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Writes `FILE:LINE:COLUMN: HEAD: MESSAGE`, the line with carets under the place, and the remedy.
    pub(super) fn show(
        &self,
        out: &mut fmt::Formatter<'_>,
        head: &str,
        message: &str,
        help: Option<&str>,
    ) -> fmt::Result {
        let (text, position) = (self.source.text(), self.position());
        let line = self.source.line_at(self.span.start);
        let boundary = |at: usize| text.floor_char_boundary(at.clamp(line.start, line.end));
        let (start, end) = (boundary(self.span.start), boundary(self.span.end));
        let parts = [line.start..start, start..end, end..line.end].map(|part| harmless(&text[part]));
        let mark = parts[0].len()..parts[0].len() + parts[1].len();
        let snippet = Snippet::source(parts.concat())
            .line_start(position.line)
            .fold(false)
            .annotation(AnnotationKind::Primary.span(mark));
        let mut group = Group::with_level(Level::ERROR).element(snippet);
        if let Some(help) = help {
            group = group.element(Level::HELP.message(harmless(help)));
        }
        let LineColumn { line, column } = position;
        let shown = Renderer::plain().term_width(WIDTH).render(&[group]);
        let (name, message) = (harmless(self.file()), harmless(message));
        write!(out, "{name}:{line}:{column}: {head}: {message}\n{shown}")
    }
}

/// `text` with a replacement character for every control and direction mark but the tab: they could steer a terminal.
pub(super) fn harmless(text: &str) -> String {
    let visible = |character: char| match character {
        '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        _ if character.is_control() && character != '\t' => '\u{fffd}',
        _ => character,
    };
    text.chars().map(visible).collect()
}
