//! Workbooks of Excel 97 to 2003 (MS-XLS, BIFF8): the cells of their sheets, record by record.
//!
//! ```text
//!  globals   BOUNDSHEET   where each sheet begins      SST   texts that cells share      FORMAT, XF   which numbers are days
//!  sheet     LABELSST NUMBER RK MULRK FORMULA STRING BOOLERR LABEL   a cell each, MULRK several
//! ```
//!
//! Nothing is allocated by a declared size: a record lies within the file, and cells are counted by the caller.

use std::collections::BTreeSet;

use serde_json::Value;

use super::cells::text_value;
use super::compound_file::{f64_at, stream, u16_at, u32_at};

const BOF: u16 = 0x0809;
const EOF: u16 = 0x000a;
const CONTINUE: u16 = 0x003c;
const FILEPASS: u16 = 0x002f;
/// The version of BIFF8.
const BIFF8: u16 = 0x0600;
/// Days before the first of the calendar that begins in 1904.
const DAYS_TO_1904: f64 = 1462.0;

/// A cell: its row and column from 0, and its value.
pub(super) type BiffCell = (u32, u32, Value);

/// A sheet: its name and its cells in the order of the file.
pub(super) type BiffSheet = (String, Vec<BiffCell>);

/// The sheets of a workbook.
///
/// # Errors
/// What is wrong with the file.
pub(super) fn sheets(bytes: &[u8]) -> Result<Vec<BiffSheet>, String> {
    let book =
        stream(bytes, &["Workbook", "Book"]).ok_or("the compound file has no workbook that can be read")?;
    let records = BiffRecords { bytes: &book, at: 0 };
    let mut globals = BookGlobals::default();
    let mut found = Vec::new();
    let mut records = records.peekable();
    match records.next() {
        Some(first) if first.kind == BOF && u16_at(first.data, 0) == Some(BIFF8) => {}
        _ => return Err("it is older than Excel 97: save it as xlsx".to_owned()),
    }
    while let Some(record) = records.next() {
        match record.kind {
            EOF => break,
            FILEPASS => return Err("it is encrypted: save it without a password".to_owned()),
            0x0085 => found.extend(bound_sheet(record.data)),
            0x0022 => globals.is_1904 = u16_at(record.data, 0) == Some(1),
            0x041e => globals.add_format(record.data),
            0x00e0 => globals.cell_formats.push(u16_at(record.data, 2).unwrap_or(0)),
            0x00fc => {
                let mut parts = vec![record.data];
                while let Some(more) = records.next_if(|next| next.kind == CONTINUE) {
                    parts.push(more.data);
                }
                globals.texts = shared_texts(&parts);
            }
            _ => {}
        }
    }
    Ok(found.into_iter().map(|(name, at)| (name, globals.cells(&book, at))).collect())
}

/// The name of a worksheet and where it begins; `None` of charts and macros.
fn bound_sheet(data: &[u8]) -> Option<(String, usize)> {
    let is_worksheet = data.get(5)? & 0x0f == 0;
    let name = plain_text(data.get(7..)?, usize::from(*data.get(6)?));
    is_worksheet.then_some((name, u32_at(data, 0)? as usize))
}

/// A text of so many characters after its byte of flags: of one byte each, or of two.
fn plain_text(data: &[u8], count: usize) -> String {
    let Some((flags, rest)) = data.split_first() else { return String::new() };
    if flags & 1 == 0 {
        rest.iter().take(count).map(|&byte| char::from(byte)).collect()
    } else {
        let units: Vec<u16> =
            rest.chunks_exact(2).take(count).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
        String::from_utf16_lossy(&units)
    }
}

/// A record: its kind and its content.
struct BiffRecord<'a> {
    kind: u16,
    data: &'a [u8],
}

struct BiffRecords<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for BiffRecords<'a> {
    type Item = BiffRecord<'a>;

    fn next(&mut self) -> Option<BiffRecord<'a>> {
        let (kind, length) = (u16_at(self.bytes, self.at)?, usize::from(u16_at(self.bytes, self.at + 2)?));
        let data = self.bytes.get(self.at + 4..self.at + 4 + length)?;
        self.at += 4 + length;
        Some(BiffRecord { kind, data })
    }
}

