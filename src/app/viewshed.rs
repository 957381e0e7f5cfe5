//! `sandtable viewshed`: what can be seen from a point.

use std::path::PathBuf;

use clap::Args;

use crate::app::failure::Failure;

/// `viewshed`.
#[derive(Debug, Args)]
pub struct ViewshedOptions {
    /// The elevation file or scene
    pub file: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read.
pub fn run(options: &ViewshedOptions) -> Result<(), Failure> {
    Err(Failure::input(format!("{}: this command is not there yet", options.file.display())))
}
