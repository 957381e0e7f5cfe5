//! Attributes of a shapefile: dBASE tables (dBASE III PLUS and the types that later versions added).
//!
//! ```text
//! header  version date×3  rows:u32  header length:u16  row length:u16  …  29: language driver
//! columns 32 bytes each, until 0x0d:  name×11  type  …  16: length  17: decimals
//! rows    ' ' or '*' (deleted), then each column's characters
//! ```
//!
//! Written by hand. `dbase` 0.8 turns integers into floats (9007199254740993 loses its last digit), leaves out deleted
//! rows, after which rows and shapes no longer match, and builds eight more crates.

use std::slice::ChunksExact;

use serde_json::{Number, Value};

use crate::encoding::TextEncoding;
use crate::error::VectorError;
use crate::feature::Properties;
use sandtable_base::bytes::ByteCursor;

const FORMAT: &str = "dBASE table (.dbf)";

pub(super) struct DbfTable<'a> {
    columns: Vec<DbfColumn>,
    encoding: TextEncoding,
    /// The complete rows.
    rows: ChunksExact<'a, u8>,
}

struct DbfColumn {
    name: String,
    kind: u8,
    length: usize,
}

pub(super) struct DbfRow<'a> {
    table: &'a DbfTable<'a>,
    bytes: &'a [u8],
}

impl<'a> DbfTable<'a> {
    /// Reads the header of a table whose texts are in `encoding`, else in that of its language driver.
    ///
    /// # Errors
    /// The header is cut short or contradicts itself. Fewer rows than it promises are not an error.
    pub fn open(bytes: &'a [u8], encoding: Option<TextEncoding>) -> Result<Self, VectorError> {
        let broken = |reason: &'static str| VectorError::broken(FORMAT, "its header", reason);
        let cut = || broken("the file ends within it");
        let header = bytes.first_chunk::<32>().ok_or_else(cut)?;
        let u16_at = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let promised = u32::from_le_bytes([header[4], header[5], header[6], header[7]]) as usize;
        let (start, row_bytes) = (u16_at(8), u16_at(10));
        let encoding = encoding.or_else(|| TextEncoding::from_language_driver(header[29]));
        let encoding = encoding.unwrap_or(TextEncoding::Guess);
        let columns = columns(bytes.get(32..start).ok_or_else(cut)?, encoding);
        if row_bytes != 1 + columns.iter().map(|column| column.length).sum::<usize>() {
            return Err(broken("the lengths of its columns do not add up to that of a row"));
        }
        let data = &bytes[start..];
        let rows = promised.min(data.len() / row_bytes);
        Ok(Self { columns, encoding, rows: data[..rows * row_bytes].chunks_exact(row_bytes) })
    }

    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Returns the row `index`, `None` past the end.
    pub fn row(&'a self, index: usize) -> Option<DbfRow<'a>> {
        self.rows.clone().nth(index).map(|bytes| DbfRow { table: self, bytes })
    }
}

fn columns(bytes: &[u8], encoding: TextEncoding) -> Vec<DbfColumn> {
    let (descriptors, _) = bytes.as_chunks::<32>();
    let descriptors = descriptors.iter().take_while(|descriptor| descriptor[0] != 0x0d);
    let column = |descriptor: &[u8; 32]| {
        let (kind, length, decimals) = (descriptor[11], descriptor[16], descriptor[17]);
        // Clipper and FoxPro: the decimals of texts are the upper byte of their length.
        let length = usize::from(length) + if kind == b'C' { usize::from(decimals) << 8 } else { 0 };
        let name = encoding.decode(until_nul(&descriptor[..11])).trim().to_owned();
        DbfColumn { name, kind, length }
    };
    descriptors.map(column).collect()
}

fn until_nul(bytes: &[u8]) -> &[u8] {
    bytes.split(|&byte| byte == 0).next().unwrap_or_default()
}

impl DbfRow<'_> {
    pub fn is_deleted(&self) -> bool {
        self.bytes[0] == b'*'
    }

    /// Returns its values by their columns' names; a blank or malformed value is null.
    pub fn properties(&self) -> Properties {
        let mut cursor = ByteCursor::new(&self.bytes[1..]);
        let value = |column: &DbfColumn| {
            let bytes = cursor.take(column.length)?;
            Some((column.name.clone(), value(column.kind, bytes, self.table.encoding)))
        };
        self.table.columns.iter().filter_map(value).collect()
    }
}