/// The texts that cells share. Their characters go on in the next record after a new byte of flags.
fn shared_texts(parts: &[&[u8]]) -> Vec<String> {
    let mut reader = SharedTextReader { parts, part: 0, at: 8 };
    let mut texts = Vec::new();
    while let Some(text) = reader.text() {
        texts.push(text);
    }
    texts
}

struct SharedTextReader<'a> {
    parts: &'a [&'a [u8]],
    part: usize,
    at: usize,
}

impl SharedTextReader<'_> {
    fn byte(&mut self) -> Option<u8> {
        while self.at >= self.parts.get(self.part)?.len() {
            (self.part, self.at) = (self.part + 1, 0);
        }
        let byte = self.parts[self.part][self.at];
        self.at += 1;
        Some(byte)
    }

    fn number(&mut self, bytes: usize) -> Option<usize> {
        (0..bytes).try_fold(0, |number, index| Some(number | usize::from(self.byte()?) << (8 * index)))
    }

    fn text(&mut self) -> Option<String> {
        let count = self.number(2)?;
        let flags = self.byte()?;
        let runs = if flags & 8 != 0 { self.number(2)? } else { 0 };
        let extension = if flags & 4 != 0 { self.number(4)? } else { 0 };
        let (mut units, mut is_wide) = (Vec::new(), flags & 1 != 0);
        for _ in 0..count {
            if self.at >= self.parts.get(self.part)?.len() {
                is_wide = self.byte()? & 1 != 0;
            }
            units.push(self.number(if is_wide { 2 } else { 1 })? as u16);
        }
        self.skip((4 * runs).saturating_add(extension));
        Some(String::from_utf16_lossy(&units))
    }

    fn skip(&mut self, mut count: usize) {
        while count > 0 {
            let Some(part) = self.parts.get(self.part) else { return };
            let here = (part.len() - self.at.min(part.len())).min(count);
            self.at += here;
            count -= here;
            if count > 0 {
                (self.part, self.at) = (self.part + 1, 0);
            }
        }
    }
}

/// What the sheets of a workbook have in common.
#[derive(Default)]
struct BookGlobals {
    is_1904: bool,
    texts: Vec<String>,
    /// The numbers of formats that show days.
    day_formats: BTreeSet<u16>,
    /// The format of each kind of cell.
    cell_formats: Vec<u16>,
}

impl BookGlobals {
    fn add_format(&mut self, data: &[u8]) {
        let Some(number) = u16_at(data, 0) else { return };
        let count = usize::from(u16_at(data, 2).unwrap_or(0));
        let text = plain_text(data.get(4..).unwrap_or_default(), count);
        // Quoted text and conditions in brackets are no part of a day.
        let (mut is_quoted, mut depth) = (false, 0);
        let mut is_day = false;
        for letter in text.chars() {
            match letter {
                '"' => is_quoted = !is_quoted,
                '[' => depth += 1,
                ']' => depth -= 1,
                'd' | 'y' | 'D' | 'Y' if !is_quoted && depth == 0 => is_day = true,
                _ => {}
            }
        }
        if is_day {
            self.day_formats.insert(number);
        }
    }

    /// Whether cells of a kind show days: by the formats that Excel has built in, and those of the workbook.
    fn is_day(&self, kind: u16) -> bool {
        let format = self.cell_formats.get(usize::from(kind)).copied().unwrap_or(0);
        matches!(format, 14..=17 | 22 | 27..=31 | 36 | 50..=54 | 57 | 58)
            || self.day_formats.contains(&format)
    }

    fn number(&self, number: f64, kind: u16) -> Value {
        if self.is_day(kind) && (0.0..3e6).contains(&number) {
            return Value::String(day(number + if self.is_1904 { DAYS_TO_1904 } else { 0.0 }));
        }
        Value::from(number)
    }

