//! Errors of commands: the message on standard error and the exit code.

use std::error::Error;
use std::fmt::Display;

use crate::output::warn;
use sandtable_base::message::chain::error_text;
use sandtable_files::error::diagnostics_text;

/// Why a command stopped.
#[derive(Debug)]
pub enum CliError {
    /// The input is wrong or missing: exit code 1.
    Input {
        error: Box<dyn Error + Send + Sync>,
        /// A remedy, after the message.
        hint: Option<String>,
    },
    /// The command was used wrongly: exit code 2.
    Usage(String),
    /// What is wrong with the input is printed already: exit code 1.
    Reported,
}

impl<E: Error + Send + Sync + 'static> From<E> for CliError {
    fn from(error: E) -> Self {
        Self::Input { error: error.into(), hint: None }
    }
}

impl CliError {
    pub fn input(message: impl Into<String>) -> Self {
        Self::Input { error: message.into().into(), hint: None }
    }

    pub fn usage(message: impl Display) -> Self {
        Self::Usage(message.to_string())
    }

    /// Prints the message on standard error and returns the exit code.
    pub fn report(&self) -> u8 {
        match self {
            Self::Usage(message) => {
                warn(&format!("error: {message}"));
                2
            }
            Self::Reported => 1,
            Self::Input { error, hint } => {
                warn(&message(error.as_ref()));
                hint.iter().for_each(|hint| warn(hint));
                1
            }
        }
    }
}

/// The text of an error. Diagnostics of a scene file stand alone: they begin with the place in the file.
fn message(error: &(dyn Error + 'static)) -> String {
    diagnostics_text(error).unwrap_or_else(|| format!("error: {}", error_text(error)))
}
