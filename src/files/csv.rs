//! Tables of numbers as text: comma, semicolon or white space between the fields, with or without a header.

use std::fmt::Display;

/// A line that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name}:{line}: {fault}")]
pub struct LineError<F: Display> {
    /// The file.
    pub name: String,
    /// From 1.
    pub line: usize,
    /// The fault.
    pub fault: F,
}

/// The lines that hold something, with their numbers from 1: no byte order mark, no empty lines, no comments (`#`).
pub fn numbered_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.trim_start_matches('\u{feff}').lines().zip(1..).map(|(line, number)| (number, line));
    lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
}

/// The fields of a line, without quotes and white space around them. White space separates fields where the line has
/// neither a comma nor a semicolon.
pub fn fields(line: &str) -> impl Iterator<Item = &str> {
    let separator = [',', ';'].into_iter().find(|&separator| line.contains(separator));
    line.split(move |at: char| separator.map_or(at.is_whitespace(), |separator| at == separator))
        .map(|field| field.trim().trim_matches('"'))
        .filter(move |field| separator.is_some() || !field.is_empty())
}

/// Whether a first line names columns: none of its fields is a number.
pub fn is_header(line: &str) -> bool {
    fields(line).all(|field| field.parse::<f64>().is_err())
}
