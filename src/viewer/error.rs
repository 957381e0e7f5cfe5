//! Errors that leave no window.

use std::path::PathBuf;

use crate::script::ScriptError;
use sandtable_files::disk::{ReadFileError, WriteFileError};
use sandtable_gpu::error::GpuError;

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
    #[error("no graphics adapter can draw frames here ({0}); draw a picture with `sandtable render` instead")]
    NoFrames(String),
    #[error(
        "frames of {width}×{height} pixels exceed the {longest} a side that the graphics adapter draws; state a smaller --size"
    )]
    FrameSize { width: u32, height: u32, longest: u32 },
    #[error("the graphics adapter failed while {doing} ({cause}); `sandtable render` draws without one")]
    Adapter { doing: &'static str, cause: String },
    #[error("{}: {error}", path.display())]
    Script { path: PathBuf, error: ScriptError },
    #[error(transparent)]
    Read(#[from] ReadFileError),
    #[error(transparent)]
    Write(#[from] WriteFileError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The file that is viewed cannot be opened.
    #[error("{0}")]
    File(String),
}