fn value(kind: u8, bytes: &[u8], encoding: TextEncoding) -> Value {
    let text = || encoding.decode(until_nul(bytes));
    match kind {
        b'N' | b'F' => number(text().trim()),
        b'L' => match bytes.first() {
            Some(b'T' | b't' | b'Y' | b'y') => Value::Bool(true),
            Some(b'F' | b'f' | b'N' | b'n') => Value::Bool(false),
            _ => Value::Null,
        },
        b'D' => date(text().trim()),
        b'I' => bytes.try_into().map_or(Value::Null, |bytes| i32::from_le_bytes(bytes).into()),
        b'O' | b'B' => {
            let number = bytes.try_into().ok().and_then(|bytes| Number::from_f64(f64::from_le_bytes(bytes)));
            number.map_or(Value::Null, Value::Number)
        }
        b'C' => match text().trim_end() {
            "" => Value::Null,
            text => text.into(),
        },
        _ => Value::Null,
    }
}

/// Returns a number; an integer where it is written as one.
fn number(text: &str) -> Value {
    match text.parse::<i64>() {
        Ok(integer) => integer.into(),
        Err(_) => text.parse().ok().and_then(Number::from_f64).map_or(Value::Null, Value::Number),
    }
}

/// Returns `YYYYMMDD` as `YYYY-MM-DD`.
fn date(text: &str) -> Value {
    if text.len() == 8 && text.bytes().all(|byte| byte.is_ascii_digit()) && text != "00000000" {
        format!("{}-{}-{}", &text[..4], &text[4..6], &text[6..]).into()
    } else {
        Value::Null
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn table(columns: &[(&str, u8, u8)], rows: &[&[u8]], driver: u8) -> Vec<u8> {
        let start = 32 + 32 * columns.len() as u16 + 1;
        let row = 1 + columns.iter().map(|column| u16::from(column.2)).sum::<u16>();
        let mut bytes = vec![3, 0, 0, 0];
        bytes.extend((rows.len() as u32).to_le_bytes());
        bytes.extend([start.to_le_bytes(), row.to_le_bytes()].concat());
        bytes.resize(32, 0);
        bytes[29] = driver;
        for &(name, kind, length) in columns {
            let mut descriptor = [0; 32];
            descriptor[..name.len()].copy_from_slice(name.as_bytes());
            (descriptor[11], descriptor[16]) = (kind, length);
            bytes.extend(descriptor);
        }
        bytes.push(0x0d);
        rows.iter().for_each(|row| bytes.extend_from_slice(row));
        bytes
    }

    #[test]
    fn every_type_of_value_is_read() {
        let columns = [
            ("name", b'C', 6),
            ("lanes", b'N', 3),
            ("width", b'F', 5),
            ("oneway", b'L', 1),
            ("built", b'D', 8),
        ];
        let bytes = table(&columns, &[b" Stra\xdfe  2 7.50T19990131", b"*                       "], 0x57);
        let table = DbfTable::open(&bytes, None).expect("sound");
        let row = table.row(0).expect("there");
        assert!(!row.is_deleted());
        let expected =
            json!({"name": "Straße", "lanes": 2, "width": 7.5, "oneway": true, "built": "1999-01-31"});
        assert_eq!(json!(row.properties()), expected);
        let blank = table.row(1).expect("there");
        assert!(blank.is_deleted() && blank.properties().values().all(Value::is_null));
        assert!(table.row(2).is_none());
    }

    #[test]
    fn a_table_cut_anywhere_or_with_a_byte_turned_is_read_or_refused() {
        let bytes = table(&[("name", b'C', 6), ("n", b'N', 3)], &[b" abcdef 12".as_slice(); 3], 0);
        for end in 0..bytes.len() {
            let mut turned = bytes.clone();
            turned[end] ^= 0xff;
            for bytes in [&bytes[..end], &turned] {
                let Ok(table) = DbfTable::open(bytes, None) else { continue };
                (0..table.row_count()).for_each(|row| drop(table.row(row).expect("counted").properties()));
            }
        }
    }
}
