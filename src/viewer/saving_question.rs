//! The questions before edits could be lost.

use std::path::PathBuf;

/// An action that leaves the edited scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// Closing the window.
    Close,
    /// Opening another file.
    Open(PathBuf),
    /// Reading the file again.
    Reload,
}

/// A question before edits are lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SavingQuestion {
    /// Whether to save edits before they would be lost.
    Unsaved(Leaving),
    /// Whether to save over what another program wrote.
    Conflict(String),
}
