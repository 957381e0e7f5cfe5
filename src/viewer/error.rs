//! Errors that leave no window.

use std::path::PathBuf;

use crate::script::ScriptError;
use sandtable_files::disk::ReadFileError;

/// Why no window can be shown. Each message names the command that needs none.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ViewerError {
    #[error("no window can be opened here ({0}); draw a picture with `sandtable render` instead")]
    NoDisplay(String),
    #[error(
        "no graphics adapter can draw in a window here ({0}); draw a picture with `sandtable render` instead"
    )]
    NoAdapter(String),
    #[error("the graphics adapter failed while {doing} ({cause}); `sandtable render` draws without one")]
    Adapter { doing: &'static str, cause: String },
    #[error("{}: {error}", path.display())]
    Script { path: PathBuf, error: ScriptError },
    #[error(transparent)]
    Read(#[from] ReadFileError),
}
