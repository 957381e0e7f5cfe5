//! The errors that keep a scene from being built: of one run as many as can be told, each of a table that the others do not
//! need.

use std::error::Error;
use std::fmt;
use std::sync::Arc;

use crate::cause_code::coded;
use sandtable_description::diagnostic::{Diagnostic, DiagnosticSink, Diagnostics};
use sandtable_description::source_text::SourceText;

/// Why a scene cannot be built, in the order of its file; never empty.
#[derive(Clone, Debug)]
pub struct BuildErrors(Diagnostics);

impl BuildErrors {
    /// The errors that are kept: [`Diagnostics`] counts those beyond.
    pub fn as_slice(&self) -> &[Diagnostic] {
        self.0.as_slice()
    }

    /// The first of them.
    pub fn into_first(self) -> Diagnostic {
        self.0.as_slice().first().cloned().expect("never empty")
    }
}

impl From<Diagnostic> for BuildErrors {
    fn from(only: Diagnostic) -> Self {
        Self(coded(only).into())
    }
}

impl fmt::Display for BuildErrors {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(out)
    }
}

impl Error for BuildErrors {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&self.0)
    }
}

/// Collects errors while a scene is built, so that those of later tables are told as well.
#[derive(Debug)]
pub struct BuildErrorSink(DiagnosticSink);

impl BuildErrorSink {
    /// No errors yet, about a scene file.
    pub fn new(source: &Arc<SourceText>) -> Self {
        Self(DiagnosticSink::new(Arc::clone(source)))
    }

    /// The value of `result`; `None` where that is an error, which is kept.
    pub fn keep<T>(&mut self, result: Result<T, Diagnostic>) -> Option<T> {
        result.map_err(|error| self.0.add(coded(error))).ok()
    }

    /// Whether none was kept.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// # Errors
    /// Those that were kept, where any were.
    pub fn finish(self) -> Result<(), BuildErrors> {
        self.0.into_diagnostics().map_or(Ok(()), |errors| Err(BuildErrors(errors)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_told_in_the_order_of_the_file_and_each_once() {
        let source = SourceText::new("a.toml", "one\ntwo\n");
        let mut errors = BuildErrorSink::new(&source);
        assert_eq!(errors.keep(Ok::<_, Diagnostic>(7)), Some(7));
        assert!(errors.is_empty());
        for span in [4..7, 0..3, 4..7] {
            assert_eq!(errors.keep(Err::<(), _>(Diagnostic::new(&source, span, "no"))), None);
        }
        let found = errors.finish().expect_err("two were kept");
        let lines: Vec<usize> = found.as_slice().iter().map(|error| error.position().line).collect();
        assert_eq!(lines, [1, 2]);
        assert_eq!(found.into_first().position().line, 1);
        assert!(BuildErrorSink::new(&source).finish().is_ok());
    }
}
