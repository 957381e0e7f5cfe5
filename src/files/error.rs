//! Errors about files.

use std::error::Error;
use std::iter::successors;
use std::path::{Path, PathBuf};

use crate::disk::display_name;
use sandtable_description::diagnostic::{Diagnostic, Diagnostics};

/// An error about a file.
#[derive(Debug, thiserror::Error)]
#[error("{}", display_name(path))]
pub struct FileError<E: Error + 'static> {
    /// The file.
    pub path: PathBuf,
    /// Its fault.
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

/// The errors in a scene file that `error` is about, as they are shown: each begins with its place, so that they stand alone.
/// `None` where it is about something else.
pub fn diagnostics_text(error: &(dyn Error + 'static)) -> Option<String> {
    let mut causes = successors(Some(error), |&error| error.source());
    causes.find(|cause| cause.is::<Diagnostic>() || cause.is::<Diagnostics>()).map(ToString::to_string)
}
