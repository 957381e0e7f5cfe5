//! `sandtable dem grid`: a grid of scattered points.

use std::path::PathBuf;

use clap::Args;

use crate::app::failure::Failure;

/// `dem grid`.
#[derive(Debug, Args)]
pub struct GridOptions {
    /// The elevation file or scene
    pub file: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read.
pub fn run(options: &GridOptions) -> Result<(), Failure> {
    Err(Failure::input(format!("{}: this command is not there yet", options.file.display())))
}
