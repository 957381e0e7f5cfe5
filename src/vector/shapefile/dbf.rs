//! A shapefile's attributes: dBASE tables (dBASE III PLUS and the types that later versions added).
//!
//! ```text
//! header  version date×3  rows:u32  header length:u16  row length:u16  …  29: language driver
//! columns 32 bytes each, until 0x0d:  name×11  type  …  16: length  17: decimals
//! rows    ' ' or '*' (deleted), then each column's characters
//! ```

use serde_json::{Number, Value};

use crate::vector::codepage::Encoding;
use crate::vector::collect::Properties;
use crate::vector::cursor::ByteCursor;
use crate::vector::error::VectorError;

const FORMAT: &str = "dBASE table (.dbf)";

/// A table.
pub(super) struct DbfTable<'a> {
    columns: Vec<DbfColumn>,
    encoding: Encoding,
    /// All whole rows that there are.
    rows: std::slice::ChunksExact<'a, u8>,
}

struct DbfColumn {
    name: String,
    kind: u8,
    length: usize,
}

/// One row.
pub(super) struct DbfRow<'a> {
    table: &'a DbfTable<'a>,
    bytes: &'a [u8],
}

impl<'a> DbfTable<'a> {
    /// The table that `bytes` are, its texts in `encoding` or, without, what its language driver says.
    ///
    /// # Errors
    /// The header is cut short or contradicts itself. Fewer rows than it promises are no error.
    pub fn open(bytes: &'a [u8], encoding: Option<Encoding>) -> Result<Self, VectorError> {
        let broken = |reason: &str| VectorError::broken(FORMAT, "its header", reason);
        let cut = || broken("it ends within it");
        let header = bytes.first_chunk::<32>().ok_or_else(cut)?;
        let short = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let rows = u32::from_le_bytes([header[4], header[5], header[6], header[7]]) as usize;
        let (start, row_length) = (short(8), short(10));
        let encoding =
            encoding.or_else(|| Encoding::of_language_driver(header[29])).unwrap_or(Encoding::Guessed);
        let columns = columns(bytes.get(32..start).ok_or_else(cut)?, encoding);
        if row_length != 1 + columns.iter().map(|column| column.length).sum::<usize>() {
            return Err(broken("the lengths of its columns do not add up to that of a row"));
        }
        let data = &bytes[start..];
        let rows = rows.min(data.len() / row_length);
        Ok(Self { columns, encoding, rows: data[..rows * row_length].chunks_exact(row_length) })
    }

    /// How many rows there are, deleted ones too.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The row with this index; `None` past the end.
    pub fn row(&'a self, index: usize) -> Option<DbfRow<'a>> {
        self.rows.clone().nth(index).map(|bytes| DbfRow { table: self, bytes })
    }
}

fn columns(bytes: &[u8], encoding: Encoding) -> Vec<DbfColumn> {
    let (descriptors, _) = bytes.as_chunks::<32>();
    let descriptors = descriptors.iter().take_while(|descriptor| descriptor[0] != 0x0d);
    let column = |descriptor: &[u8; 32]| {
        let name = descriptor[..11].split(|&byte| byte == 0).next().unwrap_or_default();
        let length = match descriptor[11] {
            // Clipper and FoxPro: the decimals are the upper byte of long texts' lengths.
            b'C' => usize::from(descriptor[16]) + (usize::from(descriptor[17]) << 8),
            _ => usize::from(descriptor[16]),
        };
        DbfColumn { name: encoding.decode(name).trim().to_owned(), kind: descriptor[11], length }
    };
    descriptors.map(column).collect()
}

impl DbfRow<'_> {
    /// Whether it is marked as deleted.
    pub fn is_deleted(&self) -> bool {
        self.bytes[0] == b'*'
    }

    /// Its values by their columns' names; what is blank or not understood is null.
    pub fn properties(&self) -> Properties {
        let mut cursor = ByteCursor::new(&self.bytes[1..]);
        let value = |column: &DbfColumn| {
            let bytes = cursor.take(column.length)?;
            Some((column.name.clone(), value(column.kind, bytes, self.table.encoding)))
        };
        self.table.columns.iter().filter_map(value).collect()
    }
}

fn value(kind: u8, bytes: &[u8], encoding: Encoding) -> Value {
    let text = || encoding.decode(bytes.split(|&byte| byte == 0).next().unwrap_or_default());
    match kind {
        b'N' | b'F' => number(text().trim()),
        b'L' => match bytes.first() {
            Some(b'T' | b't' | b'Y' | b'y') => Value::Bool(true),
            Some(b'F' | b'f' | b'N' | b'n') => Value::Bool(false),
            _ => Value::Null,
        },
        b'D' => date(text().trim()),
        b'I' => bytes.try_into().map_or(Value::Null, |bytes| i32::from_le_bytes(bytes).into()),
        b'O' | b'B' if bytes.len() == 8 => {
            let bytes = bytes.try_into().unwrap_or_default();
            Number::from_f64(f64::from_le_bytes(bytes)).map_or(Value::Null, Value::Number)
        }
        b'C' => match text().trim_end() {
            "" => Value::Null,
            text => text.into(),
        },
        _ => Value::Null,
    }
}

/// A number as it is written, whole where it is written so.
fn number(text: &str) -> Value {
    match text.parse::<i64>() {
        Ok(whole) => whole.into(),
        Err(_) => text.parse().ok().and_then(Number::from_f64).map_or(Value::Null, Value::Number),
    }
}

/// `YYYYMMDD` as `YYYY-MM-DD`.
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
                (0..table.rows()).for_each(|row| drop(table.row(row).expect("counted").properties()));
            }
        }
    }
}
