//! The cells of a table: those that are not empty, row by row.

use serde_json::Value;

/// One row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TableRow {
    /// The number that the user sees: of the line where it begins, or of the row in the sheet; from 1.
    pub number: usize,
    /// The cells that are not empty, with their columns from 0, in rising order.
    pub cells: Vec<(usize, Value)>,
}

/// All rows that are not empty.
#[derive(Debug, Default)]
pub(super) struct TableRows {
    pub rows: Vec<TableRow>,
    /// What a row is called: `line` or `row`.
    pub unit: &'static str,
    /// Whether cells come as they were typed, so that numbers are texts.
    pub is_text: bool,
    /// Sentences on what is wrong with the table as a whole.
    pub faults: Vec<String>,
}

impl TableRow {
    /// The cell in a column, from 0.
    pub fn cell(&self, column: usize) -> Option<&Value> {
        let found = self.cells.binary_search_by_key(&column, |(at, _)| *at).ok()?;
        Some(&self.cells[found].1)
    }

    /// The text of a cell, not empty.
    pub fn text(&self, column: usize) -> Option<String> {
        self.cell(column).map(written)
    }
}

/// The cell that holds a text, without the spaces round it; null for an empty one.
pub(super) fn text_value(text: &str) -> Value {
    match text.trim() {
        "" => Value::Null,
        text => Value::String(text.to_owned()),
    }
}

/// A cell as text.
pub(super) fn written(cell: &Value) -> String {
    match cell {
        Value::String(text) => text.clone(),
        Value::Number(number) => number
            .as_f64()
            .filter(|number| number.fract() == 0.0 && number.abs() < 1e15)
            .map_or_else(|| number.to_string(), |number| format!("{number:.0}")),
        other => other.to_string(),
    }
}

/// The number that a text is, with a decimal point or a decimal comma; `None` also for what is not finite.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim().trim_start_matches('+');
    let is_plain = |text: &str| {
        text.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b'e' | b'E'))
    };
    let parsed = match text.split_once(',') {
        None if is_plain(text) => text.parse(),
        // One comma and no point: thousands would need three digits behind, and a place has none.
        Some((whole, part)) if !text.contains('.') && !part.contains(',') => {
            format!("{whole}.{part}").parse()
        }
        _ => return None,
    };
    parsed.ok().filter(|number: &f64| number.is_finite())
}

/// The number of a cell.
pub(super) fn cell_number(cell: &Value) -> Option<f64> {
    match cell {
        Value::Number(number) => number.as_f64().filter(|number| number.is_finite()),
        Value::String(text) => number(text),
        _ => None,
    }
}

/// Whether a text is a number that remains the same when it is kept as one: no code with leading zeros or more digits than a
/// number has.
pub(super) fn is_faithful_number(text: &str) -> bool {
    let digits = text.trim_start_matches('-');
    let has_leading_zero =
        digits.len() > 1 && digits.starts_with('0') && !digits[1..].starts_with(['.', ',']);
    let count = digits.bytes().filter(u8::is_ascii_digit).count();
    let is_decimal = digits.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b','));
    is_decimal && !has_leading_zero && (1..=15).contains(&count) && number(text).is_some()
}
