//! Errors about files.

use std::error::Error;
use std::path::{Path, PathBuf};

use crate::pipeline::files::display_name;

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