    /// The cells of the sheet that begins at a byte.
    fn cells(&self, book: &[u8], at: usize) -> Vec<BiffCell> {
        let mut cells = Vec::new();
        let mut depth = 0;
        // The cell of a formula whose text follows.
        let mut open = None;
        for BiffRecord { kind, data } in (BiffRecords { bytes: book, at }) {
            match kind {
                BOF => depth += 1,
                EOF => {
                    depth -= 1;
                    if depth <= 0 {
                        break;
                    }
                }
                // Charts within a sheet have cells of their own.
                _ if depth != 1 => {}
                0x0207 => {
                    let count = usize::from(u16_at(data, 0).unwrap_or(0));
                    let text = plain_text(data.get(2..).unwrap_or_default(), count);
                    cells.extend(open.take().map(|(row, column)| (row, column, text_value(&text))));
                }
                _ => self.add(kind, data, &mut cells, &mut open),
            }
        }
        cells
    }

    fn add(&self, kind: u16, data: &[u8], cells: &mut Vec<BiffCell>, open: &mut Option<(u32, u32)>) {
        let (Some(row), Some(column)) = (u16_at(data, 0), u16_at(data, 2)) else { return };
        let (row, column) = (u32::from(row), u32::from(column));
        let look = u16_at(data, 4).unwrap_or(0);
        let value = match kind {
            0x00fd => {
                u32_at(data, 6).and_then(|index| self.texts.get(index as usize)).map(|text| text_value(text))
            }
            0x0203 => f64_at(data, 6).map(|number| self.number(number, look)),
            0x027e => u32_at(data, 6).map(|packed| self.number(unpacked(packed), look)),
            0x0204 | 0x00d6 => {
                let count = usize::from(u16_at(data, 6).unwrap_or(0));
                data.get(8..).map(|rest| text_value(&plain_text(rest, count)))
            }
            0x0205 => data.get(6).filter(|_| data.get(7) == Some(&0)).map(|value| Value::Bool(*value != 0)),
            0x0006 => match data.get(6..14) {
                Some([0, .., 0xff, 0xff]) => {
                    *open = Some((row, column));
                    None
                }
                Some([1, _, value, .., 0xff, 0xff]) => Some(Value::Bool(*value != 0)),
                Some([_, .., 0xff, 0xff]) | None => None,
                Some(_) => f64_at(data, 6).map(|number| self.number(number, look)),
            },
            0x00bd => {
                for (index, cell) in data.get(4..).unwrap_or_default().chunks_exact(6).enumerate() {
                    let (Some(look), Some(packed)) = (u16_at(cell, 0), u32_at(cell, 2)) else { continue };
                    cells.push((row, column + index as u32, self.number(unpacked(packed), look)));
                }
                None
            }
            _ => None,
        };
        cells.extend(value.filter(|value| !value.is_null()).map(|value| (row, column, value)));
    }
}

/// The number that four bytes hold: the upper half of a float or a whole number, perhaps of hundredths.
fn unpacked(packed: u32) -> f64 {
    let number = match packed & 2 {
        0 => f64::from_bits(u64::from(packed & !3) << 32),
        _ => f64::from((packed as i32) >> 2),
    };
    if packed & 1 == 0 { number } else { number / 100.0 }
}

/// A count of days as Excel counts them, as a day and, unless that is midnight, a time.
fn day(count: f64) -> String {
    /// Days from the last of 1899 to the first of 1970.
    const TO_1970: f64 = 25_569.0;
    let seconds = ((count - TO_1970) * 86_400.0).round();
    let moment = crate::moment::Moment::from_milliseconds(seconds * 1000.0);
    let text = moment.map_or_else(|| count.to_string(), |moment| moment.to_string());
    text.strip_suffix("T00:00:00Z").map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_numbers_are_floats_or_whole_numbers_and_hundredths_of_both() {
        assert_eq!(unpacked(0x3ff0_0000), 1.0);
        assert_eq!(unpacked(0x3ff0_0001), 0.01);
        assert_eq!(unpacked((123 << 2) | 2), 123.0);
        assert_eq!(unpacked((((-5i32) << 2) | 3) as u32), -0.05);
    }

    #[test]
    fn days_are_counted_from_1900() {
        assert_eq!(day(46_143.0), "2026-05-01");
        assert_eq!(day(46_143.25), "2026-05-01T06:00:00Z");
    }

    #[test]
    fn texts_go_on_in_the_next_record_with_new_flags() {
        let first = [0, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, b'a', b'b'];
        let second = [1, 0x44, 0x04, 0x45, 0x04, 1, 0, 0, b'z'];
        assert_eq!(shared_texts(&[&first, &second]), ["abфх", "z"]);
    }
}
