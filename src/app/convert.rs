//! `sandtable dem convert`: elevation files in another form.

use std::path::PathBuf;

use clap::Args;

use crate::app::failure::Failure;

/// `dem convert`.
#[derive(Debug, Args)]
pub struct ConvertOptions {
    /// The elevation file or scene
    pub file: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read.
pub fn run(options: &ConvertOptions) -> Result<(), Failure> {
    Err(Failure::input(format!("{}: this command is not there yet", options.file.display())))
}
