//! `sandtable profile`: the ground along a line.

use std::path::PathBuf;

use clap::Args;

use crate::app::failure::Failure;

/// `profile`.
#[derive(Debug, Args)]
pub struct ProfileOptions {
    /// The elevation file or scene
    pub file: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read.
pub fn run(options: &ProfileOptions) -> Result<(), Failure> {
    Err(Failure::input(format!("{}: this command is not there yet", options.file.display())))
}
