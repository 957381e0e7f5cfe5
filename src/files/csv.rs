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
/// neither a comma nor a semicolon outside quotes.
///
/// A quote opens a field at its beginning and closes it at its end, so that a separator within is text, and a mark of
/// seconds of arc is one: `"36.3N, 84.2W",hill` has two fields, as has `36°16'37"N,84°12'54"W`.
pub fn fields(line: &str) -> impl Iterator<Item = &str> {
    Fields { rest: Some(line), separator: separator_of(line) }
}

/// A comma or else a semicolon that stands outside quotes.
fn separator_of(line: &str) -> Option<char> {
    if !line.contains('"') {
        return [',', ';'].into_iter().find(|&separator| line.contains(separator));
    }
    let is_either = |at: char| at == ',' || at == ';';
    let (mut rest, mut found) = (line, None);
    loop {
        let end = match quoted(rest, is_either) {
            Some((_, after)) => after.map(|after| rest.len() - after.len() - 1),
            None => rest.find(is_either),
        };
        match end.map(|end| rest.split_at(end)) {
            None => return found,
            Some((_, after)) if after.starts_with(',') => return Some(','),
            Some((_, after)) => (rest, found) = (&after[1..], Some(';')),
        }
    }
}

/// What is left of a line.
struct Fields<'a> {
    rest: Option<&'a str>,
    /// White space where there is none.
    separator: Option<char>,
}

impl<'a> Iterator for Fields<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest.take()?;
        let is_separator = |at: char| self.separator.map_or(at.is_whitespace(), |separator| at == separator);
        let rest = if self.separator.is_some() { rest } else { rest.trim_start() };
        if self.separator.is_none() && rest.is_empty() {
            return None;
        }
        if let Some((field, after)) = quoted(rest, is_separator) {
            self.rest = after;
            return Some(field);
        }
        let (field, after) = match rest.split_once(is_separator) {
            Some((field, after)) => (field, Some(after)),
            None => (rest, None),
        };
        self.rest = after;
        Some(field.trim().trim_matches('"'))
    }
}

/// The quoted field that a text begins with, and what follows its separator.
fn quoted(text: &str, is_separator: impl Fn(char) -> bool) -> Option<(&str, Option<&str>)> {
    let inner = text.trim_start().strip_prefix('"')?;
    let mut from = 0;
    loop {
        let at = from + inner[from..].find('"')?;
        let after = &inner[at + 1..];
        if let Some(doubled) = after.strip_prefix('"') {
            from = inner.len() - doubled.len();
            continue;
        }
        let ending = after.trim_start_matches(|space: char| space.is_whitespace() && !is_separator(space));
        return match ending.chars().next() {
            None => Some((inner[..at].trim(), None)),
            Some(next) if is_separator(next) => Some((inner[..at].trim(), Some(&ending[next.len_utf8()..]))),
            // A quote within the field.
            Some(_) => None,
        };
    }
}

/// Whether a first line names columns: none of its fields is a number.
pub fn is_header(line: &str) -> bool {
    fields(line).all(|field| field.parse::<f64>().is_err())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(line: &str) -> Vec<&str> {
        fields(line).collect()
    }

    #[test]
    fn fields_are_parted_by_commas_semicolons_or_white_space() {
        assert_eq!(all("1, 2 ,3"), ["1", "2", "3"]);
        assert_eq!(all("1;2,5;"), ["1;2", "5;"]);
        assert_eq!(all("1;;3"), ["1", "", "3"]);
        assert_eq!(all("  1.5  2\t3 "), ["1.5", "2", "3"]);
        assert_eq!(all(""), [""; 0]);
        assert_eq!(all("a,"), ["a", ""]);
    }

    #[test]
    fn a_quoted_field_may_hold_separators_and_marks_of_seconds() {
        assert_eq!(all("\"36.3N, 84.2W\",hill"), ["36.3N, 84.2W", "hill"]);
        assert_eq!(all("\"a, b\";\"c\""), ["a, b", "c"]);
        assert_eq!(all("7;\"1\";\"2\""), ["7", "1", "2"]);
        assert_eq!(all("36°16'37\"N,84°12'54\"W"), ["36°16'37\"N", "84°12'54\"W"]);
        assert_eq!(all("\"16S GF 5 1\" hill"), ["16S GF 5 1", "hill"]);
        assert_eq!(all("\"36°16'37\"\"N\",x"), ["36°16'37\"\"N", "x"]);
        assert_eq!(all("\"open,1"), ["open", "1"]);
    }
}
