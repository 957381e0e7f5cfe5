//! `sandtable los`: whether one point can be seen from another.

use std::path::PathBuf;

use clap::Args;

use crate::app::failure::Failure;

/// `los`.
#[derive(Debug, Args)]
pub struct LosOptions {
    /// The elevation file or scene
    pub file: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read.
pub fn run(options: &LosOptions) -> Result<(), Failure> {
    Err(Failure::input(format!("{}: this command is not there yet", options.file.display())))
}
