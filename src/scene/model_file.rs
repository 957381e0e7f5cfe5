//! Opening model files.

use std::path::Path;

use crate::assets::{AssetError, Assets};
use sandtable_files::disk::{self, ReadFileError};
use sandtable_files::error::FileError;
use sandtable_model::Model;
use sandtable_model::error::ModelError;
use sandtable_model::read;

/// A model that cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenModelError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] ReadFileError),
    /// The folder of the file cannot be read.
    #[error(transparent)]
    Folder(#[from] FileError<AssetError>),
    /// The file is empty, or of no format that is read; the error names it.
    #[error(transparent)]
    Unknown(ModelError),
    /// The file breaks its format.
    #[error(transparent)]
    Format(FileError<ModelError>),
}

/// Opens the model file at `path` with the files beside it.
///
/// # Errors
/// See [`OpenModelError`].
pub fn open(path: &Path) -> Result<Model, OpenModelError> {
    let folder = FileError::<AssetError>::at(path);
    let bytes = disk::read(path)?;
    let assets = Assets::new(path, &[]).map_err(&folder)?;
    let companions = assets.beside(&disk::file_name(path)).map_err(&folder)?;
    read::read(&path.to_string_lossy(), &bytes, &companions).map_err(|error| match error {
        ModelError::Empty { .. } | ModelError::Unknown { .. } => OpenModelError::Unknown(error),
        cause => OpenModelError::Format(FileError::new(path, cause)),
    })
}
