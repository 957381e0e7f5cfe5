//! Writing results to standard output.
//!
//! A reader that goes away (`sandtable … | head`) has seen what it wanted: that is no failure, and nothing to
//! panic about. A full disk behind a redirection is one.

use std::io::{self, Write};

use crate::app::failure::CliError;

/// Prints `text` and flushes it.
///
/// # Errors
/// Standard output cannot be written, for another reason than that nobody reads it any more.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    ignore_broken_pipe(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Takes a reader that has gone away for success.
///
/// # Errors
/// Everything else that went wrong while writing.
pub fn ignore_broken_pipe(written: io::Result<()>) -> Result<(), CliError> {
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::input(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// `lines`, each ended.
pub fn text_of(lines: &[String]) -> String {
    lines.iter().flat_map(|line| [line.as_str(), "\n"]).collect()
}

/// Prints a line on standard error, where it can be written.
pub fn warn(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}
