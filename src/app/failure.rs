//! What a command can end with besides success.

use std::fmt::Display;
use std::process::ExitCode;

use crate::app::output;

/// Why a command stopped.
#[derive(Debug)]
pub enum CliError {
    /// The input is wrong, or cannot be had: exit code 1.
    Input(String),
    /// The command was used wrongly: exit code 2.
    Usage(String),
}

impl CliError {
    /// Wrong input; `reason` is shown to the user as it is.
    pub fn input(reason: impl Display) -> Self {
        Self::Input(reason.to_string())
    }

    /// Prints it on standard error. A message that already points at a place stands alone.
    pub fn report(&self) {
        let (Self::Input(reason) | Self::Usage(reason)) = self;
        let head = if reason.contains(": error: ") { "" } else { "error: " };
        output::warn(&format!("{head}{reason}"));
    }

    /// The program's exit code.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Input(_) => ExitCode::from(1),
            Self::Usage(_) => ExitCode::from(2),
        }
    }
}
