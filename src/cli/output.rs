//! Writing to standard output and standard error.
//!
//! A reader that closes the pipe (`sandtable … | head`) has all it wants, which is not an error. A full disk is one.

use std::io::{self, BufWriter, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::CliError;

/// Whether progress and summaries are left out, for the whole run.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Leaves out progress and summaries of written files from now on.
pub fn be_quiet() {
    IS_QUIET.store(true, Ordering::Relaxed);
}

/// Whether progress and summaries are left out.
pub fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

/// Standard output cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("standard output")]
struct StdoutError(#[source] io::Error);

pub fn print(text: &str) -> Result<(), CliError> {
    stream(|out| out.write_all(text.as_bytes()))
}

/// Prints `lines`, each with its end.
pub fn print_lines(lines: &[String]) -> Result<(), CliError> {
    stream(|out| lines.iter().try_for_each(|line| writeln!(out, "{line}")))
}

/// Prints what a command says of the files that it wrote; nothing where it is to be quiet.
pub fn print_summary(lines: &[String]) -> Result<(), CliError> {
    if is_quiet() { Ok(()) } else { print_lines(lines) }
}

/// Prints what `write` writes, buffered.
pub fn stream(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), CliError> {
    let mut out = BufWriter::new(io::stdout().lock());
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(StdoutError(error).into()),
        _ => Ok(()),
    }
}

/// A row of a summary: indented, the value aligned after a name of at most `width` characters.
pub fn row(width: usize, name: &str, value: impl std::fmt::Display) -> String {
    format!("  {name:<width$} {value}")
}

/// Prints a line on standard error, where possible.
pub fn warn(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Rows with columns as wide as their widest cells, two spaces apart; `is_left` names the columns aligned to the left.
pub fn aligned(rows: &[Vec<String>], is_left: impl Fn(usize) -> bool) -> Vec<String> {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let cell = |(column, cell): (usize, &String)| match is_left(column) {
        true => format!("{cell:<width$}", width = widths[column]),
        false => format!("{cell:>width$}", width = widths[column]),
    };
    rows.iter().map(|row| row.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let rows = [["a", "long"], ["method", "7"]].map(|row| row.map(str::to_owned).to_vec());
        assert_eq!(aligned(&rows, |column| column == 0), ["a       long", "method     7"]);
    }
}
