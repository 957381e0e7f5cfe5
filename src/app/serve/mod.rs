//! `sandtable serve`: the height query service over HTTP.

use std::path::PathBuf;

use clap::Args;

use crate::app::failure::Failure;

/// `serve`.
#[derive(Debug, Args)]
pub struct ServeOptions {
    /// The elevation file or scene
    pub file: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read.
pub fn run(options: &ServeOptions) -> Result<(), Failure> {
    Err(Failure::input(format!("{}: this command is not there yet", options.file.display())))
}
