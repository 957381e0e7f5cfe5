//! Tables of text: comma, semicolon, tab or bar between the fields, quoted fields with separators and line ends (RFC 4180).

use serde_json::Value;

use super::cells::{TableRow, TableRows};
use crate::encoding::TextEncoding;

/// What may part the fields, the first of those that are as frequent.
const SEPARATORS: [char; 4] = ['\t', ';', ',', '|'];

/// The lines in which the separator is searched.
const PROBED_LINES: usize = 50;

/// The rows of a table.
pub(super) fn rows(bytes: &[u8]) -> TableRows {
    let (encoding, bytes) = TextEncoding::from_mark(bytes).unwrap_or_else(|| unmarked(bytes));
    let text = encoding.decode(bytes);
    let (stated, text) = match stated_separator(&text) {
        Some((separator, rest)) => (Some(separator), rest),
        None => (None, &*text),
    };
    let separator = stated.unwrap_or_else(|| separator_of(text));
    let mut table = TableRows { unit: "line", is_text: true, ..TableRows::default() };
    let mut reader = RowReader { rest: text, line: 1 + usize::from(stated.is_some()), separator };
    while let Some(row) = reader.row(&mut table.faults) {
        if !row.cells.is_empty() {
            table.rows.push(row);
        }
    }
    table
}

/// UTF-16 without a mark has a zero in every second byte of its first letters.
fn unmarked(bytes: &[u8]) -> (TextEncoding, &[u8]) {
    match bytes {
        [first, 0, second, 0, ..] if *first != 0 && *second != 0 => {
            (TextEncoding::Standard(encoding_rs::UTF_16LE), bytes)
        }
        [0, first, 0, second, ..] if *first != 0 && *second != 0 => {
            (TextEncoding::Standard(encoding_rs::UTF_16BE), bytes)
        }
        _ => (TextEncoding::Guess, bytes),
    }
}

/// The separator that Excel's first line `sep=;` states, and the text behind that line.
fn stated_separator(text: &str) -> Option<(char, &str)> {
    let (line, rest) = text.split_once('\n')?;
    let mut stated = line.trim_end_matches('\r').trim_matches('"').strip_prefix("sep=")?.chars();
    let separator = stated.next()?;
    stated.next().is_none().then_some((separator, rest))
}

/// The separator that parts the most lines into as many fields as the most frequent count is.
fn separator_of(text: &str) -> char {
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).take(PROBED_LINES).collect();
    let score = |separator: char| {
        let counts = lines.iter().map(|line| outside_quotes(line, separator)).filter(|count| *count > 0);
        let mut counts: Vec<usize> = counts.collect();
        counts.sort_unstable();
        // A quarter of the lines may be titles; decimal commas are in as many lines as a separator, but of fewer kinds.
        let most = counts.get(counts.len() / 2).copied().unwrap_or(0);
        counts.iter().filter(|count| **count == most).count() * 2 + usize::from(most > 0)
    };
    let mut best = (',', 0);
    for separator in SEPARATORS {
        let score = score(separator);
        if score > best.1 {
            best = (separator, score);
        }
    }
    best.0
}

fn outside_quotes(line: &str, separator: char) -> usize {
    let mut is_quoted = false;
    let mut count = 0;
    for letter in line.chars() {
        is_quoted ^= letter == '"';
        count += usize::from(letter == separator && !is_quoted);
    }
    count
}

/// What is left of a table.
struct RowReader<'a> {
    rest: &'a str,
    line: usize,
    separator: char,
}

impl RowReader<'_> {
    /// The next row, also an empty one; `None` at the end.
    fn row(&mut self, faults: &mut Vec<String>) -> Option<TableRow> {
        if self.rest.is_empty() {
            return None;
        }
        let mut row = TableRow { number: self.line, cells: Vec::new() };
        for column in 0.. {
            let (field, is_last) = self.field(faults);
            let field = field.trim();
            if !field.is_empty() {
                row.cells.push((column, Value::String(field.to_owned())));
            }
            if is_last {
                break;
            }
        }
        Some(row)
    }

    /// The next field, and whether its row ends with it.
    fn field(&mut self, faults: &mut Vec<String>) -> (String, bool) {
        let start = self.rest.trim_start_matches(' ');
        if let Some(inner) = start.strip_prefix('"') {
            match quoted(inner, self.separator) {
                Some((field, after)) => {
                    self.line += inner[..inner.len() - after.len()].matches('\n').count();
                    self.rest = after;
                    return (field, self.end_field());
                }
                None => {
                    let sentence = format!("line {}: a quote opens a field and none closes it", self.line);
                    if faults.is_empty() {
                        faults.push(sentence);
                    }
                }
            }
        }
        let is_end = |letter: char| letter == self.separator || letter == '\n' || letter == '\r';
        let end = self.rest.find(is_end).unwrap_or(self.rest.len());
        let (field, after) = self.rest.split_at(end);
        let field = field.to_owned();
        self.rest = after;
        (field, self.end_field())
    }

    /// Takes what ends a field; whether it ends the row.
    fn end_field(&mut self) -> bool {
        if let Some(rest) = self.rest.strip_prefix(self.separator) {
            self.rest = rest;
            return false;
        }
        let rest = self.rest.strip_prefix('\r').unwrap_or(self.rest);
        self.rest = rest.strip_prefix('\n').unwrap_or(rest);
        self.line += 1;
        true
    }
}

/// The quoted field whose opening quote stands before `inner`, and what follows its closing quote and spaces: a separator, the end
/// of a line or nothing. `None` where the quote is part of a field, such as a mark of seconds, or is not closed.
fn quoted(inner: &str, separator: char) -> Option<(String, &str)> {
    let mut field = String::new();
    let mut rest = inner;
    loop {
        let (before, after) = rest.split_once('"')?;
        field.push_str(before);
        if let Some(doubled) = after.strip_prefix('"') {
            field.push('"');
            rest = doubled;
            continue;
        }
        let after = after.trim_start_matches(' ');
        let ends = after.is_empty() || after.starts_with([separator, '\n', '\r']);
        return ends.then_some((field, after));
    }
}
