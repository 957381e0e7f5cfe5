//! Errors about files, and the text of an error with its causes.

use std::error::Error;
use std::iter::successors;
use std::path::{Path, PathBuf};

use crate::pipeline::files::display_name;

/// An error about a file.
#[derive(Debug, thiserror::Error)]
#[error("{}", display_name(path))]
pub struct FileError<E: Error + 'static> {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub cause: E,
}

impl<E: Error + 'static> FileError<E> {
    /// The error for `path`.
    pub fn new(path: &Path, cause: impl Into<E>) -> Self {
        Self { path: path.to_owned(), cause: cause.into() }
    }

    /// Makes the errors for `path`, for `map_err`.
    pub fn at(path: &Path) -> impl Fn(E) -> Self + '_ {
        |cause| Self { path: path.to_owned(), cause }
    }
}

/// The text of `error`, then those of its causes, with colons between.
///
/// A cause that the text already quotes is left out.
pub fn error_text(error: &(dyn Error + 'static)) -> String {
    let causes = successors(error.source(), |&error| error.source());
    causes.map(ToString::to_string).fold(error.to_string(), |text, cause| {
        if text.contains(&cause) { text } else { format!("{text}: {cause}") }
    })
}
